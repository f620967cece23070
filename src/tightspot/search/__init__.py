"""Paths without times: Reeds-Shepp curves and hybrid A* over the compiled core."""

from tightspot.search.blocked import blocked_shares
from tightspot.search.hybrid_astar import Car, search
from tightspot.search.options import Direction, EndGears, HybridAStarOptions
from tightspot.search.path import Path
from tightspot.search.reeds_shepp import ReedsSheppPath, Segment, all_paths, shortest_path
from tightspot.search.resolution import (
    COARSE,
    FINE,
    FINEST,
    MEDIUM,
    NARROW,
    NARROWER,
    NARROWEST,
    SMALL_TURNS,
    Resolution,
)
from tightspot.search.result import Attempt, SearchResult, SearchStatus

__all__ = [
    "COARSE",
    "FINE",
    "FINEST",
    "MEDIUM",
    "NARROW",
    "NARROWER",
    "NARROWEST",
    "SMALL_TURNS",
    "Attempt",
    "Car",
    "Direction",
    "EndGears",
    "HybridAStarOptions",
    "Path",
    "ReedsSheppPath",
    "Resolution",
    "SearchResult",
    "SearchStatus",
    "Segment",
    "all_paths",
    "blocked_shares",
    "search",
    "shortest_path",
]
