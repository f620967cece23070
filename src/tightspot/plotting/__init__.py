"""Pictures of scenes, plans and failures, with matplotlib and without its global state.

``draw_*`` put one thing on axes that the caller owns; ``figure_*`` compose whole pictures; :func:`save`,
:func:`save_animation` and :func:`show_plan` write files, whole or not at all.
"""

from tightspot.errors import TightspotError

try:
    import matplotlib as _matplotlib  # noqa: F401
except ModuleNotFoundError:
    raise TightspotError(
        'pictures need matplotlib, which is not installed; install it with: pip install "tightspot[plot]"'
    ) from None

from tightspot.plotting.animation import save_animation
from tightspot.plotting.bodies import draw_body, swept_area
from tightspot.plotting.explanation_figure import figure_explanation
from tightspot.plotting.failure_figure import figure_failure
from tightspot.plotting.motion import Leg, drive_legs
from tightspot.plotting.output import save, show_plan
from tightspot.plotting.panels import Panel, figure_panels
from tightspot.plotting.plan_figure import figure_plan
from tightspot.plotting.profiles import draw_clearance, draw_profile
from tightspot.plotting.scene import draw_path, draw_scene, draw_sweep
from tightspot.plotting.scene_figure import figure_scene
from tightspot.plotting.worst_moment import figure_judged_plan, figure_judged_table

__all__ = [
    "Leg",
    "Panel",
    "draw_body",
    "draw_clearance",
    "draw_path",
    "draw_profile",
    "draw_scene",
    "draw_sweep",
    "drive_legs",
    "figure_explanation",
    "figure_failure",
    "figure_judged_plan",
    "figure_judged_table",
    "figure_panels",
    "figure_plan",
    "figure_scene",
    "save",
    "save_animation",
    "show_plan",
    "swept_area",
]
