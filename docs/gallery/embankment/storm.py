#!/usr/bin/python3
"""When the slope of storm.toml loses its equilibrium, looked at every six hours for a week, and how far it then slides:  storm.py TALUS FOLDER [rows|factors]
Runs into FOLDER and writes storm.csv; with `factors` the factor of safety over time, storm_factors.csv."""

import csv
import json
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

from talus_results import read_events  # noqa: E402

RUNS = {
    **{name: (f"mesh.size={size}",) for name, size in (("the scene: cells of 1 m", 1), ("cells of 0.7 m", 0.7), ("cells of 1.2 m", 1.2))},
    **{f"elements of second order, cells of {size} m": (f"mesh.size={size}", "quasi_static.elements=quadratic") for size in (1, 0.5)},
    "permeability 3.75e-14 m2 (7.5e-14)": ("body.soil.permeability=3.75e-14",),
    "permeability 1.5e-13 m2": ("body.soil.permeability=1.5e-13",),
    "shape of the curves 0.2, as in scene.toml": ("body.soil.retention.shape=0.2", "body.soil.relative_permeability.shape=0.2"),
}


def every_six_hours(text):
    """The scene without motion, with equilibrium every six hours of a week."""
    pairs = [f'[[stage]]\nname = "hour_{h}"\nkind = "seepage"\nduration = "6 h"\n[[stage]]\nname = "stands_{h}"\nkind = "quasi_static"\nduration = 1\nhold_loads = true\n'
             for h in range(6, 169, 6)]
    return re.sub(r'(?s)\[\[stage\]\]\nname = "first_day".*?\[quasi_static\]', lambda _: "\n".join(pairs) + "\n[quasi_static]", text)


def run(talus, scene, out, keys):
    words = [word for key in keys for word in ("--set", key)]
    return subprocess.run([talus, "run", scene, "-o", out, "--no-pictures", "--force", *words], capture_output=True, text=True)


def row_of(talus, folder, name, keys):
    text = (HERE / "storm.toml").read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    text = re.sub(r"^interval = .*$", "interval = 0", text, flags=re.M)
    (folder / "scene.toml").write_text(text)
    (folder / "stands.toml").write_text(every_six_hours(text))
    done = run(talus, folder / "stands.toml", folder / "stands", keys)
    lost = [event["stage"].removeprefix("stands_") for event in read_events(folder / "stands", "equilibrium_lost")]
    if done.returncode and not lost:
        raise SystemExit(done.stderr[-600:])
    row = {"run": name, "lost_h": lost[0] if lost else "stands"}
    if not lost or int(lost[0]) > 96 or "quasi_static.elements=quadratic" in keys:  # particles move with patches
        return row
    done = run(talus, folder / "scene.toml", folder / "slide", keys)
    if done.returncode:
        raise SystemExit(done.stderr[-600:])
    rows = list(csv.DictReader(open(folder / "slide/history.csv")))
    return row | {f"{point}_m": f"{float(rows[-1][f'{point}_displacement_m']):.2f}" for point in ("S1", "S2", "D1", "D2")} | {
        "speed_m_s": f"{max(float(r['S2_velocity_m_s']) for r in rows):.2f}"}


def factor_after(talus, folder, hours):
    """Factor of safety after hours of rain, in cells of 1 m."""
    text = (HERE / "storm.toml").read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    rain = f'[[stage]]\nname = "rain"\nkind = "seepage"\nduration = "{hours} h"\n[[stage]]\nname = "stands"\nkind = "quasi_static"\nduration = 1\nhold_loads = true\n'
    (folder / "factor.toml").write_text(re.sub(r'(?s)\[\[stage\]\]\nname = "first_day".*?\[quasi_static\]', lambda _: rain + "\n[quasi_static]", text))
    done = subprocess.run([talus, "solve", folder / "factor.toml", "--factor-of-safety", "-o", folder / "factor", "--force"], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr[-600:])
    factors = json.loads((folder / "factor/factor_of_safety.json").read_text())["by_flow"]
    return {"hours": hours, **{flow: f"{factors[flow]['value']:.3f}" for flow in ("davis", "associated")}}


def write(name, columns, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    talus, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    if sys.argv[3:] == ["factors"]:
        write("storm_factors.csv", ["hours", "davis", "associated"], [factor_after(talus, folder, hours) for hours in (24, 36, 48)])
    else:
        table = []
        for name, keys in RUNS.items():
            table.append(row_of(talus, folder, name, keys))
            print(table[-1], flush=True)
        write("storm.csv", ["run", "lost_h", "S1_m", "S2_m", "D1_m", "D2_m", "speed_m_s"], table)
