"""Somebody else's trajectory: a table is written, read and judged; then it is told what is wrong with a worse one."""

from pathlib import Path

import numpy as np

import tightspot

# A car that speeds up, turns left and stops, simulated in steps of 10 ms and written down every 50 ms.
L, dt = 2.796, 0.01
rows, (x, y, theta, v, delta) = [], np.zeros(5)
for k in range(801):
    t = k * dt
    a = 0.5 if t < 2 else -0.5 if t >= 6 else 0.0
    omega = 0.05 if t < 3 else -0.05 if 5 <= t < 8 else 0.0
    if k % 5 == 0:
        rows.append((x, y, theta, v, a, delta, omega, t))
    middle_v, middle_delta = v + a * dt / 2, delta + omega * dt / 2
    turn = middle_v * np.tan(middle_delta) / L * dt
    x += middle_v * np.cos(theta + turn / 2) * dt
    y += middle_v * np.sin(theta + turn / 2) * dt
    theta, v, delta = theta + turn, v + a * dt, delta + omega * dt

names = ["x", "y", "theta", "v", "a", "sigma", "omega", "t"]
table = "\n".join(
    ["\t".join(["", *names]), *("\t".join([str(k), *(f"{c:.5f}" for c in r)]) for k, r in enumerate(rows))]
)
Path("somebody.tsv").write_text(table)

scene = tightspot.Scenario.from_dict(
    {
        "vehicle": "paper",
        "obstacles": [{"name": "post", "vertices": [[5.5, 2.6], [5.8, 2.6], [5.8, 2.9], [5.5, 2.9]]}],
        "start": {"x": 0, "y": 0, "theta": 0},
        "goal": {"x": rows[-1][0], "y": rows[-1][1], "theta": rows[-1][2]},
    }
)
verdict = tightspot.judge_table(scene, scene.vehicle_model(), tightspot.read_table("somebody.tsv"))
print("\n".join(verdict.summary()))

# The same rows 0.9 m to the left: the post is hit, and that is not where the scene starts.
columns = dict(zip(names, np.array(rows).T, strict=True))
moved = tightspot.Table.from_columns({**columns, "y": columns["y"] + 0.9})
worse = tightspot.judge_table(scene, scene.vehicle_model(), moved)
print()
for finding in worse.failed:
    print(finding.sentence)
