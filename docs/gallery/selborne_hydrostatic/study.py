#!/usr/bin/python3
"""Studies of the Selborne scene: triangles against a one-element slice on three meshes, load at failure against brittleness and initial
stress, and the quasi-static limit without softening.

    study.py TALUS [pictures|meshes|brittleness|particles|excavation|limit|figure ...]

TALUS is the program (build/release/bin/talus). `pictures` runs the scene itself; each study writes a CSV beside this file; `figure` draws both from the CSVs.
"""
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

from talus_results import read_events  # noqa: E402

GROUND = "(x < 18 ? 15 : x < 36 ? 15 - (x - 18) / 2 : 6)"
VERTICAL = f"-(2200 - 1000) * 9.81 * ({GROUND} - y)"


def variant(size, dimension=2, k0=1.0, eta=500):
    """Text of the scene with another mesh, dimension, initial stress (k0 = None: gravity switched on) and softening (0: none)."""
    text = (HERE / "scene.toml").read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    text = re.sub(r'^size = .*$', f"size = {size}", text, flags=re.M)
    text = re.sub(r"^interval = .*$", "interval = 0", text, flags=re.M)
    zeros = '"0", "0", "0"' if dimension == 3 else '"0"'
    if k0 is None:
        text = re.sub(r"^stress = .*\n", "", text, flags=re.M)
        text = text.replace("softening = false\n", 'softening = false\ngravity_ramp = "5 s"\n')
    else:
        stress = f'stress = ["{k0} * {VERTICAL}", "{VERTICAL}", "{k0} * {VERTICAL}", {zeros}]'
        text = re.sub(r"^stress = .*$", lambda _: stress, text, flags=re.M)
    if eta:
        text = re.sub(r"^shape_factor = .*$", f"shape_factor = {eta}", text, flags=re.M)
    else:
        text = re.sub(r"^(residual|shape_factor|reference_size).*\n", "", text, flags=re.M)
    if dimension == 3:
        text = text.replace("dimension = 2", "dimension = 3")
        text = re.sub(r"^position = \[(.*)\]$", rf"position = [\1, {size / 2}]", text, flags=re.M)
        text = text.replace("[boundary.left]", '[boundary.sides]\ngroup = ["front", "back"]\nkind = "roller"\n[boundary.left]')
    return text


def run(talus, text, slide=True):
    """Runs a scene; returns what is asked of it."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        scene.write_text(text)
        arguments = [] if slide else ["--set", "stage.slide.duration=0.01"]
        done = subprocess.run([talus, "run", scene, "-o", f"{folder}/run", "--no-pictures", "--force", *arguments], capture_output=True, text=True)
        failure = read_events(f"{folder}/run", "failure")
        rows = list(csv.DictReader(open(f"{folder}/run/history.csv")))
    if done.returncode or not failure:
        return {"failure_time_s": "", "excess_kPa": "", "crest_m": "", "steps": "", "particles": rows[0]["particles"]}
    load = failure[0]["load_time_s"]
    return {"failure_time_s": failure[0]["time_s"], "excess_kPa": 2 * load, "crest_m": float(rows[-1]["crest_displacement_m"]),
            "steps": int(rows[-1]["step"]), "particles": int(float(rows[-1]["particles"]))}


def write(name, rows):
    with open(HERE / name, "w", newline="") as out:
        writer = csv.DictWriter(out, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def meshes(talus):
    import time
    rows = []
    for size in (1.0, 0.7, 0.5):
        for dimension in (2, 3):
            start = time.time()
            result = run(talus, variant(size, dimension))
            rows.append({"size_m": size, "dimension": dimension, **result, "wall_s": round(time.time() - start, 1)})
            print(rows[-1], flush=True)
            write("meshes.csv", rows)


def brittleness(talus):
    rows = []
    for k0 in (None, 0.7, 1.0, 1.5):
        for eta in (0, 25, 50, 100, 200, 500):
            rows.append({"k0": "gravity" if k0 is None else k0, "eta": eta, **run(talus, variant(0.7, 2, k0, eta), slide=False)})
            print(rows[-1], flush=True)
            write("brittleness.csv", rows)


def particles(talus):
    """Load at failure over the number of particles per cell, on the mesh of the scene, for three softenings."""
    rows = []
    for eta, counts in ((500, (3, 4, 6, 9, 10, 12, 16)), (200, (3, 12)), (100, (3, 12))):
        for count in counts:
            text = variant(0.45, eta=eta).replace("shape_factor", f"particles_per_cell = {count}\nshape_factor")
            rows.append({"eta": eta, "particles_per_cell": count, **run(talus, text, slide=False)})
            print(rows[-1], flush=True)
            write("particles.csv", rows)


def dug(k0, eta):
    """Text of excavation.toml with another k0 and softening (0: none)."""
    text = (HERE / "excavation.toml").read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    text = re.sub(r"^k0 = .*$", f"k0 = {k0}", text, flags=re.M)
    if eta:
        return re.sub(r"^shape_factor = .*$", f"shape_factor = {eta}", text, flags=re.M)
    return re.sub(r"^(residual|shape_factor|reference_size).*\n", "", text, flags=re.M)


def limit(talus):
    """Excess pressure at which the recharge, by finite elements without softening, loses its equilibrium."""
    static = 'kind = "quasi_static"\nduration = "60 s"\nload_steps = 60\n'
    rows = []
    for elements, flow in (("patches", "psi = 0"), ("patches", "psi = phi"), ("quadratic", "psi = 0")):
        for k0 in (None, 1.0, 1.5, 2.0):
            if k0 is None:
                text = re.sub(r"\[\[stage\]\].*?(?=\[output\])",
                              '[[stage]]\nname = "gravity"\nkind = "quasi_static"\nhold_loads = true\nduration = 1\n'
                              'reset_displacement = true\n[[stage]]\nname = "recharge"\n' + static, variant(0.7, 2, None, 0), flags=re.S)
            else:
                text = re.sub(r'(?<=name = "recharge"\n)duration.*\nuntil.*\nfailure_point.*\ndamping.*\n', static, dug(k0, 0))
            text = re.sub(r"\[quasi_static\]\nelements.*\n", "", text)
            text += f'\n[quasi_static]\nelements = "{elements}"\nsmallest_step = 5e-4\niterations = 40\n'
            if flow == "psi = phi":
                text = re.sub(r"^(friction_angle = )(.*)$", r"\1\2\ndilation_angle = \2", text, flags=re.M)
            with tempfile.TemporaryDirectory() as folder:
                (Path(folder) / "scene.toml").write_text(text)
                subprocess.run([talus, "solve", f"{folder}/scene.toml", "-o", f"{folder}/run", "--no-pictures", "--force"], capture_output=True)
                lost = [event["values"]["share_of_loads"] for event in read_events(f"{folder}/run", "equilibrium_lost") if event["stage"] == "recharge"]
            rows.append({"elements": elements, "flow": flow, "k0": "gravity" if k0 is None else k0, "excess_kPa": round(120 * lost[0], 1) if lost else ""})
            print(rows[-1], flush=True)
            write("limit.csv", rows)


def excavation(talus):
    """Load at failure from level ground with k0, excavated by finite elements (excavation.toml), and from gravity switched on (k0 = None)."""
    rows = []
    for k0 in (None, 1.0, 1.5, 2.0):
        for eta in (0, 50, 500):
            if k0 is None:
                result = run(talus, variant(0.7, 2, None, eta), slide=False)
            else:
                result = run(talus, dug(k0, eta))
                if result["excess_kPa"] != "":  # its first second of load time is the excavation
                    result["excess_kPa"] -= 2
            rows.append({"k0": "gravity" if k0 is None else k0, "eta": eta, **result})
            print(rows[-1], flush=True)
            write("excavation.csv", rows)


def pictures(talus):
    import shutil
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([talus, "run", HERE / "scene.toml", "-o", folder, "--force"], check=True)
        for source, name in (("plastic_strain", "slide"), ("history_displacement", "displacement"), ("history_velocity", "velocity"),
                             ("displacement_large", "run_out")):
            shutil.copy(f"{folder}/pictures/{source}.png", HERE / f"{name}.png")


def figure(_):
    import talus_style as style
    from talus_style import plt
    rows = list(csv.DictReader(open(HERE / "brittleness.csv")))
    figure, axes = plt.subplots(figsize=(7.2, 4.2), layout="constrained")
    for k0, colour in zip(("gravity", "0.7", "1.0", "1.5"), ("#404040", "#3b6fb6", "#c8553d", "#7a4fa3")):
        mine = [r for r in rows if r["k0"] == k0 and r["excess_kPa"]]
        label = "gravity switched on (K₀ = 0.49)" if k0 == "gravity" else f"K₀ = {k0}"
        axes.plot([max(float(r["eta"]), 10) for r in mine], [float(r["excess_kPa"]) for r in mine], "o-", color=colour, label=label)
    axes.axhline(63, color="0.6", lw=1, ls="--")
    axes.text(510, 64.5, "limit equilibrium, 63 kPa", ha="right", color="0.4", fontsize=9)
    axes.set(xscale="log", xlabel="shape factor η at h = 0.7 m (leftmost: no softening)", ylabel="excess pressure at failure [kPa]", ylim=(0, None))
    axes.set_xticks([10, 25, 50, 100, 200, 500], ["0", "25", "50", "100", "200", "500"])
    axes.minorticks_off()
    axes.legend(frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    style.save(figure, HERE / "brittleness.png", dpi=130)

    rows = list(csv.DictReader(open(HERE / "meshes.csv")))
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.4), layout="constrained")
    for dimension, label, marker in (("2", "triangles", "o-"), ("3", "slice of tetrahedra", "s-")):
        mine = [r for r in rows if r["dimension"] == dimension]
        size = [float(r["size_m"]) for r in mine]
        left.plot(size, [float(r["excess_kPa"]) for r in mine], marker, label=label)
        right.plot(size, [float(r["wall_s"]) for r in mine], marker, label=label)
    left.set(xlabel="cell size [m]", ylabel="excess pressure at failure [kPa]", ylim=(0, None))
    right.set(xlabel="cell size [m]", ylabel="wall time [s]", yscale="log")
    left.legend(frameon=False)
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
    style.save(figure, HERE / "meshes.png", dpi=130)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for name in sys.argv[2:] or ("pictures", "meshes", "brittleness", "figure"):
        {"pictures": pictures, "meshes": meshes, "brittleness": brittleness, "particles": particles, "excavation": excavation, "limit": limit, "figure": figure}[name](sys.argv[1])
