"""Convex polygons, their separation, and the decomposition of polygons that are not convex."""

from tightspot.geometry.decomposition import decompose
from tightspot.geometry.polygon import ConvexPolygon
from tightspot.geometry.rings import Ring, clean_ring
from tightspot.geometry.separation import Separation, best_line, clearance, penetration_depth
from tightspot.geometry.transforms import nearest_angle, rotation, transform, wrap_angle

__all__ = [
    "ConvexPolygon",
    "Ring",
    "Separation",
    "best_line",
    "clean_ring",
    "clearance",
    "decompose",
    "nearest_angle",
    "penetration_depth",
    "rotation",
    "transform",
    "wrap_angle",
]
