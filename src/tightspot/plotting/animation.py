"""The manoeuvre as a moving picture (GIF, MP4)."""

from __future__ import annotations

import io
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.patches import PathPatch, Polygon
from numpy.typing import NDArray
from PIL import Image

from tightspot.errors import InputError, Problem
from tightspot.files import atomic_write
from tightspot.plotting import style
from tightspot.plotting.bodies import body_shape, heading_mark, shape_path, swept_area, wheels
from tightspot.plotting.captions import shortened
from tightspot.plotting.motion import Leg, dense_motion, drive_legs
from tightspot.plotting.scene import draw_ends, draw_scene
from tightspot.plotting.video import mp4
from tightspot.plotting.view import frame_axes, view_box
from tightspot.trajectory import Trajectory
from tightspot.vehicles import VehicleModel
from tightspot.verification import Plan, replay

Array = NDArray[np.float64]

MAX_FRAMES = 1200
LAST_FRAME_MS = 1500
"""How long the last frame stands before the animation begins again, ms."""

_USUAL_LENGTH = 12.0  # s, of an animation whose speed nobody chose
_LONGEST_SIDE = 640  # pixels of the scene
_STRIP = 46  # pixels for the title above it
_MARGIN = 10
_COLORS = 96


def save_animation(plan: Plan, path: str | Path, *, fps: float = 20.0, speedup: float | None = None) -> None:
    """Write the plan's motion as a GIF that repeats for ever or, if the name ends with ``.mp4``, as an MP4 video.

    The body moves as the replayed inputs say; it leaves a trail coloured by gear and its wheels steer.

    Args:
        plan: What to show.
        path: Where to.
        fps: Frames a second, brought to what a GIF can say: whole hundredths of a second a frame.
        speedup: How many times faster than reality; by default the whole number that makes it last at
            most 12 s.

    Raises:
        InputError: ``fps`` or ``speedup`` is not a positive number, or there would be more than 1200 frames.
        TightspotError: An MP4 is asked for and there is no ffmpeg.
        OSError: The file cannot be written; an old file of that name is then unchanged.
    """
    video = Path(path).suffix.lower() == ".mp4"
    content = (film if video else animate)(plan, fps=fps, speedup=speedup)
    atomic_write(path, content)


def animate(plan: Plan, *, fps: float = 20.0, speedup: float | None = None) -> bytes:
    """The GIF of :func:`save_animation` as bytes."""
    times, delay, speedup = _schedule(plan.trajectory, fps, speedup)
    with style.drawing():
        stage, states = _staged(plan, times, speedup)
        palette = _palette([stage.picture(times[k], states[k]) for k in (0, len(times) // 2, -1)])
        pictures = [
            picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in stage.pictures(times, states)
        ]
    durations = [delay] * (len(pictures) - 1) + [LAST_FRAME_MS]
    buffer = io.BytesIO()
    pictures[0].save(
        buffer, "GIF", save_all=True, append_images=pictures[1:], duration=durations, loop=0, optimize=False
    )
    return buffer.getvalue()


def film(plan: Plan, *, fps: float = 20.0, speedup: float | None = None) -> bytes:
    """The MP4 of :func:`save_animation` as bytes; its last picture stands as long as the GIF's."""
    times, delay, speedup = _schedule(plan.trajectory, fps, speedup)
    times = np.append(times, np.full(round(LAST_FRAME_MS / delay), times[-1]))
    with style.drawing():
        stage, states = _staged(plan, times, speedup)
        return mp4(stage.pictures(times, states), 1000 / delay)


def _staged(plan: Plan, times: Array, speedup: float) -> tuple[_Stage, Array]:
    """The scene with its actors, and the states at the times."""
    motion = dense_motion(plan.vehicle, plan.trajectory)
    return _Stage(plan, motion, speedup), replay(plan.vehicle, plan.trajectory).at(times)


def _schedule(trajectory: Trajectory, fps: float, speedup: float | None) -> tuple[Array, int, float]:
    """Times of the frames, s; the delay between them, ms; the speed-up."""
    if speedup is None:
        speedup = float(max(1, math.ceil(trajectory.duration / _USUAL_LENGTH)))
    for name, value in (("fps", fps), ("speedup", speedup)):
        if not (math.isfinite(value) and value > 0):
            raise InputError(Problem(name, f"{value} must be a finite number above 0"))
    delay = max(20, round(100 / fps) * 10)
    count = math.ceil(trajectory.duration / (speedup * delay / 1000) - 1e-9)
    if count + 1 > MAX_FRAMES:
        raise InputError(
            Problem(
                "speedup",
                f"{speedup:g} gives {count + 1} frames, more than {MAX_FRAMES}; raise it or lower fps",
            )
        )
    times = trajectory.t[0] + np.minimum(np.arange(count + 1) * speedup * delay / 1000, trajectory.duration)
    return times, delay, speedup


class _Stage:
    """A figure with the still scene, drawn once, and the artists that move over copies of it."""

    def __init__(self, plan: Plan, motion: Trajectory, speedup: float) -> None:
        self.vehicle: VehicleModel = plan.vehicle
        self.motion = motion
        self.legs: Sequence[Leg] = drive_legs(motion)
        box = view_box(plan.scenario, swept_points(plan.vehicle, motion))
        scale = _LONGEST_SIDE / max(box.width, box.height)
        width, height = round(box.width * scale), round(box.height * scale)
        full_width, full_height = max(width, 320) + 2 * _MARGIN, height + _MARGIN + _STRIP
        self.figure = style.new_figure(full_width / style.DPI, full_height / style.DPI)
        left = (full_width - width) / 2
        self.axes = self.figure.add_axes(
            (left / full_width, _MARGIN / full_height, width / full_width, height / full_height)
        )
        draw_scene(self.axes, plan.scenario)
        draw_ends(self.axes, plan.scenario, plan.vehicle, mark=False)
        frame_axes(self.axes, box)
        self.axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
        self._title(plan.scenario.name, speedup, left / full_width, 1 - 13 / full_height)
        self._actors(plan.trajectory.states[0])
        self.canvas: Any = FigureCanvasAgg(self.figure)
        self.still: Any = self._still()

    def _still(self) -> Any:
        self.canvas.draw()
        return self.canvas.copy_from_bbox(self.figure.bbox)

    def picture(self, time: float, state: Array) -> Image.Image:
        """The scene with everything where it is at the time."""
        self.canvas.restore_region(self.still)
        for artist in self.at(time, state):
            self.figure.draw_artist(artist)
        return Image.fromarray(np.ascontiguousarray(np.asarray(self.canvas.buffer_rgba())[..., :3]))

    def pictures(self, times: Array, states: Array) -> Iterator[Image.Image]:
        """:meth:`picture` at each of the times."""
        return (self.picture(time, state) for time, state in zip(times.tolist(), states, strict=True))

    def at(self, time: float, state: Array) -> list[Artist]:
        """The moving artists, put where they are at the time, in the order to draw them."""
        until = int(np.searchsorted(self.motion.t, time, side="right"))
        for leg, trail in zip(self.legs, self.trails, strict=True):
            driven = self.motion.states[leg.first : min(leg.last + 1, until), :2]
            if len(driven) > 0 and until <= leg.last:
                driven = np.vstack([driven, state[:2]])
            trail.set_data(*driven.T)
        self.body.set_path(shape_path(body_shape(self.vehicle, state)))
        self.mark.set_xy(heading_mark(self.vehicle, state))
        for wheel, outline in zip(self.wheels, wheels(self.vehicle, state), strict=True):
            wheel.set_xy(outline)
        leg = next((leg for leg in self.legs if time < self.motion.t[leg.last]), self.legs[-1])
        self.clock.set_text(f"{time - self.motion.t[0]:.2f} s")
        self.gear.set_text(style.GEAR_NAME[leg.gear])
        self.gear.set_color(style.GEAR[leg.gear])
        self.body.set_edgecolor(style.GEAR[leg.gear])
        return [*self.trails, self.body, self.mark, *self.wheels, self.clock, self.gear]

    def _title(self, name: str, speedup: float, left: float, top: float) -> None:
        right = 1 - left
        self.figure.text(left, top, shortened(name, 24), fontsize=13, fontweight="bold", va="top", parse_math=False)
        look: dict[str, Any] = {"ha": "right", "va": "top", "fontsize": 12, "animated": True}
        self.clock = self.figure.text(right, top, "", family="DejaVu Sans Mono", **look)
        step = 84 / (self.figure.get_figwidth() * style.DPI)
        self.gear = self.figure.text(right - step, top, "", fontweight="bold", **look)
        if speedup != 1:
            look |= {"animated": False, "fontsize": 10, "color": style.SOFT_INK}
            self.figure.text(right - 2 * step, top - 0.003, f"{speedup:g}× real time", **look)

    def _actors(self, state: Array) -> None:
        self.trails = [
            self.axes.plot([], [], color=style.GEAR[leg.gear], linewidth=2.4, zorder=7, animated=True)[0]
            for leg in self.legs
        ]
        look: dict[str, Any] = {"animated": True, "zorder": 8}
        self.body = PathPatch(
            shape_path(body_shape(self.vehicle, state)), facecolor=(style.SWEEP, 0.35), linewidth=2.0, **look
        )
        self.mark = Polygon(heading_mark(self.vehicle, state), color=style.SOFT_INK, linewidth=0, **look)
        self.wheels = [
            Polygon(outline, color=style.INK, linewidth=0, **look) for outline in wheels(self.vehicle, state)
        ]
        for patch in (self.body, self.mark, *self.wheels):
            self.axes.add_patch(patch)


def swept_points(vehicle: VehicleModel, motion: Trajectory) -> Array:
    """Corners of the swept area, shape (n, 2)."""
    import shapely

    return np.asarray(shapely.get_coordinates(swept_area(vehicle, motion.states)))


def _palette(frames: Sequence[Image.Image]) -> Image.Image:
    """One palette for all frames, made from a few of them, so that equal pixels stay equal."""
    width, height = frames[0].size
    sheet = Image.new("RGB", (width, height * len(frames)))
    for row, frame in enumerate(frames):
        sheet.paste(frame, (0, row * height))
    return sheet.quantize(_COLORS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
