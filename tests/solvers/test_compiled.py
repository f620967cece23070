"""Functions compiled by the user's compiler: the same answers, kept, mended when damaged, told when impossible."""

import casadi as ca
import numpy as np
import pytest

from tightspot.errors import InputError
from tightspot.solvers import Fatrop, Ipopt, Nlp, SolveStatus, built, compiled

pytestmark = pytest.mark.skipif(compiled.find_compiler() is None, reason="no C compiler")


def program():
    """Rosenbrock's valley with a bound, made anew each time."""
    x, p = ca.SX.sym("x", 4), ca.SX.sym("p")
    f = ca.sum1((1 - x[:-1]) ** 2 + p * (x[1:] - x[:-1] ** 2) ** 2)
    rows = np.zeros(1), np.full(1, 2.0)
    return Nlp(x, p, f, x[0] + x[1], np.full(4, -2.0), np.full(4, 0.9), *rows, np.zeros(4), np.array([100.0]), (), ())


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("TIGHTSPOT_CACHE_DIR", str(tmp_path))
    return tmp_path / "compiled"


@pytest.mark.parametrize("backend", [Ipopt, Fatrop])
def test_the_answer_is_the_same_and_the_library_is_kept(backend, monkeypatch):
    plain = backend().solve(program())
    first = backend(compiled=True).solve(program())
    assert first.status is plain.status is SolveStatus.SOLVED
    assert first.note == ""
    np.testing.assert_allclose(first.x, plain.x, atol=1e-9)
    (entry,) = compiled.entries()
    assert entry.about["backend"] == backend.name
    assert entry.size > 1000
    monkeypatch.setattr(compiled, "write_functions", None)
    monkeypatch.setattr("tightspot.solvers.ipopt.write_functions", None)
    monkeypatch.setattr("tightspot.solvers.fatrop.write_functions", None)
    again = backend(compiled=True).solve(program())
    np.testing.assert_array_equal(again.x, first.x)
    assert len(compiled.entries()) == 1


def test_a_damaged_library_is_made_again(folder):
    Ipopt(compiled=True).solve(program())
    (entry,) = compiled.entries()
    for name, content in ((compiled.LIBRARY, b"\x7fELF damaged"), (compiled.DESCRIPTION, b"{")):
        (entry.directory / name).unlink()  # a library in use must not be written to
        (entry.directory / name).write_bytes(content)
        assert compiled.entries()[0].about == {}
        report = Ipopt(compiled=True).solve(program())
        assert report.status is SolveStatus.SOLVED
        assert report.note == ""
        assert compiled.entries()[0].about["backend"] == "ipopt"
    assert not list(folder.glob(".making-*"))


def test_without_a_compiler_it_is_told_and_solved(monkeypatch):
    monkeypatch.setattr(compiled, "find_compiler", lambda: None)
    report = Ipopt(compiled=True).solve(program())
    assert report.status is SolveStatus.SOLVED
    assert "no C compiler" in report.note
    assert report.to_dict()["note"] == report.note
    assert compiled.entries() == []


def test_a_compiler_that_fails_is_told(monkeypatch, folder):
    monkeypatch.setattr(compiled, "FLAGS", ("--no-such-flag",))
    report = Ipopt(compiled=True).solve(program())
    assert report.status is SolveStatus.SOLVED
    assert "the C compiler failed" in report.note
    assert compiled.entries() == []
    assert list(folder.iterdir()) == []


def test_a_cache_that_cannot_be_written_is_told(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TIGHTSPOT_CACHE_DIR", str(tmp_path / "file"))
    report = Ipopt(compiled=True).solve(program())
    assert report.status is SolveStatus.SOLVED
    assert "cannot be written" in report.note
    with pytest.raises(InputError, match="cannot be used"):
        compiled.entries()


def test_clearing_touches_nothing_that_is_not_ours(folder):
    Ipopt(compiled=True).solve(program())
    (folder / "somebody-s").mkdir()
    assert len(compiled.clear()) == 1
    assert [path.name for path in folder.iterdir()] == ["somebody-s"]
    assert compiled.clear() == []


def test_other_compilers_and_programs_have_other_keys(monkeypatch):
    Ipopt(compiled=True).solve(program())
    monkeypatch.setattr(compiled, "FLAGS", ("-O0", "-fPIC", "-shared"))
    Ipopt(compiled=True).solve(program())
    assert len({entry.key for entry in compiled.entries()}) == 2


def test_a_built_solver_serves_the_same_symbols_with_other_numbers(monkeypatch):
    built.forget()
    nlp = program()
    built_before = []
    original = Ipopt._build
    monkeypatch.setattr(Ipopt, "_build", lambda self, *a: built_before.append(1) or original(self, *a))
    fields = {name: getattr(nlp, name) for name in nlp.__dataclass_fields__}
    other = Nlp(**fields | {"p0": np.array([1.0]), "ubx": np.full(4, 2.0)})
    first, second = Ipopt().solve(nlp), Ipopt().solve(other)
    assert len(built_before) == 1
    assert np.abs(first.x - second.x).max() > 0.05
    np.testing.assert_allclose(second.x, 1.0, atol=1e-3)
    Ipopt(tolerance=1e-6).solve(nlp)
    assert len(built_before) == 2, "other options, another solver"
    Ipopt().solve(program())
    assert len(built_before) == 3, "other symbols"
    assert Ipopt(time_limit=1e-9).solve(nlp).status is SolveStatus.TIME_LIMIT
    assert len(built_before) == 3, "the time limit needs no other solver"
