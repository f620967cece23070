"""Motions and scenes whose clearance is known, and the brute-force judge they are compared with."""

import numpy as np
import pytest
import shapely

from tightspot.geometry import ConvexPolygon
from tightspot.scenarios import Obstacle, Scenario, Tolerance
from tightspot.trajectory import Trajectory
from tightspot.vehicles import BodyPart, Limits, SingleTrack
from tightspot.verification import Plan, replay, verify

FREE = Limits(speed=(-3, 3), acceleration=(-3, 3), steering=1.2, steering_rate=3)


class Kit:
    """Builders and oracles."""

    @staticmethod
    def box_car(length=4.0, width=2.0, overhang=1.0, wheelbase=2.5, limits=FREE):
        return SingleTrack.rectangular(
            "box", wheelbase=wheelbase, length=length, width=width, rear_overhang=overhang, limits=limits
        )

    @staticmethod
    def drive(car, t, inputs, start=(0, 0, 0, 0, 0)):
        """A trajectory whose knots are the replay of its inputs."""
        t, inputs = np.asarray(t, float), np.asarray(inputs, float)
        states = np.zeros((t.size, car.n_states))
        states[0] = start
        return Trajectory(
            t,
            replay(car, Trajectory(t, states, inputs, car.state_names, car.input_names)).knots,
            inputs,
            car.state_names,
            car.input_names,
        )

    @staticmethod
    def wander(car, seed, steps=12, dt=0.5):
        """A random motion within the car's limits."""
        rng = np.random.default_rng(seed)
        state, inputs = np.zeros(2), []
        bound = np.array([0.9 * car.limits.speed[1], 0.9 * car.limits.steering])
        for _ in range(steps):
            target = rng.uniform(-bound, bound)
            u = np.clip((target - state) / dt, 0.9 * car.input_bounds[0], 0.9 * car.input_bounds[1])
            state, inputs = state + dt * u, [*inputs, u]
        return Kit.drive(car, dt * np.arange(steps + 1), inputs)

    @staticmethod
    def scene(trajectory, obstacles=(), *, room=30.0, **changes):
        """A scene around a trajectory that starts and ends where it does."""
        low, high = trajectory.poses[:, :2].min(axis=0) - room, trajectory.poses[:, :2].max(axis=0) + room
        start, goal = trajectory.states[0, :5], trajectory.states[-1, :5].copy()
        goal[2] = np.arctan2(np.sin(goal[2]), np.cos(goal[2]))
        fields = {
            "name": "test",
            "workspace": ConvexPolygon.rectangle(low[0], high[0], low[1], high[1]),
            "obstacles": tuple(Obstacle(f"o{i}", np.asarray(ring, float)) for i, ring in enumerate(obstacles)),
            "start": start,
            "goal": goal,
            "tolerance": Tolerance(),
        }
        return Scenario(**{**fields, **changes})

    @staticmethod
    def boxes(seed, count, low, high, size=(0.3, 1.5)):
        """Random rectangles at any angle."""
        rng = np.random.default_rng(seed)
        rings = []
        for _ in range(count):
            w, h = rng.uniform(*size, 2)
            box = ConvexPolygon.rectangle(-w, w, -h, h).transformed(*rng.uniform(low, high), rng.uniform(0, 3))
            rings.append(box.vertices)
        return rings

    @staticmethod
    def shapely_clearance(scenario, car, trajectory, times):
        """Distance of body and obstacles at the times by shapely, and the area in which they overlap."""
        states = replay(car, trajectory, tolerance=1e-9).at(np.asarray(times))
        obstacles = shapely.unary_union([polygon.to_shapely() for _, polygon in scenario.obstacle_parts])
        shapely.prepare(obstacles)
        parts = [part.polygon for part in car.parts]
        bodies = [shapely.unary_union([p.transformed(*s[:3]).to_shapely() for p in parts]) for s in states]
        area = np.array([body.intersection(obstacles).area for body in bodies])
        return shapely.distance(np.array(bodies), obstacles), area


@pytest.fixture(scope="session")
def kit():
    return Kit


@pytest.fixture(scope="session")
def plan():
    """A certified plan: a body of two parts turns between three obstacles, one of them in two parts."""
    parts = (
        BodyPart("cab", ConvexPolygon.rectangle(-1, 2, -0.9, 0.9)),
        BodyPart("nose", ConvexPolygon.from_vertices([(2, -0.6), (3, -0.3), (3, 0.3), (2, 0.6)])),
    )
    car = SingleTrack("two-part", 2.5, parts, FREE)
    trajectory = Kit.drive(
        car,
        [0, 1, 2, 3, 4],
        [[1, 0.4], [0, 0.1], [0, -0.9], [-1, 0.4]],
    )
    L = [(5.2, 2.1), (9, 2.1), (9, 3.1), (6.2, 3.1), (6.2, 6), (5.2, 6)]
    scenario = Kit.scene(trajectory, [L, [(3, -2), (9, -2), (9, -0.66), (3, -0.66)], [(-9, -9), (-8, -9), (-8, -8)]])
    return Plan(scenario, car, trajectory, verify(scenario, car, trajectory, margin=0.01), {"solver": "none"})
