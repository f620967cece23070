"""MP4 videos: real frames that another decoder reads, and one sentence where there is no ffmpeg."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tightspot.errors import TightspotError
from tightspot.plotting import save_animation, show_plan
from tightspot.plotting.animation import LAST_FRAME_MS
from tightspot.plotting.video import find_ffmpeg, mp4
from tightspot.verification import Plan


@pytest.fixture(scope="module")
def ffmpeg() -> str:
    try:
        return find_ffmpeg()
    except TightspotError:
        pytest.skip("needs ffmpeg or imageio-ffmpeg")


def frames(ffmpeg: str, video: Path, size: tuple[int, int]) -> np.ndarray:
    """All frames as RGB, (n, height, width, 3)."""
    command = [ffmpeg, "-v", "error", "-i", str(video), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, check=True, capture_output=True).stdout
    return np.frombuffer(raw, np.uint8).reshape(-1, size[1], size[0], 3)


def test_the_pictures_are_in_the_video(ffmpeg: str, tmp_path: Path) -> None:
    colors = [(200, 30, 40), (20, 160, 60), (250, 250, 245), (30, 60, 200)]
    pictures = [Image.new("RGB", (101, 63), color) for color in colors]
    (tmp_path / "v.mp4").write_bytes(mp4(iter(pictures), 10))
    seen = frames(ffmpeg, tmp_path / "v.mp4", (102, 64))
    assert len(seen) == 4
    for frame, color in zip(seen, colors, strict=True):
        assert np.abs(frame[8:50, 8:90].astype(int) - color).max() <= 4


def test_the_manoeuvre_has_the_right_frames_and_moves(ffmpeg: str, plan: Plan, tmp_path: Path) -> None:
    save_animation(plan, tmp_path / "plan.mp4", fps=10, speedup=3)
    save_animation(plan, tmp_path / "plan.gif", fps=10, speedup=3)
    with Image.open(tmp_path / "plan.gif") as image:
        width, height = image.size
        image.seek(30)
        still = np.asarray(image.convert("RGB"), int)
    seen = frames(ffmpeg, tmp_path / "plan.mp4", (width + width % 2, height + height % 2))
    assert len(seen) == 61 + LAST_FRAME_MS // 100
    assert np.array_equal(seen[-1], seen[-5]) or np.abs(seen[-1].astype(int) - seen[-5]).max() < 12, "it stands"
    assert np.abs(seen[30, :height, :width].astype(int) - still).mean() < 4, "the same picture as the GIF's"
    assert (np.abs(seen[40].astype(int) - seen[20]).max(axis=2) > 60).sum() > 1000


def test_the_same_motion_gives_the_same_bytes(ffmpeg: str, plan: Plan, tmp_path: Path) -> None:
    for name in ("a.mp4", "b.mp4"):
        save_animation(plan, tmp_path / name, fps=5, speedup=12)
    assert (tmp_path / "a.mp4").read_bytes() == (tmp_path / "b.mp4").read_bytes()


def test_without_ffmpeg_one_sentence_says_what_to_install(
    plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(TightspotError, match=r'need ffmpeg, which was not found; .*pip install "tightspot\[video\]"'):
        show_plan(plan, tmp_path / "plan.mp4")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.name == "nt", reason="a shell script stands in for ffmpeg")
def test_an_ffmpeg_that_fails_is_quoted(plan: Plan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake = tmp_path / "bin" / "ffmpeg"
    fake.parent.mkdir()
    fake.write_text("#!/bin/sh\necho 'Unknown encoder libx264' >&2\nexit 1\n")
    fake.chmod(0o755)
    monkeypatch.setenv("PATH", f"{fake.parent}:{os.environ['PATH']}")
    with pytest.raises(TightspotError, match="could not write the video: Unknown encoder libx264"):
        save_animation(plan, tmp_path / "plan.mp4", fps=5, speedup=6)
    assert not (tmp_path / "plan.mp4").exists()
