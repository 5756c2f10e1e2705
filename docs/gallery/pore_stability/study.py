#!/usr/bin/python3
"""Where the scheme for pore water holds: stable, oscillating or failed, over permeability, stiffness of the water, particles per cell and saturation.

    study.py TALUS [map steps wetting storage choices]     runs all or some of them (half an hour), writes map.csv, steps.csv, wetting.csv, storage.csv and choices.csv
    study.py                                               redraws map.png, steps.png, wetting.png and choices.png from them

*map*: tests/verification/terzaghi, a saturated layer under a load whose undrained pressures are given at the start, for 400 steps at 0.6 of the critical step
without drag, whatever the drag. Noise is the rms scatter of pressure along rows of cells, over the load's pressure: the exact solution has none.
*steps*: the step at which that scene loses its stability with drag explicit and implicit, beside the one that the program computes, a formula for both limits
together, and the same for a string of elements.
*wetting*: wetting.toml, through saturation and back; *storage*: its first 0.2 s with pressure by its rate, over the length of the step.
*choices*: every smoothing of pressures with every integration, on Terzaghi's layer, on strip.toml (a strip load on undrained soil) and on ../saturated_column.
"""

import argparse
import csv
import functools
import json
import pathlib
import resource
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(ROOT / "src/output/plots"))

import matplotlib.pyplot as plt  # noqa: E402
import talus_style as style  # noqa: E402
from talus_results import Results  # noqa: E402

TERZAGHI, WETTING, STRIP = ROOT / "tests/verification/terzaghi/scene.toml", HERE / "wetting.toml", HERE / "strip.toml"
COLUMN = ROOT / "docs/gallery/saturated_column/scene.toml"
PERMEABILITY = [1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-14, 1e-17]
STIFFNESS = [20e3, 1e6, 20e6, 200e6, 2.2e9]
PARTICLES = [1, 3, 6, 16]
SHOWN = 20e6  # stiffness over which particles per cell are varied
NOISY = 0.05  # of the pressure: more is called oscillating
LOWEST, HIGHEST = 0.5, 8  # steps over the critical one that are tried
EXPLICIT = "water.drag=explicit"
SMOOTHINGS, INTEGRATIONS = ("none", "nodal"), ("blended", "particle", "mixed", "cell")
CELLS = {"layer": (0.1, 0.05, 0.025), "settled layer": (0.1, 0.05, 0.025), "strip": (0.125, 0.0625, 0.03125), "column": (0.01, 0.005)}  # sizes [m]
SETTLED = 0.03  # of the layer's height
STRIP_LOAD, COLUMN_WATER = 10e3, 981.0  # pressures that errors and noise are compared with [Pa]
POROSITY, MODULUS, LOAD, GRAINS, WATER, VISCOSITY = 0.3, 10e6, 1e3, 2650.0, 1000.0, 1e-3


def options(words):
    return [option for word in words for option in ("--set", word)]


def run(talus, scene, words, folder):
    """Results, or None when the run failed."""
    end = subprocess.run([talus, "run", scene, "-o", folder, "--no-pictures", "--force", *options(words)], capture_output=True, text=True)
    return Results(folder) if end.returncode == 0 else None


@functools.cache
def critical_step(talus, words):
    """What `check` states [s]."""
    end = subprocess.run([talus, "check", TERZAGHI, "--json", *options(words)], capture_output=True, text=True)
    return json.loads(end.stdout)["critical_step_s"]


def of_step(step):
    """Overrides for a fixed step, however long."""
    return [f"integrator.step={step!r}", "integrator.limit=1e12"]


def layer(stiffness, k, particles, smoothing):
    """Overrides of the Terzaghi scene, and the pressure of its water at the start [Pa]."""
    share = (stiffness / POROSITY) / (MODULUS + stiffness / POROSITY)  # of the load that the water bears
    return (f"transfer.pore_smoothing={smoothing}", f"water.bulk_modulus={stiffness}", "water.compression=exponential", f"body.soil.permeability={k}",
            f"body.soil.particles_per_cell={particles}", f"water.excess={LOAD * share}", f'body.soil.stress=["0", "{-LOAD * (1 - share)}", "0", "0"]',
            "mesh.size=0.075"), LOAD * share


def noise(snapshot, rows=20):
    """Scatter of the pressure along rows of cells [Pa]: the solution depends on y alone, so a parabola over y is taken off each band of rows."""
    p, y = snapshot.column("pore_pressure").values[:, 0], snapshot.position()[:, 1]
    if not np.isfinite(p).all():
        return np.inf
    band, rest = np.minimum((y * rows / y.max()).astype(int), rows - 1), []
    for k in range(rows):
        inside = band == k
        if inside.sum() > 6:
            middle = y[inside] - y[inside].mean()
            rest.append(p[inside] - np.polyval(np.polyfit(middle, p[inside], 2), middle))
    return np.sqrt((np.concatenate(rest) ** 2).mean())


# ---- drag, explicit and implicit ----


def inverse_square(stiffness, h):
    """B of the formula for a saturated string of elements of length h [1/s2]: sqrt(8 / B) is its step without drag."""
    n, solid, total = POROSITY, (1 - POROSITY) * GRAINS * WATER, (1 - POROSITY) * GRAINS + POROSITY * WATER
    b = 4 * (n * total * stiffness + (1 - 2 * n) * WATER * stiffness + n * WATER * MODULUS) / (n * solid * h**2)
    return b + np.sqrt(b**2 - 64 * MODULUS * stiffness / (solid * h**4))


def explicit_limit(stiffness, k, h):
    """Step with explicit drag by formula [s]."""
    n, total, big = POROSITY, (1 - POROSITY) * GRAINS + POROSITY * WATER, inverse_square(stiffness, h)
    a = n * total * VISCOSITY / ((1 - n) * GRAINS * WATER * k)
    return 8 / (2 * a + np.sqrt(4 * a**2 + 8 * big))  # the root, written so that it keeps its digits


def growth(stiffness, k, step, h, implicit, cells=12):
    """Largest amplification in a step of a string of elements, fixed and closed below, free and drained above; velocity first, drag before or after it."""
    n, size = POROSITY, 4 * cells
    difference = np.zeros((cells, cells))  # of nodal velocities in a cell; the node below the first is fixed
    for c in range(cells):
        difference[c, c] = 1 / h
        if c:
            difference[c, c - 1] = -1 / h
    volume = np.full(cells, h)
    volume[-1] = h / 2
    solid, water, whole = (1 - n) * GRAINS * volume, n * WATER * volume, WATER * volume
    drag = n * volume * VISCOSITY / k
    out = np.zeros((size, size))
    for j in range(size):
        state = np.zeros(size)
        state[j] = 1
        vs, vl, stress, p = state.reshape(4, cells)
        push, pull = h * difference.T @ p, h * difference.T @ stress
        resist = 0 if implicit else drag * (vl - vs)
        free_l = vl + step * (push - resist) / whole
        free_s = vs + step * ((1 - n) * push - pull + n * resist) / solid
        if implicit:
            d = step * drag / whole
            held = d / (1 + d)
            new_s = (solid * free_s + water * held * free_l) / (solid + water * held)
            new_l = (free_l + d * new_s) / (1 + d)
        else:
            new_s, new_l = free_s, free_l
        out[:, j] = np.concatenate([new_s, new_l, stress + step * MODULUS * difference @ new_s,
                                    p - step * stiffness / n * (difference @ ((1 - n) * new_s + n * new_l))])
    return np.abs(np.linalg.eigvals(out)).max()


def string_limit(stiffness, k, h, implicit):
    """Step at which the string loses its stability [s], by bisection."""
    low, high = 0.0, 4 * np.sqrt(8 / inverse_square(stiffness, h))
    for _ in range(40):
        middle = (low + high) / 2
        if growth(stiffness, k, middle, h, implicit) <= 1 + 1e-9:
            low = middle
        else:
            high = middle
    return low


# ---- studies ----


def map_of(talus):
    rows = []
    for drag, smoothing in (("explicit", "none"), ("implicit", "none"), ("implicit", "nodal")):
        for stiffness in STIFFNESS:
            for particles in PARTICLES if stiffness == SHOWN else [3]:
                for k in PERMEABILITY:
                    words, pressure = layer(stiffness, k, particles, smoothing)
                    step = critical_step(talus, words)
                    with tempfile.TemporaryDirectory() as folder:
                        results = run(talus, TERZAGHI, [*words, f"water.drag={drag}", *of_step(0.6 * step), f"stage.0.duration={240 * step!r}", f"output.history_interval={100 * step!r}"], folder)
                        worst = noise(results.snapshots[-1]) / pressure if results else np.inf
                    state = "failed" if not worst < 10 else "oscillating" if worst > NOISY else "stable"
                    rows.append((drag, smoothing, particles, f"{stiffness:g}", f"{k:g}", f"{step:.4g}", f"{worst:.2g}", state))
                    print(*rows[-1], flush=True)
    write("map.csv", ("drag", "smoothing", "particles", "K_l_Pa", "k_m2", "critical_step_s", "noise", "state"), rows)


def stable_at(talus, words, step, count=1500):
    """Does the layer keep its energy over so many steps of a length? Waves that set out from rest gain some, but little beside what the load stores, and never
    more than that: waves that grow without bound come to an end where the water cavitates."""
    with tempfile.TemporaryDirectory() as folder:
        results = run(talus, TERZAGHI, [*words, *of_step(step), f"stage.0.duration={count * step!r}", f"output.history_interval={count / 50 * step!r}"], folder)
        if not results:
            return False
        kinetic = results.history.columns["kinetic_J"]
        little = 1e-3 * LOAD**2 / (2 * MODULUS)  # [J/m3], and a cubic metre
        return bool(np.isfinite(kinetic).all() and kinetic.max() <= LOAD**2 / MODULUS and kinetic[-5:].max() <= max(little, 2 * kinetic[: len(kinetic) // 2].max()))


def largest_stable(talus, words, step):
    """Largest step over `step` that keeps its energy, within 3 %."""
    low, high = LOWEST, HIGHEST
    if not stable_at(talus, words, low * step):
        return 0
    while high > 1.03 * low:
        middle = np.sqrt(low * high)
        if stable_at(talus, words, float(middle * step)):
            low = middle
        else:
            high = middle
    return low


def steps_of(talus):
    rows, h = [], 0.05
    for stiffness in (STIFFNESS[0], SHOWN, STIFFNESS[-1]):
        free = np.sqrt(8 / inverse_square(stiffness, h))
        for k in PERMEABILITY:
            row = [f"{stiffness:g}", f"{k:g}", *(f"{step / free:.3g}" for step in (explicit_limit(stiffness, k, h), string_limit(stiffness, k, h, False), string_limit(stiffness, k, h, True)))]
            for drag, smoothing in (("explicit", "none"), ("implicit", "none"), ("implicit", "nodal")):
                words = (*layer(stiffness, k, 3, smoothing)[0], f"water.drag={drag}")
                step = critical_step(talus, words)
                share = step / critical_step(talus, layer(stiffness, k, 3, smoothing)[0])
                if drag == "explicit":
                    row.append(f"{share:.3g}")
                row.append(f"{share * largest_stable(talus, words, step):.3g}")
            rows.append(row)
            print(*row, flush=True)
    write("steps.csv", ("K_l_Pa", "k_m2", "explicit_formula", "explicit_string", "implicit_string", "explicit_stated", "explicit_program", "implicit_program", "implicit_program_smoothed"), rows)


def deviator(snapshot, row):
    xx, yy, zz, *shear = snapshot.column("stress").values[row]
    return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * np.square(shear).sum())


WEIGHT = "-9.81 * 2071 * (1 - y)"  # of wetting.toml
IN_3D = ["dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller",
         f'body.soil.stress=["{WEIGHT} * 0.33 / 0.67", "{WEIGHT}", "{WEIGHT} * 0.33 / 0.67", "0", "0", "0"]']
UNCURED = ["transfer.pore_smoothing=none", "transfer.integration=particle", "transfer.average_stress=false", "transfer.locking=none", "transfer.remap_interval=0",
           "transfer.relaxation=0"]
BY_RATE = [*UNCURED, "water.storage=rate"]
VARIANTS = {
    "defaults": [],
    "pressures as they are": ["transfer.pore_smoothing=none"],
    "volumes of particles, remap every step, no cure": UNCURED,
    "the same, pressure by its rate": BY_RATE,
    "defaults, pressure by its rate": ["water.storage=rate"],
    "defaults, soil settled by 1 mm before": ['body.soil.displacement=["0", "-0.001 * y"]'],
    "defaults, slice of tetrahedra": [*IN_3D, "mesh.thickness=0.05"],
    "defaults, tetrahedra of 7.5 cm, 15 cm thick": [*IN_3D, "mesh.thickness=0.15", "mesh.layers=0", "mesh.size=0.075"],
}
FRACTIONS = [0.6, 0.4, 0.3, 0.2, 0.15, 0.1]  # of the critical step


def followed(results):
    """Row of the particle at half height."""
    return np.linalg.norm(results.snapshots[0].position()[:, :2] - (0.15, 0.5), axis=1).argmin()


def wetting(talus):
    rows = []
    for name, words in VARIANTS.items():
        with tempfile.TemporaryDirectory() as folder:
            if not run(talus, WETTING, words, folder):
                print(name, "failed")
            results = Results(folder)
            row = followed(results)
            lost = -results.history.columns["water_error_kg"]
            for s in results.snapshots:
                rows.append((name, f"{s.time:.3f}", f"{s.column('saturation').values.mean():.5f}", f"{noise(s):.5g}", f"{deviator(s, row):.6g}", f"{np.interp(s.time, results.history.time, lost):.4g}"))
            print(name, rows[-1], flush=True)
    write("wetting.csv", ("variant", "time_s", "saturation", "scatter_Pa", "deviator_Pa", "water_lost_kg"), rows)


def storage_of(talus):
    rows = []
    for form, words, fractions in (("rate", BY_RATE, FRACTIONS), ("mass", UNCURED, FRACTIONS[:1])):
        for fraction in fractions:
            with tempfile.TemporaryDirectory() as folder:
                results = run(talus, WETTING, [*words, f"integrator.fraction={fraction}", "stage.0.duration=0.2", "output.interval=0.01"], folder)
                ledger, row = results.history.columns, followed(results)
                q = [deviator(s, row) for s in results.snapshots]
                rows.append((form, fraction, f"{-ledger['water_out_kg'][-1]:.4g}", f"{-ledger['water_error_kg'][-1]:.3g}", f"{min(q):.4g}", f"{max(q):.4g}"))
            print(*rows[-1], flush=True)
    write("storage.csv", ("storage", "step_over_critical", "water_in_kg", "water_lost_kg", "least_deviator_Pa", "largest_deviator_Pa"), rows)


def roughness(snapshot, size):
    """Scatter of pressure about a plane through each square of three cells by three [Pa]."""
    x, p = snapshot.position()[:, :2], snapshot.column("pore_pressure").values[:, 0]
    square, rest = np.unique(np.floor(x / (3 * size)).astype(int), axis=0, return_inverse=True)[1].ravel(), []
    for k in range(square.max() + 1):
        inside = square == k
        if inside.sum() > 8:
            plane = np.column_stack([x[inside] - x[inside].mean(axis=0), np.ones(inside.sum())])
            rest.append(p[inside] - plane @ np.linalg.lstsq(plane, p[inside], rcond=None)[0])
    return np.sqrt((np.concatenate(rest) ** 2).mean())


def terzaghi(y, height, seconds):
    """p / p_0 at a height over the base of the scene's layer, whose grains may have settled to a lower height."""
    c_v = 1e-7 / (1 / MODULUS + (1 - (1 - POROSITY) / height) / 75e6)
    M = (2 * np.arange(200) + 1) * np.pi / 2
    return (2 / M * np.sin(np.outer(1 - y / height, M)) * np.exp(-M * M * c_v * seconds / height**2)).sum(axis=1)


def strip_reference(talus, folder):
    """Settlement under the load [m] and pressure as a function of place [Pa], by quadratic finite elements of 1/64 m."""
    from scipy.interpolate import NearestNDInterpolator

    results = run(talus, STRIP, ["mesh.size=0.015625", "stage.0={name='loading', kind='consolidation', duration=0.16}"], folder)
    last = results.snapshots[-1]
    return results.history.columns["load_displacement_y_m"][-1], NearestNDInterpolator(last.position()[:, :2], last.column("pore_pressure").values[:, 0])


def measured(case, size, results, reference):
    """Error of what the case asks for and noise of pressure, both over their scale, and the range of pressure [Pa]."""
    last = results.snapshots[-1]
    p, x = last.column("pore_pressure").values[:, 0], last.position()
    if case.endswith("layer"):
        p0, height = LOAD * 250 / 260, 1 - SETTLED * (case == "settled layer")
        return np.sqrt(((p / p0 - terzaghi(x[:, 1], height, last.time)) ** 2).mean()), noise(last, int(1 / size)) / p0, p.min(), p.max()
    if case == "strip":
        settlement, pressure = reference
        return results.history.columns["load_displacement_y_m"][-1] / settlement - 1, np.sqrt(((p - pressure(x[:, :2])) ** 2).mean()) / STRIP_LOAD, p.min(), p.max()
    rough = [roughness(s, size) for s in results.snapshots if s.time > 0]
    return np.quantile(x[:, 0], 0.995), np.mean(rough) / COLUMN_WATER, p.min(), p.max()


def choices(talus):
    tenth = ["stage.0.duration=0.104"]  # T = 0.1
    scenes = {"layer": (TERZAGHI, tenth), "settled layer": (TERZAGHI, [*tenth, f'body.soil.displacement=["0", "-{SETTLED} * y"]']), "strip": (STRIP, []), "column": (COLUMN, [])}
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        reference = strip_reference(talus, folder)
    print("strip: settlement", reference[0], flush=True)
    for case, (scene, words) in scenes.items():
        for size in CELLS[case]:
            for smoothing in SMOOTHINGS:
                for integration in INTEGRATIONS:
                    with tempfile.TemporaryDirectory() as folder:
                        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
                        results = run(talus, scene, [*words, f"mesh.size={size}", f"transfer.pore_smoothing={smoothing}", f"transfer.integration={integration}"], folder)
                        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
                        found = [f"{v:.4g}" for v in measured(case, size, results, reference)] if results else ["failed"] * 4
                    rows.append((case, f"{size:g}", smoothing, integration, *found, f"{seconds:.1f}"))
                    print(*rows[-1], flush=True)
    write("choices.csv", ("case", "size_m", "smoothing", "integration", "answer", "noise", "lowest_Pa", "highest_Pa", "processor_s"), rows)


def write(name, head, rows):
    with open(HERE / name, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def read(name):
    with open(HERE / name) as file:
        return list(csv.DictReader(file))


# ---- pictures ----


def draw_map():
    colour = {"stable": style.LINES[3], "oscillating": style.LINES[5], "failed": style.LINES[4]}
    rows = read("map.csv")
    figure, grid = plt.subplots(2, 3, figsize=(11.5, 4.8), sharex=True)
    for upper, line, (key, choices, label) in zip((True, False), grid, (("K_l_Pa", STIFFNESS, "K_l [Pa]"), ("particles", PARTICLES, "particles a cell"))):
        for axes, column in zip(line, (("explicit", "none"), ("implicit", "none"), ("implicit", "nodal"))):
            for row in rows:
                if (row["drag"], row["smoothing"]) != column or (key == "K_l_Pa" and row["particles"] != "3") or (key == "particles" and float(row["K_l_Pa"]) != SHOWN):
                    continue
                x, y = PERMEABILITY.index(float(row["k_m2"])), choices.index(float(row[key]))
                axes.scatter(x, y, s=330, marker="s", color=colour[row["state"]], lw=0)
                axes.text(x, y, "x" if row["state"] == "failed" else row["noise"] if float(row["noise"]) > 1e-3 else f"{float(row['noise']):.0e}", ha="center", va="center", size=5, color="white")
            axes.set_yticks(range(len(choices)), [f"{c:g}" for c in choices])
            axes.set_xticks(range(len(PERMEABILITY)), [f"{k:g}" for k in PERMEABILITY])
            axes.set(ylabel=label, xlim=(-0.6, len(PERMEABILITY) - 0.4), ylim=(-0.7, len(choices) - 0.3))
            if upper:
                axes.set_title(f"{column[0]} drag: noise, {'pressures as they are' if column[1] == 'none' else 'smoothed (the default)'}", loc="left", fontsize=8.5)
            else:
                axes.set_xlabel("permeability [m²]")
    for state in colour:
        grid[0, 2].scatter([], [], marker="s", color=colour[state], label=state)
    figure.legend(loc="upper right", ncols=3, fontsize=8)
    figure.tight_layout(rect=(0, 0, 1, 0.96))
    style.save(figure, HERE / "map.png")


def draw_steps():
    rows = read("steps.csv")
    choices = sorted({float(row["K_l_Pa"]) for row in rows})
    figure, grid = plt.subplots(1, len(choices), figsize=(11.5, 3.3), sharey=True)
    for axes, stiffness in zip(grid, choices):
        mine = [row for row in rows if float(row["K_l_Pa"]) == stiffness]
        k = [float(row["k_m2"]) for row in mine]
        for key, look, label in (("explicit_formula", {"color": style.LINES[1]}, "explicit drag, formula"), ("explicit_string", {"color": style.LINES[1], "ls": "", "marker": "o"}, "explicit drag, string of elements"),
                                 ("implicit_string", {"color": style.LINES[0], "ls": "", "marker": "o"}, "implicit drag, string of elements"),
                                 ("explicit_stated", {"color": style.LINES[4], "ls": "--"}, "explicit drag on triangles, stated by the program"),
                                 ("explicit_program", {"color": style.LINES[4], "ls": "", "marker": "s"}, "explicit drag on triangles, measured"),
                                 ("implicit_program", {"color": style.LINES[2], "marker": "^", "ls": ":"}, "implicit drag on triangles, pressures as they are"),
                                 ("implicit_program_smoothed", {"color": style.LINES[3], "marker": "v", "ls": ":"}, "implicit drag on triangles, smoothed")):
            axes.loglog(k, [float(row[key]) for row in mine], ms=4, lw=1.2, label=label, **look)
        axes.axhline(0.6, color=style.FAINT, lw=0.8)
        axes.set(xlabel="permeability [m²]", title=f"K_l = {stiffness:g} Pa", ylim=(3e-8, 10))
    grid[0].set_ylabel("largest stable step / step without drag")
    grid[-1].legend(fontsize=6.5, loc="lower right")
    figure.tight_layout()
    style.save(figure, HERE / "steps.png")


def draw_wetting():
    rows = read("wetting.csv")
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11.5, 3.4))
    for colour, name in zip((style.LINES[0], style.LINES[3], style.LINES[1], style.LINES[4], style.LINES[2], style.LINES[5], style.FAINT), VARIANTS):
        mine = [r for r in rows if r["variant"] == name]
        t = [float(r["time_s"]) for r in mine]
        left.plot(t, [float(r["saturation"]) for r in mine], color=colour, label=name)
        middle.semilogy(t, [max(float(r["scatter_Pa"]), 1) for r in mine], color=colour, label=name)
        right.plot(t, [float(r["deviator_Pa"]) / 1e3 for r in mine], color=colour, lw=1)
    left.set(xlabel="time [s]", ylabel="mean degree of saturation")
    middle.set(xlabel="time [s]", ylabel="scatter of pressure along rows [Pa]")
    right.set(xlabel="time [s]", ylabel="q at half height [kPa]", xlim=(0, 3))
    figure.legend(*left.get_legend_handles_labels(), loc="lower center", ncols=4, fontsize=7.5)
    figure.tight_layout(rect=(0, 0.1, 1, 1))
    style.save(figure, HERE / "wetting.png")


def draw_choices():
    rows, colour = read("choices.csv"), dict(zip(INTEGRATIONS, style.LINES))
    figure, grid = plt.subplots(1, 5, figsize=(14, 3.5))
    panels = (("settled layer", "answer", "settled layer: rms error of p, T = 0.1 [% of p₀]"), ("strip", "noise", "strip: rms error of p [% of the load]"), ("strip", "answer", "strip: error of settlement [%]"),
              ("column", "noise", "column: scatter of p [% of ρgH]"), ("column", "answer", "column: 99.5 % of the grains within [cm]"))
    for axes, (case, key, title) in zip(grid, panels):
        for smoothing, line in zip(SMOOTHINGS, ("--", "-")):
            for integration in INTEGRATIONS:
                mine = [r for r in rows if (r["case"], r["smoothing"], r["integration"]) == (case, smoothing, integration)]
                held = [(100 * float(r["size_m"]), 100 * abs(float(r[key]))) for r in mine if r[key] != "failed"]
                axes.plot(*zip(*held), line, color=colour[integration], marker="o", ms=4, mfc="white" if smoothing == "none" else None, lw=1.2 if integration != "blended" else 2.4, label=f"{integration}, {'smoothed' if smoothing == 'nodal' else 'as they are'}")
        failed = [f"{r['integration']}, {100 * float(r['size_m']):g} cm" for r in rows if r["case"] == case and r[key] == "failed"]
        sizes = [100 * size for size in CELLS[case]]
        axes.set(xscale="log", yscale="linear" if (case, key) == ("column", "answer") else "log", xlabel="cells [cm]", xlim=(0.8 * min(sizes), 1.25 * max(sizes)))
        axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
        axes.minorticks_off()
        axes.set_title(title, loc="left", fontsize=8)
        if failed or case == "strip":
            axes.text(0.05, 0.5 if failed else 0.3, "all integrations alike" if case == "strip" else "as they are, failed:\n" + "\n".join(failed), transform=axes.transAxes, fontsize=7)
    figure.legend(*grid[0].get_legend_handles_labels(), loc="lower center", ncols=8, fontsize=7.5)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    style.save(figure, HERE / "choices.png")


STUDIES = {"map": (map_of, draw_map), "steps": (steps_of, draw_steps), "wetting": (wetting, draw_wetting), "storage": (storage_of, None), "choices": (choices, draw_choices)}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talus", nargs="?", help="the program")
    parser.add_argument("studies", nargs="*", help=", ".join(STUDIES) + " (default: all)")
    given = parser.parse_args()
    for study in (given.studies or STUDIES) if given.talus else ():
        STUDIES[study][0](given.talus)
    for study, (_, draw) in STUDIES.items():
        if draw and (HERE / f"{study}.csv").exists():
            draw()
