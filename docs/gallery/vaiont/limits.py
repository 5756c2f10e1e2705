#!/usr/bin/python3
"""Level of the water at which the rock fails, by cell size and flow rule, written to limits.csv:  limits.py TALUS

By finite elements it is the level beyond which no equilibrium was found; in motion, that at which the mean speed of the rock passes 0.1 m/s. The rock
either has psi = 0 as in scene.toml, or associated flow with the strength of Davis (1968) for psi = 0, of which 2 % are left out so that it fails while
the water rises. Levels in motion for psi = 0 are those of sensitivity.csv."""

import csv
import math
import os
import pathlib
import re
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

SIZES = (17, 16, 15.5, 15, 14, 13, 12.5, 12, 11, 10, 8)  # m
QUADRATIC = (17, 16, 15, 14, 12.5, 11)  # m; finer cells take long
LOAD_STEPS = 60  # over the 60 s of rising water
SHARE = 0.98  # of the strength of Davis
FINITE_ELEMENTS = (f"stage=[{{name='gravity', kind='quasi_static', duration=1, hold_loads=true}}, "
                   f"{{name='water', kind='quasi_static', duration=60, load_steps={LOAD_STEPS}, when_lost='next_stage'}}]",)
MOTION = ("stage=[{name='gravity', kind='quasi_static', duration=1, hold_loads=true}, "
          "{name='settle', duration=40, until='equilibrium', damping=0.7, hold_loads=true}, {name='water', duration=75}]",)
COLUMNS = ("size_m", "patches_m", "quadratic_m", "motion_m", "davis_patches_m", "davis_quadratic_m", "davis_motion_m")


def davis():
    """Associated flow with the strength that Davis (1968) gives rock with psi = 0: tan(phi*) = sin(phi), c* = c cos(phi); all of it times SHARE."""
    angle = lambda tangent: math.degrees(math.atan(SHARE * tangent))
    peak, residual = (angle(math.sin(math.radians(degrees))) for degrees in (42, 36))
    base = angle(math.tan(math.radians(12)))
    return (f"body.rock.cohesion={SHARE * 300e3 * math.cos(math.radians(42))}", f"body.rock.friction_angle={peak}", f"body.rock.dilation_angle={peak}",
            f"body.rock.residual_friction_angle={residual}", f"body.rock.residual_dilation_angle={residual}",
            f"functions.phi_b=[[0, {base}], [150, {base}], [151, 0]]")


def run(talus, command, folder, name, keys):
    """Folder of a run and what it wrote on its screen."""
    out = pathlib.Path(folder) / name
    words = [word for key in keys for word in ("--set", key)]
    done = subprocess.run([talus, command, HERE / "scene.toml", "-o", out, "--no-pictures", *words], capture_output=True, text=True, check=False,
                          env={**os.environ, "OMP_NUM_THREADS": "1"})
    return out, done.stdout + done.stderr


def level_without_equilibrium(talus, folder, name, keys):
    """Level of the water beyond which finite elements found no equilibrium [m]; "stands" where they found one at 60 m, "gravity" where they found none
    without water."""
    _, text = run(talus, "solve", folder, name, (*FINITE_ELEMENTS, *keys))
    if lost := re.search(r"no equilibrium beyond ([\d.]+) % of the loads of stage water", text):
        return f"{np.interp(0.6 * float(lost[1]), (0, 20, 40, 50, 60), (0, 30, 53, 57, 60)):.0f}"
    if "of the loads of stage gravity" in text:
        return "gravity"
    return "stands" if "stage water is in equilibrium" in text else "none: " + text.strip().splitlines()[-1]


def level_in_motion(talus, folder, name, keys):
    """Level of the water at which the rock fails in motion [m]; "stands" where it does not within 15 s at 60 m."""
    out, _ = run(talus, "run", folder, name, (*MOTION, *keys))
    level = measures.level_of_failure(Results(out), "m10")
    return f"{level:.0f}" if level == level else "stands"


def row(talus, folder, size):
    cells, weaker = f"mesh.size={size}", davis()
    name = lambda kind: f"{kind}_{size}".replace(".", "_")
    with open(HERE / "sensitivity.csv", newline="") as file:
        motion = {each["case"]: each["failure_m"] for each in csv.DictReader(file)}["as the scene" if size == 15 else f"cells of {size} m"]
    quadratic = lambda kind, keys: (level_without_equilibrium(talus, folder, name(kind), (cells, 'quasi_static.elements="quadratic"', *keys))
                                    if size in QUADRATIC else "")
    return {"size_m": size, "patches_m": level_without_equilibrium(talus, folder, name("patches"), (cells,)), "quadratic_m": quadratic("quadratic", ()),
            "motion_m": "stands" if motion == "none" else motion,
            "davis_patches_m": level_without_equilibrium(talus, folder, name("davis"), (cells, *weaker)),
            "davis_quadratic_m": quadratic("davis_quadratic", weaker),
            "davis_motion_m": level_in_motion(talus, folder, name("davis_motion"), (cells, *weaker))}


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool, open(HERE / "limits.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for each in pool.map(lambda size: row(sys.argv[1], folder, size), SIZES):
            print(each, flush=True)
            writer.writerow(each), file.flush()
