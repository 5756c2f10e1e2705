#!/usr/bin/python3
"""Runs the scene with other parameters, cells and models:  study.py TALUS FOLDER [sensitivity|cells|model ...]
`sensitivity` halves and doubles in cells of 1 m what the paper does not give, `cells` changes cells, particles and steps, `model` the phases, the storage of
the water and the dimension, in cells of 1.4 m, and draws storage.png. Each writes its table, NAME.csv beside this file. Runs that FOLDER holds are not
repeated."""

import csv
import pathlib
import resource
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[2] / "src/output/plots"), str(HERE)]

import figure  # noqa: E402
import measures  # noqa: E402
import talus_measures  # noqa: E402
from talus_results import Results, read_events  # noqa: E402

SLICE = ("dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller")  # as --slice
PAPER = ("body.soil.permeability=1e-10", "water.bulk_modulus=100e6", "stage.rain.duration=400")  # wetting takes ten times as long
AIR = ("phases=three-phase",)  # air: the program's defaults
GAS = ("phases=three-phase", "body.soil.gas_permeability=1e-10", "gas.bulk_modulus=1e4", "gas.density=1", "gas.viscosity=1e-6")  # Table 3, as permeable as raised
STUDIES = {
    "sensitivity": {
        "the scene": (),
        "strength from suction 5 kPa (10)": ("body.soil.suction_cohesion=5e3",),
        "strength from suction 20 kPa": ("body.soil.suction_cohesion=20e3",),
        "67 kPa at a suction of 800 kPa, as the text says": ("body.soil.suction_cohesion=154e3", "body.soil.suction_cohesion_rate=7e-7"),
        "P_0 of the retention curve 25 kPa (50)": ("body.soil.retention.reference_suction=25e3",),
        "P_0 of the retention curve 100 kPa": ("body.soil.retention.reference_suction=100e3",),
        "permeability 5e-10 m2 (1e-9)": ("body.soil.permeability=5e-10", "stage.rain.duration=120"),
        "permeability 2e-9 m2": ("body.soil.permeability=2e-9",),
        "K_l 10 MPa (20)": ("water.bulk_modulus=10e6",),
        "K_l 40 MPa": ("water.bulk_modulus=40e6",),
    },
    "cells": {
        **{f"cells of {size} m": (f"mesh.size={size}",) for size in (1.4, 1.0, 0.7, 0.5)},
        "cells of 1.0 m, 6 particles in each": ("mesh.size=1", "body.soil.particles_per_cell=6"),
        "cells of 1.0 m, step 0.3 of the critical (0.6)": ("mesh.size=1", "integrator.fraction=0.3"),
        "cells of 1.4 m, the paper's k and K_l": ("mesh.size=1.4", *PAPER),
        "cells of 1.0 m, the paper's k and K_l": ("mesh.size=1", *PAPER),
    },
    "model": {
        "the scene": (),
        "three phases, air": AIR,
        "three phases, gas of Table 3": GAS,
        "slice of tetrahedra": SLICE,
        "storage of the water in rate form": ("water.storage=rate",),
        "three phases, gas of Table 3, step 0.3 of the critical (0.6)": (*GAS, "integrator.fraction=0.3"),
    },
}
UNTIL_REST = "stage.rain.duration=60"  # the slide is over by then
COMMON = {"sensitivity": ("mesh.size=1", UNTIL_REST), "cells": (UNTIL_REST,), "model": ("mesh.size=1.4", UNTIL_REST)}


def outcome(results):
    """What the run of a scene gave, as words of a table."""
    columns = results.history.columns
    row = {point: f"{measures.share_of_strength(results, point):.2f}" for point in ("S1", "S2")}
    sliding = [snapshot.time for snapshot, _ in measures.while_it_slides(results)]
    row["slides_after_s"] = f"{sliding[0] - measures.start_of_rain(results):.0f}" if sliding else "stands"
    if sliding and not results.broke_off():
        row |= {"toe_m": f"{measures.run_out_of_the_toe(results):.1f}", "middle_m": f"{measures.displacement_at_mid_height(results):.1f}",
                **{f"{point}_m": f"{columns[f'{point}_displacement_m'][-1]:.2f}" for point in ("S1", "D1", "S2", "D2")},
                "D1_S": f"{columns['D1_saturation'][-1]:.3f}", "flatter_deg": f"{measures.flattening(results):.1f}",
                "dry_percent": f"{100 * measures.share_behind_the_front_that_is_dry(results):.1f}",
                "pressure_kPa": f"{measures.largest_pressure_while_it_slides(results) / 1e3:.0f}",
                "still_water_kPa": f"{measures.hydrostatic_pressure_behind_the_front(results) / 1e3:.0f}"}
    return row | {"steps": f"{talus_measures.steps(results):.0f}", "particles": f"{talus_measures.particles(results):.0f}"}


def run(talus, scene, out, overrides=()):
    """Results of a scene, from the folder if it holds them, and the processor time of the run [s]."""
    cost = out / "processor_s"
    if not cost.exists():
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        ended = subprocess.run([talus, "run", scene, "-o", out, "--no-pictures", "--force", *(word for key in overrides for word in ("--set", key))],
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if ended.returncode and not read_events(out, "broke_off"):
            sys.exit(ended.stderr[-600:])
        cost.write_text(f"{resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before:.1f}")
    return Results(out), float(cost.read_text())


def write(name, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.DictWriter(file, max(rows, key=len).keys(), restval="")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    talus, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    for name in sys.argv[3:] or STUDIES:
        rows, ran = [], {}
        for number, (label, overrides) in enumerate(STUDIES[name].items()):
            results, seconds = run(talus, HERE / "scene.toml", folder / f"{name}_{number}", (*COMMON.get(name, ()), *overrides))
            ran[label] = results
            ended = f"broke off after {results.history.time[-1] - measures.start_of_rain(results):.0f} s of rain" if results.broke_off() else "completed"
            rows.append({"run": label, **({"ended": ended} if name == "model" else {}), **outcome(results), "processor_s": f"{seconds:.0f}"})
            print(rows[-1], flush=True)
            write(f"{name}.csv", rows)
        if name == "model":
            figure.draw_storage(ran["the scene"], ran["storage of the water in rate form"], HERE / "storage.png")
