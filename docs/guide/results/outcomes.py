#!/usr/bin/python3
"""Several runs in one chart:  outcomes.py FOLDER PICTURE   with the folder that `talus compare SCENE --series ...` wrote"""
import sys
from pathlib import Path

import numpy as np
from talus_results import Results, Table
from talus_style import LINES, plt, save

folder = Path(sys.argv[1])
runs = Table(folder / "study.csv")
varied = f"{runs['key'][0].rpartition('.')[2].replace('_', ' ')} [{runs['unit'][0] or '-'}]"

lines = runs["line"]  # its series and, where that varies several keys, the values of all but the last
travel = runs["travel_distance_m"]  # none where a run broke off

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
for colour, line in zip(LINES, dict.fromkeys(lines)):
    of = [k for k in range(len(runs)) if lines[k] == line]
    left.plot(runs["value"][of], travel[of], "o-", color=colour, label=line)
    for k, style in zip(of, 2 * ("-", "--", ":", "-.")):
        history, value = Results(folder / runs["folder"][k]).history, runs["value"][k]
        text = value if isinstance(value, str) else f"{value:g}"
        alone = len(set(lines)) == 1
        right.plot(history.time, history["crest_displacement_m"], ls="-" if alone else style, color=None if alone else colour, label=text if alone else f"{line}: {text}")
if len(set(lines)) > 1:
    left.legend(fontsize=8)
left.set(xlabel=varied, ylabel="travel distance [m]")
right.set(xlabel="time [s]", ylabel="displacement of the crest [m]")
right.legend(title=varied, fontsize=8, title_fontsize=8)
save(figure, Path(sys.argv[2]))
known = travel[np.isfinite(travel)]
print(f"{len(runs)} runs; " + (f"the slide travels by {min(known):.2f} to {max(known):.2f} m, 0 where the slope stands" if len(known) else "no slide"))
