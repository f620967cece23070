"""Pictures of cells: PGM is read here, everything else by Pillow. Sizes are checked before anything is decoded."""

from __future__ import annotations

import io
import re
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.errors import Problem, SceneError
from tightspot.scenarios.readers.files import read_bytes, refuse

MAX_CELLS = 4096 * 4096
MAX_BYTES = 60_000_000
PICTURES = (".pgm", ".png", ".bmp", ".ppm", ".gif", ".tif", ".tiff", ".jpg", ".jpeg")
_FORMATS = ("PNG", "BMP", "PPM", "GIF", "TIFF")
_HEADER = re.compile(
    rb"P([25])(?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+?(\d{1,9})(?:#[^\n]*\n|\s)"
)


class Picture(NamedTuple):
    """Cells as the picture shows them, its first row on top.

    Attributes:
        shade: 0 (black) to 255 (white), the mean of the colours, shape (rows, columns).
        seen: False where the picture is wholly transparent, shape (rows, columns).
    """

    shade: NDArray[np.float32]
    seen: NDArray[np.bool_]


def read_picture(path: Path) -> Picture:
    """The picture in a file.

    Raises:
        SceneError: Missing, unreadable, too large, cut off, or Pillow is needed and not installed.
    """
    data = read_bytes(path, MAX_BYTES)
    if data[:2] in (b"P2", b"P5"):
        shade = _pgm(path, data)
        return Picture(shade, np.ones(shape=shade.shape, dtype=bool))
    return _pillow(path, data)


def _pgm(path: Path, data: bytes) -> NDArray[np.float32]:
    header = _HEADER.match(data[:10_000])
    if not header:
        raise refuse(path, "is not readable as PGM: after P2 or P5 must come width, height and the largest value")
    columns, rows, largest = (int(header[k]) for k in (2, 3, 4))
    _check_size(path, columns, rows)
    if not 1 <= largest <= 65_535:
        raise refuse(path, f"has {largest} as its largest value; a PGM picture has 1 to 65535")
    body, count = data[header.end() :], columns * rows
    if header[1] == b"5":
        kind = np.dtype(np.uint8) if largest < 256 else np.dtype(">u2")
        if len(body) < count * kind.itemsize:
            raise _cut_off(path, columns, rows, len(body) // kind.itemsize)
        values = np.frombuffer(body, dtype=kind, count=count)
    else:
        values = _plain_values(path, body, count)
        if values.size < count:
            raise _cut_off(path, columns, rows, values.size)
    if int(values.max()) > largest:
        raise refuse(path, f"has a value {int(values.max())} above {largest}, which it says is the largest")
    shade: NDArray[np.float32] = values.astype(np.float32).reshape(rows, columns)
    return shade if largest == 255 else shade * np.float32(255 / largest)


def _plain_values(path: Path, body: bytes, count: int) -> NDArray[np.int64]:
    """The first ``count`` numbers of a text, comments left out, fewer if there are not as many."""
    words = re.sub(rb"#[^\n]*", b" ", body).split()[:count]
    if words and not all(word.isdigit() and len(word) <= 6 for word in words):
        raise refuse(path, "is not readable as PGM: a value is not a whole number")
    return np.array(words, dtype="S6").astype(np.int64)


def _pillow(path: Path, data: bytes) -> Picture:
    try:
        from PIL import Image
    except ModuleNotFoundError:
        sentence = (
            f'reading {path.suffix or "this"} needs Pillow: pip install "tightspot[readers]"; PGM is read without it'
        )
        raise SceneError(Problem(str(path), sentence)) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Pillow warns of large pictures, which are refused below
            with Image.open(io.BytesIO(data), formats=_FORMATS) as image:
                _check_size(path, *image.size)
                return _cells(image)
    except SceneError:
        raise
    except Exception as error:  # what Pillow's decoders raise has no common base class
        kinds = ", ".join(("PGM", *_FORMATS))
        reason = str(error).partition("<_io")[0] or type(error).__name__
        raise refuse(path, f"is not readable as a picture ({kinds}): {' '.join(reason.split())[:100]}") from None


def _cells(image: Any) -> Picture:
    """Mean of the colours; 16-bit grey is scaled to 8 bits."""
    if image.mode.startswith(("I", "F")):
        values = np.asarray(image, dtype=np.float32)
        scale = 255 / 65_535 if float(values.max(initial=0)) > 255 else 1.0
        shade = np.clip(values * np.float32(scale), 0, 255)
        return Picture(shade, np.ones(shape=shade.shape, dtype=bool))
    if image.mode in ("L", "1"):
        shade = np.asarray(image.convert("L"), dtype=np.float32)
        return Picture(shade, np.ones(shape=shade.shape, dtype=bool))
    layers = np.asarray(image.convert("RGBA"))
    return Picture(layers[..., :3].mean(axis=-1, dtype=np.float32), layers[..., 3] > 0)


def _check_size(path: Path, columns: int, rows: int) -> None:
    if columns < 1 or rows < 1:
        raise refuse(path, f"has {columns} x {rows} cells; it needs one at least")
    if columns * rows > MAX_CELLS:
        raise refuse(path, f"has {columns} x {rows} cells; at most {MAX_CELLS} are read: cut out what is needed")


def _cut_off(path: Path, columns: int, rows: int, found: int) -> SceneError:
    return refuse(path, f"holds {found} of {columns} x {rows} cells that it announces; is it cut off?")
