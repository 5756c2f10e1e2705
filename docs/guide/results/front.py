#!/usr/bin/python3
"""The front of a slide over time and its speed:  front.py RESULTS PICTURE"""
import sys
from pathlib import Path

import numpy as np
from talus_results import Results
from talus_style import plt, save

MOVED = 0.05  # soil belongs to the slide if it has moved by more than this [m]

results = Results(sys.argv[1])
time, front = [], []
for snapshot in results.snapshots:
    moved = np.linalg.norm(snapshot.values("displacement"), axis=1) > MOVED
    if moved.any():
        time.append(snapshot.time)
        front.append(snapshot.position()[moved, 0].max())
if len(time) < 2:
    sys.exit(f"no soil has moved by more than {100 * MOVED:g} cm in two snapshots: there is no front")
speed = np.gradient(front, time)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
left.plot(time, front)
left.set(xlabel="time [s]", ylabel="front of the slide, x [m]")
right.plot(time, speed, label="front, from the snapshots")
right.plot(results.history.time, results.history["crest_velocity_m_s"], label="crest, from history.csv")
right.set(xlabel="time [s]", ylabel="speed [m/s]", xlim=left.get_xlim())
right.legend()
save(figure, Path(sys.argv[2]))
print(f"the front ends at x = {front[-1]:.2f} m; its largest speed is {max(speed):.2f} m/s")
