"""``tightspot verify`` with tables: good ones, bad ones, what cannot be read; and plans elsewhere."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tightspot.scenarios import builtin

TPCAP = Path(__file__).parents[3] / "shared" / "data" / "tpcap"
ISSUE = ("x", "y", "theta", "v", "a", "delta", "omega", "t")


def rows_of(trajectory: Path) -> list[dict[str, float]]:
    with trajectory.open(encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def issue_table(rows, path: Path, *, decimals: int = 5) -> Path:
    """Tab-separated x y theta v a sigma omega t with an index column, as pandas writes it."""
    lines = ["\t" + "\t".join("sigma" if name == "delta" else name for name in ISSUE)]
    lines += ["\t".join([str(k), *(f"{row[name]:.{decimals}f}" for name in ISSUE)]) for k, row in enumerate(rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.fixture
def rows(planned):
    return rows_of(planned[0] / "trajectory.csv")


@pytest.fixture
def table(rows, tmp_path):
    """The shared plan's motion as somebody else writes it."""
    return issue_table(rows, tmp_path / "oblique.tsv")


def test_a_third_party_table_is_upheld(cli, table):
    result = cli("verify", table, "--scene", "oblique")
    assert (result.code, result.err) == (0, ""), result.out
    lines = result.out.splitlines()
    assert lines[:2] == ["the trajectory is upheld", "collision-free: proved for the interpolated motion at all times"]
    assert any(line.startswith("score: integral of a^2 + (v omega)^2") for line in lines)
    answer = cli("verify", table, "--scene", "oblique", "--json")
    assert answer.code == 0
    data = answer.json
    assert (data["status"], data["kind"], data["collision"]) == ("upheld", "table", "free")
    assert data["clearance"] > 0.04
    assert data["table"]["columns"]["delta"] == "sigma"
    assert data["reasons"] == data["witnesses"] == []


def test_the_plan_and_its_own_table_agree(cli, planned):
    plan = cli("verify", planned[0] / "plan.json", "--json").json
    table = cli("verify", planned[0] / "trajectory.csv", "--scene", "oblique", "--margin", "0.04", "--json").json
    assert plan["status"] == table["status"] == "upheld"
    assert plan["collision"] == table["collision"] == "free"
    assert table["clearance"] == pytest.approx(plan["judged_anew"]["clearance"], abs=5e-3)
    for key, value in plan["scores"].items():
        assert table["scores"][key] == pytest.approx(value, rel=0.03), key


def hit(rows):
    for row in rows:
        row["y"] -= 0.4


def slip(rows):
    for row in rows:
        row["theta"] += 0.04


def jump(rows):
    rows[len(rows) // 2]["x"] += 0.05


def speed(rows):
    for row in rows:
        row["v"] *= 1.3


def short(rows):
    del rows[-len(rows) // 4 :]


BAD = {"obstacles": hit, "side slip": slip, "speed against motion": jump, "speed": speed, "goal position": short}


@pytest.mark.parametrize("check", BAD)
def test_bad_tables_are_refuted(check, cli, rows, tmp_path):
    BAD[check](rows)
    path = issue_table(rows, tmp_path / "bad.tsv")
    result = cli("verify", path, "--scene", "oblique")
    assert result.code == 1
    assert result.out.startswith("the trajectory is NOT upheld\n")
    assert f"FAILED {check}:" in result.out
    answer = cli("verify", path, "--scene", "oblique", "--json")
    assert answer.code == 1
    assert answer.json["status"] == "not-upheld"
    assert any(reason.startswith(f"{check}:") for reason in answer.json["reasons"])
    assert answer.json["collision"] == ("collides" if check == "obstacles" else "free")


def test_an_obstacle_moved_into_the_way(cli, table, rows, tmp_path):
    scene = builtin("oblique").to_dict()
    middle = rows[len(rows) // 2]
    x, y = middle["x"], middle["y"]
    scene["obstacles"].append({"name": "post", "vertices": [[x, y], [x + 0.1, y], [x + 0.1, y + 0.1], [x, y + 0.1]]})
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    data = cli("verify", table, "--scene", path, "--json").json
    assert data["collision"] == "collides"
    assert data["witnesses"][0]["obstacle"] == "post"
    worst = data["witnesses"][0]["where"]
    nearest = min(rows, key=lambda row: abs(row["t"] - worst["time"]))
    assert np.hypot(nearest["x"] - x, nearest["y"] - y) < 5


def test_the_margin_is_asked_for(cli, table):
    assert cli("verify", table, "--scene", "oblique", "--margin", "0.03").code == 0
    result = cli("verify", table, "--scene", "oblique", "--margin", "0.5", "--json")
    assert result.code == 1
    assert result.json["collision"] == "free"
    assert result.json["witnesses"][0]["kind"] == "margin"


def test_another_vehicle(cli, table):
    data = cli("verify", table, "--scene", "oblique", "--vehicle", "forklift", "--json").json
    assert data["vehicle"] == "forklift"
    assert any("wheelbase" in reason for reason in data["reasons"])


def test_columns_may_be_named(cli, rows, tmp_path):
    path = tmp_path / "bare.txt"
    path.write_text("".join(f"{r['t']:.6f} {r['x']:.6f} {r['y']:.6f} {r['theta']:.6f} 7\n" for r in rows))
    refused = cli("verify", path, "--scene", "oblique")
    assert refused.code == 2
    assert "--columns" in refused.err
    assert cli("verify", path, "--scene", "oblique", "--columns", "t,x,y,theta,-").code == 0


def test_paths_without_times(cli, rows, tmp_path):
    path = tmp_path / "path.csv"
    path.write_text(
        "x,y,yaw\n" + "".join(f"{r['x']:.4f},{r['y']:.4f},{r['theta']:.4f}\n" for r in rows[::3] + rows[-1:])
    )
    result = cli("verify", path, "--scene", "oblique")
    assert result.code == 0, result.out
    assert "there are no times" in result.out
    scores = cli("verify", path, "--scene", "oblique", "--json").json["scores"]
    assert scores["duration"] is None
    assert scores["path_length"] > 0


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_pictures(ending, cli, table, rows, tmp_path):
    for name, path in (("good", table), ("bad", tmp_path / "bad.tsv")):
        if name == "bad":
            hit(rows)
            issue_table(rows, path)
        picture = tmp_path / f"{name}.{ending}"
        result = cli("verify", path, "--scene", "oblique", "--picture", picture, "--json")
        assert result.json["files"] == {"picture": str(picture)}
        assert picture.read_bytes().startswith({"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[ending])


WRONG = {
    "no scene": (["TABLE"], ["--scene", "missing"]),
    "unknown scene": (["TABLE", "--scene", "obliqe"], ["oblique"]),
    "unknown vehicle": (["TABLE", "--scene", "oblique", "--vehicle", "magic"], ["magic"]),
    "negative margin": (["TABLE", "--scene", "oblique", "--margin", "-1"], ["margin", "-1"]),
    "picture of no kind": (["TABLE", "--scene", "oblique", "--picture", "worst.doc"], ["worst.doc", ".png"]),
    "picture nowhere": (["TABLE", "--scene", "oblique", "--picture", "no/where.png"], ["--picture", "no directory"]),
    "too few names": (["TABLE", "--scene", "oblique", "--columns", "x,y"], ["9 values", "2 columns"]),
    "names for a plan": (["PLAN", "--columns", "x,y"], ["--columns", "tables"]),
    "no file": (["missing.csv", "--scene", "oblique"], ["missing.csv"]),
    "a directory": ([".", "--scene", "oblique"], ["directory"]),
}


@pytest.mark.parametrize("kind", WRONG)
def test_bad_input(kind, cli, table, plan_file):
    arguments, words = WRONG[kind]
    arguments = [{"TABLE": table, "PLAN": plan_file}.get(argument, argument) for argument in arguments]
    result = cli("verify", *arguments)
    assert (result.code, result.out) == (2, "")
    assert all(line.startswith("error: ") for line in result.err.splitlines())
    for word in words:
        assert word in result.err
    assert cli("verify", *arguments, "--json").json["status"] == "bad-input"
    assert list(Path().iterdir()) == []


def test_all_problems_of_table_scene_and_vehicle_at_once(cli, tmp_path):
    path = tmp_path / "bad.csv"
    path.write_text("t,x,y,foo\n0,0,nan,0\n0,1,0,0\n")
    for options, words in (([], ["--scene"]), (["--scene", "obliqe", "--vehicle", "papr"], ["obliqe", "papr"])):
        result = cli("verify", path, *options)
        assert result.code == 2
        for word in ("foo", "nan", *words):
            assert word in result.err


def test_a_plan_elsewhere(cli, plan_file):
    same = cli("verify", plan_file, "--scene", "oblique", "--vehicle", "paper")
    assert same.code == 0, same.out
    assert "the stored certificate was not asked" in same.out
    other = cli("verify", plan_file, "--scene", "vertical", "--json")
    assert other.code == 1
    assert other.json["scene"] == "vertical"
    assert other.json["stored_certificate_proves_its_claim"] is None
    wider = cli("verify", plan_file, "--vehicle", "lincoln-mkz", "--json")
    assert wider.code == 1
    assert wider.json["judged_anew"]["failed"]
    assert cli("verify", plan_file, "--margin", "0.01").code == 0
    assert cli("verify", plan_file, "--margin", "0.5").code == 1


def test_a_plan_has_scores_and_a_picture(cli, plan_file, tmp_path):
    picture = tmp_path / "worst.png"
    result = cli("verify", plan_file, "--picture", picture)
    assert result.code == 0
    assert "score: duration" in result.out
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_plan_is_known_by_its_first_character(cli, plan_file, tmp_path):
    copy = tmp_path / "plan.txt"
    copy.write_bytes(b"\xef\xbb\xbf \n" + plan_file.read_bytes())
    assert "is no JSON file" in cli("verify", copy).err  # a mark of byte order does not belong there
    copy.write_bytes(plan_file.read_bytes())
    assert cli("verify", copy).code == 0


BLOCKER = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("casadi", "matplotlib"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Blocked())
from tightspot.cli import main
code = main(sys.argv[1:])
loaded = set(sys.modules) & {"casadi", "matplotlib", "tightspot._core", "tightspot.planner", "tightspot.solvers"}
print(sorted(loaded))
sys.exit(code)
"""


def test_nothing_that_optimises_or_draws_need_be_installed(plan_file, table):
    for arguments in ([plan_file], [plan_file, "--scene", "oblique"], [table, "--scene", "oblique", "--json"]):
        command = [sys.executable, "-c", BLOCKER, "verify", *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[-1] == "[]"
    command = [sys.executable, "-c", BLOCKER, "verify", str(plan_file), "--picture", "worst.png"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "matplotlib" in done.stderr


@pytest.mark.skipif(not TPCAP.is_dir(), reason=f"the TPCAP scenes are not in {TPCAP}")
def test_a_competition_scene(cli, tmp_path):
    """A table for a scene 4.5e9 m from the origin, in the file's own coordinates; shifted by 8 cm it collides."""
    planned = cli("plan", TPCAP / "Case13.csv", "--output", tmp_path / "plan", "--no-picture", "--json")
    assert planned.code == 0, planned.err
    rows = rows_of(tmp_path / "plan" / "trajectory.csv")
    good = issue_table(rows, tmp_path / "good.tsv", decimals=6)
    assert cli("verify", good, "--scene", TPCAP / "Case13.csv", "--vehicle", "tpcap").code == 0
    collided = 0
    for dx, dy in ((0.08, 0), (-0.08, 0), (0, 0.08), (0, -0.08)):
        moved = [{**row, "x": row["x"] + dx, "y": row["y"] + dy} for row in rows]
        result = cli("verify", issue_table(moved, tmp_path / "bad.tsv"), "--scene", TPCAP / "Case13.csv", "--json")
        assert result.code == 1  # it does not begin where the scene does, either
        collided += result.json["collision"] == "collides"
    assert collided >= 1
