#!/usr/bin/python3
"""Several runs in one chart:  outcomes.py FOLDER PICTURE   with the folder that `talus compare SCENE --series ...` wrote"""
import sys
from pathlib import Path

from talus_results import Results, Table
from talus_style import plt, save

folder = Path(sys.argv[1])
sweep, runs = Table(folder / "sweep.csv"), Table(folder / "runs.csv")
varied = f"{runs['key'][0].rpartition('.')[2].replace('_', ' ')} [{runs['unit'][0] or '-'}]"

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
left.plot(sweep["value"], sweep["travel_distance_m"], "o-")
left.set(xlabel=varied, ylabel="travel distance [m]")
for value, name in zip(runs["value"], runs["folder"]):
    history = Results(folder / name).history
    right.plot(history.time, history["crest_displacement_m"], label=value if isinstance(value, str) else f"{value:g}")
right.set(xlabel="time [s]", ylabel="displacement of the crest [m]")
right.legend(title=varied, fontsize=8, title_fontsize=8)
save(figure, Path(sys.argv[2]))
print(f"{len(sweep)} runs; the slide travels by {min(sweep['travel_distance_m']):.2f} to {max(sweep['travel_distance_m']):.2f} m")
