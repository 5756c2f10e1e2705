#!/usr/bin/python3
"""What `talus compare` cannot read off one column: energy over 100 periods, angular momentum, dissipation of remaps, time per evaluation, steps by the frequency of cells and of the mesh.

    runs.py TALUS [drift|spin|dissipation|cost|bound|laws|brittle|stability|figure ...]

Each study writes NAME.csv beside this file, `figure` draws drift.png, orders.png and stability.png. TALUS is build/release/bin/talus; `stability` runs stability_test
beside it.
"""
import csv
import json
import os
import resource
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(ROOT / "src/output/plots"))

from talus_results import read_events  # noqa: E402

RUNS = ROOT / "results/integrators/runs"
VERIFICATION = ROOT / "tests/verification"
KINDS = {"euler": [], **{f"arkode {k}": ["integrator.kind=arkode", f"integrator.order={k}"] for k in (2, 3, 4, 5)},
         "petsc rk8": ["integrator.kind=petsc", "integrator.method=rk8"]}
FROZEN = ["transfer.remap_interval=0.3", "transfer.relaxation=0", "transfer.locking=none"]


def run(talus, scene, name, overrides):
    """Rows of history.csv (None if the run failed), processor seconds, evaluations of the forces."""
    folder = RUNS / name.replace(" ", "_")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(talus), "run", str(scene), "-o", str(folder), "--no-pictures", "--force", *(["--set", *overrides] if overrides else [])], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if not (folder / "history.csv").exists():
        raise SystemExit(done.stderr)
    rows = [{k: float(v) for k, v in r.items() if k != "stage"} for r in csv.DictReader(open(folder / "history.csv"))]
    counts = read_events(folder, "steps")
    return None if done.returncode else rows, after.ru_utime - before.ru_utime, int(counts[-1]["values"]["evaluations"]) if counts else 0


def write(name, rows):
    with open(HERE / f"{name}.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def read(name):
    return list(csv.DictReader(open(HERE / f"{name}.csv")))


def drift(talus):
    """Energy of the elastic bar over 100 periods of 0.4 s."""
    rows = []
    for how, transfer in (("cells frozen", FROZEN), ("default transfer", [])):
        for kind, overrides in KINDS.items():
            history, _, _ = run(talus, VERIFICATION / "elastic_bar/scene.toml", f"drift {how} {kind}",
                                ["mesh.size=0.05", "stage.0.duration=40", "output.history_interval=0.1", *transfer, *overrides])
            if history is None:
                print(how, kind, "failed")
                continue
            start = history[0]["kinetic_J"] + history[0]["strain_J"]
            rows += [{"transfer": how, "integrator": kind, "time_s": r["time_s"], "energy": (r["kinetic_J"] + r["strain_J"]) / start} for r in history]
            print(how, kind, rows[-1]["energy"], flush=True)
    write("drift", rows)


def momentum(folder):
    """Angular momentum about the centre of mass at the start and at the end."""
    import h5py
    spins = []
    with h5py.File(folder / "run.h5") as file:
        names = sorted(file["snapshots"])
        for name in (names[0], names[-1]):
            s = file["snapshots"][name]
            m, x, v = s["mass"][:, 0], s["position"][...], s["velocity"][...]
            x = x - (m[:, None] * x).sum(0) / m.sum()
            spins.append(float((m * (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])).sum()))
    return spins[1] / spins[0]


def spin(talus):
    """Angular momentum of the spinning block after two turns over the initial."""
    rows = []
    transfers = {"default": [], "flip": ["transfer.relaxation=0"], "pic": ["transfer.velocity=pic"]}
    for how, transfer in transfers.items():
        for kind, overrides in KINDS.items():
            name = f"spin {how} {kind}"
            history, _, _ = run(talus, VERIFICATION / "spinning_block/scene.toml", name, [*transfer, *overrides])
            rows.append({"transfer": how, "integrator": kind, "angular_momentum": "" if history is None else momentum(RUNS / name.replace(" ", "_"))})
            print(rows[-1], flush=True)
    write("spin", rows)


def dissipation(talus):
    """Energy of the elastic bar after ten periods against how often it is remapped, and the time that takes."""
    rows = []
    for relaxation in ("default", "0"):
        for interval in (0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3):
            history, seconds, _ = run(talus, VERIFICATION / "elastic_bar/scene.toml", "dissipation",
                                      [f"transfer.remap_interval={interval}", *([] if relaxation == "default" else ["transfer.relaxation=0"])])
            energy = [r["kinetic_J"] + r["strain_J"] for r in history if r["time_s"] <= 4.0001]
            rows.append({"relaxation": relaxation, "interval": interval, "energy_after_ten_periods": round(energy[-1] / energy[0], 5), "processor_s": round(seconds, 2)})
            print(rows[-1], flush=True)
    write("dissipation", rows)


def cost(talus):
    """Processor time per evaluation of the forces, arkode over euler, less what a run of no time takes; in turns, five times, and the least of each counts."""
    rows = []
    scenes = {"column": (HERE.parent / "column/scene.toml", ["stage.0.duration=0.3"], ["stage.0.duration=1e-6"]),
              "Selborne": (HERE.parent / "selborne_hydrostatic/scene.toml", ["mesh.size=0.9", "stage.recharge.duration=2", "stage.slide.duration=0"],
                           ["mesh.size=0.9", "stage.gravity.duration=1e-6", "stage.recharge.duration=1e-6", "stage.slide.duration=0"])}
    for scene, (path, overrides, nothing) in scenes.items():
        least, count = {}, {}
        for turn in range(5):
            for kind in ("start", "euler", "arkode 2", "arkode 3", "arkode 4", "arkode 5"):
                _, seconds, count[kind] = run(talus, path, "cost", ["output.interval=0", *(nothing if kind == "start" else overrides), *KINDS.get(kind, [])])
                least[kind] = min(least.get(kind, 1e9), seconds)
        best = {kind: (seconds - least["start"]) / count[kind] for kind, seconds in least.items() if kind != "start"}
        rows += [{"scene": scene, "integrator": kind, "us_per_evaluation": round(1e6 * value, 1), "over_euler": round(value / best["euler"], 3)} for kind, value in best.items()]
        print(*rows[-5:], sep="\n", flush=True)
        write("cost", rows)


def bound(talus):
    """Steps by the fastest cell and by the frequency of the whole filled mesh: how many, how long they take, and what comes out."""
    from slides import COLUMN3D
    scenes = {"column 2D": ("column", "corner_x_m", ["mesh.size=0.01"]), "column 3D": ("column", "corner_x_m", ["mesh.size=0.02", "mesh.layers=0", "mesh.thickness=0.06", *COLUMN3D]),
              "Selborne 2D": ("selborne_hydrostatic", "crest_displacement_m", ["mesh.size=0.9"]), "bowl": ("bowl", "crest_displacement_m", [])}
    rows = []
    for scene, (folder, column, overrides) in scenes.items():
        for of in ("cells", "mesh"):
            for fraction in (0.3, 0.4, 0.6, 0.8):
                name = f"bound {scene} {of} {fraction}"
                history, seconds, count = run(talus, HERE.parent / folder / "scene.toml", name, ["output.interval=0", f"integrator.omega_max={of}", f"integrator.fraction={fraction}", *overrides])
                failure = read_events(RUNS / name.replace(" ", "_"), "failure")
                end = history[-1]["time_s"] if history else 0
                rows.append({"scene": scene, "omega_max": of, "fraction": fraction, "steps": count, "mean_step_ms": round(1e3 * end / count, 4), "processor_s": round(seconds, 2),
                             "failure_load_time_s": round(failure[0]["load_time_s"], 3) if failure else "", "front_or_crest_m": round(history[-1][column], 4) if history else "failed"})
                print(rows[-1], flush=True)
                write("bound", rows)


LAWS = {"mohr_coulomb": "cohesion = 0\nfriction_angle = 19.8", "mohr_coulomb, softening": "cohesion = 300\nfriction_angle = 25\nresidual_cohesion = 30\nresidual_friction_angle = 15\nshape_factor = 25",
        "drucker_prager": "cohesion = 0\nfriction_angle = 19.8", "mu_i": "static_friction = 0.36\nlimiting_friction = 0.6\ngrain_size = 0.002", "newtonian": "viscosity = 1",
        "bingham": "viscosity = 1\nyield_stress = 100", "linear_elastic": ""}


def laws(talus):
    """The column in free tetrahedra with seven laws by both bounds, with remaps seldom and in every step."""
    from slides import COLUMN3D
    scene = (HERE.parent / "column/scene.toml").read_text()
    body = scene[scene.index('law = "mohr_coulomb"'):scene.index("stress =")]
    rows = []
    for law, keys in LAWS.items():
        # beside the scene, since its mesh is named relative to it
        file = HERE.parent / "column/.laws.toml"
        file.write_text(scene.replace(body, f'law = "{law.split(",")[0]}"\nyoung_modulus = "0.84 MPa"\npoisson_ratio = 0.3\n{keys}\n'))
        try:
            for interval in (0.1, 0):
                for of, fraction in (("cells", 0.6), ("mesh", 0.6), ("mesh", 0.8)):
                    name = f"laws {law} {interval} {of} {fraction}".replace(",", "")
                    _, seconds, count = run(talus, file, name, ["output.interval=0", "stage.0.duration=0.2", f"transfer.remap_interval={interval}", f"integrator.omega_max={of}", f"integrator.fraction={fraction}",
                                                                "mesh.size=0.02", "mesh.layers=0", "mesh.thickness=0.06", *COLUMN3D])
                    end = list(csv.DictReader(open(RUNS / name.replace(" ", "_") / "history.csv")))[-1]
                    rows.append({"law": law, "remap_interval": interval, "omega_max": of, "fraction": fraction, "steps": count, "processor_s": round(seconds, 2), "front_m": round(float(end["corner_x_m"]), 4),
                                 "kinetic_J": round(float(end["kinetic_J"]), 5)})
                    print(rows[-1], flush=True)
                    write("laws", rows)
        finally:
            file.unlink()


CUT_SECTION = """part,x,y
outline,0,0
outline,16,0
outline,16,6.5
outline,0,6.5
interface0,0,5
interface0,6,5
interface0,6,0
region_soil,3,2.5
region_air,12,3
"""
CUT = """title = "{what} in softening soil, whose weight grows"
dimension = 3
gravity = 9.81
[mesh]
section = "section.csv"
size = 0.6
layers = 0
{mesh}
[body.soil]
region = "{region}"
density = 2000
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = "40 kPa"
friction_angle = 20
residual_cohesion = "5 kPa"
residual_friction_angle = 15
shape_factor = {shape}
reference_size = 0.6
stress = ["-9810 * (5 - y)", "-19620 * (5 - y)", "-9810 * (5 - y)", "0", "0", "0"]
body_acceleration = ["0", "-0.3 * t", "0"]
[boundary.base]
kind = "fixed"
[boundary.sides]
group = ["left", "right", "front", "back"]
kind = "roller"
[[stage]]
name = "gravity"
duration = 20
until = "equilibrium"
damping = 0.7
softening = false
hold_loads = true
reset_displacement = true
[[stage]]
name = "loading"
duration = 40
until = "failure"
failure_point = "crest"
damping = 0.05
[[stage]]
name = "slide"
duration = 3
hold_loads = true
[output]
interval = 0
history_interval = 0.05
point.crest.position = [6, 5, {middle}]
point.toe.position = [6, 0.3, {middle}]
"""


def brittle(talus):
    """Vertical cuts 5 m high, straight and around a corner, whose weight grows until they fail: load and run-out by both bounds, for soil that softens faster and faster."""
    rows = []
    kinds = {"cut": {"what": "Vertical cut", "mesh": "thickness = 6", "region": "soil", "middle": 3},
             "corner": {"what": "Corner of two vertical cuts", "mesh": "thickness = 12\ncuts = [6]", "region": "soil_1", "middle": 6}}
    for kind, keys in kinds.items():
        for shape in (50, 100, 300):
            file = RUNS / "brittle.toml"
            (RUNS / "section.csv").write_text(CUT_SECTION)
            file.write_text(CUT.format(**keys, shape=shape))
            checked = json.loads(subprocess.run([talus, "check", file, "--json"], check=True, capture_output=True, text=True).stdout)
            length = float(f"{max(body['critical_slip_length_m'] for body in checked['bodies']):.3g}")
            for of, fraction in (("cells", 0.6), ("mesh", 0.3), ("mesh", 0.6)):
                name = f"brittle {kind} {shape} {of} {fraction}"
                history, _, count = run(talus, file, name, [f"integrator.omega_max={of}", f"integrator.fraction={fraction}"])
                [failed] = read_events(RUNS / name.replace(" ", "_"), "failure")
                failure = failed["load_time_s"]
                rows.append({"scene": kind, "shape_factor": shape, "critical_length_m": length, "omega_max": of, "fraction": fraction, "steps": count, "failure_load_time_s": round(failure, 3),
                             "failure_load_g": round(1 + 0.3 * failure / 9.81, 4), "crest_m": round(history[-1]["crest_displacement_m"], 3), "toe_m": round(history[-1]["toe_displacement_m"], 3)})
                print(rows[-1], flush=True)
                write("brittle", rows)


def stability(talus):
    test = Path(talus).parent / "stability_test"
    subprocess.run([next(p for p in (test, *ROOT.glob("build/*/tests/**/stability_test"), *ROOT.glob("build/*/bin/stability_test")) if p.exists())], check=True,
                   env={**os.environ, "TALUS_STABILITY_CSV": str(HERE / "stability.csv")})


def figure(_):
    from talus_style import LINES, np, plt, save
    if (HERE / "stability.csv").exists():
        rows = read("stability")
        kinds = list(dict.fromkeys(r["integrator"] for r in rows))
        picture, all_axes = plt.subplots(2, 3, figsize=(10.6, 5), sharex=True, sharey=True, layout="constrained")
        for axes, kind in zip(all_axes.flat, kinds):
            for k, share in enumerate(dict.fromkeys(r["share"] for r in rows)):
                of = [r for r in rows if r["integrator"] == kind and r["share"] == share]
                axes.plot([int(r["step"]) for r in of], [float(r["energy"]) for r in of], color=LINES[k % len(LINES)], linewidth=1, label=share)
            axes.set(title=kind, yscale="log", ylim=(1e-6, 1e3))
        all_axes[0, 0].legend(title="step over the limit", fontsize=6, ncols=2)
        all_axes[1, 2].axis("off")
        for axes in all_axes[:, 0]:
            axes.set_ylabel("energy over the initial")
        for axes in all_axes[-1]:
            axes.set_xlabel("step")
        save(picture, HERE / "stability.png")
    if (HERE / "drift.csv").exists():
        rows = read("drift")
        picture, all_axes = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
        for axes, how in zip(all_axes, dict.fromkeys(r["transfer"] for r in rows)):
            for k, kind in enumerate(KINDS):
                of = [r for r in rows if r["transfer"] == how and r["integrator"] == kind]
                energy = np.array([float(r["energy"]) for r in of])[:400].reshape(100, 4).mean(1)
                axes.plot(np.arange(100) + 0.5, energy, color=LINES[k % len(LINES)], linewidth=1, label=kind)
            axes.set(title=how, xlabel="periods", ylabel="energy over the initial, mean of a period")
        all_axes[0].legend()
        save(picture, HERE / "drift.png")
    studies = {"frozen": "elastic, cells frozen", "plastic": "plastic, cells frozen", "crossing": "elastic, a remap in every step"}
    if all((HERE / f"{name}.csv").exists() for name in studies):
        picture, all_axes = plt.subplots(1, 3, figsize=(10.6, 3.4), sharey=True, layout="constrained")
        for axes, (name, title) in zip(all_axes, studies.items()):
            rows = [r for r in read(name) if not r["failure"] and r["series"] != "forward-euler" and 0 < float(r["error"]) < 0.1]
            for k, kind in enumerate(dict.fromkeys(r["series"] for r in rows)):
                of = [r for r in rows if r["series"] == kind]
                axes.plot([1e6 * float(r["value"]) for r in of], [float(r["error"]) for r in of], "o-", color=LINES[k % len(LINES)], markersize=4, linewidth=1, label=kind)
            axes.set(title=title, xscale="log", yscale="log", xlabel="step [µs]")
            axes.set_xticks([60, 120, 240, 480], [60, 120, 240, 480])
            axes.set_xticks([], minor=True)
        all_axes[0].set_ylabel("error of the place of the end [m]")
        all_axes[2].legend(*all_axes[0].get_legend_handles_labels())
        save(picture, HERE / "orders.png")


if __name__ == "__main__":
    RUNS.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[2:] or ["drift", "spin", "dissipation", "cost", "bound", "laws", "brittle", "stability", "figure"]:
        globals()[name](sys.argv[1])
