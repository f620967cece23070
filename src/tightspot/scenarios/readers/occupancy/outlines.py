"""From occupied cells to polygons: the exact outlines of their union."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray

Mask = NDArray[np.bool_]


def count_sides(mask: Mask) -> int:
    """How many sides of cells lie between occupied and other cells."""
    padded = np.pad(mask, 1)
    return int(np.count_nonzero(padded[:, 1:] != padded[:, :-1]) + np.count_nonzero(padded[1:] != padded[:-1]))


def outlines(mask: Mask) -> list[shapely.Polygon]:
    """The polygons with holes that the occupied cells of ``mask`` (rows, columns) cover, in units of cells.

    Cell (row, column) is the square [column, column + 1] x [row, row + 1]. Cells that share a corner only belong to
    different polygons, or bound different holes.
    """
    padded = np.pad(mask, 1)
    upright = padded[1:-1, 1:] != padded[1:-1, :-1]  # [row, x]: the side from (x, row) to (x, row + 1)
    level = padded[1:, 1:-1] != padded[:-1, 1:-1]  # [y, column]: the side from (column, y) to (column + 1, y)
    ends_level = np.pad(level, ((0, 0), (1, 1)))
    meets_level = ends_level[:, 1:] | ends_level[:, :-1]  # [y, x]: a level side ends at (x, y)
    ends_upright = np.pad(upright, ((1, 1), (0, 0)))
    meets_upright = ends_upright[1:] | ends_upright[:-1]
    columns, low, high = _runs(upright.T, meets_level.T)
    rows, left, right = _runs(level, meets_upright)
    lines = np.concatenate(
        [
            np.stack([np.stack([columns, low], axis=1), np.stack([columns, high], axis=1)], axis=1),
            np.stack([np.stack([left, rows], axis=1), np.stack([right, rows], axis=1)], axis=1),
        ]
    )
    if not len(lines):
        return []
    faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(lines.astype(float))))
    x, y = np.floor(shapely.get_coordinates(shapely.point_on_surface(faces))).astype(int).T
    return list(faces[mask[y, x]])


def _runs(sides: Mask, breaks: Mask) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Sides along each line joined to runs: index of the line, and where the run begins and ends.

    Args:
        sides: Whether there is a side from k to k + 1, shape (lines, n).
        breaks: Whether a run must end at k, shape (lines, n + 1).
    """
    before = np.pad(sides, ((0, 0), (1, 0)))[:, :-1]
    after = np.pad(sides, ((0, 0), (0, 1)))[:, 1:]
    line, begin = np.nonzero(sides & (~before | breaks[:, :-1]))
    _, end = np.nonzero(sides & (~after | breaks[:, 1:]))
    return line, begin, end + 1
