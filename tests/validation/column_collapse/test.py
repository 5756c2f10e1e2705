#!/usr/bin/python3
"""Column of aluminium bars (Bui et al. 2008): profile, toe and failure line; sand column: run-out between the two laws.

    test.py TALUS DIR    runs with the program TALUS into DIR; fails if a claim does
"""

import pathlib
import subprocess
import sys

GALLERY = pathlib.Path(__file__).resolve().parents[3] / "docs/gallery/column"
sys.path.insert(0, str(GALLERY))
sys.dont_write_bytecode = True

import measures  # noqa: E402
import runout  # noqa: E402


def run(program, scene, folder, *overrides):
    """Runs a scene, without pictures; returns its results."""
    settings = [part for override in overrides for part in ("--set", override)]
    subprocess.run([program, "run", str(scene), "-o", str(folder), "--no-pictures", "--force", *settings], check=True)
    return measures.Results(folder)


def within(name, value, wanted, tolerance, unit):
    holds = abs(value - wanted) <= tolerance
    print(f"{'pass' if holds else 'FAIL'}  {name}: {value:.4g} {unit}, claimed {wanted:g} +- {tolerance:g}")
    return holds


def bars(program, folder):
    """The claims on the aluminium bars; in a slice of tetrahedra the profile and the toe."""
    scene = GALLERY / "scene.toml"
    plane = measures.measures(run(program, scene, folder / "bars").snapshots[-1])
    lateral, vertical = "-9.81 * 2650 * (0.1 - y) * 0.3 / 0.7", "-9.81 * 2650 * (0.1 - y)"
    slice_ = measures.measures(run(
        program, scene, folder / "slice", "dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller",
        "output.point.corner.position=[0.2, 0.1, 0.0025]",
        f'body.bars.stress=["{lateral}", "{vertical}", "{lateral}", "0 * x", "0 * x", "0 * x"]').snapshots[-1])
    return [
        within("profile off in the mean", plane["profile"], 0, 0.005, "m"),
        within("toe, 99.5 % of the mass", plane["toe"], 0.442, 0.02, "m"),
        within("foot of the failure line", plane["foot"], 0.179, 0.01, "m"),
        within("slice: profile off in the mean", slice_["profile"], 0, 0.005, "m"),
    ]


def sand(program, folder):
    """Run-out of a square column."""
    aspect = 1
    here = folder / "sand"
    runout.write_scene(here, aspect, 30, None, 1 / 20)
    run(program, here / "scene.toml", here)
    low, high = sorted(float(runout.law(aspect, *law)) for law in runout.LAWS.values())
    return [within("run-out over L0 at H0 = L0", runout.measure(here)["runout"], (low + high) / 2, (high - low) / 2, "")]


if __name__ == "__main__":
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    sys.exit(not all(bars(program, folder) + sand(program, folder)))
