"""``tightspot cache``: list, size, clear."""

import casadi as ca
import numpy as np
import pytest

from tightspot.solvers import Ipopt, Nlp, compiled


@pytest.fixture
def one_kept(tmp_path, monkeypatch):
    if compiled.find_compiler() is None:
        pytest.skip("no C compiler")
    monkeypatch.setenv("TIGHTSPOT_CACHE_DIR", str(tmp_path / "cache"))
    x = ca.SX.sym("x", 2)
    free = np.full(2, -np.inf), np.full(2, np.inf)
    nothing = np.zeros(0)
    nlp = Nlp(x, ca.SX(0, 1), ca.sumsqr(x - 1), ca.SX(0, 1), *free, nothing, nothing, np.zeros(2), nothing, (), ())
    assert Ipopt(compiled=True).solve(nlp).note == ""


def test_an_empty_cache(cli, tmp_path, monkeypatch):
    monkeypatch.setenv("TIGHTSPOT_CACHE_DIR", str(tmp_path / "none"))
    assert cli("cache", "list", "--json").json["entries"] == []
    assert cli("cache", "size", "--json").json["bytes"] == 0
    assert cli("cache", "clear", "--json").json == {"removed": 0, "bytes": 0}
    assert "0 kept" in cli("cache", "list").out
    assert not (tmp_path / "none").exists()


def test_list_size_and_clear(cli, one_kept):
    listed = cli("cache", "list", "--json").json
    assert (listed["count"], len(listed["entries"])) == (1, 1)
    entry = listed["entries"][0]
    assert entry["whole"]
    assert entry["about"]["backend"] == "ipopt"
    assert cli("cache", "size", "--json").json["bytes"] == entry["bytes"] == listed["bytes"] > 0
    shown = cli("cache", "list")
    assert shown.code == 0
    assert entry["key"][:12] in shown.out
    assert cli("cache", "clear", "--json").json == {"removed": 1, "bytes": entry["bytes"]}
    assert cli("cache", "list", "--json").json["count"] == 0


def test_a_damaged_entry_is_listed_as_such(cli, one_kept):
    (entry,) = compiled.entries()
    (entry.directory / compiled.LIBRARY).unlink()  # a library in use must not be written to
    (entry.directory / compiled.LIBRARY).write_bytes(b"")
    assert not cli("cache", "list", "--json").json["entries"][0]["whole"]
    assert "damaged" in cli("cache", "list").out
    assert cli("cache", "clear").code == 0


def test_a_cache_that_is_a_file_is_one_sentence(cli, tmp_path, monkeypatch):
    (tmp_path / "compiled").write_text("")
    monkeypatch.setenv("TIGHTSPOT_CACHE_DIR", str(tmp_path))
    result = cli("cache", "list")
    assert result.code == 2
    assert "TIGHTSPOT_CACHE_DIR" in result.err
    assert "Traceback" not in result.err
