"""From a path of circular arcs to a timed trajectory that the vehicle can drive exactly."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tightspot.trajectory import Trajectory
from tightspot.vehicles.single_track import SingleTrack

Array = NDArray[np.float64]


class Arc(NamedTuple):
    """Constant steering over a distance: signed length in m (negative in reverse), curvature in 1/m."""

    length: float
    curvature: float


def merge_arcs(arcs: Sequence[Arc], tolerance: float = 1e-9) -> list[Arc]:
    """The same path without empty arcs and with neighbours of equal curvature and gear joined."""
    merged: list[Arc] = []
    for arc in arcs:
        if abs(arc.length) <= tolerance:
            continue
        last = merged[-1] if merged else None
        if last and abs(last.curvature - arc.curvature) <= tolerance and last.length * arc.length > 0:
            merged[-1] = Arc(last.length + arc.length, arc.curvature)
        else:
            merged.append(arc)
    return merged


def lift_arcs(arcs: Sequence[Arc], start: Array, goal_steering: float, vehicle: SingleTrack) -> Trajectory:
    """Drive each arc from rest to rest and steer at standstill in between.

    The curvature of a path of arcs jumps, which only a standing car can follow. So: steer at the largest rate
    while standing, accelerate, cruise, brake, arc after arc, all within the vehicle's limits. The result satisfies
    the dynamics exactly and sweeps exactly the path's area: if the path is free, so is the trajectory, for all
    times. It is slow, and meant as a guess.

    Args:
        arcs: The path; ``|curvature| <= tan(delta_max) / L``.
        start: Full start state (x, y, theta, v, delta); NaN entries are taken as 0, and so is its speed: the
            optimiser restores it.
        goal_steering: Steering angle at the end, rad; NaN: as it comes.
        vehicle: Wheelbase and limits.

    Returns:
        Knots at every change of input. Without arcs or steering there is one short interval at rest.
    """
    initial = np.nan_to_num(np.asarray(start, float))
    initial[3] = 0.0
    phases: list[tuple[float, float, float]] = []
    steering = float(initial[4])
    arcs = merge_arcs(arcs)
    if arcs and np.isnan(np.asarray(start, float)[4]):
        steering = initial[4] = np.arctan(arcs[0].curvature * vehicle.wheelbase)
    for arc in arcs:
        wanted = float(np.arctan(arc.curvature * vehicle.wheelbase))
        phases += _steer(wanted - steering, vehicle) + _drive(arc.length, vehicle)
        steering = wanted
    if np.isfinite(goal_steering):
        phases += _steer(goal_steering - steering, vehicle)
    if not phases:
        phases = [(1.0, 0.0, 0.0)]
    return _integrate(phases, initial, arcs, vehicle)


def _steer(change: float, vehicle: SingleTrack) -> list[tuple[float, float, float]]:
    """(duration, a, omega) phases that turn the steering by ``change`` rad while standing."""
    if abs(change) < 1e-12:
        return []
    duration = abs(change) / vehicle.limits.steering_rate
    return [(duration, 0.0, change / duration)]


def _drive(length: float, vehicle: SingleTrack) -> list[tuple[float, float, float]]:
    """(duration, a, omega) phases of a trapezoidal speed profile from rest to rest over a signed length."""
    gear = np.sign(length)
    distance = abs(length)
    limit = vehicle.limits.speed[1] if gear > 0 else -vehicle.limits.speed[0]
    rate = min(vehicle.limits.acceleration[1], -vehicle.limits.acceleration[0])
    top = min(limit, np.sqrt(distance * rate))
    ramp = top / rate
    cruise = (distance - top * ramp) / top
    phases = [(ramp, gear * rate, 0.0), (cruise, 0.0, 0.0), (ramp, -gear * rate, 0.0)]
    return [phase for phase in phases if phase[0] > 1e-9]


def _integrate(
    phases: list[tuple[float, float, float]], initial: Array, arcs: Sequence[Arc], vehicle: SingleTrack
) -> Trajectory:
    """Exact states at the phases' ends: on an arc the pose moves along a circle by the distance driven."""
    t, states = [0.0], [initial]
    for duration, a, omega in phases:
        x, y, theta, v, delta = states[-1]
        distance = v * duration + a * duration**2 / 2
        turned = distance * np.tan(delta) / vehicle.wheelbase
        chord = distance * np.sinc(turned / (2 * np.pi))
        heading = theta + turned / 2
        after = [x + chord * np.cos(heading), y + chord * np.sin(heading), theta + turned]
        v = v + a * duration
        states.append(np.array([*after, 0.0 if abs(v) < 1e-9 else v, delta + omega * duration]))
        t.append(t[-1] + duration)
    inputs = np.array([phase[1:] for phase in phases])
    return Trajectory(np.array(t), np.array(states), inputs, vehicle.state_names, vehicle.input_names)
