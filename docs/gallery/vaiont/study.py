#!/usr/bin/python3
"""Studies of the Vaiont scene: each choice of the model beside its alternative, meshes, and the pictures of the page.

    study.py TALUS [choices|meshes|figures ...]

TALUS is the program (build/release/bin/talus). The first two add to NAME.csv beside this file the runs that are not in it yet; `figures` runs the scene
and draws its pictures.
"""
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SECTION = HERE.parents[2] / "meshes/vaiont.csv"
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))
sys.path.insert(0, str(HERE))
import measures  # noqa: E402
from talus_results import Results  # noqa: E402

COARSE = "mesh.size=15"
STIFF = ["body.rock.young_modulus=5 GPa", "stage.water.damping=0"]
# Water in the rock alone: the water table comes down to the toe within 150 m, so that nothing rests on the toe.
NO_LAKE = ["water.level=0", "water.excess=1000 * 9.81 * max(0, 640 + hw(t) * min(1, max(0, (1115.6 - x) / 150)) - y)"]
SLOWER = ["functions.hw=[[0, 0], [40, 30], [80, 53], [100, 57], [120, 60]]", "functions.phi_b=[[0, 12], [210, 12], [211, 0]]", "stage.water.duration=210"]
# Sections that differ in some lines.
SECTIONS = {
    "lower_head": [(r"^interface0,247.8,963$", "interface0,247.8,953.5")],  # 9.5 m
    "far_bank": [(r",1255,", ",1405,"), (r",1755,", ",1905,")],  # 150 m
}
LOWER_HEAD = ["mesh.section=lower_head"]
FAR_BANK = ["mesh.section=far_bank", "water.table=[[-150, 640], [1905, 640]]"]


def base(before, after):
    return f"functions.phi_b=[[0, {before}], [150, {before}], [151, {after}]]"


# name of a study: {name of a run: (scene, overrides)}
STUDIES = {
    "choices": {
        "the scene": ("scene.toml", [COARSE]),
        "E = 5 GPa, no damping": ("scene.toml", [COARSE, *STIFF]),
        "E = 200 MPa": ("scene.toml", [COARSE, "body.rock.young_modulus=200 MPa"]),
        "E = 1 GPa": ("scene.toml", [COARSE, "body.rock.young_modulus=1 GPa"]),
        "no damping": ("scene.toml", [COARSE, "stage.water.damping=0"]),
        "damping 0.1": ("scene.toml", [COARSE, "stage.water.damping=0.1"]),
        "residual cohesion 300 kPa": ("scene.toml", [COARSE, "body.rock.residual_cohesion=300 kPa"]),
        "E = 100 MPa, residual cohesion 300 kPa": ("scene.toml", [COARSE, "body.rock.young_modulus=100 MPa", "body.rock.residual_cohesion=300 kPa"]),
        "E = 100 MPa, residual cohesion 300 kPa, cells of 10 m": ("scene.toml", ["body.rock.young_modulus=100 MPa", "body.rock.residual_cohesion=300 kPa"]),
        "E = 200 MPa, residual cohesion 300 kPa": ("scene.toml", [COARSE, "body.rock.young_modulus=200 MPa", "body.rock.residual_cohesion=300 kPa"]),
        "no lake": ("scene.toml", [COARSE, *NO_LAKE]),
        "no lake, head 9.5 m lower": ("scene.toml", [COARSE, *NO_LAKE, *LOWER_HEAD]),
        "no lake, base of 12.3 degrees": ("scene.toml", [COARSE, *NO_LAKE, base(12.3, 0)]),
        "water rises in twice the time": ("scene.toml", [COARSE, *SLOWER]),
        "base of 5 degrees": ("scene.toml", [COARSE, base(12, 5)]),
        "bank 150 m farther": ("scene.toml", [COARSE, *FAR_BANK]),
        "dry until the base is lost": ("scene.toml", [COARSE, "functions.hw=0"]),
    },
    "meshes": {f"{size} m": ("scene.toml", [f"mesh.size={size}"]) for size in (15, 12, 10)},
}


def scene_text(name):
    """A scene without snapshots, with the files that it reads by their whole paths."""
    path = (HERE / name).resolve()
    text = re.sub(r'"([\w./]+\.csv)"', lambda found: f'"{(path.parent / found[1]).resolve()}"', path.read_text())
    return re.sub(r"^interval = .*$", "interval = 0", text, flags=re.M)


def run(talus, variant):
    """Runs a variant; returns its results, which live as long as their folder, and the folder."""
    scene, keys = variant
    made = tempfile.TemporaryDirectory()
    folder = Path(made.name)
    (folder / "scene.toml").write_text(scene_text(scene))
    for name, changes in SECTIONS.items():
        text = SECTION.read_text()
        for old, new in changes:
            text = re.sub(old, new, text, flags=re.M)
        (folder / f"{name}.csv").write_text(text)
    words = [word for key in keys for word in ("--set", re.sub(r"^mesh.section=(\w+)$", rf"mesh.section={folder}/\1.csv", key))]
    subprocess.run([talus, "run", folder / "scene.toml", "-o", folder / "run", "--no-pictures", "--force", *words], check=True, capture_output=True)
    return Results(folder / "run"), made


def outcomes(results):
    """What the page compares with the paper, and where the energy of the slide went until it was fastest."""
    def written(digits, value):
        return f"{value:.{digits}f}" if value == value else ""
    row = {f"at_{level}_m": written(1, measures.way_at_level(results, "P0", level)) for level in (30, 53, 60)}
    row |= {"end_m": written(1, measures.way_before_slide(results, "P0")), "creep_m_s": written(2, measures.mean_speed_in_stage(results, "P0", "water")),
            "left_m_s": written(2, measures.mean_speed_left(results, "P0")), "slide_m_s": written(1, measures.speed_in_stage(results, "P0", "slide")),
            "way_m": written(0, measures.way_in_all(results, "P0"))}
    energy = measures.energy_of_slide(results)
    row |= {f"{name}_GJ": written(1, energy[name] / 1e9) for name in ("gravity", "water", "base", "rock", "kinetic")}
    row |= {"yield_m": written(0, measures.level_of_yield(results)), "bank_s": written(1, measures.first_yield(results, "m13"))}
    return row | {"drop_m": written(1, energy["drop"]), "frictionless_m_s": written(1, energy["frictionless"]), "steps": int(results.history.step[-1])}


def study(talus, name):
    path = HERE / f"{name}.csv"
    rows = list(csv.DictReader(open(path))) if path.exists() else []
    for label, variant in STUDIES[name].items():
        if label in {r["run"] for r in rows}:
            continue
        results, made = run(talus, variant)
        with made:
            rows.append({"run": label, **outcomes(results)})
        rows.sort(key=lambda row: list(STUDIES[name]).index(row["run"]))
        print(label, flush=True)
        with open(path, "w", newline="") as out:
            writer = csv.DictWriter(out, rows[0].keys(), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    for name in sys.argv[2:] or [*STUDIES, "figures"]:
        if name == "figures":
            import figures
            figures.draw(sys.argv[1])
        else:
            study(sys.argv[1], name)
