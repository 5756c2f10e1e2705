#!/usr/bin/python3
"""Studies of the cures: what crossing of cells, locking and noise do with each cure off and on.

    study.py TALUS [crossing|locking|noise|figure ...]

TALUS is the program (build/release/bin/talus). Each study writes its CSVs beside this file; `figure` draws all pictures from the CSVs.
"""
import csv
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

from talus_results import Results  # noqa: E402

SLICE = ["dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller"]


class Run:
    """A scene, run with overrides: its history by column, its snapshots, seconds that it took; `broke` says why it ended early, if it did."""

    def __init__(self, talus, scene, overrides):
        with tempfile.TemporaryDirectory() as folder:
            start = time.time()
            done = subprocess.run([talus, "run", HERE / scene, "-o", folder, "--no-pictures", "--force", "--set", *overrides], capture_output=True, text=True)
            self.wall = time.time() - start
            self.broke = next((line.split("; ")[0] for line in done.stderr.splitlines() if line.startswith("talus:")), "stopped") if done.returncode else ""
            rows = list(csv.DictReader(open(f"{folder}/history.csv"))) if Path(f"{folder}/history.csv").exists() else []
            self.history = {name: np.array([float(row[name] or "nan") for row in rows]) for name in (rows[0] if rows else ()) if name != "stage"}
            self.steps = int(self.history["step"][-1]) if rows else 0
            self.snapshots = []
            if Path(f"{folder}/run.h5").exists() and not self.broke:
                results = Results(folder)
                self.nodes, self.cells = results.mesh()
                self.snapshots = [{name: s.column(name).values for name in ("mass", "displacement", "stress", "velocity")} | {"position": s.position()}
                                  for s in results.snapshots]

    def cell_of(self, points):
        """The cell of the mesh that holds each point."""
        from scipy.spatial import cKDTree
        corners = self.nodes[self.cells]
        tree = cKDTree(corners.mean(axis=1))
        frame = np.linalg.inv(np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2))
        near = tree.query(points, k=min(40, len(self.cells)))[1]
        inside = np.einsum("pkij,pkj->pki", frame[near], points[:, None] - corners[near][:, :, 0])
        least = np.minimum(inside.min(axis=2), 1 - inside.sum(axis=2))
        return near[np.arange(len(points)), least.argmax(axis=1)]


def write(name, rows):
    with open(HERE / name, "w", newline="") as out:
        writer = csv.DictWriter(out, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def read(name):
    return list(csv.DictReader(open(HERE / name)))


# Locking ------------------------------------------------------------------------------------------------------------------

CURES = ("none", "nodal", "patches")
BODIES = {"triangles": (0.2, 0.1, 0.05, 0.025), "slice": (0.2, 0.1, 0.05), "tetrahedra": (0.2, 0.1)}
COHESION, STIFFNESS, LIMIT = 10e3, 40e6, 2 + np.pi


def footing(talus, body, size, cure):
    """Runs the footing; returns settlement E s / (c_u b), load Q / (c_u b) and the run."""
    boxes = [((0.5, 3.4), (1.5, 4), size)]
    if size < 0.05:  # fine at the edge only, and 0.1 m in all of the mechanism
        boxes = [((0, 2.8), (3.2, 4), 0.1), ((0.8, 3.8), (1.2, 4), size)]
    thickness = {"triangles": 1, "slice": size, "tetrahedra": 0.4}[body]
    depth = ("", "") if body == "triangles" else (", 0", ", 1")
    refine = ", ".join(f"{{from = [{a[0]}, {a[1]}{depth[0]}], to = [{b[0]}, {b[1]}{depth[1]}], size = {h}}}" for a, b, h in boxes)
    overrides = [f"transfer.locking={cure}", f"mesh.refine=[{refine}]"]
    if body != "triangles":
        overrides += SLICE + ['boundary.footing.velocity=["0", "-0.015 * min(1, t / 0.1)", "0"]',
                              f"mesh.thickness={thickness}", f"mesh.layers={1 if body == 'slice' else 0}"]
    run = Run(talus, "footing.toml", overrides)
    t = run.history["time_s"]
    settlement = 0.015 * np.where(t < 0.1, t * t / 0.2, t - 0.05)
    return settlement * STIFFNESS / COHESION, -run.history["footing_force_y_N"] / (COHESION * thickness), run


def pressures(run):
    """Pressure of each filled cell over c_u, and its roughness: root mean square of the jump from cell to cell near the footing."""
    end = run.snapshots[-1]
    cell = run.cell_of(end["position"] - end["displacement"])
    count = np.bincount(cell, minlength=len(run.cells))
    pressure = -np.bincount(cell, weights=end["stress"][:, :3].mean(axis=1), minlength=len(run.cells)) / np.maximum(count, 1) / COHESION
    faces = {}
    jumps = []
    for c, nodes in enumerate(run.cells):
        centre = run.nodes[nodes].mean(axis=0)
        if centre[0] > 2 or centre[1] < 3:
            continue
        for k in range(len(nodes)):
            other = faces.setdefault(tuple(sorted(np.delete(nodes, k))), c)
            if other != c:
                jumps.append(pressure[c] - pressure[other])
    return pressure, float(np.sqrt(np.mean(np.square(jumps))))


def locking(talus):
    rows, curves, fields = [], [], []
    for body, sizes in BODIES.items():
        for size in sizes:
            for cure in CURES:
                settlement, load, run = footing(talus, body, size, cure)
                if run.broke:
                    rows.append({"body": body, "size_m": size, "cure": cure, "broke": run.broke})
                    continue
                pressure, rough = pressures(run)
                last = slice(-len(load) // 10, None)
                rows.append({"body": body, "size_m": size, "cure": cure, "N_c": round(load[last].mean(), 3),
                             "error_percent": round(100 * (load[last].mean() / LIMIT - 1), 1),
                             "roughness": round(rough, 2), "steps": run.steps, "wall_s": round(run.wall, 1)})
                print(rows[-1], flush=True)
                write("locking.csv", rows)
                if size == 0.1:
                    curves += [{"body": body, "cure": cure, "settlement": round(s, 4), "load": round(q, 4)} for s, q in zip(settlement[::2], load[::2])]
                    write("locking_curves.csv", curves)
                if size == 0.1 and body == "triangles" and cure != "nodal":
                    for nodes, p in zip(run.cells, pressure):
                        place = run.nodes[nodes]
                        if place[:, 0].min() < 2.5 and place[:, 1].max() > 2.5:
                            fields.append({"cure": cure, **{f"{axis}{k}": round(float(place[k, d]), 4) for k in range(3) for d, axis in enumerate("xy")}, "pressure": round(p, 3)})
                    write("locking_pressure.csv", fields)


def draw_locking(plt, style):
    import matplotlib.tri as mtri
    curves, fields = read("locking_curves.csv"), read("locking_pressure.csv")
    figure = plt.figure(figsize=(8.6, 6.0), layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=(1.05, 1))
    colours = {"none": style.LINES[1], "nodal": style.SOFT, "patches": style.ACCENT}
    names = {"triangles": "triangles", "slice": "slice one element thick", "tetrahedra": "tetrahedra"}
    for axes, body in zip(above.subplots(1, 3, sharey=True), BODIES):
        axes.axhline(LIMIT, color=style.INK, lw=0.8, ls=(0, (4, 2)))
        for cure in CURES:
            mine = [r for r in curves if (r["body"], r["cure"]) == (body, cure)]
            axes.plot([float(r["settlement"]) for r in mine], [float(r["load"]) for r in mine], color=colours[cure],
                      lw=1.6, ls=(0, (3, 1.5)) if cure == "nodal" else "-", zorder=3 if cure == "nodal" else 2)
        axes.set(title=names[body], xlabel="settlement  E s / (c$_u$ b)", xlim=(0, 30), ylim=(0, 9))
        if body == "triangles":
            axes.set_ylabel("load  Q / (c$_u$ b)")
            axes.text(29.5, LIMIT - 0.15, "2 + π", ha="right", va="top", size=8)
            axes.text(17, 7.25, "no cure", color=colours["none"], ha="right", va="bottom", size=8.5)
            axes.annotate("nodal (dashed), patches", (25, 5.55), (29.5, 3.2), ha="right", color=colours["patches"], size=8.5,
                          arrowprops={"arrowstyle": "-", "color": style.FAINT})
    panels = below.subplots(1, 2, sharey=True)
    for axes, cure, title in zip(panels, ("none", "patches"), ("no cure", "patches of two triangles")):
        mine = [r for r in fields if r["cure"] == cure]
        x = np.array([[float(r[f"x{k}"]) for k in range(3)] for r in mine]).ravel()
        y = np.array([[float(r[f"y{k}"]) for k in range(3)] for r in mine]).ravel()
        drawn = axes.tripcolor(mtri.Triangulation(x, y, np.arange(len(x)).reshape(-1, 3)), facecolors=np.array([float(r["pressure"]) for r in mine]),
                               cmap="RdBu_r", vmin=-8, vmax=8, edgecolors="none")
        axes.plot([0, 1], [4.03, 4.03], color=style.INK, lw=4, solid_capstyle="butt", clip_on=False)
        axes.set(xlim=(0, 2.2), ylim=(2.9, 4), aspect="equal", xlabel="x / b")
        axes.set_title("pressure / c$_u$, triangles, " + title, pad=10)
        axes.set_yticks([3, 3.5, 4], ["1", "0.5", "0"])
    panels[0].set_ylabel("depth / b")
    below.colorbar(drawn, ax=panels, shrink=0.8, extend="both")
    style.save(figure, HERE / "locking.png")


# Crossing -----------------------------------------------------------------------------------------------------------------

INTEGRATION = ("particle", "mixed", "cell", "blended")
WEIGHT, HEIGHT, MODULUS = 2000 * 10, 1.0, 100e3 * 0.8 / (1.2 * 0.6)  # rho g [N/m3], [m], E_c [Pa]


def settled(at, stiff=1):
    """Exact displacement of the point that was at this height."""
    scale = stiff * MODULUS / WEIGHT
    return scale * (np.exp(-(HEIGHT - at) / scale) - np.exp(-HEIGHT / scale)) - at


def column(talus, dimension, integration, average, particles, stiff=1):
    """Errors of stress in per cent of the base stress and of displacement in per cent of the settlement, places and stresses."""
    run = Run(talus, "column.toml", [f"transfer.integration={integration}", f"transfer.average_stress={str(average).lower()}",
                                     f"body.soil.particles_per_cell={particles}", f"body.soil.young_modulus={stiff * 100e3}",
                                     *(SLICE if dimension == 3 else [])])
    if run.broke:
        return {"broke": run.broke}, [], []
    end = run.snapshots[-1]
    share = end["mass"][:, 0] / end["mass"].sum()
    start, stress = end["position"][:, 1] - end["displacement"][:, 1], end["stress"][:, 1]
    error = {"stress_percent": round(100 * np.sqrt(share @ (stress / WEIGHT / HEIGHT + 1 - start / HEIGHT) ** 2), 2),
             "displacement_percent": round(100 * np.sqrt(share @ (end["displacement"][:, 1] - settled(start, stiff)) ** 2) / -settled(HEIGHT, stiff), 3),
             "speed_mm_s": round(1e3 * np.sqrt(share @ (end["velocity"] ** 2).sum(axis=1)), 3), "steps": run.steps, "wall_s": round(run.wall, 1), "broke": ""}
    return error, start, stress


def crossing(talus):
    rows, profiles = [], []
    cases = [(d, "blended", a, n, 100) for d, n in ((2, 3), (3, 8)) for a in (False, True)]  # so stiff that nothing crosses
    cases += [(2, i, a, n, 1) for n in (1, 3, 6, 12) for a in (False, True) for i in INTEGRATION]
    cases += [(3, i, a, n, 1) for n in (4, 8) for i, a in (("particle", False), ("blended", False), ("blended", True))]
    for dimension, integration, average, particles, stiff in cases:
        error, start, stress = column(talus, dimension, integration, average, particles, stiff)
        rows.append({"E_kPa": 100 * stiff, "dimension": dimension, "integration": integration, "average_stress": average, "particles_per_cell": particles,
                     **dict.fromkeys(("stress_percent", "displacement_percent", "speed_mm_s", "steps", "wall_s"), ""), **error})
        print(rows[-1], flush=True)
        write("crossing.csv", rows)
        if (dimension, particles, stiff) == (2, 3, 1) and (integration, average) in (("particle", False), ("blended", True)):
            profiles += [{"integration": integration, "height_m": round(y, 4), "stress_kPa": round(s / 1e3, 3)} for y, s in zip(start, stress)]
            write("crossing_profile.csv", profiles)


def draw_crossing(plt, style):
    rows, profile = read("crossing.csv"), read("crossing_profile.csv")
    figure, panels = plt.subplots(1, 3, figsize=(8.6, 3.5), layout="constrained", gridspec_kw={"width_ratios": (1, 1, 1.35)})
    for axes, integration, title, colour in zip(panels, ("particle", "blended"), ("particle volumes", "blended, averaged (default)"), (style.LINES[1], style.ACCENT)):
        mine = [r for r in profile if r["integration"] == integration]
        axes.plot([-float(r["stress_kPa"]) for r in mine], [float(r["height_m"]) for r in mine], ".", color=colour, ms=3, mec="none", alpha=0.7)
        axes.plot([WEIGHT / 1e3, 0], [0, 1], color=style.INK, lw=0.9)
        axes.set(title=title, xlabel="vertical stress [kPa]", xlim=(-1, 30), ylim=(0, 1.02))
    panels[0].set_ylabel("height before settlement [m]")
    panels[0].annotate("exact", (17, 0.15), (25, 0.42), size=8, arrowprops={"arrowstyle": "-", "color": style.SOFT, "lw": 0.7})
    axes = panels[2]
    names = {"particle": "particle", "mixed": "mixed", "cell": "cell", "blended": "blended"}
    for integration, colour, marker in zip(INTEGRATION, (style.LINES[1], style.LINES[5], style.LINES[2], style.ACCENT), "osD^"):
        for average in ("False", "True"):
            mine = [r for r in rows if (r["dimension"], r["integration"], r["average_stress"]) == ("2", integration, average) and r["E_kPa"] == "100"]
            axes.plot([int(r["particles_per_cell"]) for r in mine], [float(r["stress_percent"]) for r in mine], marker + ("-" if average == "True" else ":"), color=colour,
                      ms=4, lw=1.4, mfc=colour if average == "True" else "white", label=names[integration] if average == "True" else None)
    axes.set(xscale="log", yscale="log", ylim=(0.4, 40), xlabel="particles per triangle", title="error of stress [% of 20 kPa]")
    axes.set_xticks([1, 3, 6, 12], ["1", "3", "6", "12"])
    axes.set_yticks([0.5, 1, 2, 5, 10, 20], ["0.5", "1", "2", "5", "10", "20"])
    axes.minorticks_off()
    axes.plot([], [], ":", color=style.SOFT, label="not averaged")
    axes.legend(fontsize=8, loc="upper right", handlelength=2.2, ncol=2)
    style.save(figure, HERE / "crossing.png")


# Noise --------------------------------------------------------------------------------------------------------------------

TRANSFERS = {"particle volumes": ["transfer.integration=particle", "transfer.average_stress=false", "transfer.relaxation=0"],
             "stress not averaged": ["transfer.average_stress=false", "transfer.relaxation=0"],
             "relaxation 0": ["transfer.relaxation=0"], "relaxation 400": [],
             "PIC share 0.01": ["transfer.relaxation=0", "transfer.pic_fraction=0.01"]}
SPEED, PERIOD = 0.1, 0.4


def roughness(snapshot):
    """Root mean square of what the particle velocities hold beside the first four modes of the bar, over its first speed."""
    x, velocity, mass = snapshot["position"][:, 0] - snapshot["displacement"][:, 0], snapshot["velocity"], snapshot["mass"][:, 0]
    modes = np.stack([np.sin((k + 0.5) * np.pi * x) for k in range(4)], axis=1)
    weight = np.sqrt(mass / mass.sum())
    rest = velocity.copy()
    rest[:, 0] -= modes @ np.linalg.lstsq(modes * weight[:, None], velocity[:, 0] * weight, rcond=None)[0]
    return np.sqrt(((rest * weight[:, None]) ** 2).sum()) / SPEED


def noise(talus):
    rows, curves = [], []
    for interval in (0, 0.1):
        for name, overrides in TRANSFERS.items():
            run = Run(talus, "bar.toml", [*overrides, f"transfer.remap_interval={interval}"])
            energy = (run.history["kinetic_J"] + run.history["strain_J"]) / run.history["kinetic_J"][0]
            periods = run.history["time_s"] / PERIOD
            row = {"transfer": name, "remap_interval": interval, "periods": round(periods[-1], 2), "energy": round(energy[-1], 4), "roughness": "",
                   "steps": run.steps, "wall_s": round(run.wall, 1), "broke": run.broke}
            if not run.broke:
                row["roughness"] = round(np.mean([roughness(s) for s in run.snapshots[-6:]]), 4)
            rows.append(row)
            print(row, flush=True)
            write("noise.csv", rows)
            curves += [{"transfer": name, "remap_interval": interval, "periods": round(t, 4), "energy": round(e, 5)} for t, e in zip(periods[::4], energy[::4])]
            write("noise_curves.csv", curves)


def draw_noise(plt, style):
    rows, curves = read("noise.csv"), read("noise_curves.csv")
    figure, panels = plt.subplots(1, 3, figsize=(8.6, 3.4), layout="constrained", gridspec_kw={"width_ratios": (1.2, 1.2, 1)})
    colours = dict(zip(TRANSFERS, (style.LINES[1], style.SOFT, style.LINES[5], style.ACCENT, style.LINES[2])))
    for axes, interval, title in zip(panels, ("0", "0.1"), ("remap in every step", "remap interval 0.1 (default)")):
        for name, colour in colours.items():
            mine = [r for r in curves if (r["transfer"], r["remap_interval"]) == (name, interval)]
            axes.plot([float(r["periods"]) for r in mine], [float(r["energy"]) for r in mine], color=colour, lw=1.5, label=name)
        axes.set(title=title, xlabel="periods", xlim=(0, 20), ylim=(0.92, 1.16))
    panels[0].set_ylabel("energy over its initial value")
    panels[1].tick_params(labelleft=False)
    panels[1].legend(fontsize=8, loc="upper left")
    axes = panels[2]
    names = list(TRANSFERS)
    for interval, marker in (("0", "o"), ("0.1", "s")):
        for k, name in enumerate(names):
            for r in rows:
                if (r["transfer"], r["remap_interval"]) == (name, interval) and r["roughness"]:
                    axes.plot(float(r["roughness"]), -k, marker, color=colours[name], mfc="white" if interval == "0" else colours[name], ms=6)
    for marker, colour, label in (("o", "white", "every step"), ("s", style.SOFT, "interval 0.1")):
        axes.plot([], [], marker, color=style.SOFT, mfc=colour, label=label)
    axes.set(xscale="log", title="roughness of velocity / V", ylim=(-len(names) + 0.4, 0.6))
    axes.set_yticks([-k for k in range(len(names))], names)
    axes.grid(axis="x", color=style.FAINT, lw=0.5)
    axes.legend(fontsize=8, loc="lower right")
    style.save(figure, HERE / "noise.png")


def figure(_):
    import talus_style as style
    import matplotlib.pyplot as plt
    for name, draw in (("crossing", draw_crossing), ("locking", draw_locking), ("noise", draw_noise)):
        if (HERE / f"{name}.csv").exists():
            draw(plt, style)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for name in sys.argv[2:] or ("crossing", "locking", "noise", "figure"):
        globals()[name](sys.argv[1])
