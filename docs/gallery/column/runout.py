#!/usr/bin/python3
"""Run-out of dry columns against their aspect ratio H0 / L0: runs the columns, writes runout.csv, draws runout.png.

    runout.py -o DIR              runs what DIR does not hold yet (about ten minutes on one core), then draws
    runout.py                     draws runout.csv again
"""

import argparse
import csv
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(ROOT / "src/output/plots"))

import matplotlib.pyplot as plt  # noqa: E402
import talus_style as style  # noqa: E402
from talus_results import Results  # noqa: E402

WIDTH, GRAVITY, DENSITY = 0.1, 9.81, 1600  # L0 [m], [m/s2], [kg/m3]
ASPECTS = (0.5, 1, 1.5, 2, 3, 4, 6, 8)
MASS = 0.995  # share of the mass behind the front
# name -> friction angle [deg], friction angle of the base (None: no slip), cell over L0
SERIES = {
    "30°, no slip": (30, None, 1 / 20),
    "22°, no slip": (22, None, 1 / 20),
    "33°, no slip": (33, None, 1 / 20),
    "36°, no slip": (36, None, 1 / 20),
    "30°, base 20°": (30, 20, 1 / 20),
    "30°, no slip, cells L₀/40": (30, None, 1 / 40),
}
SHORT = (0.5, 1, 2, 4, 6)
ONLY = {"22°, no slip": SHORT, "36°, no slip": SHORT, "33°, no slip": (*SHORT, 8), "30°, base 20°": (0.5, 1, 2),
        "30°, no slip, cells L₀/40": (1, 4)}  # series that do not run every aspect
LAWS = {"Lube et al. (2005)": (1.2, 1.9), "Lajeunesse et al. (2005)": (1.8, 2.3)}  # prefactors of a and a^(2/3)
SMALL, LARGE = (0.5, 3), (3, 8)  # aspects over which the two exponents are fitted

SECTION = """part,x,y
outline,0,0
outline,{right},0
outline,{right},{top}
outline,0,{top}
interface0,0,{height}
interface0,{width},{height}
interface0,{width},0
region_sand,{x},{y}
region_air,{beside},{y}
"""
SCENE = """title = "Dry column, H0 / L0 = {aspect:g}"
dimension = 2
gravity = {gravity}
[mesh]
section = "section.csv"
size = {size}
[body.sand]
region = "sand"
density = {density}
law = "mohr_coulomb"
young_modulus = "2 MPa"
poisson_ratio = 0.3
cohesion = 0
friction_angle = {friction}
stress = ["{lateral} * ({height} - y)", "{vertical} * ({height} - y)", "{lateral} * ({height} - y)", "0 * x"]
[boundary.base]
{base}
[boundary.left]
kind = "roller"
[boundary.right]
kind = "roller"
[[stage]]
name = "collapse"
duration = {duration}
until = "rest"
rest_speed = 0.005
"""


def law(aspect, small, large):
    """Run-out over L0: the line and the 2/3 power, which change places where they meet or at the published limit."""
    limit = 2.3 if small == 1.2 else 3.0  # middle of 1.8 to 2.8 (Lube), 3.0 (Lajeunesse)
    return np.where(aspect <= limit, small * aspect, large * aspect ** (2 / 3))


def write_scene(folder, aspect, friction, base_friction, cell):
    """The section and the scene of one column; free space for 1.5 times the larger law, and high over a base with friction,
    where the front throws up single particles."""
    folder.mkdir(parents=True, exist_ok=True)
    height, far = aspect * WIDTH, WIDTH * (1.6 + 1.5 * float(max(law(aspect, 1.8, 2.3), 1.8 * aspect)))
    (folder / "section.csv").write_text(SECTION.format(
        right=f"{far:.4f}", top=f"{height + (0.05 if base_friction is None else 0.4):.4f}", height=height, width=WIDTH, x=WIDTH / 2, y=height / 2,
        beside=far - WIDTH / 2))
    base = 'kind = "fixed"' if base_friction is None else f'kind = "friction"\nfriction_angle = {base_friction}'
    (folder / "scene.toml").write_text(SCENE.format(
        aspect=aspect, gravity=GRAVITY, size=cell * WIDTH, density=DENSITY, friction=friction, height=height, base=base,
        vertical=-GRAVITY * DENSITY, lateral=-GRAVITY * DENSITY * 0.3 / 0.7,
        duration=f"{1 + 8 * np.sqrt(height / GRAVITY):.3f}"))


def measure(folder):
    """Front, height and state of the deposit."""
    last = Results(folder).snapshots[-1]
    position, mass = last.position(), last.column("mass").values[:, 0]
    order = np.argsort(position[:, 0])
    share = np.cumsum(mass[order]) / mass.sum()
    front = {part: position[order[np.searchsorted(share, part)], 0] for part in (0.99, MASS, 0.999)}
    crest = np.max(position[position[:, 0] < 0.1 * WIDTH, 1])
    speed = last.scalar("velocity")[0]
    return {"runout": front[MASS] / WIDTH - 1, "runout_99": front[0.99] / WIDTH - 1, "runout_999": front[0.999] / WIDTH - 1,
            "crest": crest / WIDTH, "time_s": last.time, "rms_speed_m_s": np.sqrt((mass * speed**2).sum() / mass.sum())}


def run_all(folder, program):
    """Runs every column and writes runout.csv. One that fails is left out and said."""
    rows = []
    for series, (friction, base_friction, cell) in SERIES.items():
        for aspect in ONLY.get(series, ASPECTS):
            here = folder / f"friction{friction}_{'no_slip' if base_friction is None else f'base{base_friction}'}_cell{cell * WIDTH:g}" / f"a{aspect:g}"
            if not (here / "done").exists():
                write_scene(here, aspect, friction, base_friction, cell)
                done = subprocess.run([program, "run", str(here / "scene.toml"), "-o", str(here), "--no-pictures", "--force"],
                                      capture_output=True, text=True)
                if done.returncode:
                    print(f"{series}, a = {aspect:g}: {done.stderr.strip().splitlines()[-1]}", file=sys.stderr)
                    continue
                (here / "done").touch()
            row = {"series": series, "friction_angle_deg": friction,
                   "base": "no slip" if base_friction is None else f"{base_friction} deg", "cell_over_L0": cell,
                   "aspect": aspect}
            row |= {name: f"{value:.4g}" for name, value in measure(here).items()}
            rows.append(row)
            print(", ".join(f"{name} {value}" for name, value in row.items()), flush=True)
    with open(HERE / "runout.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def exponent(aspects, runouts, between):
    """Slope of log run-out against log aspect over the aspects of a range."""
    chosen = (aspects >= between[0]) & (aspects <= between[1])
    return np.polyfit(np.log(aspects[chosen]), np.log(runouts[chosen]), 1)[0] if chosen.sum() > 1 else np.nan


def read_series():
    """{series: (aspects, run-outs)} of runout.csv."""
    with open(HERE / "runout.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([(float(row["aspect"]), float(row["runout"])) for row in rows if row["series"] == name]).T
            for name in SERIES if any(row["series"] == name for row in rows)}


def tell(series):
    """The exponents, and how far run-outs lie outside the two laws."""
    for name, (aspects, runouts) in series.items():
        bounds = np.array([law(aspects, *pair) for pair in LAWS.values()])
        outside = np.where(runouts > bounds.max(0), runouts / bounds.max(0) - 1,
                           np.where(runouts < bounds.min(0), runouts / bounds.min(0) - 1, 0))
        print(f"{name:26s} exponent {exponent(aspects, runouts, SMALL):.2f} for a {SMALL[0]:g} to {SMALL[1]:g}, "
              f"{exponent(aspects, runouts, LARGE):.2f} for {LARGE[0]:g} to {LARGE[1]:g}; outside the laws by "
              + ", ".join(f"{100 * part:+.0f} % (a = {a:g})" for a, part in zip(aspects, outside) if part))


def draw(series, path):
    """Run-out over aspect ratio, on logarithmic axes, with the two measured laws."""
    figure, axes = plt.subplots(figsize=(6.4, 4.4))
    figure.subplots_adjust(left=0.1, right=0.98, bottom=0.12, top=0.97)
    a = np.geomspace(0.42, 10, 600)
    bounds = [law(a, *pair) for pair in LAWS.values()]
    axes.fill_between(a, np.minimum(*bounds), np.maximum(*bounds), color="#e6eef0", lw=0, zorder=0)
    for (name, (small, large)), limit, dash in zip(LAWS.items(), (2.3, 3.0), ((0, (4, 2)), (0, (1, 1.4)))):
        for part, values in ((a <= limit, small * a), (a > limit, large * a ** (2 / 3))):
            axes.plot(a[part], values[part], color=style.SOFT, lw=1.3, ls=dash,
                      label=f"{name}: {small:g} a, {large:g} a$^{{2/3}}$" if part[0] else None)
    looks = {"36°, no slip": ("^", style.LINES[3]), "33°, no slip": ("P", style.LINES[6]), "30°, no slip": ("o", style.LINES[0]), "22°, no slip": ("v", style.LINES[1]),
             "30°, base 20°": ("D", style.LINES[2]), "30°, no slip, cells L₀/40": ("s", style.LINES[4])}
    for name, (marker, colour) in looks.items():
        if name in series:
            axes.plot(*series[name], marker, color=colour, ms=6 if marker != "D" else 5, mec="white", mew=0.6,
                      lw=0.9, ls="-" if len(series[name][0]) > 4 else "none", label=f"Talus: φ = {name}")
    axes.set(xscale="log", yscale="log", xlim=(0.42, 10), ylim=(0.3, 20), xlabel="aspect ratio a = H₀ / L₀",
             ylabel="run-out (L∞ − L₀) / L₀")
    for axis, ticks in ((axes.xaxis, (0.5, 1, 2, 3, 4, 6, 8)), (axes.yaxis, (0.5, 1, 2, 5, 10, 20))):
        axis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
        axis.set_minor_locator(plt.NullLocator())
    axes.legend(loc="lower right", fontsize=8)
    style.save(figure, path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", metavar="DIR", type=pathlib.Path, help="folder of the runs")
    parser.add_argument("--program", default=str(ROOT / "talus"), help="the talus program")
    given = parser.parse_args()
    if given.output:
        run_all(given.output.resolve(), given.program)
    drawn = read_series()
    tell(drawn)
    draw(drawn, HERE / "runout.png")
