#!/usr/bin/python3
"""Studies of the embankment: the stress before the rain, each choice beside its alternative, slopes, cells, what the paper does not give, gas and dimension,
and the pictures of the page.

    study.py TALUS [start|choices|slopes|cells|sensitivity|model|figures ...]

TALUS is the program (build/release/bin/talus). Each study adds to NAME.csv beside this file the runs that are not in it yet; `figures` runs the scene and
draws its pictures.
"""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[2] / "src/output/plots"), str(HERE)]

import measures  # noqa: E402
import talus_measures  # noqa: E402
from talus_results import Results  # noqa: E402

CREST, BASE, HEIGHT, BEYOND = 15.0, 5.0, 10.0, 15.0  # width of the crest, depth of the ground, height of the slope, level ground in front of it [m]
POINTS = {"S1": (0.4, 0.2), "D1": (2.0, 1.7), "S2": (None, 0.3), "D2": (None, 1.2)}  # from the toe up the face (None: mid-height), depth below it [m]

PAPER = ("body.soil.permeability=1e-10", "water.bulk_modulus=100e6", "stage.rain.duration=400", "output.history_interval=0.25")  # wetting takes ten times as long
GAS = ("phases=three-phase", "body.soil.gas_permeability=1e-10", "gas.bulk_modulus=1e4", "gas.density=1", "gas.viscosity=1e-6")  # Table 3, as permeable as raised
SLICE = ("dimension=3", "boundary.front.kind=roller", "boundary.back.kind=roller")  # as --slice
UNTIL_REST = "stage.rain.duration=60"  # the first slide is over by then
ONE_METRE = ("mesh.size=1", UNTIL_REST)


def strength(kilopascal):
    return (f"body.soil.suction_cohesion={kilopascal}e3",)


# name of a study: {name of a run: (slope or None for that of the scene, overrides)}
STUDIES = {
    "start": {(f"1:{slope}", f"{gained}"): (slope, strength(gained)) for slope in (1.25, 1.5, 1.6, 1.75, 1.8, 1.85, 1.9, 2.0) for gained in (6.4, 7.5, 10.0, 15.0)},
    "choices": {
        "the scene: 10 kPa on 1:1.85": (None, ONE_METRE),
        "15 kPa, as in Table 3": (None, (*ONE_METRE, *strength(15))),
        "15 kPa on 1:1.5": (1.5, (*ONE_METRE, *strength(15))),
        "67 kPa at 800 kPa, as in the text": (None, (*ONE_METRE, *strength(154), "body.soil.suction_cohesion_rate=7e-7")),
        "cells of 1.4 m": (None, ("mesh.size=1.4", UNTIL_REST)),
        "the paper's k and K_l, cells of 1.4 m": (None, ("mesh.size=1.4", *PAPER)),
        "the paper's k and K_l": (None, ("mesh.size=1", *PAPER)),
    },
    "slopes": {f"1:{slope}": (slope, ("stage.rain.duration=94",)) for slope in (1.6, 1.75, 1.8, 1.85, 1.9)},  # by then the slide is over
    "cells": {
        **{f"cells of {size} m": (None, (f"mesh.size={size}", UNTIL_REST)) for size in (1.4, 1.0, 0.7, 0.5)},
        "cells of 1.0 m, 6 particles in each": (None, (*ONE_METRE, "body.soil.particles_per_cell=6")),
        "cells of 1.0 m, half the step": (None, (*ONE_METRE, "integrator.fraction=0.3")),
        **{f"cells of {size} m": (None, (f"mesh.size={size}", UNTIL_REST)) for size in (1.02, 0.98)},
    },
    "sensitivity": {
        "the scene": (None, ONE_METRE),
        "P_0 of the retention curve 25 kPa (50)": (None, (*ONE_METRE, "body.soil.retention.reference_suction=25e3")),
        "P_0 of the retention curve 100 kPa": (None, (*ONE_METRE, "body.soil.retention.reference_suction=100e3")),
        "permeability 5e-10 m2 (1e-9)": (None, ("mesh.size=1", "body.soil.permeability=5e-10", "stage.rain.duration=120")),
        "permeability 2e-9 m2": (None, (*ONE_METRE, "body.soil.permeability=2e-9")),
        "K_l 10 MPa (20)": (None, (*ONE_METRE, "water.bulk_modulus=10e6")),
        "K_l 40 MPa": (None, (*ONE_METRE, "water.bulk_modulus=40e6")),
    },
    "model": {
        "the scene": (None, ("mesh.size=1.4", UNTIL_REST)),
        "three phases, air": (None, ("mesh.size=1.4", UNTIL_REST, "phases=three-phase")),
        "three phases, gas of Table 3": (None, ("mesh.size=1.4", UNTIL_REST, *GAS)),
        "slice of tetrahedra": (None, ("mesh.size=1.4", UNTIL_REST, *SLICE)),
        "storage of the water in rate form": (None, ("mesh.size=1.4", UNTIL_REST, "water.storage=rate")),
    },
}
HEADS = {"start": ("slope", "strength_kPa"), "slopes": ("slope",)}
WAY = ("slides_after_s", "toe_m", "middle_m", "S2_m")
QUIET = ("flatter_deg", "dry_percent", "pressure_kPa", "still_water_kPa")
COLUMNS = {"choices": ("S1", "S2", *WAY, "speed_m_s", "faster_s", "slower_s", "S2_yields_s", "D1_m", "D1_yields_s", "D1_S", "D2_m", "flatter_deg", "steps"),
           "slopes": ("slides_after_s", "toe_m", "middle_m", "S1_m", "S2_m", "D2_m", *QUIET), "cells": ("S1", "S2", *WAY, "D2_m", *QUIET, "steps", "particles"),
           "sensitivity": (*WAY, "D2_m", *QUIET), "model": (*WAY, *QUIET, "steps", "particles")}


def outcomes(results):
    """{column: text} of all that the tables show of a run."""
    columns = results.history.columns
    sliding = [snapshot.time for snapshot, _ in measures.while_it_slides(results)]
    row = {point: f"{measures.share_of_strength(results, point):.2f}" for point in ("S1", "S2")}
    row |= {f"{point}_m": f"{columns[f'{point}_displacement_m'][-1]:.2f}" for point in POINTS}
    row |= {f"{point}_yields_s": seconds(measures.yields_after(results, point)) for point in ("S2", "D1")}
    return row | {"slides_after_s": f"{sliding[0] - measures.start_of_rain(results):.0f}",
                  "toe_m": f"{measures.run_out_of_the_toe(results):.1f}", "middle_m": f"{measures.displacement_at_mid_height(results):.1f}",
                  "speed_m_s": f"{talus_measures.largest_speed(results, 'S2'):.2f}", "D1_S": f"{columns['D1_saturation'][-1]:.3f}",
                  **{f"{part}_s": f"{measures.part_of_the_slide(results, 'S2', part):.1f}" for part in ("faster", "slower")},
                  "flatter_deg": f"{measures.flattening(results):.1f}",
                  "dry_percent": f"{100 * measures.share_behind_the_front_that_is_dry(results):.1f}",
                  "pressure_kPa": f"{measures.largest_pressure_while_it_slides(results) / 1e3:.0f}",
                  "still_water_kPa": f"{measures.hydrostatic_pressure_behind_the_front(results) / 1e3:.0f}",
                  "steps": f"{talus_measures.steps(results):.0f}", "particles": f"{talus_measures.particles(results):.0f}"}


def seconds(time):
    return "never" if np.isnan(time) else f"{time:.0f}"


def before_the_rain(results):
    """{column: text} of the stress at the end of gravity."""
    return {point: f"{measures.share_of_strength(results, point):.2f}" for point in ("S1", "S2")} | {"yields_percent": f"{100 * measures.share_that_yields(results):.1f}"}


def outline(slope):
    """The section as a spreadsheet of `talus mesh`."""
    toe, top = CREST + slope * HEIGHT, BASE + HEIGHT
    end = toe + BEYOND
    return (f"part,x,y\noutline,0,0\noutline,{end},0\noutline,{end},{BASE}\noutline,{end},{top + 3}\noutline,0,{top + 3}\noutline,0,{top}\n"
            f"interface0,0,{top}\ninterface0,{CREST},{top}\ninterface0,{toe},{BASE}\ninterface0,{end},{BASE}\nregion_soil,10,{BASE}\nregion_air,{end - 10},{top - 3}\n")


def place(point, slope):
    """Position of a tracked point."""
    up, depth = POINTS[point]
    long = np.hypot(1, slope)
    along, inwards = np.array([-slope, 1]) / long, -np.array([1, slope]) / long
    toe = np.array([CREST + slope * HEIGHT, BASE])
    return toe + along * (HEIGHT * long / 2 if up is None else up) + inwards * depth


def run(talus, variant, folder, rain=True):
    """Results of a variant, computed in `folder`."""
    slope, keys = variant
    text, folder = (HERE / "scene.toml").read_text(), pathlib.Path(folder)
    section = HERE.parents[2] / "meshes/embankment.csv"
    if slope:
        section = folder / "section.csv"
        section.write_text(outline(slope))
        for point in POINTS:
            x, y = place(point, slope)
            text = re.sub(rf"(\[output.point.{point}\]\nposition = ).*", rf"\g<1>[{x:.3f}, {y:.3f}]", text)
    if not rain:
        text = re.sub(r'(?s)\[\[stage\]\]\nname = "rain".*?\n\n', "", text)
    (folder / "scene.toml").write_text(text.replace("../../../meshes/embankment.csv", str(section)))
    words = [word for key in keys for word in ("--set", key)]
    subprocess.run([talus, "run", folder / "scene.toml", "-o", folder / "run", "--no-pictures", "--force", *words], check=True, capture_output=True)
    return Results(folder / "run")


def study(talus, name):
    path, heads = HERE / f"{name}.csv", HEADS.get(name, ("run",))
    rows = list(csv.DictReader(open(path))) if path.exists() else []
    for label, variant in STUDIES[name].items():
        label = label if isinstance(label, tuple) else (label,)
        if label in {tuple(row[head] for head in heads) for row in rows}:
            continue
        with tempfile.TemporaryDirectory() as folder:
            results = run(talus, variant, folder, rain=name != "start")
            found = before_the_rain(results) if name == "start" else outcomes(results)
        rows.append(dict(zip(heads, label)) | {column: found[column] for column in COLUMNS.get(name, found)})
        print(rows[-1], flush=True)
        with open(path, "w", newline="") as out:
            writer = csv.DictWriter(out, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    for name in sys.argv[2:] or [*STUDIES, "figures"]:
        if name == "figures":
            import figures
            figures.draw(sys.argv[1])
        else:
            study(sys.argv[1], name)
