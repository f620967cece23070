"""CommonRoad's XML files: scenarios read and written, solutions read (`tightspot.exports` writes them).

CommonRoad (https://commonroad.in.tum.de) is a collection of benchmarks for motion planning on roads. Format: Althoff,
Koschi, Manzinger: CommonRoad: Composable benchmarks for motion planning on roads, IV 2017, and its documentation 2020a.
"""

from tightspot.scenarios.readers.commonroad.elements import decimal
from tightspot.scenarios.readers.commonroad.origin import Origin
from tightspot.scenarios.readers.commonroad.reader import read_commonroad
from tightspot.scenarios.readers.commonroad.reference import (
    Reference,
    checked_reference,
    reference_offset,
    to_rear_axle,
    to_reference,
)
from tightspot.scenarios.readers.commonroad.remainder import to_comment
from tightspot.scenarios.readers.commonroad.solution import CommonRoadSolution, read_commonroad_solution
from tightspot.scenarios.readers.commonroad.task import Task, read_task
from tightspot.scenarios.readers.commonroad.writer import write_commonroad

__all__ = [
    "CommonRoadSolution",
    "Origin",
    "Reference",
    "Task",
    "checked_reference",
    "decimal",
    "read_commonroad",
    "read_commonroad_solution",
    "read_task",
    "reference_offset",
    "to_comment",
    "to_rear_axle",
    "to_reference",
    "write_commonroad",
]
