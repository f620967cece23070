"""Pictures to an MP4 video with ffmpeg, the machine's own or the one that the package imageio-ffmpeg brings."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from itertools import chain
from pathlib import Path

from PIL import Image

from tightspot.errors import TightspotError

_OPTIONS = {
    # Even sides, which yuv420p needs, and the colours that players assume.
    "-vf": "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white,scale=out_color_matrix=bt709:out_range=tv",
    "-c:v": "libx264",
    "-crf": "18",
    "-pix_fmt": "yuv420p",
    "-colorspace": "bt709",
    "-color_primaries": "bt709",
    "-color_trc": "bt709",
    # The same input gives the same bytes; the index comes first, for browsers.
    "-threads": "1",
    "-fflags": "+bitexact",
    "-flags:v": "+bitexact",
    "-map_metadata": "-1",
    "-movflags": "+faststart",
    "-f": "mp4",
}


def find_ffmpeg() -> str:
    """The program's path.

    Raises:
        TightspotError: There is none; the sentence says what to install.
    """
    found = shutil.which("ffmpeg")
    if found:
        return found
    try:
        import imageio_ffmpeg

        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except (ModuleNotFoundError, RuntimeError):
        advice = 'install ffmpeg, or: pip install "tightspot[video]"; a GIF needs nothing'
        raise TightspotError(f"MP4 videos need ffmpeg, which was not found; {advice}") from None


def mp4(pictures: Iterable[Image.Image], fps: float) -> bytes:
    """An H.264 video of RGB pictures of one size, ``fps`` a second.

    Raises:
        TightspotError: There is no ffmpeg, or it failed; the sentence has its last words.
    """
    program = find_ffmpeg()
    frames = iter(pictures)
    first = next(frames)
    source = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{first.width}x{first.height}", "-r", f"{fps:g}", "-i", "-")
    with tempfile.TemporaryDirectory() as directory, tempfile.TemporaryFile() as words:
        target = Path(directory) / "film.mp4"
        command = [program, "-nostdin", "-v", "error", "-y", *source, *chain(*_OPTIONS.items()), str(target)]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=words) as process:
            try:
                _feed(process, first, frames)
            except BaseException:
                process.kill()
                raise
        if process.returncode:
            words.seek(0)
            raise TightspotError(f"ffmpeg could not write the video: {_last_line(words.read())}")
        return target.read_bytes()


def _feed(process: subprocess.Popen[bytes], first: Image.Image, frames: Iterable[Image.Image]) -> None:
    assert process.stdin is not None
    try:
        process.stdin.write(first.tobytes())
        for frame in frames:
            process.stdin.write(frame.tobytes())
        process.stdin.close()
    except BrokenPipeError:  # it gave up; its exit code and words say why
        pass


def _last_line(words: bytes) -> str:
    lines = words.decode(errors="replace").strip().splitlines()
    return lines[-1][:200] if lines else "it said nothing"
