#!/usr/bin/python3
"""A field along a vertical line at some times:  profile.py RESULTS FIELD X PICTURE TIME [TIME ...]

The value at an elevation is the mean over the particles nearby, weighted by volume and by the distance in x and y.
"""
import sys
from pathlib import Path

import numpy as np
from talus_results import Results
from talus_style import plt, save

if len(sys.argv) < 6:
    sys.exit(__doc__)
folder, field, x, picture, *times = sys.argv[1:]
results = Results(folder)
if results.snapshots[-1].scalar(field) is None:
    sys.exit(f"there is no field {field}; there are {', '.join(results.snapshots[-1].names())}")
nodes, cells = results.mesh()
corners = nodes[cells]
width = np.median(np.linalg.norm(corners[:, 0] - corners[:, 1], axis=1)) / 2  # half a cell [m]

figure, axes = plt.subplots(figsize=(4.5, 4), layout="constrained")
for time in map(float, times):
    snapshot = results.snapshot_at(time)
    values, unit = snapshot.scalar(field)
    place, volume = snapshot.position(), snapshot.values("volume")
    near = np.abs(place[:, 0] - float(x)) < 2 * width
    if not near.any():
        sys.exit(f"no soil is near x = {x} m at {snapshot.time:g} s")
    elevation = np.arange(place[near, 1].min(), place[near, 1].max(), width)
    distance = np.hypot(place[near, 0] - float(x), place[near, 1] - elevation[:, None]) / width
    weight = volume[near] * np.exp(-distance**2)
    profile = (weight * values[near]).sum(axis=1) / weight.sum(axis=1)
    axes.plot(profile, elevation, label=f"{snapshot.time:g} s, {snapshot.stage}")
    print(f"{snapshot.time:g} s: {field} from {profile.min():.4g} to {profile.max():.4g} {unit}")
axes.set(xlabel=f"{field.replace('_', ' ')} [{unit or '-'}]", ylabel=f"elevation at x = {float(x):g} m [m]")
axes.legend()
save(figure, Path(picture))
