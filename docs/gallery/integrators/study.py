#!/usr/bin/python3
"""Integrators side by side: `talus compare` on four scenes, orders with and without crossing, and how often to remap.

    study.py TALUS [frozen|plastic|crossing|bar|oedometer|column|selborne|remap|creep|figure ...]

TALUS is the program (build/release/bin/talus). Each study writes its CSVs beside this file (NAME.csv, NAME_reference.csv); `figure` draws NAME.png
from them. Runs are kept in results/integrators, so that a study goes on where it stopped; remove it to measure times anew.
"""
import csv
import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(ROOT / "src/output/plots"))

from talus_results import Table  # noqa: E402

RUNS = ROOT / "results/integrators"

FRACTIONS = "euler: integrator.fraction=0.8,0.4,0.2,0.1,0.05,0.025"


def arkode(order, tolerances):
    return f"arkode {order}: integrator.kind=arkode; integrator.order={order}; integrator.displacement_tolerance=1; integrator.velocity_tolerance={tolerances}"


STEPS = "integrator.step=" + ",".join(f"{1.33 / n:.15g}" for n in (2800, 5600, 11200, 22400))

FIFTH_MODE = ["transfer.relaxation=0", "transfer.locking=none", "stage.0.duration=1.33", "output.history_interval=1.33", "body.soil.velocity=[\"0.2 * sin(4.5 * pi * x)\", \"0 * x\"]"]
FIXED = ["euler: " + STEPS] + [f"arkode {k}: integrator.kind=arkode; integrator.order={k}; " + STEPS for k in (2, 3, 4, 5)]
TRESCA = ["body.soil.law=mohr_coulomb", "body.soil.cohesion=500", "body.soil.friction_angle=0"]

STUDIES = {
    "frozen": ("tests/verification/elastic_bar/scene.toml", "end_x_m", ["transfer.remap_interval=0.3", *FIFTH_MODE],
               ["forward-euler: integrator.kind=forward-euler; " + STEPS, *FIXED, "petsc rk8: integrator.kind=petsc; integrator.method=rk8; " + STEPS]),
    "plastic": ("tests/verification/elastic_bar/scene.toml", "end_x_m", ["transfer.remap_interval=0.3", *FIFTH_MODE, *TRESCA], FIXED),
    "crossing": ("tests/verification/elastic_bar/scene.toml", "end_x_m", ["transfer.remap_interval=0", *FIFTH_MODE], FIXED),
    "bar": ("tests/verification/elastic_bar/scene.toml", "end_x_m@1.33", [],
            [FRACTIONS] + [arkode(k, "1e-2,1e-3,1e-4,1e-5,1e-6,1e-7") for k in (2, 3, 4, 5)]),
    "oedometer": ("tests/verification/dynamic_oedometer/scene.toml", "load_displacement_y_m@0.07", ["output.history_interval=0.0005"],
                  [FRACTIONS] + [arkode(k, "1e-2,1e-3,1e-4,1e-5,1e-6,1e-7") for k in (2, 3, 4)]),
    "column": ("docs/gallery/column/scene.toml", "corner_x_m@0.15", ["mesh.size=0.01", "stage.0.duration=0.2"],
               [FRACTIONS] + [arkode(k, "1e-2,1e-3,1e-4,1e-5,1e-6,1e-7") for k in (2, 3, 4)]),
    "selborne": ("docs/gallery/selborne_absolute/scene.toml", "max:crest_displacement_m", ["mesh.size=0.9"],
                 ["euler: integrator.fraction=0.9,0.6,0.4,0.2,0.1,0.05", arkode(4, "1e-2,1e-3,1e-4,3e-5,1e-5,3e-6")]),
    "remap": ("docs/gallery/column/scene.toml", "corner_x_m", ["mesh.size=0.01"],
              ["euler: transfer.remap_interval=0.3,0.2,0.1,0.05,0.02,0", "arkode 3: integrator.kind=arkode; transfer.remap_interval=0.3,0.2,0.1,0.05,0.02"]),
    "creep": ("docs/gallery/selborne_hydrostatic/scene.toml", "crest_displacement_m",
              ["mesh.size=0.9", "stage.recharge.duration=5", "stage.slide.duration=0"],
              ["euler: transfer.remap_interval=0.02,0.01,0.005,0.002,0.001,0.0005,0"]),
}
REFERENCES = {"creep": "no remap: transfer.remap_interval=0.3"}  # cells that stay: linear finite elements


def study(talus, name):
    scene, measure, overrides, series = STUDIES[name]
    words = [talus, "compare", ROOT / scene, "--measure", measure, "-o", RUNS / name, "--no-plot", "--force", *sum((["--series", s] for s in series), []),
             *(["--reference", REFERENCES[name]] if name in REFERENCES else [])]
    subprocess.run(words + (["--set", *overrides] if overrides else []), check=False)  # a failed run is a line of the table
    (HERE / f"{name}.csv").write_text((RUNS / name / "study.csv").read_text().replace(f"{ROOT}/", ""))  # what runs say of themselves names folders
    reference = json.loads((RUNS / name / "study.json").read_text())["reference"]
    with open(HERE / f"{name}_reference.csv", "w", newline="") as file:
        csv.writer(file).writerows([reference.keys(), reference.values()])


def rows_of(path):
    columns = Table(path).columns
    return [dict(zip(columns, row)) for row in zip(*columns.values())]


def figure():
    from talus_compare import chart_of_errors
    from talus_runs import charts
    for name in STUDIES.keys() - {"frozen", "plastic", "crossing"}:  # runs.py draws these side by side
        if (HERE / f"{name}.csv").exists():
            what, *panels = chart_of_errors(rows_of(HERE / f"{name}.csv"), rows_of(HERE / f"{name}_reference.csv")[0])
            charts(HERE / f"{name}.png", what, "", *panels)


if __name__ == "__main__":
    chosen = sys.argv[2:] or [*STUDIES, "figure"]
    for name in chosen:
        figure() if name == "figure" else study(sys.argv[1], name)
