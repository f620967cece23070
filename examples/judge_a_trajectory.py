"""The judge alone: is a trajectory from anywhere safe? No optimiser takes part."""

import numpy as np

import tightspot

scene = tightspot.Scenario.from_dict(
    {
        "obstacles": [{"name": "thin wall", "vertices": [[7.0, -1], [7.2, -1], [7.2, 4], [7.0, 4]]}],
        "start": {"x": 0, "y": 0, "theta": 0},
        "goal": {"x": 12, "y": 0, "theta": 0},
    }
)
car = scene.vehicle_model()

# Speed up, cruise at 1 m/s, stop. At all four knots the car is far from the wall: before it or behind it.
t = np.array([0.0, 1.0, 12.0, 13.0])
x, v = np.array([0.0, 0.5, 11.5, 12.0]), np.array([0.0, 1.0, 1.0, 0.0])
states = np.column_stack([x, np.zeros(4), np.zeros(4), v, np.zeros(4)])
inputs = np.array([[1.0, 0.0], [0.0, 0.0], [-1.0, 0.0]])

certificate = tightspot.verify(scene, car, tightspot.Trajectory(t, states, inputs), margin=0.05)
print("certified:", certificate.certified)
for witness in certificate.witnesses:
    print(witness)
