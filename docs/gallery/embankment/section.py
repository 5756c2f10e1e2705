#!/usr/bin/python3
"""Which slope and which strength from suction meet what the paper says of its embankment:  section.py TALUS FOLDER [start|slide ...]
`start` computes the stress before the rain and writes section_start.csv, `slide` the slide and writes section_slide.csv, in cells of 0.7 m. A section is
10 m high at 1V:mH with a crest of 15 m on 5 m of soil. Runs that FOLDER holds are not repeated."""

import pathlib
import re
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[2] / "src/output/plots"), str(HERE)]

import measures  # noqa: E402
import study  # noqa: E402

CREST, BASE, HEIGHT, BEYOND = 15.0, 5.0, 10.0, 15.0  # width of the crest, depth of the ground, height of the slope, level ground in front of it [m]
POINTS = {"S1": (0.4, 0.2), "D1": (2.0, 1.7), "S2": (None, 0.3), "D2": (None, 1.2)}  # from the toe up the face (None: mid-height), depth below it [m]
START = [(slope, strength) for slope in (1.25, 1.5, 1.6, 1.75, 1.8, 1.85, 1.9, 2.0) for strength in (6.4, 7.5, 10.0, 15.0)]
SLIDE = [(slope, 10.0) for slope in (1.6, 1.75, 1.8, 1.85, 1.9)]


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


def scene(slope, strength, rain):
    """Text of the scene with another section and strength, beside a file section.csv."""
    text = (HERE / "scene.toml").read_text().replace("../../../meshes/embankment.csv", "section.csv")
    text = re.sub(r"^suction_cohesion = .*$", f'suction_cohesion = "{strength} kPa"', text, flags=re.M)
    for point in POINTS:
        x, y = place(point, slope)
        text = re.sub(rf"(\[output.point.{point}\]\nposition = ).*", rf"\g<1>[{x:.3f}, {y:.3f}]", text)
    text = text.replace("duration = 110", "duration = 94")  # by then the slide is over
    if not rain:
        return re.sub(r'(?s)\[\[stage\]\]\nname = "rain".*?\n\n', "", text)
    return text


def run(talus, folder, slope, strength, rain):
    out = folder / f"{slope}_{strength}_{'slide' if rain else 'start'}"
    out.mkdir(parents=True, exist_ok=True)
    (out / "section.csv").write_text(outline(slope))
    (out / "scene.toml").write_text(scene(slope, strength, rain))
    return study.run(talus, out / "scene.toml", out / "run")[0]


def start_row(results):
    return {point: f"{measures.share_of_strength(results, point):.2f}" for point in ("S1", "S2")} | {"yields_percent": f"{100 * measures.share_that_yields(results):.1f}"}


def slide_row(results):
    row = study.outcome(results)
    return {key: row[key] for key in ("slides_after_s", "toe_m", "middle_m", "S1_m", "S2_m", "D2_m", "flatter_deg", "dry_percent", "pressure_kPa", "still_water_kPa")}


if __name__ == "__main__":
    talus, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    asked = sys.argv[3:] or ("start", "slide")
    if "start" in asked:
        rows = []
        for slope, strength in START:
            rows.append({"slope": f"1:{slope}", "strength_kPa": strength, **start_row(run(talus, folder, slope, strength, False))})
            print(rows[-1], flush=True)
        study.write("section_start.csv", rows)
    if "slide" in asked:
        rows = []
        for slope, strength in SLIDE:
            rows.append({"slope": f"1:{slope}", "strength_kPa": strength, **slide_row(run(talus, folder, slope, strength, True))})
            print(rows[-1], flush=True)
            study.write("section_slide.csv", rows)
