#!/usr/bin/python3
"""Level of the water at which the rock fails, by cell size and flow rule, written to limits.csv:  limits.py TALUS FOLDER

By finite elements it is the level beyond which no equilibrium was found; in motion, that at which the mean speed of the rock passes 0.1 m/s. The rock
has psi = 0 as in scene.toml; or psi = 0 with 5 % less of all strength and without softening, so that it fails while the water rises; or associated flow
with the strength of Davis (1968) for psi = 0, of which 2 % are left out for the same reason. Levels in motion for psi = 0 are those of sensitivity.csv
where it has them. Runs that FOLDER holds are not repeated, and short ones come first; limits.csv has what is known so far."""

import csv
import math
import os
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))
sys.path.insert(0, str(HERE))

import measures  # noqa: E402
from talus_results import Results, read_events  # noqa: E402

SIZES = (17, 16.5, 16, 15.5, 15, 14, 13, 12.5, 12, 11, 10, 9.5, 9, 8)  # m
MOST = tuple(size for size in SIZES if size not in (9.5, 9))  # m, of which ...
SOME = (17, 16, 15, 14, 12.5, 11)  # ... these where finer cells take long
LOAD_STEPS = 60  # over the 60 s of rising water
SHARE, UNSOFTENED_SHARE = 0.98, 0.95  # of the strength of Davis, and of that of rock that does not soften
FINITE_ELEMENTS = (f"stage=[{{name='gravity', kind='quasi_static', duration=1, hold_loads=true}}, "
                   f"{{name='water', kind='quasi_static', duration=60, load_steps={LOAD_STEPS}, when_lost='next_stage'}}]",)
# ends at five times the speed that counts as failure, which only rock that has failed reaches
MOTION = ("stage=[{name='gravity', kind='quasi_static', duration=1, hold_loads=true}, "
          "{name='settle', duration=40, until='equilibrium', damping=0.7, hold_loads=true}, "
          "{name='water', duration=75, until='failure', failure_point='m10', failure_speed=0.5}]",)


def angle(tangent):
    return math.degrees(math.atan(tangent))


def base(share):
    """The base with a share of its friction."""
    degrees = angle(share * math.tan(math.radians(12)))
    return f"functions.phi_b=[[0, {degrees}], [150, {degrees}], [151, 0]]"


def davis():
    """Associated flow with the strength that Davis (1968) gives rock with psi = 0: tan(phi*) = sin(phi), c* = c cos(phi); all of it times SHARE."""
    peak, residual = (angle(SHARE * math.sin(math.radians(degrees))) for degrees in (42, 36))
    return (f"body.rock.cohesion={SHARE * 300e3 * math.cos(math.radians(42))}", f"body.rock.friction_angle={peak}", f"body.rock.dilation_angle={peak}",
            f"body.rock.residual_friction_angle={residual}", f"body.rock.residual_dilation_angle={residual}", base(SHARE))


def unsoftened():
    """Rock with psi = 0 that keeps its peak strength; all of it times UNSOFTENED_SHARE."""
    cohesion, friction = UNSOFTENED_SHARE * 300e3, angle(UNSOFTENED_SHARE * math.tan(math.radians(42)))
    return (f"body.rock.cohesion={cohesion}", f"body.rock.residual_cohesion={cohesion}", f"body.rock.friction_angle={friction}",
            f"body.rock.residual_friction_angle={friction}", base(UNSOFTENED_SHARE))


def run(talus, command, out, keys):
    """What a run wrote on its screen."""
    words = [word for key in keys for word in ("--set", key)]
    done = subprocess.run([talus, command, HERE / "scene.toml", "-o", out, "--no-pictures", "--force", *words], capture_output=True, text=True, check=False,
                          stdin=subprocess.DEVNULL, env={**os.environ, "OMP_NUM_THREADS": "1"})
    return done.stdout + done.stderr


def level_without_equilibrium(talus, out, keys):
    """Level of the water beyond which finite elements found no equilibrium [m]; "stands" where they found one at 60 m, "gravity" where they found none
    without water."""
    text = run(talus, "solve", out, (*FINITE_ELEMENTS, *keys))
    lost = {event["stage"]: event["values"]["share_of_loads"] for event in read_events(out, "equilibrium_lost")}
    if "water" in lost:
        return f"{np.interp(60 * lost['water'], (0, 20, 40, 50, 60), (0, 30, 53, 57, 60)):.0f}"
    if "gravity" in lost:
        return "gravity"
    if any(event["stage"] == "water" for event in read_events(out, "equilibrium")):
        return "stands"
    sys.exit(f"{out.name}: {text.strip()[-600:]}")


def level_in_motion(talus, out, keys):
    """Level of the water at which the rock fails in motion [m]; "stands" where it does not within 15 s at 60 m."""
    text = run(talus, "run", out, (*MOTION, *keys))
    if not (out / "history.csv").exists() or Results(out).broke_off():
        sys.exit(f"{out.name}: {text.strip()[-600:]}")
    level = measures.level_of_failure(Results(out), "m10")
    return f"{level:.0f}" if level == level else "stands"


SECOND_ORDER = 'quasi_static.elements="quadratic"'
# of each column, the sizes, what finds the level, and the keys
COLUMNS = {
    "patches_m": (SIZES, level_without_equilibrium, ()),
    "quadratic_m": (SOME, level_without_equilibrium, (SECOND_ORDER,)),
    "motion_m": (MOST, level_in_motion, ()),
    "unsoftened_m": (SOME, level_without_equilibrium, unsoftened()),
    "davis_patches_m": (MOST, level_without_equilibrium, davis()),
    "davis_quadratic_m": (SOME, level_without_equilibrium, (SECOND_ORDER, *davis())),
    "davis_motion_m": (tuple(size for size in MOST if size != 16.5), level_in_motion, davis()),
}
ORDER = ("patches_m", "davis_quadratic_m", "unsoftened_m", "motion_m", "davis_patches_m", "quadratic_m", "davis_motion_m")


def levels_of_study():
    """Of each cell size, the level in motion of sensitivity.csv."""
    with open(HERE / "sensitivity.csv", newline="") as file:
        levels = {each["case"]: each["failure_m"] for each in csv.DictReader(file)}
    found = {size: levels.get("as the scene" if size == 15 else f"cells of {size} m") for size in SIZES}
    return {size: "stands" if level == "none" else level for size, level in found.items() if level}


def level(talus, folder, column, size):
    """Of one case, from the folder if it holds it."""
    _, find, keys = COLUMNS[column]
    out = folder / f"{column}_{size}"
    known = out.with_suffix(out.suffix + ".level")
    if not known.exists():
        known.write_text(find(talus, out, (f"mesh.size={size}", *keys)))
    return known.read_text()


def write(rows):
    with open(HERE / "limits.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, ("size_m", *COLUMNS), restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows.values())


if __name__ == "__main__":
    talus, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    rows, studied = {size: {"size_m": size} for size in SIZES}, levels_of_study()
    cases = [(column, size) for column in ORDER for size in COLUMNS[column][0]]
    for column, size in sorted(cases, key=lambda case: case[1] < (13 if case[0] == "quadratic_m" else 9.5)):  # what takes long last
        rows[size][column] = studied[size] if column == "motion_m" and size in studied else level(talus, folder, column, size)
        print(f"cells of {size} m, {column}: {rows[size][column]}", flush=True)
        write(rows)
