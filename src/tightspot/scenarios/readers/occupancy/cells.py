"""Which cells are occupied, by the rules of ROS's map_server."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tightspot.scenarios.readers.occupancy.map_file import MapSpec
from tightspot.scenarios.readers.occupancy.pictures import Picture

Mask = NDArray[np.bool_]


def occupied_cells(picture: Picture, spec: MapSpec, unknown_is_occupied: bool) -> Mask:
    """The cells that the vehicle must not enter, shape (rows, columns), the first row at the *bottom*.

    A shade s is an occupancy p = (255 - s) / 255, or s / 255 if negated. Above ``occupied_thresh`` a cell is occupied,
    below ``free_thresh`` free, in between unknown: in mode ``scale`` it then has a probability, which is neither. In
    mode ``raw`` s is the occupancy in percent, and unknown if above 100. Wholly transparent cells are unknown.
    """
    shade = picture.shade.astype(np.float64)  # in single precision 51/255 would be above 0.2
    if spec.mode == "raw":
        occupancy, seen = np.round(shade) / 100, picture.seen & (np.round(shade) <= 100)
    else:
        occupancy, seen = (shade if spec.negate else 255 - shade) / 255, picture.seen
    occupied = seen & (occupancy > spec.occupied_thresh)
    free = seen & (occupancy < spec.free_thresh)
    return np.asarray((~free if unknown_is_occupied else occupied)[::-1])
