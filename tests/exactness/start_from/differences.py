"""How far a run that starts at the state of another departs from the run that was not parted: differences.py TALUS

A block of sand settles for 0.03 s and then falls apart for 0.03, 0.3 and 1 s, in one run of two stages and in two runs. Prints for each phase model the
largest difference of stress and of velocity between the two over all particles, as a share of the largest value. The numbers are those of the guide.
"""

import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

SECTION = """part,x,y
outline,0,0
outline,2,0
outline,2,1
outline,0,1
interface0,0,0.5
interface0,1,0.5
interface0,1,0
region_sand,0.5,0.25
region_air,1.5,0.5
"""
SCENE = """gravity = 9.81
[mesh]
section = "section.csv"
size = 0.25
[body.sand]
region = "sand"
porosity = 0.3
grain_density = 2650
law = "mohr_coulomb"
young_modulus = "1 MPa"
poisson_ratio = 0.3
cohesion = "1 kPa"
friction_angle = 30
[boundary.base]
kind = "friction"
friction_angle = 15
[boundary.left]
kind = "roller"
[output]
interval = 0.01
"""
SETTLE = '[[stage]]\nname = "settle"\nduration = 0.03\ndamping = 0.5\nhold_loads = true\nreset_displacement = true\n'
START = '[start_from]\nfolder = "source"\n'
WET = ["body.sand.permeability=1e-10", "water.bulk_modulus=1e7"]
CURVES = ["body.sand.retention.curve=van_genuchten", "body.sand.retention.reference_suction=5e3", "body.sand.retention.shape=0.5",
          "body.sand.relative_permeability.curve=van_genuchten_mualem", "body.sand.relative_permeability.shape=0.5", "water.table=[[0, 0.2], [2, 0.2]]"]
CASES = {"dry": [], "drained, table at rest": ["phases=drained", "water.table=[[0, 0.3]]"],
         "drained, table rises through the ground": ["phases=drained", "water.table=[[0, 0.3]]", "water.level=t"],
         "saturated": ["phases=saturated", *WET], "unsaturated": ["phases=unsaturated", *WET, *CURVES]}


def last_of(folder):
    with h5py.File(folder / "run.h5") as file:
        last = max(file["snapshots"].values(), key=lambda snapshot: snapshot.attrs["step"])
        order = np.argsort(last["id"][:, 0])
        return {name: last[name][...][order] for name in ("stress", "velocity")}


def main(talus):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "section.csv").write_text(SECTION)
        for case, overrides in CASES.items():
            for duration in (0.03, 0.3, 1.0):
                fall = f'[[stage]]\nname = "fall"\nduration = {duration}\n'
                for text, results in ((SCENE + SETTLE + fall, "whole"), (SCENE + SETTLE, "source"), (SCENE + fall + START, "started")):
                    (folder / "scene.toml").write_text(text)
                    words = [talus, "run", "scene.toml", "-o", results, "--no-pictures", "--force"]
                    subprocess.run(words + [word for one in overrides for word in ("--set", one)], cwd=folder, check=True, capture_output=True)
                whole, started = last_of(folder / "whole"), last_of(folder / "started")
                shares = {field: np.abs(whole[field] - started[field]).max() / np.abs(whole[field]).max() for field in whole}
                print(f"{case:42s} {duration:5g} s  " + "  ".join(f"{field} {share:.1e}" for field, share in shares.items()), flush=True)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve())
