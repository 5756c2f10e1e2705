#!/usr/bin/python3
"""Factors of safety of the slopes of this page, by finite elements with strength reduction.

    study.py TALUS [slopes|meshes|figure ...]

TALUS is the program (build/release/bin/talus). `slopes` writes factors.csv and `meshes` meshes.csv beside this file, `figure` draws mechanism.png.
"""
import csv
import json
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


def rows_of(answer, **facts):
    """One row for each flow: the soil's own psi = 0, and its bounds."""
    for flow, bracket in answer["by_flow"].items():
        value = f"{bracket['value']:.3f}" if bracket["decided"] else f"{bracket['equilibrium']:.3f} to {bracket['mechanism']:.3f}"
        yield {**facts, "flow": flow, "lower": f"{bracket['equilibrium']:.4f}", "upper": f"{bracket['mechanism']:.4f}", "factor": value}


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


def figure(talus):
    solve(talus, "scene.toml", [*overrides_of("GL-1"), "mesh.size=0.75"], keep=HERE)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for study in sys.argv[2:] or ["slopes", "meshes", "figure"]:
        {"slopes": slopes, "meshes": meshes, "figure": figure}[study](sys.argv[1])
