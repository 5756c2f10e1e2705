#!/usr/bin/python3
"""Factors of safety of the slopes of this page, by finite elements with strength reduction.

    study.py TALUS [slopes|meshes|motion|figure ...]

TALUS is the program (build/release/bin/talus). `slopes` writes factors.csv, `meshes` meshes.csv and `motion` motion.csv beside this file, `figure` draws
mechanism.png.
"""
import csv
import json
import math
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import limit_equilibrium

GRAVITY = 9.81
# section, c [kPa], phi [deg], gamma [kN/m3], cell sizes [m], published factor; sources in README.md
PUBLISHED = {
    "ACADS-1a": ("acads_1a.csv", 3, 19.6, 20, (1.5, 0.75), "0.99"),
    "AT-1": ("arai_tagyo.csv", 41.65, 15, 18.82, (2, 1), "1.41"),
    "GL-1": ("griffiths_lane_1.csv", 14.9626, 20, 19.6359, (1.5, 0.75), "1.38"),
    "GL-2": ("griffiths_lane_2.csv", 14.9626, 20, 19.6359, (2, 1), "1.38"),
}
OWN = {"weak seam": ("weak_seam.toml", (1,)), "layered": ("layered.toml", (1,))}
GUIDE_SIZES = (0.8, 0.6, 0.5, 0.4, 0.35)
# scene, c [kPa], phi [deg], gamma' [kN/m3], cell sizes [m], crest, middle of the face, height [m], published factor
MOVED = {"SP-1969": ("spencer.toml", 10.8, 40, 9, (4, 3, 2), (10, 40), (40, 25), 30, "1.01 to 1.08")}
MOVED |= {name: ("scene.toml", *PUBLISHED[name][1:4], *more, PUBLISHED[name][5]) for name, more in {
    "ACADS-1a": ((1.5, 0.75), (50, 35), (40, 30), 10), "AT-1": ((2,), (48, 35), (33, 25), 20),
    "GL-1": ((1.5,), (18.288, 15.24), (33.528, 7.62), 15.24), "GL-2": ((2,), (18.288, 15.24), (33.528, 7.62), 15.24)}.items()}
STEP = 0.05       # between the factors that are tried by motion
STANDS = 0.01     # displacement over height


def solve(talus, scene, overrides, keep=None):
    """The answer of one run as --json gives it, and its processor time [s]; the pictures go into the folder `keep`."""
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        command = [talus, "solve", HERE / scene, "--factor-of-safety", "--json", "--force", "-o", folder, "--set", *overrides]
        done = subprocess.run(command if keep else [*command[:4], "--no-pictures", *command[4:]], capture_output=True, text=True)
        if done.returncode not in (0, 3):
            raise RuntimeError(f"{scene}: {done.stderr}")
        if keep:
            shutil.copy(Path(folder) / "pictures/factor_mechanism.png", keep / "mechanism.png")
        return json.loads(done.stdout), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def overrides_of(name):
    section, cohesion, phi, gamma, _, _ = PUBLISHED[name]
    sides = [] if name == "GL-1" else ["boundary.right.kind=roller"]
    return [f"mesh.section={section}", f"body.soil.density={1000 * gamma / GRAVITY}", f"body.soil.cohesion={1000 * cohesion}",
            f"body.soil.friction_angle={phi}", *sides]


def value_of(bracket):
    return f"{bracket['value']:.3f}" if bracket["decided"] else f"{bracket['equilibrium']:.3f} to {bracket['mechanism']:.3f}"


def rows_of(answer, **facts):
    """One row for each flow: the soil's own psi = 0, and its bounds."""
    for flow, bracket in answer["by_flow"].items():
        yield {**facts, "flow": flow, "lower": f"{bracket['equilibrium']:.4f}", "upper": f"{bracket['mechanism']:.4f}", "factor": value_of(bracket)}


def write(name, rows):
    with open(HERE / name, "w", newline="") as out:
        writer = csv.DictWriter(out, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def slopes(talus):
    rows = []
    cases = [(name, "scene.toml", overrides_of(name), sizes, published) for name, (*_, sizes, published) in PUBLISHED.items()]
    cases += [(name, scene, [], sizes, "") for name, (scene, sizes) in OWN.items()]
    for name, scene, overrides, sizes, published in cases:
        spencer, davis = (f"{limit_equilibrium.least(limit_equilibrium.SLOPES[name], davis)[0]:.3f}" for davis in (False, True))
        for size in sizes:
            answer, _ = solve(talus, scene, [*overrides, f"mesh.size={size}"])
            rows += rows_of(answer, slope=name, published=published, spencer=spencer, spencer_davis=davis, size_m=size)
            print(*rows[-3:], sep="\n", flush=True)
            write("factors.csv", rows)


def meshes(talus):
    rows = []
    for size in GUIDE_SIZES:
        answer, seconds = solve(talus, "guide_slope.toml", [f"mesh.size={size}"])
        rows += rows_of(answer, size_m=size, cpu_s=f"{seconds:.1f}")
        print(*rows[-3:], sep="\n", flush=True)
        write("meshes.csv", rows)


def moved(talus, name, size, start, associated, factor):
    """Largest displacement of crest and face [m] in motion, with strength divided by `factor`."""
    scene, cohesion, phi, gamma, _, crest, face, height, _ = MOVED[name]
    reduced = math.degrees(math.atan(math.tan(math.radians(phi)) / factor))
    sets = [*sets_of(name, size), f"body.soil.cohesion={1000 * cohesion / factor}", f"body.soil.friction_angle={reduced}",
            f"body.soil.dilation_angle={reduced if associated else 0}", "mesh.leaving_particles=remove",
            f"output.point={{crest={{position={list(crest)}}}, face={{position={list(face)}}}}}"]
    if start == "K0":
        (x0, y0), (x1, y1) = crest, (2 * f - c for c, f in zip(crest, face))
        vertical = f"-{1000 * gamma} * (max({y1}, min({y0}, {y0} - ({y0 - y1}) * (x - {x0}) / {x1 - x0})) - y)"
        lateral = f"{1 - math.sin(math.radians(phi))} * {vertical}"
        sets.append(f"body.soil.stress=['{lateral}', '{vertical}', '{lateral}', '0']")
    ramp = 5 if start == "gravity" else 0
    sets.append(f"stage=[{{name='gravity', duration=15, gravity_ramp={ramp}, damping=0.5, until='equilibrium'}}]")
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([talus, "run", HERE / scene, "--no-pictures", "--force", "-o", folder, "--set", *sets], capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"{scene}: {done.stderr}")
        with open(Path(folder) / "history.csv", newline="") as history:
            last = list(csv.DictReader(history))[-1]
    distance = max(float(last[f"{point}_displacement_m"]) for point in ("crest", "face"))
    print(f"{name} {size} m {start}{' psi = phi' * associated} F {factor:.2f}: {distance:.3f} m in {float(last['time_s']):.1f} s", flush=True)
    return distance


def bracketed(talus, name, size, start, first, associated=False):
    """The largest factor at which the slope stands in motion and the least at which it fails, with the displacements; trials from `first` on."""
    tried, k = {}, round(first / STEP)
    limit = STANDS * MOVED[name][-2]
    while True:
        tried[k] = moved(talus, name, size, start, associated, k * STEP)
        stood, fell = ([j for j in tried if (tried[j] < limit) == stands] for stands in (True, False))
        if stood and fell:
            return {"stands": f"{max(stood) * STEP:.2f}", "fails": f"{min(fell) * STEP:.2f}", "stands_moved_m": f"{tried[max(stood)]:.2f}",
                    "fails_moved_m": f"{tried[min(fell)]:.2f}"}
        k += 1 if stood else -1


def sets_of(name, size):
    return [*(overrides_of(name) if name in PUBLISHED else []), f"mesh.size={size}"]


def motion(talus):
    """The published slopes with psi = 0 from two initial stresses, by elements and by motion with strength divided by hand. With psi = phi the limit does
    not depend on the stress from which it is reached: motion from one."""
    rows = []
    for name, (scene, *_, sizes, _, _, _, published) in MOVED.items():
        for size in sizes:
            for start in ("gravity", "K0"):
                k0 = ["stage=[{name='gravity', kind='quasi_static', duration=1, initial_stress='k0'}]"]
                answer, _ = solve(talus, scene, sets_of(name, size) + (k0 if start == "K0" else []))
                flows = answer["by_flow"]
                rows.append({"slope": name, "published": published, "size_m": size, "start": start, "own": value_of(flows["own"]),
                             "weakened": value_of(answer["weakened"]) if answer["weakened"] else "", "davis": value_of(flows["davis"]),
                             "associated": value_of(flows["associated"]), **bracketed(talus, name, size, start, flows["own"]["equilibrium"])})
                associated = bracketed(talus, name, size, start, flows["associated"]["equilibrium"], associated=True) if start == "gravity" else {}
                rows[-1] |= {f"{key}_associated": associated.get(key, "") for key in ("stands", "fails")}
                print(rows[-1], flush=True)
                write("motion.csv", rows)


def figure(talus):
    solve(talus, "scene.toml", [*overrides_of("GL-1"), "mesh.size=0.75"], keep=HERE)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for study in sys.argv[2:] or ["slopes", "meshes", "motion", "figure"]:
        {"slopes": slopes, "meshes": meshes, "motion": motion, "figure": figure}[study](sys.argv[1])
