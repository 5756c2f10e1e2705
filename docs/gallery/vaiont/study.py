#!/usr/bin/python3
"""Runs the scene with each uncertain parameter changed, in cells of 20 m, and writes sensitivity.csv:  study.py TALUS [CASE ...]
With names of cases only these are run, and the rows of the others stay as they are."""

import csv
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))
sys.path.insert(0, str(HERE))

import measures  # noqa: E402
from talus_results import Results  # noqa: E402

CASES = (
    ("as the scene", []),
    ("cells of 15 m", ["mesh.size=15"]),
    ("cells of 12 m", ["mesh.size=12"]),
    ("eta halved", ["body.rock.shape_factor=75"]),
    ("eta doubled", ["body.rock.shape_factor=300"]),
    ("residual cohesion 75 kPa", ["body.rock.residual_cohesion=75e3"]),
    ("residual cohesion 150 kPa", ["body.rock.residual_cohesion=150e3"]),
    ("E 2.5 GPa", ["body.rock.young_modulus=2.5e9"]),
    ("E 10 GPa", ["body.rock.young_modulus=1e10"]),
    ("E 5 MPa, as printed", ["body.rock.young_modulus=5e6"]),
    ("damping of the water stage 0", ["stage.1.damping=0"]),
    ("damping of the water stage 0.1", ["stage.1.damping=0.1"]),
    ("opposite slope keeps 12 degrees", ["boundary.bed.friction_angle=x > 1255 ? 12 : phi_b(t)"]),
    ("hardly any softening, eta 1", ["body.rock.shape_factor=1"]),
    ("no water on the toe", ["water.level=0", "water.excess=1000 * 9.81 * max(0, 640 + hw(t) * min(1, max(0, (1115.6 - x) / 150)) - y)"]),
)


COLUMNS = ("case", "ended", "at_30_m", "at_53_m", "at_60_m", "water_m_s", "slide_m_s", "run_out_m")


def run(talus, name, changes, folder):
    """One row: what the case gave, or that it broke off."""
    out = pathlib.Path(folder) / name.replace(" ", "_").replace(",", "")
    subprocess.run([talus, "run", HERE / "scene.toml", "-o", out, "--set", "mesh.size=20", *changes], stdout=subprocess.DEVNULL, check=False)
    results = Results(out)
    row = {"case": name, "ended": "broke off" if results.broke_off() else "completed"}
    row |= {f"at_{level}_m": f"{measures.displacement_at_level(results, 'P0', level):.2f}" for level in (30, 53, 60)}
    row |= {f"{stage}_m_s": f"{measures.speed_in_stage(results, 'P0', stage):.2f}" for stage in ("water", "slide")}
    return row | {"run_out_m": f"{measures.run_out(results, 'P0'):.1f}"}


if __name__ == "__main__":
    table, wanted = HERE / "sensitivity.csv", sys.argv[2:]
    rows = {}
    if wanted and table.exists():
        with open(table, newline="") as file:
            rows = {row["case"]: row for row in csv.DictReader(file)}
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        cases = [case for case in CASES if not wanted or case[0] in wanted]
        rows |= {row["case"]: row for row in pool.map(lambda case: run(sys.argv[1], *case, folder), cases)}
    with open(table, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader(), writer.writerows(rows[name] for name, _ in CASES if name in rows)
