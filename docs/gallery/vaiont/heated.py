#!/usr/bin/python3
"""The base that heats itself (heated.toml): runs it in cells of 15 m with each number of the shear zone changed, writes heated.csv:  heated.py TALUS [CASE ...]
With names of cases only these are run, and the rows of the others stay as they are. Draws heated.png from a run:  heated.py --draw FOLDER"""

import csv
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))
sys.path.insert(0, str(HERE))

import measures  # noqa: E402
from talus_results import Results  # noqa: E402

BED = "boundary.bed."
CASES = (
    ("cells of 15 m", []),
    ("as heated.toml, cells of 12 m", ["mesh.size=12"]),
    ("heat without expansion", [BED + "thermal_pressurisation=0"]),
    ("thickness 1.4 mm", [BED + "thickness=1.4e-3"]),
    ("thickness 10 cm", [BED + "thickness=0.1"]),
    ("conductivity 1e-9 m/s", [BED + "hydraulic_conductivity=1e-9"]),
)
COLUMNS = ("case", "ended", "level_m", "to_10_m_s_s", "slip_m", "speed_m_s", "run_out_m", "friction_deg", "pressure_MPa", "warmer_K", "hottest_K")


def smooth(values, rows=11):
    """Mean over about a second: contact vibrates."""
    return np.convolve(values, np.ones(rows) / rows, "same")


def row_of(name, results):
    """What a run gave: how soon, how fast and how far, and its base at its fastest."""
    history = results.history
    remembering = [stage["name"] for stage in results.scene["stage"] if stage.get("softening", True)]
    columns, heats = history.columns, np.isin(history.stage, remembering)
    friction, speed = smooth(columns["bed_friction"]), np.where(heats, columns["P0_velocity_m_s"], 0)
    fast, fastest = np.flatnonzero(speed >= 10), speed.argmax()
    halved = np.flatnonzero(heats & (columns["bed_slip_m"] > 0.01) & (friction < np.tan(np.radians(12)) / 2))

    def written(rows, column, digits):
        return f"{column[rows[0]]:.{digits}f}" if rows.size else ""

    return {"case": name, "ended": "broke off" if results.broke_off() else "completed",
            "level_m": written(fast, measures.levels(results), 0), "to_10_m_s_s": written(fast, history.time - history.time[heats][0], 1), "slip_m": written(halved, columns["bed_slip_m"], 2),
            "speed_m_s": f"{speed.max():.1f}", "run_out_m": f"{measures.way_in_all(results, 'P0'):.0f}",
            "friction_deg": f"{np.degrees(np.arctan(friction[fastest])):.1f}", "pressure_MPa": f"{columns['bed_excess_pressure_Pa'][fastest] / 1e6:.2f}",
            "warmer_K": f"{columns['bed_temperature_K'][fastest]:.0f}", "hottest_K": f"{columns['bed_hottest_K'][fastest]:.0f}"}


def run(talus, name, changes, folder):
    out = pathlib.Path(folder) / name.replace(" ", "_").replace("/", "_")
    subprocess.run([talus, "run", HERE / "heated.toml", "-o", out, "--no-pictures", "--set", "mesh.size=15", *changes], stdout=subprocess.DEVNULL, check=False)
    return row_of(name, Results(out))


def study(talus, wanted):
    table, rows = HERE / "heated.csv", {}
    if wanted and table.exists():
        with open(table, newline="") as file:
            rows = {row["case"]: row for row in csv.DictReader(file)}
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        cases = [case for case in CASES if not wanted or case[0] in wanted]
        rows |= {row["case"]: row for row in pool.map(lambda case: run(talus, *case, folder), cases)}
    with open(table, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader(), writer.writerows(rows[name] for name, _ in CASES if name in rows)


def draw(results, path):
    import matplotlib.pyplot as plt
    import talus_style as style

    columns, rows = results.history.columns, np.array(results.history.stage) == "slide"
    time, way = (column[rows] - column[rows][0] for column in (results.history.time, columns["P0_displacement_x_m"]))
    forth = np.arange(way.size) <= way.argmax()  # not its way back
    panels = (("speed of P0 [m/s]", columns["P0_velocity_m_s"], None),
              ("mobilised friction of the base [deg]", np.degrees(np.arctan(smooth(columns["bed_friction"]))), (0, 13)),
              ("rise of temperature in the shear zone [K]", columns["bed_temperature_K"], None),
              ("excess pressure in the shear zone [MPa]", columns["bed_excess_pressure_Pa"] / 1e6, None))
    figure, grid = plt.subplots(2, 4, figsize=(11.5, 5), sharex="row")
    figure.subplots_adjust(left=0.04, right=0.985, bottom=0.09, top=0.94, hspace=0.3, wspace=0.22)
    for (title, values, limits), over_time, over_way in zip(panels, *grid):
        for axes, x, shown in ((over_time, time, slice(None)), (over_way, way, forth)):
            axes.plot(x[shown], values[rows][shown], linewidth=1.2, label="mean")
            if title.startswith("rise"):
                axes.plot(x[shown], columns["bed_hottest_K"][rows][shown] / 10, linewidth=0.9, label="hottest place, a tenth")
            axes.set_ylim(*(limits or (0, None)))
        over_time.set_title(title, loc="left", size=8.5)
        over_time.set_xlabel("time since the rock may soften [s]"), over_way.set_xlabel("horizontal way of P0 since then [m]")
        over_way.set_xscale("log"), over_way.set_xlim(0.1, 500)
    grid[0, 2].legend(frameon=False, fontsize=8)
    style.save(figure, path)


if __name__ == "__main__":
    if sys.argv[1] == "--draw":
        draw(Results(sys.argv[2]), HERE / "heated.png")
    else:
        study(sys.argv[1], sys.argv[2:])
