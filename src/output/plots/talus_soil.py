"""Draws DIR/soil.png from the CSV files that `talus soil` writes: stress path, shear, volume, compression line."""

import argparse
import csv
import pathlib

from matplotlib.ticker import LogFormatter
from talus_style import LINES, np, plt, save
from talus_units import readable_unit, with_unit, words


def read(path):
    """Columns of a CSV file by name; an empty field is NaN."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    values = np.array([[float(x) if x else np.nan for x in row] for row in rows[1:]])
    return dict(zip(rows[0], values.T))


def driven_strain(test):
    """Deviatoric strain sqrt(2/3 e : e), which every kind of test has."""
    e = [test[f"strain_{c}"] for c in ("xx", "yy", "zz", "xy", "yz", "xz")]
    mean = (e[0] + e[1] + e[2]) / 3
    normal = sum((x - mean) ** 2 for x in e[:3])
    return np.sqrt(2 / 3 * (normal + sum(g**2 for g in e[3:]) / 2))


def widen(limits, set_limits, least):
    """Lets an axis span at least so much."""
    low, high = limits()
    if high - low < least:
        set_limits((low + high - least) / 2, (low + high + least) / 2)


def draw(tests, title, path):
    top = max(np.nanmax(np.abs([t["mean_pressure_Pa"], t["deviator_Pa"]])) for t in tests.values())
    scale, unit = readable_unit(top, "Pa")
    figure, axes = plt.subplots(2, 2, figsize=(8.6, 7.0), layout="constrained")
    figure.suptitle(title, fontsize=10.5, x=0.01, ha="left")
    has_void_ratio = any(np.isfinite(t["void_ratio"]).all() for t in tests.values())
    for colour, (name, t) in zip(LINES * 4, tests.items()):
        p, q = scale * t["mean_pressure_Pa"], scale * t["deviator_Pa"]
        strain = 100 * driven_strain(t)
        axes[0, 0].plot(p, q, color=colour, label=words(name))
        axes[0, 0].plot(p[:1], q[:1], "o", color=colour, ms=4)
        if np.ptp(t["pore_pressure_Pa"]) > 1e-6 * top:
            axes[0, 0].plot(p + scale * t["pore_pressure_Pa"], q, "--", color=colour, lw=0.8)
        axes[0, 1].plot(strain, q, color=colour)
        axes[1, 0].plot(strain, 100 * t["compression"], color=colour)
        volume = t["void_ratio"] if has_void_ratio else -100 * t["compression"]
        axes[1, 1].plot(np.where(p > 1e-3 * scale * top, p, np.nan), volume, color=colour)
    axes[0, 0].set(xlabel=f"mean effective pressure p' [{unit}]", ylabel=with_unit("q", unit), title="stress path (dashed: total)")
    axes[0, 1].set(xlabel="deviatoric strain [%]", ylabel=with_unit("q", unit), title="shear")
    axes[1, 0].set(xlabel="deviatoric strain [%]", ylabel="loss of volume [%]", title="volume")
    axes[1, 1].set(xscale="log", xlabel=f"mean effective pressure p' [{unit}]", title="compression",
                   ylabel="void ratio e" if has_void_ratio else "volume strain [%]")
    widen(axes[0, 0].get_xlim, axes[0, 0].set_xlim, 0.1 * scale * top)  # what hardly changes is not blown up
    low, high = axes[1, 1].get_xlim()
    if high < 1.5 * low:
        axes[1, 1].set_xlim(low / 1.5, high * 1.5)
    widen(axes[1, 0].get_ylim, axes[1, 0].set_ylim, 0.01)
    if not has_void_ratio:
        widen(axes[1, 1].get_ylim, axes[1, 1].set_ylim, 0.01)
    axes[1, 0].invert_yaxis()
    for formatter in (axes[1, 1].xaxis.set_major_formatter, axes[1, 1].xaxis.set_minor_formatter):
        formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(2, 0.5)))
    axes[0, 0].legend(fontsize=8)
    return save(figure, path)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dir", type=pathlib.Path)
    parser.add_argument("--title", default="")
    parser.add_argument("--tests", nargs="+", required=True)
    arguments = parser.parse_args()
    tests = {name: read(arguments.dir / f"{name}.csv") for name in arguments.tests}
    draw(tests, arguments.title, arguments.dir / "soil.png")


if __name__ == "__main__":
    main()
