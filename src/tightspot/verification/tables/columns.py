"""What the columns of other people's tables mean: names in common use, and units written into them.

Names are compared in lower case. A unit may stand in brackets (``time [s]``, ``yaw (deg)``), behind a stroke
(``t / ms``) or at the end (``speed_kmh``, ``acceleration_mps2``). Without one a column is in SI units.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from tightspot.errors import Problem
from tightspot.problems import near, shown

MEANINGS: Mapping[str, str] = {
    "t": "time",
    "x": "x of the rear-axle midpoint",
    "y": "y of the rear-axle midpoint",
    "theta": "heading",
    "v": "speed",
    "delta": "steering angle of the front wheels",
    "a": "acceleration",
    "omega": "steering rate",
}
"""The columns that are used, with their meaning."""

_SYNONYMS: Mapping[str, str] = {
    "t": (
        "t time times timestamp stamp tt sec secs seconds elapsed elapsed_time sim_time simtime __time "
        "time_from_start time_stamp"
    ),
    "x": (
        "x px pos_x posx x_pos x_position position_x pose_x x_pose x_rear rear_x x_r xr x_rear_axle rear_axle_x x_coord"
        " x_coordinate"
    ),
    "y": (
        "y py pos_y posy y_pos y_position position_y pose_y y_pose y_rear rear_y y_r yr y_rear_axle rear_axle_y y_coord"
        " y_coordinate"
    ),
    "theta": "theta th yaw heading psi orientation yaw_angle heading_angle pose_theta θ ψ",
    "v": (
        "v speed vel velocity v_x_body longitudinal_velocity longitudinal_speed long_velocity v_long vel_long"
        " linear_velocity"
    ),
    "delta": (
        "delta sigma steer steering steering_angle steer_angle delta_f df delta_front front_wheel_angle"
        " front_steering_angle front_steer wheel_angle steering_angle_front δ σ"
    ),
    "a": "a acc accel acceleration longitudinal_acceleration long_acceleration a_long acc_long",
    "omega": (
        "omega w steering_rate steer_rate steering_angle_rate steering_angle_velocity steering_velocity steering_speed"
        " delta_dot deltadot ddelta delta_rate sigma_dot front_wheel_angle_rate ω"
    ),
    "qx": "qx q_x quat_x orientation.x rotation.x",
    "qy": "qy q_y quat_y orientation.y rotation.y",
    "qz": "qz q_z quat_z orientation.z rotation.z",
    "qw": "qw q_w quat_w orientation.w rotation.w",
    "index": "index idx i k n no nr # step row id seq sample frame timestep time_step knot unnamed:_0 level_0",
    "ignored": (
        "kappa curvature s arc_length arclength distance dist station path_length jerk j gear direction dir z pos_z"
        " position_z pose_z roll pitch yaw_rate yawrate heading_rate theta_dot thetadot dtheta psi_dot beta slip"
        " slip_angle cost radius frame_id child_frame_id name mode label comment lateral_velocity rear_wheel_angle"
        " angular.x angular.y angular.z linear.y linear.z position.z clearance"
    ),
}
_MEANING = {word: meaning for meaning, words in _SYNONYMS.items() for word in words.split()} | {"linear.x": "v"}

PHI = "phi"
"""The heading if another column is the steering angle, the steering angle if another column is the heading."""
_PHI_DOT = ("phi_dot", "phidot", "dphi")

_DEGREE = float(np.pi / 180)
_ANGLE = {"rad": 1.0, "radian": 1.0, "radians": 1.0, "deg": _DEGREE, "degree": _DEGREE, "degrees": _DEGREE}
_RATE = {
    **dict.fromkeys(("rad/s", "radps", "rad_s", "rad_per_s", "rads", "rps", "rad/sec"), 1.0),
    **dict.fromkeys(("deg/s", "degps", "deg_s", "deg_per_s", "dps", "deg/sec"), _DEGREE),
}
_LENGTH = {
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1.0),
    "cm": 1e-2,
    "mm": 1e-3,
    "km": 1e3,
}
_TIME = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec", "millis", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "usec", "µs", "μs", "microseconds"), 1e-6),
    **dict.fromkeys(("ns", "nsec", "nanos", "nanoseconds"), 1e-9),
}
_SPEED = {
    **dict.fromkeys(("m/s", "mps", "m_s", "m_per_s", "ms", "m/sec", "ms^-1", "ms-1"), 1.0),
    **dict.fromkeys(("km/h", "kmh", "kph", "kmph", "km_h"), 1 / 3.6),
}
_ACCELERATION = dict.fromkeys(
    ("m/s^2", "m/s2", "m/s/s", "mps2", "mpss", "m_s2", "m_per_s2", "ms2", "m/s**2", "ms^-2", "ms-2", "m/sec^2"), 1.0
)
UNITS: Mapping[str, Mapping[str, float]] = {
    "t": _TIME,
    "x": _LENGTH,
    "y": _LENGTH,
    "theta": _ANGLE,
    "v": _SPEED,
    "delta": _ANGLE,
    "a": _ACCELERATION,
    "omega": _RATE,
}
"""Units by column, each with what a number in it is to be multiplied by."""

_ANY_UNIT = {unit for units in UNITS.values() for unit in units} | {"-", "1", "none"}
_BRACKETS = re.compile(r"^(.*?)[\s_]*[\[({<]\s*([^\])}>]*?)\s*[\])}>]\s*$")


@dataclass(frozen=True)
class Heading:
    """What one column holds.

    Attributes:
        name: As the file has it.
        meaning: A key of :data:`MEANINGS`, a part of a quaternion, ``index`` or ``ignored``; empty if unknown.
        unit: As written, empty if none was.
        ambiguous: Whether the name alone does not decide between heading and steering angle.
    """

    name: str
    meaning: str
    unit: str = ""
    ambiguous: bool = False

    @property
    def scale(self) -> float:
        """What the numbers are multiplied by to be in SI units."""
        return UNITS.get(self.meaning, {}).get(self.unit, 1.0)


@dataclass(frozen=True)
class Columns:
    """The columns that are used.

    Attributes:
        place: Index of the column of each meaning.
        headings: Of all columns.
        problems: What is wrong with the names.
        ignored: Names of columns that are known but not used.
    """

    place: Mapping[str, int]
    headings: Sequence[Heading]
    problems: Sequence[Problem] = field(default=())
    ignored: Sequence[str] = field(default=())


def heading_of(name: str, unit: str = "") -> Heading:
    """What a column of that name holds; ``unit`` is its unit if a line of its own says so."""
    text = _plain(name)
    if "covariance" in text or name == "-":
        return Heading(name, "ignored")
    if not unit and (found := _BRACKETS.match(text)):
        text, unit = found[1].strip(), found[2].strip()
    for word, own in _readings(text):
        meaning = PHI if word == PHI else "omega" if word in _PHI_DOT else _MEANING.get(word, "")
        written = _plain(unit) or own
        units = UNITS.get("theta" if meaning == PHI else meaning, _ANY_UNIT)
        if meaning and (not own or own in units):
            return Heading(name, meaning, written, meaning == PHI)
    return Heading(name, "", _plain(unit))


def is_unit(text: str) -> bool:
    """Whether a cell of a second header line is a unit."""
    return _plain(text).strip("[]() ") in _ANY_UNIT


def understand(headings: Sequence[Heading]) -> Columns:
    """Which column holds what; with every problem: unknown, ambiguous, repeated and missing columns, odd units."""
    headings = _decided(list(headings))
    problems = [_unknown(heading) for heading in headings if not heading.meaning]
    place: dict[str, int] = {}
    ignored = []
    for index, heading in enumerate(headings):
        if heading.meaning in ("index", "ignored"):
            ignored.append(heading.name)
        elif heading.meaning == PHI:
            sentence = "may be the heading or the steering angle; name it theta or delta"
            problems.append(Problem(_where(heading), sentence))
        elif heading.meaning in place:
            first = headings[place[heading.meaning]].name
            what = MEANINGS.get(heading.meaning, heading.meaning)
            problems.append(Problem(_where(heading), f"means the {what}, as column {shown(first)} does; keep one"))
        elif heading.meaning:
            place[heading.meaning] = index
            problems += _odd_unit(heading)
    return Columns(place, headings, [*problems, *_missing(place, problems), *_yaw_rate(place, headings)], ignored)


def _plain(text: str) -> str:
    text = text.strip().strip("\"'").strip().lower().replace("²", "^2").replace("°", "deg").replace("⁻", "-")
    return re.sub(r"[\s\-]+", "_", text.lstrip("%#").strip()) if not text.startswith("#") or len(text) > 1 else text


def _readings(text: str) -> list[tuple[str, str]]:
    """(word, unit) in the order in which they are tried: whole, last parts of a path, with the unit at the end."""
    parts = [part for part in re.split(r"[./]", text) if part]
    words = [text, *(".".join(parts[-count:]) for count in (2, 1) if len(parts) > 1)]
    found = [(word, "") for word in words]
    if stroke := re.match(r"^(.+?)_*/_*\(?([^()]+?)\)?$", text):
        found.append((stroke[1], stroke[2]))
    for word in words:
        pieces = word.split("_")
        found += [("_".join(pieces[:cut]), "_".join(pieces[cut:])) for cut in range(1, len(pieces))]
    return found


def _decided(headings: list[Heading]) -> list[Heading]:
    """``phi`` is what the other columns leave over; a message's stamp counts if there is no other time."""
    times = [h for h in headings if h.meaning == "t" and not _plain(h.name).endswith("stamp")]
    if times:
        stamps = [h for h in headings if h.meaning == "t" and h not in times]
        headings = [Heading(h.name, "ignored") if h in stamps else h for h in headings]
    known = {heading.meaning for heading in headings}
    has_heading = "theta" in known or {"qz", "qw"} <= known
    if has_heading != ("delta" in known):
        meaning = "delta" if has_heading else "theta"
        return [Heading(h.name, meaning, h.unit) if h.meaning == PHI else h for h in headings]
    return headings


def _where(heading: Heading) -> str:
    return f"column {shown(heading.name)}"


def _unknown(heading: Heading) -> Problem:
    if not heading.name.strip():
        return Problem("column ''", "has no name; name it, or give all names with --columns")
    guesses = near(_plain(heading.name), [word for word in _MEANING if len(word) > 2])
    advice = f"did you mean {guesses[0]!r}? " if guesses else ""
    return Problem(_where(heading), f"is not known; {advice}rename it, remove it, or give all names with --columns")


def _odd_unit(heading: Heading) -> list[Problem]:
    units = UNITS.get(heading.meaning)
    if units is None or not heading.unit or heading.unit in units or heading.unit in ("-", "1", "none"):
        return []
    sentence = f"has the unit {shown(heading.unit)}; known for the {MEANINGS[heading.meaning]} are {', '.join(units)}"
    return [Problem(_where(heading), sentence)]


def _missing(place: Mapping[str, int], others: Sequence[Problem]) -> list[Problem]:
    missing = [name for name in ("x", "y") if name not in place]
    if not missing:
        return []
    sentence = f"is missing: a table needs at least x and y; known names are {', '.join(MEANINGS)} and many others"
    return [Problem(f"column {name}", sentence) for name in missing]


def _yaw_rate(place: Mapping[str, int], headings: Sequence[Heading]) -> list[Problem]:
    """``omega`` is the rate of a steering angle; in tables without one it is often the yaw rate."""
    if "omega" not in place or "delta" in place or _plain(headings[place["omega"]].name) not in ("omega", "w", "ω"):
        return []
    sentence = "may be the steering rate or the yaw rate; name it steering_rate or yaw_rate"
    return [Problem(_where(headings[place["omega"]]), sentence)]
