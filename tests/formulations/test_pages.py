"""One page a formulation, reachable, with every section; its example runs."""

import re
from pathlib import Path

import pytest

from tightspot.formulations import FORMULATIONS

DOCS = Path(__file__).parents[2] / "docs"
SECTIONS = ["Mathematics", "What it promises", "Size", "When to choose it", "Source"]


@pytest.mark.parametrize("name", FORMULATIONS)
def test_every_member_has_a_page(name):
    text = (DOCS / "formulations" / f"{name}.md").read_text(encoding="utf-8")
    assert re.findall(r"^## (.*)$", text, re.MULTILINE)[:5] == SECTIONS
    assert f"`{name}`" in text
    assert f"formulations/{name}.md" in (DOCS / "choosing.md").read_text(encoding="utf-8")
    assert f"formulations/{name}.md" in (DOCS.parent / "mkdocs.yml").read_text(encoding="utf-8")


def test_the_example_of_minimum_penetration_runs(capsys):
    text = (DOCS / "formulations" / "signed-distance-dual.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```python\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    exec(compile(block, "signed-distance-dual.md", "exec", dont_inherit=True), {})
    assert re.search(r"^body penetrates wall\S* by 2\.5\d\d m at", capsys.readouterr().out)
