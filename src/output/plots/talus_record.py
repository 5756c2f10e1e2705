"""Draws DIR/record.png from the CSV files that `talus record` writes: acceleration, velocity, displacement, Arias intensity and response spectrum."""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import csv
import pathlib

from talus_style import LINES, headline, np, plt, save

G = 9.80665  # [m/s2]


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], np.array([[float(x) for x in row] for row in rows[1:]]).T))


def draw(folder, names):
    figure = plt.figure(figsize=(9.2, 7.2), layout="constrained")
    grid = figure.add_gridspec(4, 2, width_ratios=(3, 2))
    histories = [figure.add_subplot(grid[k, 0]) for k in range(4)]
    spectrum = figure.add_subplot(grid[:, 1])
    headline(figure, "Motion of the ground", ", ".join(names))
    for colour, name in zip(LINES * 4, names):
        t = read(folder / f"{name}.csv")
        curves = (t["acceleration_m_s2"] / G, t["velocity_m_s"], t["displacement_m"], t["arias_m_s"])
        for axes, curve in zip(histories, curves):
            axes.plot(t["time_s"], curve, color=colour, lw=0.8)
            axes.set_xlim(0, max(t["time_s"][-1], axes.get_xlim()[1] if len(names) > 1 else 0))
        for axes, curve in zip(histories[:3], curves):
            peak = np.argmax(np.abs(curve))
            axes.plot(t["time_s"][peak], curve[peak], "o", color=colour, ms=4)
            axes.annotate(f"{curve[peak]:.3g}", (t["time_s"][peak], curve[peak]), xytext=(5, 0), textcoords="offset points", va="center", fontsize=8, color=colour)
        s = read(folder / f"{name}_spectrum.csv")
        spectrum.plot(s["period_s"], s["pseudo_acceleration_m_s2"] / G, color=colour, label=name)
    for axes, label in zip(histories, ("acceleration [g]", "velocity [m/s]", "displacement [m]", "Arias intensity [m/s]")):
        axes.set_ylabel(label)
        axes.axhline(0, color="0.8", lw=0.6, zorder=0)
        axes.tick_params(labelbottom=axes is histories[-1])
    histories[-1].set_xlabel("time [s]")
    histories[-1].set_ylim(bottom=0)
    spectrum.set(xscale="log", xlabel="period [s]", ylabel="pseudo-acceleration [g]", title="response spectrum, 5 % damping", xlim=(0.02, 10), ylim=(0, None))
    spectrum.set_xticks([0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10], ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5", "10"])
    spectrum.minorticks_off()
    spectrum.grid(color="0.9", lw=0.5)
    if len(names) > 1:
        spectrum.legend(fontsize=8)
    return save(figure, folder / "record.png")


def main(description, draw):
    """Draws what the arguments say: a folder, and the names of its records."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("dir", type=pathlib.Path)
    parser.add_argument("names", nargs="+")
    arguments = parser.parse_args()
    draw(arguments.dir, arguments.names)


if __name__ == "__main__":
    main(__doc__, draw)
