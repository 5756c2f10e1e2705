#!/usr/bin/python3
"""Load at failure against brittleness, initial stress and excavation.

    study.py TALUS [pictures|brittleness|excavation|figure ...]

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


def variant(size, k0, eta):
    """Text of the scene with another mesh, initial stress (k0 = None: gravity switched on) and softening (0: none)."""
    text = (HERE / "scene.toml").read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    text = re.sub(r'^size = .*$', f"size = {size}", text, flags=re.M)
    text = re.sub(r"^interval = .*$", "interval = 0", text, flags=re.M)
    if k0 is None:
        text = re.sub(r"^stress = .*\n", "", text, flags=re.M)
        text = text.replace("softening = false\n", 'softening = false\ngravity_ramp = "5 s"\n')
    else:
        stress = f'stress = ["{k0} * {VERTICAL}", "{VERTICAL}", "{k0} * {VERTICAL}", "0"]'
        text = re.sub(r"^stress = .*$", lambda _: stress, text, flags=re.M)
    if eta:
        text = re.sub(r"^shape_factor = .*$", f"shape_factor = {eta}", text, flags=re.M)
    else:
        text = re.sub(r"^(residual|shape_factor|reference_size).*\n", "", text, flags=re.M)
    return text


def run(talus, text):
    """Runs a scene until it fails; returns what is asked of it."""
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder) / "scene.toml"
        scene.write_text(text)
        done = subprocess.run([talus, "run", scene, "-o", f"{folder}/run", "--no-pictures", "--force", "--set", "stage.slide.duration=0.01"],
                              capture_output=True, text=True)
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


def brittleness(talus):
    rows = []
    for k0 in (None, 0.7, 1.0, 1.5):
        for eta in (0, 25, 50, 100, 200, 500):
            rows.append({"k0": "gravity" if k0 is None else k0, "eta": eta, **run(talus, variant(0.7, k0, eta))})
            print(rows[-1], flush=True)
            write("brittleness.csv", rows)


def dug(k0, eta):
    """Text of excavation.toml with another k0 and softening (0: none)."""
    text = (HERE / "excavation.toml").read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    text = re.sub(r"^k0 = .*$", f"k0 = {k0}", text, flags=re.M)
    if eta:
        return re.sub(r"^shape_factor = .*$", f"shape_factor = {eta}", text, flags=re.M)
    return re.sub(r"^(residual|shape_factor|reference_size).*\n", "", text, flags=re.M)


def excavation(talus):
    """Load at failure from level ground with k0, excavated by finite elements (excavation.toml), and from gravity switched on (k0 = None)."""
    rows = []
    for k0 in (None, 1.0, 1.5, 2.0):
        for eta in (0, 50, 500):
            if k0 is None:
                result = run(talus, variant(0.7, None, eta))
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
        shutil.copy(f"{folder}/pictures/plastic_strain.png", HERE / "slide.png")


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



if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for name in sys.argv[2:] or ("pictures", "brittleness", "excavation", "figure"):
        {"pictures": pictures, "brittleness": brittleness, "excavation": excavation, "figure": figure}[name](sys.argv[1])
