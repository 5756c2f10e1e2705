"""Draws DIR/soil.png from the CSV files that `talus soil` writes: stress path, shear, volume, compression line."""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import csv
import pathlib

from talus_style import LINES, few_log_ticks, headline, np, plt, save
from talus_units import readable_unit, with_unit, words

MOST = 1.6  # of the room that other tests need: more is not given to compression, which has a chart of its own


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


def compresses(test):
    """Is it an oedometer or isotropic compression, whose pressure rises as long as it is driven?"""
    return np.nanmax(np.abs(test["compression"])) > np.nanmax(driven_strain(test))


def keep_to(axes, shown, begun):
    """Limits axes to curves [(x, y)] and to the beginnings of others where these would take most of the room. Returns whether they reach further."""
    cut = False
    for k, limits, set_limits in ((0, axes.get_xlim, axes.set_xlim), (1, axes.get_ylim, axes.set_ylim)):
        values = np.concatenate([curve[k] for curve in shown] + [curve[k][:1] for curve in begun])
        low, high = np.nanmin(values), np.nanmax(values)
        if high > low and np.ptp(limits()) > MOST * (high - low):
            set_limits(low - 0.05 * (high - low), high + 0.05 * (high - low))
            cut = True
    return cut


def draw(tests, title, path):
    compression = [name for name in tests if compresses(tests[name])]
    others = [name for name in tests if name not in compression]
    top = max(np.nanmax(np.abs([tests[name]["mean_pressure_Pa"], tests[name]["deviator_Pa"]])) for name in others or tests)
    scale, unit = readable_unit(top, "Pa")
    figure, axes = plt.subplots(2, 2, figsize=(8.6, 7.2), layout="constrained")
    headline(figure, "Element tests", title)
    curves = {name: [] for name in tests}  # in the three charts that tests share
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
        curves[name] = [(p, q), (strain, q), (strain, 100 * t["compression"])]
        volume = t["void_ratio"] if has_void_ratio else -100 * t["compression"]
        axes[1, 1].plot(np.where(p > 1e-3 * scale * top, p, np.nan), volume, color=colour)
    axes[0, 0].set(xlabel=f"mean effective pressure p' [{unit}]", ylabel=with_unit("q", unit), title="stress path (dashed: total)")
    axes[0, 1].set(xlabel="deviatoric strain [%]", ylabel=with_unit("q", unit), title="shear")
    axes[1, 0].set(xlabel="deviatoric strain [%]", ylabel="loss of volume [%]", title="volume")
    axes[1, 1].set(xscale="log", xlabel=f"mean effective pressure p' [{unit}]", title="compression",
                   ylabel="void ratio e" if has_void_ratio else "volume strain [%]")
    shared = (axes[0, 0], axes[0, 1], axes[1, 0])
    if compression and others and any([keep_to(one, *([curves[name][k] for name in names] for names in (others, compression))) for k, one in enumerate(shared)]):
        axes[1, 1].set_title("compression, whole here alone")
    widen(axes[0, 0].get_xlim, axes[0, 0].set_xlim, 0.1 * scale * top)  # what hardly changes is not blown up
    low, high = axes[1, 1].get_xlim()
    if high < 1.5 * low:
        axes[1, 1].set_xlim(low / 1.5, high * 1.5)
    widen(axes[1, 0].get_ylim, axes[1, 0].set_ylim, 0.01)
    if not has_void_ratio:
        widen(axes[1, 1].get_ylim, axes[1, 1].set_ylim, 0.01)
    axes[1, 0].invert_yaxis()
    few_log_ticks(axes[1, 1])
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
