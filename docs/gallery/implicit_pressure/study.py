#!/usr/bin/python3
"""What pore pressure that is implicit in time costs and where it fails, beside explicit pressure.

    study.py TALUS [consolidation slide map]    runs all or some of them (half an hour), writes consolidation.csv, slide.csv and map.csv
    study.py                                    draws errors.png and map.png from them

*consolidation*: tests/verification/terzaghi with true water on three meshes, in saturated soil and in soil that may dry; error is the rms of pressure against the
exact solution, over the load's.
*slide*: block.toml, a wet block that slumps, with steps of 0.8 and 0.4 of the critical one; error is the rms of displacements against explicit pressure with
0.2 of its critical step, over their rms.
*map*: the same block, over permeability and stiffness of the water: processor time per simulated second of both schemes, where one breaks off, and what "auto"
chooses.
Times are processor times of one rank without those of a run of one step; on a machine that does other work at the same time they scatter by some tenths.
"""

import argparse
import csv
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

TERZAGHI, BLOCK = ROOT / "tests/verification/terzaghi/scene.toml", HERE / "block.toml"
SCHEMES, PHASES = ("explicit", "implicit"), ("saturated", "unsaturated")
POROSITY, MODULUS, LOAD, VISCOSITY, WATER = 0.3, 10e6, 1e3, 1e-3, 2.2e9
SIZES = (0.1, 0.05, 0.025)  # of cells [m]
PERMEABILITY, STIFFNESS = (1e-7, 1e-9, 1e-11, 1e-13), (2e7, 1e8, 5e8, 2.2e9)
CURVES = ("body.{}.retention.curve=van_genuchten", "body.{}.retention.reference_suction=5e3", "body.{}.retention.shape=0.4",
          "body.{}.relative_permeability.curve=van_genuchten_mualem", "body.{}.relative_permeability.shape=0.4")
NAMES = {"consolidation": ("phases", "scheme", "size_m", "error", "processor_s"), "slide": ("phases", "scheme", "fraction", "error", "processor_s"),
         "map": ("k_m2", "K_w_Pa", "explicit_s", "implicit_s", "auto")}


def of_phases(phases, body):
    return [f"phases={phases}", *(curve.format(body) for curve in CURVES if phases == "unsaturated")]


def run(talus, scene, words, folder):
    """Results, or None when the run failed, and its processor time [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    options = [option for word in words for option in ("--set", word)]
    end = subprocess.run([talus, "run", scene, "-o", folder, "--no-pictures", "--force", *options], capture_output=True, text=True)
    return Results(folder) if end.returncode == 0 else None, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def timed(talus, scene, words, duration, folder):
    """Results, or None, and the processor time of the steps alone [s]."""
    at_start = min(run(talus, scene, [*words, "stage.0.duration=1e-6"], folder)[1] for _ in range(3))
    results, all_of_it = run(talus, scene, [*words, f"stage.0.duration={duration!r}"], folder)
    return results, max(all_of_it - at_start, 1e-3)


def exact(depth, T):
    M = (2 * np.arange(400) + 1) * np.pi / 2
    return (2 / M * np.sin(np.outer(depth, M)) * np.exp(-M * M * T)).sum(axis=1)


def consolidation(talus, folder):
    share, T, k = (WATER / POROSITY) / (MODULUS + WATER / POROSITY), 0.1, 1e-10
    duration = T / (k / VISCOSITY / (1 / MODULUS + POROSITY / WATER))
    for phases in PHASES:
        for scheme in SCHEMES:
            for size in SIZES:
                words = [*of_phases(phases, "soil"), f"mesh.size={size}", f"water.pressure={scheme}", f"water.bulk_modulus={WATER}", f"body.soil.permeability={k}",
                         f"water.excess={LOAD * share}", f'body.soil.stress=["0", "{-LOAD * (1 - share)}", "0", "0"]']
                results, time = timed(talus, TERZAGHI, words, duration, folder)
                error = np.nan
                if results:
                    last = results.snapshots[-1]
                    p, y = last.column("pore_pressure").values[:, 0] / (LOAD * share), last.position()[:, 1]
                    error = np.sqrt(((p - exact(1 - y, T)) ** 2).mean())
                yield phases, scheme, size, f"{error:.4g}", f"{time:.3g}"


def displacement(results):
    return results.snapshots[-1].column("displacement").values  # in the order of the particles' numbers


def slide(talus, folder):
    duration = 0.1
    for phases in PHASES:
        words = [*of_phases(phases, "soil")]
        reference, _ = run(talus, BLOCK, [*words, f"stage.0.duration={duration}", "integrator.fraction=0.2"], folder)
        base = displacement(reference)
        for scheme in SCHEMES:
            for fraction in (0.8, 0.4):
                results, time = timed(talus, BLOCK, [*words, f"water.pressure={scheme}", f"integrator.fraction={fraction}"], duration, folder)
                error = np.nan if results is None else np.sqrt(((displacement(results) - base) ** 2).mean() / (base**2).mean())
                yield phases, scheme, fraction, f"{error:.4g}", f"{time:.3g}"


def chosen(talus, words):
    end = subprocess.run([talus, "check", BLOCK, *(option for word in [*words, "water.pressure=auto"] for option in ("--set", word))], capture_output=True, text=True)
    return "implicit" if "pore pressure is implicit in time" in end.stdout + end.stderr else "explicit"


def map_of(talus, folder):
    duration = 0.1
    for k in PERMEABILITY:
        for stiffness in STIFFNESS:
            words = [f"body.soil.permeability={k}", f"water.bulk_modulus={stiffness}"]
            times = []
            for scheme in SCHEMES:
                results, time = timed(talus, BLOCK, [*words, f"water.pressure={scheme}"], duration, folder)
                times.append(f"{time / duration:.3g}" if results else "failed")
            yield k, stiffness, *times, chosen(talus, words)


def read(name):
    with open(HERE / f"{name}.csv") as file:
        return list(csv.DictReader(file))


def draw_errors():
    figure, grid = plt.subplots(1, 2, figsize=(9.5, 3.8))
    for axes, name, what in zip(grid, ("consolidation", "slide"), ("Consolidation: error of pressure over the load", "Slumping block: error of displacement")):
        rows = read(name)
        for k, phases in enumerate(PHASES):
            for scheme in SCHEMES:
                line = [(float(r["processor_s"]), float(r["error"])) for r in rows if (r["phases"], r["scheme"]) == (phases, scheme)]
                axes.loglog(*zip(*line), marker="o" if scheme == "implicit" else "s", color=style.LINES[k], ls="-" if scheme == "implicit" else "--",
                            label=f"{phases}, {scheme}")
        axes.set_title(what, loc="left")
        axes.set(xlabel="processor time [s]", ylabel="error")
        axes.yaxis.set_minor_formatter(style.NullFormatter())
    grid[0].legend(fontsize=7.5)
    figure.tight_layout()
    style.save(figure, HERE / "errors.png")


def draw_map():
    figure, axes = plt.subplots(figsize=(6.4, 3.8))
    for row in read("map"):
        x, y = PERMEABILITY.index(float(row["k_m2"])), STIFFNESS.index(float(row["K_w_Pa"]))
        failed = [scheme for scheme in SCHEMES if row[f"{scheme}_s"] == "failed"]
        gain = None if failed else float(row["explicit_s"]) / float(row["implicit_s"])
        colour = style.LINES[4] if failed else style.LINES[3] if gain > 1 else style.LINES[5]
        axes.scatter(x, y, s=2600, marker="s", color=colour, lw=0)
        axes.text(x, y, " and ".join(failed) + "\nfails" if failed else f"{gain:.1f} times\nauto: {row['auto']}", ha="center", va="center", size=6.5, color="white")
    axes.set_xticks(range(len(PERMEABILITY)), [f"{k:g}" for k in PERMEABILITY])
    axes.set_yticks(range(len(STIFFNESS)), [f"{s:g}" for s in STIFFNESS])
    axes.set(xlabel="permeability [m²]", ylabel="bulk modulus of the water [Pa]", xlim=(-0.6, len(PERMEABILITY) - 0.4), ylim=(-0.6, len(STIFFNESS) - 0.4))
    axes.set_title("Processor time of explicit over implicit pressure, slumping block", loc="left")
    figure.tight_layout()
    style.save(figure, HERE / "map.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talus", nargs="?", help="the program; without it only the pictures are drawn")
    parser.add_argument("studies", nargs="*", choices=[*NAMES, []], help="all, unless some are named")
    given = parser.parse_args()
    studies = {"consolidation": consolidation, "slide": slide, "map": map_of}
    for name in (given.studies or NAMES) if given.talus else ():
        with tempfile.TemporaryDirectory() as folder, open(HERE / f"{name}.csv", "w", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(NAMES[name])
            for row in studies[name](given.talus, folder):
                table.writerow(row)
                file.flush()
                print(name, *row, flush=True)
    draw_errors()
    draw_map()


if __name__ == "__main__":
    main()
