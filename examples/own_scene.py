"""A scene and a vehicle of one's own: a delivery van backs into an L-shaped yard."""

import tightspot

van = tightspot.SingleTrack.rectangular(
    "van",
    wheelbase=3.2,
    length=5.3,
    width=2.0,
    rear_overhang=1.1,
    limits=tightspot.vehicle("lincoln-mkz").limits,
)
yard = tightspot.Scenario.from_dict(
    {
        "name": "yard",
        "workspace": {"x": [-8, 14], "y": [-9, 6]},
        "obstacles": [
            {
                "name": "building",  # an L: not convex, and given as it is
                "vertices": [[-8, -2.5], [1, -2.5], [1, -9], [-3, -9], [-3, -6], [-8, -6]],
            },
            {"name": "wall", "vertices": [[3.7, -9], [14, -9], [14, -2.5], [3.7, -2.5]]},
        ],
        "start": {"x": -4, "y": 0.5, "theta": 0},
        "goal": {"x": 2.35, "y": -6.5, "theta": 1.5707963267948966},
    }
)

try:
    plan = tightspot.plan(yard, vehicle=van, margin=0.1)
except tightspot.PlanningError as error:
    print("no plan:", error.reason)
    print("worst moment of the last attempt:", error.witness)
else:
    print(plan.certificate.summary()[0])
