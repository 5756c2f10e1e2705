#!/usr/bin/python3
"""The front of a slide over time and its speed:  front.py RESULTS PICTURE

The slide goes where its soil has moved on the average by the end. Displacement counts from the last reset (reset_displacement) on. The speed is that of
the soil at the front: the front itself jumps where soil further on begins to belong to the slide, which is no motion.
"""
import sys
from pathlib import Path

import numpy as np
from talus_results import Results
from talus_style import plt, save

MOVED = 0.05  # soil belongs to the slide if it has moved by more than this [m]

results = Results(sys.argv[1])
resets = [k for k, stage in enumerate(results.model()["stages"]) if stage["reset_displacement"]]
before = {"start"} | {stage["name"] for stage in results.model()["stages"][: max(resets, default=-1) + 1]}
snapshots = [snapshot for snapshot in results.snapshots if snapshot.stage not in before and "velocity" in snapshot]
level = [axis for axis in range(snapshots[-1].position().shape[1]) if axis != results.up_axis()] if snapshots else []


def slides(snapshot):
    return np.linalg.norm(snapshot.values("displacement"), axis=1) > MOVED


if not snapshots or not slides(snapshots[-1]).any():
    sys.exit(f"no soil has moved by more than {100 * MOVED:g} cm since the last reset of displacement: there is no front")
last, moved = snapshots[-1], slides(snapshots[-1])
way = np.average(last.values("displacement")[moved], axis=0, weights=last.values("volume")[moved])[level]
way /= np.linalg.norm(way)  # direction on the level

time, front, place, speed = [], [], [], []
for snapshot in snapshots:
    moved = slides(snapshot)
    if moved.any():
        position = snapshot.position()[moved][:, level]
        farthest = np.argmax(position @ way)
        time.append(snapshot.time)
        front.append(position[farthest] @ way)
        place.append(position[farthest])
        speed.append(snapshot.values("velocity")[moved][farthest][level] @ way)
plane = len(level) == 1
towards = f"{'larger' if way[0] > 0 else 'smaller'} x" if plane else "(" + ", ".join(f"{part:.2f}" for part in way) + ")"

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
left.plot(time, np.array(place)[:, 0] if plane else front)
left.set(xlabel="time [s]", ylabel="front of the slide, x [m]" if plane else f"front of the slide towards {towards} [m]")
right.plot(time, speed, label="soil at the front, from the snapshots")
speeds = [name for name in results.history.names() if name.endswith("_velocity_m_s")] if results.history else []
for name in speeds:
    right.plot(results.history.time, results.history[name], label=f"{name.removesuffix('_velocity_m_s')}, from history.csv")
right.set(xlabel="time [s]", ylabel="speed [m/s]", xlim=left.get_xlim())
right.set_ylim(top=1.4 * right.get_ylim()[1])  # room for the legend
right.legend(loc="upper left")
save(figure, Path(sys.argv[2]))
where = ", ".join(f"{'xyz'[axis]} = {value:.2f} m" for axis, value in zip(level, place[-1]))
print(f"the slide goes towards {towards}; the front ends at {where}; the largest speed of the soil there is {max(speed):.2f} m/s")
