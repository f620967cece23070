"""Files: formats, sizes, determinism, and nothing left behind."""

from __future__ import annotations

import itertools
import subprocess
import sys
import time
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from PIL import Image

from tightspot.errors import InputError
from tightspot.plotting import figure_plan, figure_scene, save, save_animation, show_plan
from tightspot.plotting.animation import LAST_FRAME_MS
from tightspot.verification import Plan

from .conftest import make_plan


def test_png_is_an_image_of_the_promised_size(plan: Plan, tmp_path: Path) -> None:
    show_plan(plan, tmp_path / "plan.png")
    with Image.open(tmp_path / "plan.png") as image:
        image.load()
        assert image.size == (1400, 900)
        colors = {color for _, color in image.convert("RGB").getcolors(1 << 24)}
    assert {(0x00, 0x72, 0xB2), (0xD5, 0x5E, 0x00)} <= colors
    assert (tmp_path / "plan.png").stat().st_size < 300_000


def test_svg_and_pdf_are_what_they_say(plan: Plan, tmp_path: Path) -> None:
    show_plan(plan, tmp_path / "plan.svg")
    show_plan(plan, tmp_path / "PLAN.PDF")
    assert "<svg" in (tmp_path / "plan.svg").read_text()[:1000]
    assert (tmp_path / "PLAN.PDF").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize("ending", [".png", ".svg", ".pdf"])
def test_the_same_picture_gives_the_same_bytes(ending: str, plan: Plan, tmp_path: Path) -> None:
    first, second = tmp_path / f"a{ending}", tmp_path / f"b{ending}"
    for path in (first, second):
        save(figure_scene(plan.scenario), path)
    assert first.read_bytes() == second.read_bytes()
    assert b"/CreationDate" not in first.read_bytes()
    assert b"<dc:date>" not in first.read_bytes()


def test_dpi_scales_the_pixels(plan: Plan, tmp_path: Path) -> None:
    save(figure_plan(plan), tmp_path / "large.png", dpi=200)
    with Image.open(tmp_path / "large.png") as image:
        assert image.size == (2800, 1800)


@pytest.mark.parametrize("name", ["plan.jpg", "plan", "plan.png.txt", ".png"])
def test_unknown_endings_get_one_sentence_with_the_list(name: str, plan: Plan, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"must end in \.png, \.svg, \.pdf, \.gif, \.mp4"):
        show_plan(plan, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_an_old_file_survives_a_failure(plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "plan.png"
    target.write_bytes(b"old")
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("disk")))
    with pytest.raises(OSError, match="disk"):
        show_plan(plan, target)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_gif_has_the_right_frames_and_duration(plan: Plan, tmp_path: Path) -> None:
    save_animation(plan, tmp_path / "plan.gif", fps=10, speedup=3)
    with Image.open(tmp_path / "plan.gif") as image:
        durations = []
        for index in range(image.n_frames):
            image.seek(index)
            durations.append(image.info["duration"])
        assert image.info["loop"] == 0
    assert len(durations) == 1 + 60  # 18 s / 3 at 10 a second, and the start
    assert durations == [100] * 60 + [LAST_FRAME_MS]


def test_gif_shows_the_body_moving(plan: Plan, tmp_path: Path) -> None:
    save_animation(plan, tmp_path / "plan.gif", fps=5, speedup=6)
    with Image.open(tmp_path / "plan.gif") as image:
        frames = []
        for index in range(image.n_frames):
            image.seek(index)
            frames.append(np.asarray(image.convert("RGB"), dtype=int))
    pairs = itertools.pairwise(frames)
    changed = [np.abs(after - before).max(axis=2) > 30 for before, after in pairs]
    assert all(pixels[60:].sum() > 50 for pixels in changed)
    assert max(pixels.mean() for pixels in changed) < 0.2


def test_gif_by_default_is_short_small_and_quick(plan: Plan, tmp_path: Path) -> None:
    begun = time.process_time()
    show_plan(plan, tmp_path / "plan.gif")
    assert time.process_time() - begun < 10
    assert (tmp_path / "plan.gif").stat().st_size < 3_000_000
    with Image.open(tmp_path / "plan.gif") as image:
        assert image.n_frames == 181  # 18 s twice as fast at 20 a second
        assert max(image.size) < 720


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"fps": 0}, "fps: 0 must be"),
        ({"fps": float("nan")}, "fps: nan must be"),
        ({"speedup": -1}, "speedup: -1 must be"),
        ({"speedup": 0.001}, "raise it or lower fps"),
    ],
)
def test_impossible_animations_are_refused(
    arguments: dict[str, float], sentence: str, plan: Plan, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=sentence):
        save_animation(plan, tmp_path / "plan.gif", **arguments)
    assert list(tmp_path.iterdir()) == []


def test_pictures_far_from_the_origin(tmp_path: Path) -> None:
    offset = np.array([4_484_378_812.7, -354_286_011.3])
    near, far = make_plan(), make_plan(offset=(offset[0], offset[1]))
    show_plan(far, tmp_path / "far.png")
    axes, distant = figure_plan(near).axes[0], figure_plan(far).axes[0]
    moved = offset - far.scenario.offset
    assert distant.get_xlim() == pytest.approx(np.add(axes.get_xlim(), moved[0]), abs=1e-5)
    assert distant.get_ylim() == pytest.approx(np.add(axes.get_ylim(), moved[1]), abs=1e-5)
    assert "4\N{THIN SPACE}484\N{THIN SPACE}378\N{THIN SPACE}810" in distant.get_xlabel()


def test_the_users_settings_neither_matter_nor_change(plan: Plan, tmp_path: Path) -> None:
    save(figure_scene(plan.scenario), tmp_path / "a.png")
    with matplotlib.rc_context({"font.size": 40, "axes.facecolor": "red", "savefig.bbox": "tight"}):
        before = dict(matplotlib.rcParams)
        save(figure_scene(plan.scenario), tmp_path / "b.png")
        assert dict(matplotlib.rcParams) == before
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_pyplot_is_never_loaded() -> None:
    code = "import sys, tightspot.plotting; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_without_matplotlib_one_sentence_says_what_to_install() -> None:
    code = (
        "import sys; sys.modules['matplotlib'] = None\n"
        "from tightspot.errors import TightspotError\n"
        "try:\n    import tightspot.plotting\n"
        "except TightspotError as error:\n    print(error)\n"
    )
    shown = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout
    assert 'pip install "tightspot[plot]"' in shown
    assert len(shown.splitlines()) == 1
