"""Draws DIR/newmark.png from the CSV files that `talus newmark` writes: acceleration of the ground with the yield coefficient, and the way of the block."""

import talus_interrupt  # noqa: F401  before all that takes time

import json

from talus_record import G, main, read
from talus_style import LINES, headline, plt, save


def draw(folder, names):
    found = json.loads((folder / "newmark.json").read_text())
    figure, axes = plt.subplots(2, 1, figsize=(8.6, 5.4), sharex=True, layout="constrained")
    headline(figure, "Newmark's sliding block", f"yield coefficient {found['yield_coefficient']:.3f}")
    for colour, name in zip(LINES * 4, names):
        t = read(folder / f"{name}.csv")
        axes[0].plot(t["time_s"], t["acceleration_m_s2"] / G, color=colour, lw=0.7)
        axes[1].plot(t["time_s"], 100 * t["way_m"], color=colour, label=name)
        axes[1].plot(t["time_s"], 100 * t["reversed_way_m"], "--", color=colour, lw=0.9)
    for side in (-1, 1):
        axes[0].axhline(side * found["yield_coefficient"], color="0.4", lw=0.8, ls=":")
    axes[0].set_ylabel("acceleration [g]")
    axes[1].set(xlabel="time [s]", ylabel="way [cm] (dashed: motion reversed)", xlim=(0, None), ylim=(0, None))
    axes[1].legend(fontsize=8)
    return save(figure, folder / "newmark.png")


if __name__ == "__main__":
    main(__doc__, draw)
