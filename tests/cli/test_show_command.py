"""``tightspot show``: pictures by the ending of the name."""

from __future__ import annotations

import json

import pytest


def test_by_default_a_png_beside_the_plan(cli, plan_file):
    result = cli("show", plan_file)
    assert (result.code, result.err) == (0, "")
    picture = plan_file.with_suffix(".png")
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert str(picture) in result.out


@pytest.mark.parametrize(("ending", "start"), [("svg", b"<?xml"), ("pdf", b"%PDF"), ("PNG", b"\x89PNG")])
def test_the_ending_chooses_the_format(ending, start, cli, plan_file, tmp_path):
    picture = tmp_path / f"picture.{ending}"
    result = cli("show", plan_file, "-o", picture, "--json")
    assert result.code == 0
    assert result.json == {"status": "drawn", "upheld": True, "files": {"picture": str(picture)}}
    assert picture.read_bytes().startswith(start)


def test_what_is_not_upheld_is_not_drawn_as_certified(cli, plan_file, monkeypatch):
    from tightspot import plotting

    plan = json.loads(plan_file.read_text())
    for point in plan["vehicle"]["body"][0]["vertices"]:
        point[1] *= 1.5
    plan_file.write_text(json.dumps(plan))
    drawn = []
    monkeypatch.setattr(plotting, "show_plan", lambda plan, path: drawn.append(plan))
    result = cli("show", plan_file, "--json")
    assert result.code == 0
    assert result.json["upheld"] is False
    assert "warning: the plan is not upheld" in result.err
    assert drawn[0].certificate.certified is False


@pytest.mark.slow
def test_animation(cli, plan_file, tmp_path):
    from PIL import Image

    assert cli("show", plan_file, "-o", tmp_path / "motion.gif").code == 0
    with Image.open(tmp_path / "motion.gif") as image:
        assert image.n_frames > 10


@pytest.mark.parametrize("name", ["picture.bmp", "picture", "missing/picture.png"])
def test_other_endings_and_missing_directories_are_refused(name, cli, plan_file, tmp_path):
    before = set(tmp_path.rglob("*"))
    result = cli("show", plan_file, "-o", tmp_path / name)
    assert (result.code, result.out) == (2, "")
    assert len(result.err.splitlines()) == 1
    assert result.err.startswith("error: ")
    assert set(tmp_path.rglob("*")) == before


def test_a_directory_is_no_picture(cli, plan_file, tmp_path):
    (tmp_path / "there.png").mkdir()
    assert cli("show", plan_file, "-o", tmp_path / "there.png").code == 2
