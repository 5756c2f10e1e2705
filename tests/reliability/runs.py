"""Small runs of every phase model, and what equal results are: shared by the commands of this folder."""
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WORK = ROOT / "build/reliability"

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

# A block of soil that settles and then slides on a rough base. `duration` of the second stage is set by each case.
SCENE = """title = "a block of soil"
gravity = 9.81
[mesh]
file = "mesh.msh"
[body.sand]
region = "sand"
porosity = 0.3
grain_density = 2650
permeability = 1e-10
law = "mohr_coulomb"
young_modulus = "1 MPa"
poisson_ratio = 0.3
cohesion = "1 kPa"
friction_angle = 25
[boundary.base]
kind = "friction"
friction_angle = 15
[boundary.left]
kind = "roller"
[boundary.right]
kind = "roller"
[boundary.surface]
kind = "roller"
[[stage]]
name = "settle"
duration = 0.03
damping = 0.5
reset_displacement = true
[[stage]]
name = "fall"
duration = 0.15
[output]
interval = 0.02
history_interval = 0.003
checkpoint_interval = 0.013
point.tip.position = [1, 0.5]
"""

# Steps are short where the soil contains water: so are its runs.
SHORT = ["stage.0.duration=0.002", "stage.1.duration=0.006", "output.interval=0.002", "output.history_interval=0.0004",
         "output.checkpoint_interval=0.0007"]
PORES = [*SHORT, "water.bulk_modulus=1e7", "water.table=[[0, 0.2], [2, 0.2]]", "body.sand.retention.curve=van_genuchten",
         "body.sand.retention.reference_suction=5e3", "body.sand.retention.shape=0.5",
         "body.sand.relative_permeability.curve=van_genuchten_mualem", "body.sand.relative_permeability.shape=0.5"]
RAIN = ["boundary.rain.kind=rainfall", "boundary.rain.group=free_surface", "boundary.rain.intensity=0.01"]
MODELS = {  # overrides of the scene
    "dry": [],
    "softening": ["body.sand.residual_cohesion=0", "body.sand.shape_factor=20"],
    "drained": ["phases=drained", "water.table=[[0, 0.3], [2, 0.1]]", "water.excess=100 * t"],
    "saturated": [*SHORT, "phases=saturated", "water.bulk_modulus=1e7"],
    "unsaturated": ["phases=unsaturated", *PORES, *RAIN],
    "three-phase": ["phases=three-phase", *PORES],
    "seepage": ["phases=drained", "water.table=[[0, 0.3], [2, 0.1]]", "stage.0={name='settle', kind='seepage', steady=true, duration=0.03}",
                "boundary.base={kind='fixed'}",
                "boundary.pond={kind='head', group='left', level=0.4}"],
}
INTEGRATORS = {"euler": [], "arkode": ["integrator.kind=arkode"]}


class Wrong(Exception):
    """Something that must not happen."""


def program(name="talus"):
    """A program of the release build, or of the folder TALUS_PROGRAMS: a copy that another build does not replace."""
    path = Path(os.environ.get("TALUS_PROGRAMS", ROOT / "build/release/bin")) / name
    if not path.exists():
        sys.exit(f"{path} is missing: build it with `cmake --build build/release`")
    return str(path)


def make_case(folder, size=0.1):
    """A folder with the scene and its mesh."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "section.csv").write_text(SECTION)
    (folder / "scene.toml").write_text(SCENE)
    subprocess.run([program(), "mesh", "section.csv", "-o", "mesh.msh", "--size", str(size)], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def on_ranks(command, ranks, environment=None, at=0):
    """The command line on that many ranks; `environment` is that of rank `at` alone."""
    special = ["env", *(f"{key}={value}" for key, value in environment.items())] if environment else []
    if ranks == 1:
        return [*special, *command]
    parts = []
    for rank in range(ranks):
        parts += [":"] if rank else []
        parts += ["-n", "1", *(special if rank == at else []), *command]
    return ["mpirun", "--allow-run-as-root", "--oversubscribe", *parts]


def run_words(results, overrides, resume):
    words = [program(), "run", "scene.toml", "-o", results, "--no-pictures"]
    for one in overrides:
        words += ["--set", one]
    return words + (["--resume"] if resume else ["--force"])


def can_resume(folder, results):
    return (folder / results / "checkpoint/header").exists()


def start(folder, results, overrides, ranks, resume, environment=None, at=0):
    log = open(folder / "output", "w")
    return subprocess.Popen(on_ranks(run_words(results, overrides, resume), ranks, environment, at), cwd=folder, stdout=log, stderr=log)


def output(folder):
    return (folder / "output").read_text(errors="replace")


def finish(folder, results, overrides, ranks, resume=None, timeout=600):
    """Runs to the end, resumed where there is a checkpoint; it must end well."""
    resume = can_resume(folder, results) if resume is None else resume
    process = start(folder, results, overrides, ranks, resume)
    status = process.wait(timeout)
    if status:
        raise Wrong(f"the run ended with status {status} when it was {'resumed' if resume else 'started'}:\n{output(folder)}")


def ranks_of(process, ranks):
    """Processes of the program itself: of mpirun its children."""
    if ranks == 1:
        return [process.pid]
    try:
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    except OSError:
        return []
    return [int(child) for child in children]


def snapshots(folder, results):
    """Every dataset and attribute of every snapshot that run.h5 names; none where there is no run.h5."""
    content = {}
    path = folder / results / "run.h5"
    if not path.exists():
        return content
    with h5py.File(path, "r") as run:
        for number, snapshot in run["snapshots"].items():
            content[number] = {name: values[...] for name, values in snapshot.items()}
            content[number].update({"attribute " + name: numpy.asarray(value) for name, value in snapshot.attrs.items()})
    return content


def readable(folder, results):
    """What a fault left behind can be read: all snapshots that run.h5 names, and all whole lines of history.csv."""
    try:
        content = snapshots(folder, results)
    except Exception as error:
        raise Wrong(f"run.h5 cannot be read: {error}") from error
    table = folder / results / "history.csv"
    if table.exists():
        lines = table.read_text().split("\n")
        for line in lines[1:-1]:
            if line.count(",") != lines[0].count(","):
                raise Wrong(f"history.csv has a damaged line: {line}")
    return len(content)


def compare(folder, one, other):
    """history.csv, pore_pressure.csv of seepage and the states in the checkpoint byte for byte, snapshots value by value. The number of a checkpoint counts those
    that were written, of which an interruption repeats or spares some: it is not compared."""
    a, b = folder / one, folder / other
    states = [{path.suffix: path.read_bytes() for path in sorted((which / "checkpoint").iterdir()) if path.name[0].isdigit()} for which in (a, b)]
    if states[0].keys() != states[1].keys():
        raise Wrong(f"the checkpoint has states of the ranks {sorted(states[1])}, not {sorted(states[0])}")
    for rank in states[0]:
        if states[0][rank] != states[1][rank]:
            raise Wrong(f"the state of rank {rank[1:]} in the checkpoint differs from that of the run without interruption")
    if (a / "history.csv").read_bytes() != (b / "history.csv").read_bytes():
        raise Wrong("history.csv differs from that of the run without interruption")
    pressures = [(which / "pore_pressure.csv").read_bytes() if (which / "pore_pressure.csv").exists() else None for which in (a, b)]
    if pressures[0] != pressures[1]:
        raise Wrong("pore_pressure.csv differs from that of the run without interruption")
    mine, whole = snapshots(folder, other), snapshots(folder, one)
    if mine.keys() != whole.keys():
        raise Wrong(f"the snapshots are {sorted(mine)}, not {sorted(whole)}")
    for number in whole:
        for name, values in whole[number].items():
            if name not in mine[number] or not numpy.array_equal(values, mine[number][name]):
                raise Wrong(f"{name} of snapshot {number} differs from that of the run without interruption")


def fault_library():
    """Compiles file_faults.c."""
    WORK.mkdir(parents=True, exist_ok=True)
    library = WORK / "file_faults.so"
    subprocess.run(["gcc", "-O1", "-Wall", "-Wextra", "-shared", "-fPIC", HERE / "file_faults.c", "-o", library, "-ldl"], check=True)
    return str(library)


def faults(library, folder, at=0, kind="EIO", log="", repeat=False):
    """Environment in which an operation on a file below `folder` fails."""
    return {"LD_PRELOAD": library, "TALUS_FAULT_FOLDER": str(folder), "TALUS_FAULT_AT": at, "TALUS_FAULT_KIND": kind, "TALUS_FAULT_LOG": log,
            "TALUS_FAULT_REPEAT": int(repeat)}


def setting():
    """Machine and version, for the page of numbers."""
    model = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    version = subprocess.run([program(), "--version"], capture_output=True, text=True, check=True).stdout.strip()
    return {"program": version, "processor": model.group(1) if model else "unknown", "cores": os.cpu_count()}
