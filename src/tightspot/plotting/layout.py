"""Where the parts of a picture stand, in inches: computed from the scene's shape so that none is squeezed."""

from __future__ import annotations

from typing import NamedTuple

WIDTH, HEIGHT = 14.0, 9.0
"""Size of the main picture, inches."""

_LEFT, _RIGHT, _TOP, _BOTTOM = 0.7, 0.35, 1.05, 0.6
_GAP = 0.95  # between columns, for the labels of the right one
_STACK = 0.95  # between a picture and what stands below it
_COLUMN = 3.6  # narrowest column of curves
_LOWEST = 1.2  # lowest picture of the clearance below the scene
_SMALLEST = 0.85  # how much a scene is shrunk to have the clearance below it
_CURVE = 1.6  # height of a curve below everything else
_BESIDE_UP_TO = 3.2  # scenes wider than this many times their height get the whole width


class Rect(NamedTuple):
    """Left, bottom, width and height, inches from the picture's lower left corner."""

    left: float
    bottom: float
    width: float
    height: float

    def within(self, width: float, height: float) -> tuple[float, float, float, float]:
        """The same as fractions of a picture of that size, as matplotlib wants it."""
        return self.left / width, self.bottom / height, self.width / width, self.height / height


class Layout(NamedTuple):
    """Places of the main picture's parts.

    Attributes:
        scene: Exactly as wide and high as the view at equal scales.
        profiles: Curves of states and inputs, four of them: top to bottom, or row by row.
        clearance: The clearance over time.
        columns: Columns in which the profiles stand, 1 or 2.
    """

    scene: Rect
    profiles: list[Rect]
    clearance: Rect
    columns: int


def arrange(aspect: float) -> Layout:
    """Places for a scene whose view is ``aspect`` times as wide as high.

    Square and tall scenes have all curves at their right; wide ones have the clearance below; very wide ones
    take the whole width and have everything below.
    """
    room_x, room_y = WIDTH - _LEFT - _RIGHT, HEIGHT - _TOP - _BOTTOM
    if aspect > _BESIDE_UP_TO:
        return _stacked(room_x, room_x / aspect)
    width = min(room_x - _GAP - _COLUMN, room_y * aspect)
    lower = room_y - _STACK - _LOWEST
    if _SMALLEST * width / aspect <= lower < width / aspect:
        width = lower * aspect
    height = width / aspect
    scene = Rect(_LEFT, HEIGHT - _TOP - height, width, height)
    left = _LEFT + width + _GAP
    column = Rect(left, _BOTTOM, WIDTH - _RIGHT - left, room_y)
    below = room_y - height - _STACK
    if below >= _LOWEST - 1e-9:
        return Layout(scene, _rows(column, 4), Rect(_LEFT, _BOTTOM, width, below), 1)
    *profiles, clearance = _rows(column, 5)
    scene = scene._replace(bottom=scene.bottom - max(0.0, (room_y - height) / 2))
    return Layout(scene, profiles, clearance._replace(height=clearance.height - 0.1), 1)


def _stacked(width: float, height: float) -> Layout:
    scene = Rect(_LEFT, HEIGHT - _TOP - height, width, height)
    rest = scene.bottom - _STACK - _BOTTOM
    half = (width - _GAP) / 2
    clearance = Rect(_LEFT, _BOTTOM, half, rest)
    quarter = (half - _GAP) / 2
    columns = [_rows(Rect(_LEFT + half + _GAP + i * (quarter + _GAP), _BOTTOM, quarter, rest), 2) for i in range(2)]
    return Layout(scene, [columns[0][0], columns[1][0], columns[0][1], columns[1][1]], clearance, 2)


def _rows(column: Rect, count: int, gap: float = 0.28) -> list[Rect]:
    height = (column.height - gap * (count - 1)) / count
    return [
        column._replace(bottom=column.bottom + (count - 1 - i) * (height + gap), height=height) for i in range(count)
    ]


class Page(NamedTuple):
    """Places of a picture that is built around one scene.

    Attributes:
        width: Of the picture.
        height: Of the picture.
        scene: Exactly as wide and high as the view at equal scales.
        detail: A magnified square at the scene's right, or ``None``.
        curve: A curve over time below both, or ``None``.
    """

    width: float
    height: float
    scene: Rect
    detail: Rect | None
    curve: Rect | None


def page(aspect: float, *, detail: bool = False, curve: bool = False, narrowest: float = 8.0) -> Page:
    """A page for a scene whose view is ``aspect`` times as wide as high; its size follows its contents.

    Args:
        aspect: Of the view.
        detail: Whether a magnified square stands beside the scene.
        curve: Whether a curve stands below.
        narrowest: Smallest width of the page, so that title and legend find room.
    """
    room_x, room_y = WIDTH - _LEFT - _RIGHT, HEIGHT - _TOP - _BOTTOM
    below = _STACK + _CURVE if curve else 0.0
    side, gap = 0.0, 0.0
    if detail:
        gap = _GAP
        side = max(3.0, min(room_y - below, (room_x - gap) / (aspect + 1)))
    row = side if detail else room_y - below
    width = min(room_x - gap - side, row * aspect)
    size = width / aspect
    row = max(size, side)
    full = max(_LEFT + width + gap + side + _RIGHT, narrowest)
    high = _TOP + row + below + _BOTTOM
    top = high - _TOP
    return Page(
        full,
        high,
        Rect(_LEFT, top - size, width, size),
        Rect(_LEFT + width + gap, top - side, side, side) if detail else None,
        Rect(_LEFT, _BOTTOM, full - _LEFT - _RIGHT, _CURVE) if curve else None,
    )
