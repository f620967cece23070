"""Occupancy maps as robots make them: a picture of cells and a YAML file of ROS's map_server that places it."""

from tightspot.scenarios.readers.occupancy.map_file import is_map
from tightspot.scenarios.readers.occupancy.pictures import PICTURES
from tightspot.scenarios.readers.occupancy.reader import picture_alone, read_map

__all__ = ["PICTURES", "is_map", "picture_alone", "read_map"]
