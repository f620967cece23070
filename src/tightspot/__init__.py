"""Certified collision-free manoeuvres for vehicles among polygons.

The one verb is :func:`plan`::

    import tightspot

    plan = tightspot.plan("vertical")
    print(plan.certificate.clearance)

Names are imported when they are first used, so that ``import tightspot`` costs next to nothing and programs
that only check plans never load an optimiser.
"""

from __future__ import annotations

from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tightspot.errors import (
        BlockedError,
        BuildError,
        GeometryError,
        InputError,
        PlanFileError,
        PlanningError,
        Problem,
        SceneError,
        TableError,
        TightspotError,
        VehicleError,
    )
    from tightspot.exports import export_plan
    from tightspot.geometry import ConvexPolygon
    from tightspot.planner import Explanation, FailureKind, Planner, Progress, minimum_penetration, plan
    from tightspot.scenarios import Obstacle, Scenario, load, save
    from tightspot.scenarios.readers.commonroad import read_commonroad, read_commonroad_solution, write_commonroad
    from tightspot.trajectory import Trajectory
    from tightspot.transcription import Objective
    from tightspot.vehicles import SingleTrack, VehicleModel, load_vehicle, vehicle
    from tightspot.verification import (
        Certificate,
        Plan,
        Table,
        TableVerdict,
        Verdict,
        judge_table,
        load_plan,
        read_table,
        save_plan,
        verify,
        verify_plan,
        write_trajectory_csv,
    )

_ROOMS = {
    "tightspot.errors": (
        "BlockedError",
        "BuildError",
        "GeometryError",
        "InputError",
        "PlanFileError",
        "PlanningError",
        "Problem",
        "SceneError",
        "TableError",
        "TightspotError",
        "VehicleError",
    ),
    "tightspot.exports": ("export_plan",),
    "tightspot.geometry": ("ConvexPolygon",),
    "tightspot.planner": ("Explanation", "FailureKind", "Planner", "Progress", "minimum_penetration", "plan"),
    "tightspot.scenarios": ("Obstacle", "Scenario", "load", "save"),
    "tightspot.scenarios.readers.commonroad": ("read_commonroad", "read_commonroad_solution", "write_commonroad"),
    "tightspot.trajectory": ("Trajectory",),
    "tightspot.transcription": ("Objective",),
    "tightspot.vehicles": ("SingleTrack", "VehicleModel", "load_vehicle", "vehicle"),
    "tightspot.verification": (
        "Certificate",
        "Plan",
        "Table",
        "TableVerdict",
        "Verdict",
        "judge_table",
        "load_plan",
        "read_table",
        "save_plan",
        "verify",
        "verify_plan",
        "write_trajectory_csv",
    ),
}
_ROOM_OF = {name: room for room, names in _ROOMS.items() for name in names}

try:
    __version__ = version("tightspot")
except PackageNotFoundError:  # run from a bare source tree
    __version__ = "0+unknown"


def __getattr__(name: str) -> Any:
    """Import a public name on first use (PEP 562)."""
    if name not in _ROOM_OF:
        raise AttributeError(f"module 'tightspot' has no attribute {name!r}")
    value = getattr(import_module(_ROOM_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


__all__ = [
    "BlockedError",
    "BuildError",
    "Certificate",
    "ConvexPolygon",
    "Explanation",
    "FailureKind",
    "GeometryError",
    "InputError",
    "Objective",
    "Obstacle",
    "Plan",
    "PlanFileError",
    "Planner",
    "PlanningError",
    "Problem",
    "Progress",
    "Scenario",
    "SceneError",
    "SingleTrack",
    "Table",
    "TableError",
    "TableVerdict",
    "TightspotError",
    "Trajectory",
    "VehicleError",
    "VehicleModel",
    "Verdict",
    "__version__",
    "export_plan",
    "judge_table",
    "load",
    "load_plan",
    "load_vehicle",
    "minimum_penetration",
    "plan",
    "read_commonroad",
    "read_commonroad_solution",
    "read_table",
    "save",
    "save_plan",
    "vehicle",
    "verify",
    "verify_plan",
    "write_commonroad",
    "write_trajectory_csv",
]
