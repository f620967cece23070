"""Types of the compiled core; see cpp/bindings/module.cpp."""

from collections.abc import Sequence
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

class SearchAnswer(TypedDict):
    outcome: str
    arcs: Array
    cost: float
    expansions: int
    nodes: int
    pose_checks: int
    pair_tests: int
    seconds: float
    blocking: int
    clearance: float
    closed: Array

class CollisionChecker:
    def __init__(
        self, parts: Sequence[Array], workspace: Array, obstacles: Array, first: NDArray[np.int64], margin: float
    ) -> None: ...
    def slack(self, poses: Array) -> Array: ...
    def free_length(self, pose: Array, longest: float, curvature: float) -> float: ...
    def contact(self, pose: Array) -> tuple[int, float]: ...
    @property
    def narrowest(self) -> float: ...
    @property
    def pose_checks(self) -> int: ...
    @property
    def pair_tests(self) -> int: ...

class MotionCost:
    gear_change: float
    reverse: float
    steering: float
    steering_change: float
    full_curvature: float

class SearchOptions:
    cell: float
    heading_bins: int
    step: float
    halvings: int
    steering: Sequence[float]
    full_curvature: float
    cost: MotionCost
    heuristic_weight: float
    patience: int
    tolerance: float
    gears: tuple[int, int]
    backward: bool
    max_words: int
    extra_expansions: int
    max_expansions: int
    time_limit: float
    keep_closed: bool

def reeds_shepp_shortest(start: Array, goal: Array, radius: float) -> tuple[str, Array]: ...
def reeds_shepp_all(start: Array, goal: Array, radius: float) -> list[tuple[str, Array]]: ...
def sample_arcs(start: Array, arcs: Array, spacing: float) -> Array: ...

class RollingLimits:
    def __init__(
        self,
        wheelbase: float,
        steering: float,
        steering_rate: float,
        forwards: float,
        backwards: float,
        slowest: float,
        fastest: float,
        half_window: float,
    ) -> None: ...

def rolling(path: Array, first: float, last: float, limits: RollingLimits) -> tuple[Array, Array, Array]: ...
def search(
    checker: CollisionChecker, start: Array, goal: Array, options: SearchOptions, shortcuts: bool = True
) -> SearchAnswer: ...

class CoverAnswer(TypedDict):
    pair: NDArray[np.int64]
    start: Array
    end: Array
    normal: Array
    support: Array
    proved: Array
    holds: NDArray[np.uint8]
    seen: Array
    seen_at: Array

class JudgeAccuracy:
    tolerance: float
    first_step: float
    max_steps: float
    largest: float
    reserve: float
    rounding: float

class JudgeTask:
    demand: float
    resolution: float
    floor: float
    tolerance: float
    worst: float
    most_open: float

class JudgeSingleTrackMotion:
    def __init__(self, t: Array, start: Array, inputs: Array, parameters: Array) -> None: ...
    def integrate(self, accuracy: JudgeAccuracy) -> bool: ...
    def at(self, times: Array) -> Array: ...
    def apart(self, record: Array) -> tuple[float, Array]: ...
    def nearness(
        self,
        vertices: Array,
        first: NDArray[np.int64],
        frames: NDArray[np.int64],
        obstacles: JudgeObstacles,
        walls: JudgeWalls,
        far: float,
    ) -> tuple[NDArray[np.int64], Array, Array, Array]: ...
    @property
    def substeps(self) -> NDArray[np.int64]: ...
    @property
    def nodes(self) -> Array: ...
    @property
    def node_states(self) -> Array: ...
    @property
    def knots(self) -> Array: ...
    @property
    def extremes(self) -> Array: ...
    @property
    def position_error(self) -> float: ...
    @property
    def heading_error(self) -> float: ...

class JudgeSingleTrackBody:
    def __init__(
        self,
        motion: JudgeSingleTrackMotion,
        vertices: Array,
        first: NDArray[np.int64],
        frames: NDArray[np.int64],
        radii: Array,
        pads: Array,
        reserve: float,
    ) -> None: ...

class JudgeObstacles:
    def __init__(self, vertices: Array, first: NDArray[np.int64]) -> None: ...

class JudgeWalls:
    def __init__(self, normals: Array, supports: Array) -> None: ...

def sampled_clearances(part: Array, poses: Array, obstacles: JudgeObstacles, far: float) -> Array: ...
def sampled_nearness(
    vertices: Array,
    first: NDArray[np.int64],
    poses: Array,
    per_interval: int,
    obstacles: JudgeObstacles,
    walls: JudgeWalls,
    far: float,
) -> tuple[NDArray[np.int64], Array, Array, Array]: ...
def sampled_depths(part: Array, poses: Array, walls: JudgeWalls) -> Array: ...
def judge_cover(body: JudgeSingleTrackBody, barriers: JudgeObstacles | JudgeWalls, task: JudgeTask) -> CoverAnswer: ...
def judge_worst_moments(
    body: JudgeSingleTrackBody,
    barriers: JudgeObstacles | JudgeWalls,
    pairs: NDArray[np.int64],
    times: Array,
    clearances: Array,
) -> tuple[Array, Array]: ...
