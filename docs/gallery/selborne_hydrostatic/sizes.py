#!/usr/bin/python3
"""What the cell size does to the Selborne slope when softening is not regularised, scaled with the cell, or nonlocal.

    sizes.py TALUS [run|figure ...]

TALUS is the program (build/release/bin/talus). `run` adds to sizes.csv the runs that are not in it yet, one at a time and at low priority;
`figure` draws sizes.png from it.
"""
import csv
import os
import re
import sys
import time

import study

SIZES = (1.2, 0.9, 0.65, 0.45)
LENGTH = 1.2  # l of the average, the largest cell [m]
KINDS = ("off", "scaled", "nonlocal")
ETAS = (500, 50)  # the paper's, and one that gives the load of limit equilibrium
TABLE = study.HERE / "sizes.csv"


def scene(size, kind, eta):
    text = study.variant(size, eta=eta)
    if kind == "off":
        text = re.sub(r"^reference_size.*\n", "", text, flags=re.M)
    if kind == "nonlocal":  # the scale of shape_factor stays: 2 l / reference_size
        text = re.sub(r"^law = ", f"averaging_length = {LENGTH}\nlaw = ", text, flags=re.M)
    return text


def run(talus):
    os.nice(15)
    rows = list(csv.DictReader(open(TABLE))) if TABLE.exists() else []
    done = {(float(r["size_m"]), r["regularisation"], float(r["eta"])) for r in rows}
    for eta in ETAS:
        for size in SIZES:
            for kind in KINDS:
                if (size, kind, eta) in done:
                    continue
                start = time.time()
                result = study.run(talus, scene(size, kind, eta))
                rows.append({"size_m": size, "regularisation": kind, "eta": eta, **result, "wall_s": round(time.time() - start, 1)})
                print(rows[-1], flush=True)
                study.write("sizes.csv", rows)


def figure(_):
    import talus_style as style
    from talus_style import plt
    rows = list(csv.DictReader(open(TABLE)))
    figure, axes = plt.subplots(2, 2, figsize=(7.6, 6.0), layout="constrained", sharex=True)
    for column, eta in zip(axes.T, ETAS):
        for kind, marker in zip(KINDS, ("o--", "s-", "D-")):
            mine = [r for r in rows if r["regularisation"] == kind and float(r["eta"]) == eta and r["excess_kPa"]]
            size = [float(r["size_m"]) for r in mine]
            column[0].plot(size, [float(r["excess_kPa"]) for r in mine], marker, ms=4, label=kind)
            column[1].plot(size, [float(r["crest_m"]) for r in mine], marker, ms=4, label=kind)
        column[0].set(title=f"η = {eta}", ylim=(0, None))
        column[1].set(xlabel="cell size [m]", ylim=(0, None))
    axes[0, 0].set(ylabel="excess pressure at failure [kPa]")
    axes[1, 0].set(ylabel="displacement of the crest [m]")
    axes[1, 0].legend(frameon=False)
    for one in axes.flat:
        one.spines[["top", "right"]].set_visible(False)
    style.save(figure, study.HERE / "sizes.png", dpi=110)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for name in sys.argv[2:] or ("run", "figure"):
        {"run": run, "figure": figure}[name](sys.argv[1])
