#!/usr/bin/python3
"""Draws peers.png from peers.csv: processor time and accuracy of Talus beside other codes.  docs/peers.py"""
import csv
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "src" / "output" / "plots"))

import talus_style as style  # noqa: E402
from talus_style import plt  # noqa: E402

OTHER = style.LINES[1]

with open(HERE / "peers.csv", newline="") as file:
    rows = list(csv.DictReader(file))


def values(quantity):
    return [(row["code"], row["case"], row["transfer"], float(row["low"]), float(row["high"])) for row in rows if row["quantity"] == quantity]


def draw_times(axes):
    """A bar for each comparison: how often the processor time of Talus the other code takes."""
    times = values("processor time over Talus")
    times.sort(key=lambda one: one[2] == "of Talus")  # the equal methods first
    times.sort(key=lambda one: one[2] == "speed alone")
    axes.axvline(1, color=style.ACCENT, linewidth=2)
    axes.text(1.08, -0.95, "Talus = 1", color=style.ACCENT, va="center", fontweight="bold")
    for k, (code, case, transfer, low, high) in enumerate(times):
        axes.barh(k, high - 1, left=1, height=0.62, color=OTHER, alpha=0.35)
        axes.barh(k, low - 1, left=1, height=0.62, color=OTHER, alpha=0.75)
        axes.text(high * 1.05, k, f"{low:g}" if low == high else f"{low:g} to {high:g}", va="center")
    axes.set_yticks(range(len(times)), [f"{code}, {case}\n" + {"its own": "its own transfer in both", "of Talus": "each with its own transfer",
                                                              "speed alone": "speed alone"}[transfer] for code, case, transfer, *_ in times])
    axes.set_xscale("log")
    axes.set_xlim(1, 140)
    axes.set_ylim(len(times) - 0.4, -1.4)
    axes.set_xticks([1, 3, 10, 30, 100], ["1", "3", "10", "30", "100"])
    axes.minorticks_off()
    axes.set_xlabel("processor time, in that of Talus")
    axes.set_title("Time to answer: 98,304 particles, one core", loc="left")


def draw_column(axes):
    """Time and error of a soft elastic column at rest."""
    errors, seconds = values("error of the stress"), values("processor time per simulated second")
    for (code, _, _, error, _), (_, _, _, second, _) in zip(errors, seconds):
        own = code == "Talus"
        axes.plot(second, error, "o", markersize=10, color=style.ACCENT if own else OTHER)
        axes.annotate(f"{code}\n{second:g} s, {error:g} %", (second, error), (0, 14 if own else -14), textcoords="offset points", ha="center",
                      va="bottom" if own else "top", color=style.ACCENT if own else OTHER)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(0.05, 10)
    axes.set_ylim(0.7, 15)
    axes.set_xticks([0.1, 1, 10], ["0.1", "1", "10"])
    axes.set_yticks([1, 3, 10], ["1", "3", "10"])
    axes.minorticks_off()
    axes.set_xlabel("processor time per simulated second [s]")
    axes.set_ylabel("error of the stress [%]")
    axes.set_title("Accuracy: soft elastic column at rest", loc="left")


figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.9), gridspec_kw={"width_ratios": [1.5, 1]}, layout="constrained")
draw_times(left)
draw_column(right)
figure.savefig(HERE / "peers.png", dpi=130)
