"""Convex polygons, their separation, and what makes them of polygons that are not convex or not clean."""

from tightspot.geometry.decomposition import convex_parts, decompose
from tightspot.geometry.polygon import ConvexPolygon, is_convex
from tightspot.geometry.rings import Ring, clean_ring
from tightspot.geometry.separation import Separation, best_line, clearance, penetration_depth
from tightspot.geometry.solids import solid_polygons
from tightspot.geometry.stack import PolygonStack
from tightspot.geometry.transforms import nearest_angle, rotation, transform, wrap_angle

__all__ = [
    "ConvexPolygon",
    "PolygonStack",
    "Ring",
    "Separation",
    "best_line",
    "clean_ring",
    "clearance",
    "convex_parts",
    "decompose",
    "is_convex",
    "nearest_angle",
    "penetration_depth",
    "rotation",
    "solid_polygons",
    "transform",
    "wrap_angle",
]
