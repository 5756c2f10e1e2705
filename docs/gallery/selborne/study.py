#!/usr/bin/python3
"""Studies of the Selborne scene: what each number that the paper does not give does to the answer, and the figures of the page.

    study.py TALUS [cells|softening|figure5|residual|initial|excavation|rear|steps|model|days|figures ...]

TALUS is the program (build/release/bin/talus). Each study adds to NAME.csv beside this file the runs that are not in it yet; `figures` runs the scene
itself and draws the pictures of the page from it and from the tables.
"""
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

from talus_results import read_events  # noqa: E402

GROUND = "(x < 18 ? 15 : x < 36 ? 15 - (x - 18) / 2 : 6)"
# effective vertical stress of the first stage: soil of 2200 kg/m3, water below the table of 5.6 m
VERTICAL = f"-9.81 * (2200 * ({GROUND} - y) - 1000 * max(0, (x < 18 ? 5.6 : x < 36 ? max(5.6 + 0.4 * (x - 18) / 18, 5.6) : 6) - y))"


def both(key, value):
    return [f"body.{body}.{key}={value}" for body in ("weathered", "unweathered")]


def softening(eta=500, reference=1.4, length=1):
    """Softening of both clays; `length` 0: local."""
    return both("shape_factor", eta) + both("reference_size", reference) + both("averaging_length", length)


SLICE = ["dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller"]  # as --slice
HELD = "functions.h=[[0, 5.6], [5, 5.6], [25.37, 11.07], [1000, 11.07]]"  # the load at failure of the scene, no more

# name of a study: {name of a run: overrides, or (scene, overrides)}
STUDIES = {
    "cells": {f"{kind}, {size} m": [f"mesh.size={size}", *keys]
              for kind, keys in (("nonlocal", []), ("of the cell", softening(length=0) + both("reference_size", 0.7)))
              for size in (1.4, 1.0, 0.7, 0.5)},
    "softening": {"as the scene": [], "averaging_length 0.7 m": softening(length=0.7), "averaging_length 1.4 m": softening(length=1.4),
                  "reference_size 0.7 m": softening(reference=0.7), "reference_size 2.8 m": softening(reference=2.8),
                  "shape_factor 400": softening(eta=400), "of the cell, 1.0 m": ["mesh.size=1.0", *softening(length=0)]},
    "figure5": {f"eta {eta}, {size} m": [f"mesh.size={size}", *both("shape_factor", eta)] for size in (1.0, 0.7) for eta in (250, 400, 500, 1000)},
    "residual": {**{f"{c} kPa": [f"body.weathered.residual_cohesion={c} kPa"] for c in (1, 2, 4.7, 7, 10)},
                 **{f"{c} kPa, table held at 11.07 m": [f"body.weathered.residual_cohesion={c} kPa", HELD, "stage.recharge.duration=40"] for c in (4.7, 7, 10)},
                 **{f"unweathered clay {c} kPa": [f"body.unweathered.residual_cohesion={c} kPa"] for c in (0, 0.5, 2, 4.7)}},
    "initial": {"gravity switched on": [], **{f"K0 = {k0}": k0 for k0 in (0.5, 1.0, 1.5, 2.0)}},
    "excavation": {f"K0 = {k0}, eta {eta}": ("excavation.toml", [*(f"body.{body}.k0={k0}" for body in ("weathered", "unweathered", "cut")), *both("shape_factor", eta)])
                   for eta in (500, 50) for k0 in (0.5, 1.0, 1.5, 2.0)},
    "rear": {**{"rear at x = 0, 1.2 m": ["mesh.size=1.2"]},
             **{f"rear at x = -20 m, {size} m": [f"mesh.size={size}", 'mesh.section="rear.csv"'] for size in (1.2, 1.0, 0.7)},
             **{f"{name}, 1.2 m": ["mesh.size=1.2", f'mesh.section="{file}.csv"']
                for name, file in (("base at y = -5 m", "base"), ("rear -20 m, base -5 m, front 20 m farther", "wide"),
                                   ("rear -20 m, base -10 m, front 20 m farther", "deep"))}},
    "steps": {**{f"step {f} of the critical": [f"integrator.fraction={f}"] for f in (0.3, 0.6, 0.9)},
              **{f"{n} particles per cell": both("particles_per_cell", n) for n in (3, 6, 12)}},
    "model": {"locking left in": ["transfer.locking=none"], "damping 0": ["stage.recharge.damping=0", "stage.slide.damping=0"],
              "damping 0.1": ["stage.recharge.damping=0.1", "stage.slide.damping=0.1"],
              "E 10 MPa": both("young_modulus", "10 MPa"), "E 40 MPa": both("young_modulus", "40 MPa"),
              "table rises at half the rate": ["functions.h=[[0, 5.6], [5, 5.6], [75, 15]]"],
              "table rises at twice the rate": ["functions.h=[[0, 5.6], [5, 5.6], [22.5, 15]]"],
              "grains of 3125 kg/m3, 1.2 m": [*both("grain_density", 3125), "mesh.size=1.2"],
              "slice of tetrahedra, 1 m": [*SLICE, "mesh.size=1", *both("particles_per_cell", 8)], "triangles, 1 m": ["mesh.size=1"]},
}


def scene_text(name):
    """A scene of this folder without pictures and lines."""
    text = (HERE / name).read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    text = re.sub(r"^interval = .*$", "interval = 0", text, flags=re.M)
    return re.sub(r"^\[output\.line.*\n(points.*\n)?", "", text, flags=re.M)


SECTIONS = {"rear": (-20, 0, 56), "base": (0, -5, 56), "wide": (-20, -5, 76), "deep": (-20, -10, 76)}  # rear, base, front [m]; the scene: 0, 0, 56


def write_sections(folder):
    """NAME.csv: the section of the scene with other ends."""
    for name, (rear, base, front) in SECTIONS.items():
        text = (HERE.parents[2] / "meshes/selborne.csv").read_text()
        text = re.sub(r"^(outline|b_recharge_base|b_recharge_side),(\d+),0$", rf"\1,\2,{base}", text, flags=re.M)
        text = re.sub(r"^(outline|interface\d),56,", rf"\1,{front},", text, flags=re.M)
        (Path(folder) / f"{name}.csv").write_text(re.sub(r"^(outline|interface\d|b_recharge_base|b_recharge_side),0,", rf"\1,{rear},", text, flags=re.M))


def scene(overrides):
    """Text of a scene and the overrides of its run; a number stands for K0."""
    if isinstance(overrides, tuple):
        return scene_text(overrides[0]), overrides[1]
    text = scene_text("scene.toml")
    if isinstance(overrides, float):  # K0 in the slope as it is, brought to equilibrium
        stress = f'stress = ["{overrides} * {VERTICAL}", "{VERTICAL}", "{overrides} * {VERTICAL}", "0"]\nlaw = '
        text = re.sub(r'^gravity_ramp.*\n', "", text, flags=re.M)
        return re.sub(r"^law = ", lambda _: stress, text, flags=re.M), []
    return text, overrides


def table_height(load_time, text, overrides):
    """Height of the water table behind the crest [m] at a time of the loads."""
    found = next((o for o in overrides if o.startswith("functions.h=")), None) or re.search(r"^h = .*\]\]", text, flags=re.M)[0]
    points = numpy.array([float(n) for n in re.findall(r"-?\d+\.?\d*", found.split("=", 1)[1])]).reshape(-1, 2)
    return float(numpy.interp(load_time, points[:, 0], points[:, 1]))


def steady(values, times, span):
    """Largest mean of a rate of change over `span` [s], from values at `times`."""
    later = numpy.interp(times + span, times, values)
    inside = times + span <= times[-1]
    return float(numpy.max(numpy.abs(later - values)[inside])) / span


def run(talus, overrides):
    """Runs a variant; returns what is asked of it."""
    text, keys = scene(overrides)
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "scene.toml").write_text(text)
        write_sections(folder)
        words = [word for key in keys for word in ("--set", key)]
        done = subprocess.run([talus, "run", f"{folder}/scene.toml", "-o", f"{folder}/run", "--no-pictures", "--force", *words], capture_output=True, text=True)
        if done.returncode:
            print(done.stderr[-600:])
            return {"pressure_kPa": "", "table_m": "", "crest_m": "", "speed_m_s": "", "acceleration_g": "", "toe_m": "", "steps": "", "particles": ""}
        return outcomes(read_events(f"{folder}/run", "failure"), list(csv.DictReader(open(f"{folder}/run/history.csv"))), text, keys)


def outcomes(failure, rows, text, keys):
    at = table_height(failure[0]["load_time_s"], text, keys) if failure else None
    column = lambda name: numpy.array([float(r[name]) for r in rows if r["stage"] != "gravity"])
    time, speed = column("time_s"), column("crest_velocity_m_s")
    return {"pressure_kPa": round(9.81 * at, 2) if at else "", "table_m": round(at, 3) if at else "",
            "crest_m": float(rows[-1]["crest_displacement_m"]), "speed_m_s": float(speed.max()),
            "acceleration_g": round(steady(speed, time, 0.5) / 9.81, 4), "toe_m": float(rows[-1]["toe_displacement_m"]),
            "steps": int(rows[-1]["step"]), "particles": int(float(rows[-1]["particles"]))}


def coupled():
    """Text of days.toml with consolidation of the whole time in place of seepage and equilibrium in turn, until equilibrium is lost."""
    text = scene_text("days.toml").replace('phases = "drained"', 'phases = "saturated"')
    text = re.sub(r"^(saturation = |bulk_modulus = ).*\n", "", text, flags=re.M)
    text = re.sub(r"(?s)\[\[stage\]\]\nname = \"months\".*?\[output\]", '[[stage]]\nname = "months"\nkind = "consolidation"\nduration = "364 days"\n\n[output]', text)
    return text


def until_lost():
    """Text of days.toml without motion, with equilibrium every week for two years."""
    text = scene_text("days.toml")
    pairs = [f'[[stage]]\nname = "week_{n}"\nkind = "seepage"\nduration = "7 days"\n[[stage]]\nname = "stands_{n}"\nkind = "quasi_static"\nduration = 1\nhold_loads = true\n'
             for n in range(1, 105)]
    text = re.sub(r"^h = .*$", 'h = [[0, 5.6], ["784 days", 28]]', text, flags=re.M)
    return re.sub(r"(?s)\[\[stage\]\]\nname = \"months\".*?\[quasi_static\]", "\n".join(pairs) + "\n[quasi_static]", text)


DAYS = {**{f"{size} m": (until_lost, [f"mesh.size={size}"]) for size in (1.4, 1.0, 0.7)},
        **{f"coupled, {size} m": (coupled, [f"mesh.size={size}"]) for size in (1.4, 1.0, 0.7)},
        **{f"permeability {k} m/s": (until_lost, both("hydraulic_conductivity", f"{k} m/s")) for k in ("1e-10", "1e-9", "3e-9", "3e-8", "1e-7")},
        **{f"storage of the skeleton times {f}": (until_lost, [f"water.bulk_modulus={5.9 / f} MPa"]) for f in (0.5, 2)},
        **{f"ground sealed, coupled, {size} m": (coupled, [f"mesh.size={size}", "boundary.ground.kind=impermeable"]) for size in (1.4, 1.0, 0.7)}}


def endure(talus, variant):
    """Days of recharge, at the rate of the scene, until finite elements find no equilibrium, and the pressures then."""
    make, keys = variant
    text = make()
    if "boundary.ground.kind=impermeable" in keys:
        text, keys = text.replace('kind = "rainfall"\nintensity = 0', 'kind = "impermeable"'), keys[:1]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "scene.toml").write_text(text)
        words = [word for key in keys for word in ("--set", key)]
        done = subprocess.run([talus, "run", f"{folder}/scene.toml", "-o", f"{folder}/run", "--no-pictures", "--force", *words], capture_output=True, text=True)
        rows = list(csv.DictReader(open(f"{folder}/run/history.csv")))
        if done.returncode and "no equilibrium beyond" not in done.stderr:
            raise SystemExit(done.stderr[-600:])
    last = rows[-1]
    return {"ended": "no equilibrium" if done.returncode else "stands", "days": round(float(last["time_s"]) / 86400), "base_kPa": float(last["base_pore_pressure_Pa"]) / 1e3,
            "P2_kPa": float(last["P2_pore_pressure_Pa"]) / 1e3, "below_toe_kPa": float(last["below_toe_pore_pressure_Pa"]) / 1e3,
            "crest_mm": 1e3 * float(last["crest_displacement_m"])}


def study(talus, name):
    path = HERE / f"{name}.csv"
    rows = list(csv.DictReader(open(path))) if path.exists() else []
    done = {r["run"] for r in rows}
    for label, overrides in STUDIES[name].items():
        if label in done:
            continue
        rows.append({"run": label, **(endure if name == "days" else run)(talus, overrides)})
        print(rows[-1], flush=True)
        with open(path, "w", newline="") as out:
            writer = csv.DictWriter(out, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)


STUDIES["days"] = DAYS

if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    for asked in sys.argv[2:] or (*STUDIES, "figures"):
        if asked == "figures":
            import figures
            figures.draw(sys.argv[1])
        else:
            study(sys.argv[1], asked)
