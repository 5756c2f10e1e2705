#!/usr/bin/python3
"""Studies of the Selborne scene: the shape of its excess pressure, each choice of the model beside its alternative, meshes, and the pictures of the page.

    study.py TALUS [pressure|choices|meshes|figures ...]

TALUS is the program (build/release/bin/talus). `pressure` writes excess.asc, which the scene reads. `choices` and `meshes` add to NAME.csv beside this file
the runs that are not in it yet; `figures` runs the scene and draws its pictures.
"""
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from matplotlib.tri import LinearTriInterpolator, Triangulation

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))
sys.path.insert(0, str(HERE))
import measures  # noqa: E402
import talus_measures  # noqa: E402
from talus_results import Results  # noqa: E402

CELL = 0.25  # of excess.asc [m]
LAKE = 17.0  # its level [m]


def both(key, value):
    return [f"body.{body}.{key}={value}" for body in ("weathered", "unweathered")]


def lower_clay(eta):
    return [f"body.unweathered.shape_factor={eta}"]


AVERAGED = [*both("averaging_length", "1 m"), *both("reference_size", "1.4 m")]
CURED = ["transfer.locking=patches"]

# name of a study: {name of a run: (scene, overrides)}
STUDIES = {
    "choices": {
        "the scene": ("scene.toml", []),
        "lower clay does not soften": ("scene.toml", ["body.unweathered.residual_cohesion=25 kPa", "body.unweathered.residual_friction_angle=26"]),
        "lower clay with eta = 500": ("scene.toml", lower_clay(500)),
        "softening averaged over 1 m": ("scene.toml", AVERAGED),
        "locking cured": ("scene.toml", CURED),
        "averaged and cured": ("scene.toml", [*AVERAGED, *CURED]),
        "water that moves": ("moving.toml", []),
        "slice of tetrahedra as published": ("slice.toml", []),
    },
    "meshes": {f"{size} m": ("scene.toml", [f"mesh.size={size}"]) for size in (1.4, 1.0, 0.7, 0.5)},
}


def ground(x):
    return np.interp(x, [18, 36], [15, 6])


def write_pressure(talus):
    """excess.asc: steady excess pressure over that of the base, 0 outside the soil."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([talus, "run", HERE / "pressure.toml", "-o", f"{folder}/run", "--no-pictures", "--force"], check=True)
        last = Results(f"{folder}/run").snapshots[-1]
        place, excess = last.position(), (last.values("pore_pressure") - 9810 * (LAKE - last.position()[:, 1])) / 1e5
    x, y = np.arange(0, 56 + CELL / 2, CELL), np.arange(0, 15 + CELL / 2, CELL)
    beyond = np.linspace(0, 56, 225)  # values that the boundaries give
    wet = beyond[beyond <= 24]
    points = np.concatenate([place, np.stack([beyond, ground(beyond)], axis=1), np.stack([wet, 0 * wet], axis=1), np.stack([beyond[beyond > 26], 0 * beyond[beyond > 26]], axis=1)])
    nearest = [excess[np.argmin(np.hypot(place[:, 0] - at, place[:, 1]))] for at in beyond[beyond > 26]]
    field = LinearTriInterpolator(Triangulation(*points.T), np.concatenate([excess, 0 * beyond, 1 + 0 * wet, nearest]))(*np.meshgrid(x, y))
    field = np.where(np.add.outer(y, 0 * x) < ground(x) - 1e-9, np.clip(field.filled(0), 0, 1), 0)
    lines = [f"ncols {len(x)}", f"nrows {len(y)}", "xllcenter 0", "yllcenter 0", f"cellsize {CELL}"]
    lines += [" ".join(f"{v:.3f}".replace("0.000", "0") for v in row) for row in field[::-1]]
    (HERE / "excess.asc").write_text("\n".join(lines) + "\n")


def scene_text(name):
    """A scene without pictures, with the files that it reads by their whole paths."""
    path = (HERE / name).resolve()
    text = re.sub(r'"([\w./]+\.(csv|asc))"', lambda found: f'"{(path.parent / found[1]).resolve()}"', path.read_text())
    return re.sub(r"^interval = .*$", "interval = 0", text, flags=re.M)


def run(talus, variant, folder=None):
    """Runs a variant; returns what the page compares with the paper."""
    scene, keys = variant
    with tempfile.TemporaryDirectory() as made:
        folder = Path(folder or made)
        (folder / "scene.toml").write_text(scene_text(scene))
        words = [word for key in keys for word in ("--set", key)]
        subprocess.run([talus, "run", f"{folder}/scene.toml", "-o", f"{folder}/run", "--no-pictures", "--force", *words], check=True, capture_output=True)
        return outcomes(Results(folder / "run"))


def outcomes(results):
    """What the page compares with the paper."""
    return {"pressure_kPa": f"{measures.rise_at_failure(results, 'base') / 1e3:.0f}", "crest_m": f"{talus_measures.displacement(results, 'crest'):.2f}", "upper_m": f"{talus_measures.displacement(results, 'upper'):.2f}",
            "toe_m": f"{talus_measures.displacement(results, 'toe'):.2f}",
            "speed_m_s": f"{max(talus_measures.largest_speed(results, point) for point in ('crest', 'upper')):.2f}",
            "acceleration_g": f"{measures.acceleration(results, 'crest') / 9.81:.3f}", "time_s": f"{measures.sliding_time(results, 'crest'):.1f}",
            "first_yield": f"{measures.first_yield(results, 'contact'):.2f}", "plateau_deg": f"{measures.plateau(results, 'contact'):.1f}", "steps": results.snapshots[-1].step}


def study(talus, name):
    path = HERE / f"{name}.csv"
    rows = list(csv.DictReader(open(path))) if path.exists() else []
    for label, variant in STUDIES[name].items():
        if label in {r["run"] for r in rows}:
            continue
        rows.append({"run": label, **run(talus, variant)})
        print(rows[-1], flush=True)
        with open(path, "w", newline="") as out:
            writer = csv.DictWriter(out, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    for name in sys.argv[2:] or ["pressure", *STUDIES, "figures"]:
        if name == "pressure":
            write_pressure(sys.argv[1])
        elif name == "figures":
            import figures
            figures.draw(sys.argv[1])
        else:
            study(sys.argv[1], name)
