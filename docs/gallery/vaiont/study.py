#!/usr/bin/python3
"""Runs the scene with each uncertain parameter changed, in cells of 15 m, and writes sensitivity.csv:  study.py TALUS [CASE ...]
With names of cases only these are run, and the rows of the others stay as they are."""

import csv
import math
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor, as_completed

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))
sys.path.insert(0, str(HERE))

import measures  # noqa: E402
import mirrored  # noqa: E402
from talus_results import Results  # noqa: E402

SIZE = 15  # m, of the cells where a case says nothing else


def times(factor):
    """The scene with its water `factor` times as slow, and as long a time to come to rest at 60 m."""
    t = [factor * each for each in (20, 40, 50, 60)]
    end = t[-1] + 90
    return [f"functions.hw=[[0, 0], [{t[0]}, 30], [{t[1]}, 53], [{t[2]}, 57], [{t[3]}, 60]]",
            f"functions.phi_b=[[0, 12], [{end}, 12], [{end + 1}, 0]]", f"stage.water.duration={end}"]


def strength(factor):
    """All strength times a factor."""
    angle = lambda degrees: f"{math.degrees(math.atan(factor * math.tan(math.radians(degrees)))):.4f}"
    return [f"body.rock.cohesion={factor * 300e3}", f"body.rock.friction_angle={angle(42)}", f"body.rock.residual_friction_angle={angle(36)}",
            f"functions.phi_b=[[0, {angle(12)}], [150, {angle(12)}], [151, 0]]"]


CASES = (
    ("as the scene", []),
    ("mirrored: x to -x", lambda talus, folder: mirrored.write(talus, folder, SIZE)),
    *((f"cells of {size} m", [f"mesh.size={size}"]) for size in (20, 17, 16, 15.5, 15.1, 14.9, 14, 13, 12.5)),
    ("cells of 12 m", ["mesh.size=12"]),
    ("cells of 11 m", ["mesh.size=11"]),
    ("cells of 10 m", ["mesh.size=10"]),
    ("cells of 8 m", ["mesh.size=8"]),
    *((f"other round-off: snapshots every {interval} s", [f"output.interval={interval}"]) for interval in (0.5, 1, 1.25, 1.5, 3)),
    *((f"other round-off: the scene shifted, {right:g} m in x, {up:g} m in y",
       lambda talus, folder, right=right, up=up: mirrored.write_shifted(talus, folder, SIZE, right, up))
      for right, up in ((0, -640), (0, 360), (1000, 0), (3000, -640))),
    ("other round-off: steps of 0.59 of the critical one (0.6)", ["integrator.fraction=0.59"]),
    ("softening of the cell, 20 m", ["body.rock.averaging_length=0", "mesh.size=20"]),
    ("softening of the cell, 15 m", ["body.rock.averaging_length=0"]),
    ("softening of the cell, 12 m", ["body.rock.averaging_length=0", "mesh.size=12"]),
    ("averaging_length 40 m", ["body.rock.averaging_length=40"]),
    ("averaging_length 10 m, cells of 10 m", ["body.rock.averaging_length=10", "mesh.size=10"]),
    ("reference_size halved (or eta doubled)", ["body.rock.reference_size=12"]),
    ("reference_size doubled (or eta halved)", ["body.rock.reference_size=48"]),
    ("hardly any softening, eta 1", ["body.rock.shape_factor=1"]),
    ("all strength 1 % lower", strength(0.99)),
    ("all strength 1 % higher", strength(1.01)),
    *((f"cells of {size} m, all strength {abs(percent)} % {'lower' if percent < 0 else 'higher'}", [f"mesh.size={size}", *strength(1 + percent / 100)])
      for size, percent in ((16, -1), (16, -2), (14, -1), (11, 1), (11, 2))),
    ("gravity does not soften the rock", ["stage.gravity.softening=false", "stage.settle.softening=false"]),
    ("residual cohesion 75 kPa", ["body.rock.residual_cohesion=75e3"]),
    ("residual cohesion 150 kPa", ["body.rock.residual_cohesion=150e3"]),
    *((f"residual cohesion {c} kPa, cells of 12 m", [f"body.rock.residual_cohesion={c}e3", "mesh.size=12"]) for c in (75, 150, 225)),
    ("residual cohesion 150 kPa, cells of 10 m", ["body.rock.residual_cohesion=150e3", "mesh.size=10"]),
    ("E 2.5 GPa", ["body.rock.young_modulus=2.5e9"]),
    ("E 10 GPa", ["body.rock.young_modulus=1e10"]),
    ("E 5 MPa, as printed", ["body.rock.young_modulus=5e6"]),
    ("Poisson's ratio 0.165", ["body.rock.poisson_ratio=0.165"]),
    ("Poisson's ratio 0.45", ["body.rock.poisson_ratio=0.45"]),
    ("dilation angle 5 degrees, residual 0", ["body.rock.dilation_angle=5", "body.rock.residual_dilation_angle=0"]),
    ("dilation angle 10 degrees, residual 0", ["body.rock.dilation_angle=10", "body.rock.residual_dilation_angle=0"]),
    ("water rises in half the time", times(0.5)),
    ("water rises in twice the time", times(2)),
    ("damping of the water stage 0.01", ["stage.water.damping=0.01"]),
    ("damping of the water stage 0.05", ["stage.water.damping=0.05"]),
    ("opposite slope keeps 12 degrees", ["boundary.bed.friction_angle=x > 1255 ? 12 : phi_b(t)"]),
    ("no water on the toe", ["water.level=0", "water.excess=1000 * 9.81 * max(0, 640 + hw(t) * min(1, max(0, (1115.6 - x) / 150)) - y)"]),
)


COLUMNS = ("case", "ended", "failure_m", "at_30_m", "at_53_m", "at_60_m", "rest_m", "water_m_s", "P0_m", "slide_m_s", "run_out_m")


def run(talus, name, changes, folder):
    """One row: what the case gave, or that it broke off."""
    out = pathlib.Path(folder) / "".join(letter for letter in name if letter.isalnum())
    placed = callable(changes)  # writes a scene with its own mesh
    scene, sets = (changes(talus, folder), []) if placed else (HERE / "scene.toml", [f"mesh.size={SIZE}", *changes])
    command = [talus, "run", scene, "-o", out, "--no-pictures", *(word for each in sets for word in ("--set", each))]
    subprocess.run(command, stdout=subprocess.DEVNULL, check=False)
    results = Results(out)
    row = {"case": name, "ended": "broke off" if results.broke_off() else "completed"}
    level = measures.level_of_failure(results, "m10")
    row["failure_m"] = f"{level:.0f}" if level == level else "none"
    row |= {f"at_{level}_m": f"{measures.displacement_at_level(results, 'm10', level):.2f}" for level in (30, 53, 60)}
    row["rest_m"] = f"{measures.displacement_before_slide(results, 'm10'):.1f}"
    row["water_m_s"] = f"{measures.mean_speed_in_stage(results, 'm10', 'water'):.2f}"
    row["P0_m"] = f"{measures.displacement_before_slide(results, 'P0'):.1f}"
    row["slide_m_s"] = f"{measures.speed_in_stage(results, 'P0', 'slide'):.2f}"
    return row | {"run_out_m": f"{measures.run_out(results, 'P0'):.1f}"}


if __name__ == "__main__":
    table, wanted = HERE / "sensitivity.csv", sys.argv[2:]
    rows = {}
    if wanted and table.exists():
        with open(table, newline="") as file:
            rows = {row["case"]: row for row in csv.DictReader(file)}
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        jobs = [pool.submit(run, sys.argv[1], *case, folder) for case in CASES if not wanted or case[0] in wanted]
        for job in as_completed(jobs):
            row = job.result()
            rows[row["case"]] = row
            with open(table, "w", newline="") as file:
                writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
                writer.writeheader(), writer.writerows(rows[name] for name, _ in CASES if name in rows)
