"""Scenes: what they are, the built-in ones, files, and whether a vehicle can stand at start and goal."""

from tightspot.scenarios.blocked import Blocked, blocked
from tightspot.scenarios.bottleneck import Bottleneck, bottleneck
from tightspot.scenarios.check import check
from tightspot.scenarios.clearances import Clearance, clearance, clearances, workspace_excess
from tightspot.scenarios.library import builtin, names, summaries
from tightspot.scenarios.obstacle import Obstacle
from tightspot.scenarios.readers import FORMATS, load, save
from tightspot.scenarios.scenario import Scenario, Tolerance
from tightspot.scenarios.schema import json_schema

__all__ = [
    "FORMATS",
    "Blocked",
    "Bottleneck",
    "Clearance",
    "Obstacle",
    "Scenario",
    "Tolerance",
    "blocked",
    "bottleneck",
    "builtin",
    "check",
    "clearance",
    "clearances",
    "json_schema",
    "load",
    "names",
    "save",
    "summaries",
    "workspace_excess",
]
