"""The paper's Tables II and V as data, and what rebuilding its problem gave."""

from __future__ import annotations

from typing import NamedTuple


class PaperCell(NamedTuple):
    """One scenario, formulation and guess of Table II.

    Attributes:
        objective: J.
        seconds: The paper's solver time on its machine, s.
        effort: TS = sum of a^2 + omega^2.
        final_time: t_f, s.
    """

    objective: float
    seconds: float
    effort: float
    final_time: float


class KnownRow(NamedTuple):
    """A distinct optimum and what it was reproduced as.

    Attributes:
        scene: Built-in scene.
        printed: J as the paper prints it; ``None`` for optima that the paper does not have.
        objective: J when reproduced.
        final_time: t_f when reproduced, s.
        effort: TS when reproduced.
    """

    scene: str
    printed: float | None
    objective: float
    final_time: float
    effort: float


SIZES: dict[str, tuple[int, int]] = {
    "17": (1166, 266),
    "16": (1286, 306),
    "14": (3446, 1426),
    "18": (3606, 1426),
    "19": (3766, 1426),
    "21": (3766, 1426),
}
"""Equation to the paper's (CN, VN)."""

_A, _B, _C = (1.012, 0.036, 80.3), (1.19, 0.044, 97.2), (1.907, 0.05, 171.3)
_P = (1.221, 0.042, 93.94)
# Equation, guess, vertical (J, TS, t_f) and time, parallel (J, TS, t_f) and time, time of oblique.
_ROWS = (
    ("14", "simplified", _C, 3.515, (1.704, 0.064, 141.49), 13.016, 2.785),
    ("14", "collision-free", _A, 1.470, _P, 3.409, 1.869),
    ("14", "hybrid-astar", _B, 1.610, _P, 1.688, 1.586),
    ("16", "simplified", _B, 0.733, (1.683, 0.063, 138.67), 3.223, 1.131),
    ("16", "collision-free", _A, 0.725, _P, 0.834, 0.827),
    ("16", "hybrid-astar", _B, 0.596, _P, 0.712, 1.001),
    ("17", "simplified", _B, 0.722, (1.647, 0.055, 136.26), 2.561, 0.981),
    ("17", "collision-free", _B, 0.510, _P, 0.703, 0.708),
    ("17", "hybrid-astar", _A, 0.538, _P, 0.920, 0.964),
    ("18", "simplified", _B, 2.057, (1.686, 0.058, 138.47), 7.428, 3.061),
    ("18", "collision-free", _B, 1.971, _P, 4.022, 3.127),
    ("18", "hybrid-astar", _C, 3.472, (1.344, 0.047, 103.81), 2.883, 2.669),
    ("19", "simplified", _B, 2.047, (1.699, 0.059, 139.58), 8.216, 3.174),
    ("19", "collision-free", _B, 2.176, _P, 2.572, 2.546),
    ("19", "hybrid-astar", _B, 1.486, _P, 2.539, 3.544),
    ("21", "simplified", _B, 2.485, (1.684, 0.063, 138.72), 10.137, 3.053),
    ("21", "collision-free", _B, 1.894, _P, 2.501, 2.762),
    ("21", "hybrid-astar", _B, 1.182, _P, 3.374, 2.047),
)
_OBLIQUE = (0.856, 0.032, 70.18)


def _cells() -> dict[tuple[str, str, str], PaperCell]:
    cells = {}
    for equation, guess, vertical, time_vertical, parallel, time_parallel, time_oblique in _ROWS:
        for scene, (objective, effort, final_time), seconds in (
            ("vertical", vertical, time_vertical),
            ("parallel", parallel, time_parallel),
            ("oblique", _OBLIQUE, time_oblique),
        ):
            cells[scene, equation, guess] = PaperCell(objective, seconds, effort, final_time)
    return cells


TABLE_II = _cells()
"""(scene, equation, guess) to what the paper prints."""

KNOWN = (
    KnownRow("oblique", 0.856, 0.8561, 70.19, 0.0317),
    KnownRow("vertical", 1.012, 1.0117, 80.28, 0.0363),
    KnownRow("vertical", 1.19, 1.1894, 97.18, 0.0439),
    KnownRow("vertical", 1.907, 1.9071, 171.31, 0.0498),
    KnownRow("parallel", 1.221, 1.2208, 93.96, 0.0425),
    KnownRow("parallel", 1.344, 1.3438, 103.84, 0.0469),
    KnownRow("parallel", 1.683, 1.6834, 138.67, 0.0627),
    KnownRow("parallel", 1.704, 1.7041, 141.44, 0.0639),
)
"""Rows of Table II that the recovered settings reproduce."""

BETTER = (KnownRow("vertical", None, 0.942, 72.88, 0.0), KnownRow("parallel", None, 1.162, 90.40, 0.0))
"""Better optima of the same programs than the paper has."""

PRINTED_FORM = (
    KnownRow("oblique", None, 22.750, 19.30, 0.0),
    KnownRow("vertical", None, 23.522, 20.13, 0.0),
    KnownRow("parallel", None, 30.841, 27.28, 0.0),
)
"""The best optima known of the programs with the printed settings, none of which is in the paper."""

TABLE_V = {"14": "N_B + N_O", "16": "3", "17": "4", "18": "N_B + N_O", "19": "N_B + N_O", "21": "N_B + N_O"}
"""Auxiliary variables a pair as Table V prints them; (16) and (17) are swapped there: (16) has 4, (17) has 3."""
