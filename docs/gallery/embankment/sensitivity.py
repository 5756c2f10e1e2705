#!/usr/bin/python3
"""What halving and doubling does to each parameter that the paper does not give, or gives in two ways:  sensitivity.py TALUS FOLDER
Runs the scene with one change at a time into FOLDER and writes sensitivity.csv."""

import csv
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[2] / "src/output/plots"), str(HERE)]

import measures  # noqa: E402
import talus_measures  # noqa: E402
from talus_results import Results  # noqa: E402

TOE, MIDDLE, START = 35.0, (24.87, 9.9), 3.0  # [m], [m], end of the stage gravity [s]
FRICTION, FRICTION_RATE = 20.0, 1e-6  # of the scene [deg], [deg/Pa]
CHANGES = (
    ("the scene", ()),
    ("strength from suction 7.5 kPa (15)", ("body.soil.suction_cohesion=7.5e3",)),
    ("strength from suction 30 kPa", ("body.soil.suction_cohesion=30e3",)),
    ("67 kPa at a suction of 800 kPa, as the text says", ("body.soil.suction_cohesion=154e3", "body.soil.suction_cohesion_rate=7e-7")),
    ("P_0 of the retention curve 25 kPa (50)", ("body.soil.retention.reference_suction=25e3",)),
    ("P_0 of the retention curve 100 kPa", ("body.soil.retention.reference_suction=100e3",)),
    ("permeability 5e-10 m2 (1e-9)", ("body.soil.permeability=5e-10",)),
    ("permeability 2e-9 m2", ("body.soil.permeability=2e-9",)),
    ("K_l 10 MPa (20)", ("water.bulk_modulus=10e6",)),
    ("K_l 40 MPa", ("water.bulk_modulus=40e6",)),
)


def share_of_strength(results, point):
    """Mobilised share of the strength of a point at the end of the stage gravity."""
    columns, k = results.history.columns, np.searchsorted(results.history.time, START - 0.01)
    strength = FRICTION + FRICTION_RATE * columns[f"{point}_suction_Pa"][k]
    return np.sin(np.radians(columns[f"{point}_mobilised_friction_deg"][k])) / np.sin(np.radians(strength))


def row_of(name, folder):
    results = Results(folder)
    sliding = [snapshot.time for snapshot, _ in measures.while_it_slides(results)]
    row = {"changed": name, "S1": f"{share_of_strength(results, 'S1'):.2f}", "S2": f"{share_of_strength(results, 'S2'):.2f}",
           "slides_after_s": f"{sliding[0] - START:.0f}" if sliding else "stands"}
    if sliding:
        row |= {"front_m": f"{talus_measures.largest_x_moved(results, beyond=TOE):.1f}",
                "middle_m": f"{talus_measures.largest_displacement_near(results, MIDDLE, 1.2, 3):.1f}",
                "dry_percent": f"{100 * measures.share_behind_the_front_that_is_dry(results):.1f}",
                "pressure_kPa": f"{measures.largest_pressure_while_it_slides(results) / 1e3:.0f}"}
    return row


if __name__ == "__main__":
    talus, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    rows = []
    for number, (name, keys) in enumerate(CHANGES):
        out = folder / str(number)
        if not (out / "history.csv").exists():
            subprocess.run([talus, "run", HERE / "scene.toml", "-o", out, "--no-pictures", *(word for key in keys for word in ("--set", key))],
                           stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, check=True)
        rows.append(row_of(name, out))
    with open(HERE / "sensitivity.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, ["changed", "S1", "S2", "slides_after_s", "front_m", "middle_m", "dry_percent", "pressure_kPa"], restval="")
        writer.writeheader()
        writer.writerows(rows)
