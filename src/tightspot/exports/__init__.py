"""Plans as files that others read: tables, ROS messages, CommonRoad solutions, pictures, animations."""

from tightspot.exports.commonroad_solution import write_commonroad_solution
from tightspot.exports.formats import FORMATS, Format, export_plan, format_of
from tightspot.exports.ros import ros_path, ros_trajectory, write_ros_path, write_ros_trajectory

__all__ = [
    "FORMATS",
    "Format",
    "export_plan",
    "format_of",
    "ros_path",
    "ros_trajectory",
    "write_commonroad_solution",
    "write_ros_path",
    "write_ros_trajectory",
]
