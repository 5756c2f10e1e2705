#!/usr/bin/python3
"""Days of recharge until finite elements find no equilibrium.

    study.py TALUS

TALUS is the program (build/release/bin/talus). Adds to days.csv beside this file the runs that are not in it yet.
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


def both(key, value):
    return [f"body.{body}.{key}={value}" for body in ("weathered", "unweathered")]


def days_text():
    """days.toml without pictures and lines."""
    text = (HERE / "days.toml").read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    text = re.sub(r"^interval = .*$", "interval = 0", text, flags=re.M)
    return re.sub(r"^\[output\.line.*\n(points.*\n)?", "", text, flags=re.M)


def coupled():
    """Text of days.toml with consolidation of the whole time in place of seepage and equilibrium in turn, until equilibrium is lost."""
    text = days_text().replace('phases = "drained"', 'phases = "saturated"')
    text = re.sub(r"^(saturation = |bulk_modulus = ).*\n", "", text, flags=re.M)
    text = re.sub(r"(?s)\[\[stage\]\]\nname = \"months\".*?\[output\]", '[[stage]]\nname = "months"\nkind = "consolidation"\nduration = "364 days"\n\n[output]', text)
    return text


def until_lost():
    """Text of days.toml without motion, with equilibrium every week for two years."""
    text = days_text()
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
        lost = read_events(f"{folder}/run", "equilibrium_lost")
        if done.returncode and not lost:
            raise SystemExit(done.stderr[-600:])
    last = rows[-1]
    return {"ended": "no equilibrium" if lost else "stands", "days": round(float(last["time_s"]) / 86400), "base_kPa": float(last["base_pore_pressure_Pa"]) / 1e3,
            "P2_kPa": float(last["P2_pore_pressure_Pa"]) / 1e3, "below_toe_kPa": float(last["below_toe_pore_pressure_Pa"]) / 1e3,
            "crest_mm": 1e3 * float(last["crest_displacement_m"])}


def study(talus):
    path = HERE / "days.csv"
    rows = list(csv.DictReader(open(path))) if path.exists() else []
    done = {r["run"] for r in rows}
    for label, variant in DAYS.items():
        if label in done:
            continue
        rows.append({"run": label, **endure(talus, variant)})
        print(rows[-1], flush=True)
        with open(path, "w", newline="") as out:
            writer = csv.DictWriter(out, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    study(sys.argv[1])
