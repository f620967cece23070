"""CommonRoad's XML files: scenarios read and written, solutions read (`tightspot.exports` writes them).

CommonRoad (https://commonroad.in.tum.de) is a collection of benchmarks for motion planning on roads. Format: Althoff,
Koschi, Manzinger: CommonRoad: Composable benchmarks for motion planning on roads, IV 2017, and its documentation 2020a.
"""

from tightspot.scenarios.readers.commonroad.origin import Origin
from tightspot.scenarios.readers.commonroad.reader import read_commonroad
from tightspot.scenarios.readers.commonroad.reference import (
    Reference,
    reference_offset,
    to_rear_axle,
    to_reference,
)
from tightspot.scenarios.readers.commonroad.writer import write_commonroad

__all__ = [
    "Origin",
    "Reference",
    "read_commonroad",
    "reference_offset",
    "to_rear_axle",
    "to_reference",
    "write_commonroad",
]
