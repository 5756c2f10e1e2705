#!/usr/bin/python3
"""Does the discretisation decide? `convergence.py TALUS PAGE FOLDER [QUANTITY ...]` runs `talus converge` on the scene of a page of the gallery three
times: with three cell sizes, three time steps, and three numbers of particles per cell. It writes convergence.csv into the folder of the page: one line
for each refinement and quantity, with the values of the three runs from coarse to fine, how far they are apart in percent of the finest, and the verdict of
the command. QUANTITY is a column of study.csv, such as load_time_of_failure_s or crest_displacement_m; without any, all that the command judges.
"cells=2,1,0.5" among the quantities gives other values than the command's own."""

import csv
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
VERDICT = {"equal": "does not decide", "settles": "settles", "open": "decides", "swings": "swings", "missing": "missing in some"}
NAMES = {"load_time_of_failure_s": "time t of the loads at failure [s]", "largest_displacement_m": "largest displacement [m]",
         "travel_distance_m": "travel of the front [m]", "volume_of_slide_m3": "volume of the slide [m³]", "depth_of_slide_m": "depth of the slip surface [m]"}


def name_of(quantity):
    return NAMES.get(quantity) or f"displacement of {quantity.removesuffix('_displacement_m').replace('_', ' ')} [m]"


def four_digits(value):
    return "none" if value is None else f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


def main():
    talus, page, folder, *words = sys.argv[1:]
    values = dict(word.split("=") for word in words if "=" in word)
    wanted = [word for word in words if "=" not in word]
    lines = []
    for by in ("cells", "steps", "particles"):
        out = pathlib.Path(folder) / by
        chosen = ["--values", values[by]] if by in values else []
        ended = subprocess.run([talus, "converge", HERE / page / "scene.toml", "--by", by, "-o", out, "-j", "1", "--no-plot", "--force", *chosen],
                               stdin=subprocess.DEVNULL)
        if ended.returncode not in (0, 1):  # 1: something decides
            sys.exit(f"talus converge --by {by} failed")
        verdict = json.loads((out / "study.json").read_text())
        with open(out / "study.csv", newline="") as file:
            runs = list(csv.DictReader(file))
        of = ", ".join(f"{float(run['value']):g}" for run in runs) + (f" {runs[0]['unit']}" if runs[0]["unit"] else "")
        common = {"refined": by, "values": of}
        if any(run["failure"] for run in runs):
            sys.exit("\n".join(verdict["verdict"]))
        lines.append(common | {"quantity": "fails", **dict(zip(("coarse", "middle", "fine"), ("yes" if run["fails"] == "True" else "no" for run in runs)))})
        for one in verdict["quantities"]:
            if wanted and one["quantity"] not in wanted:
                continue
            found = one["values"]
            apart = 100 * (max(found) - min(found)) / abs(found[-1]) if None not in found and found[-1] else 0.0
            lines.append(common | {"quantity": name_of(one["quantity"]), "apart_percent": f"{apart:.1f}", "verdict": VERDICT[one["state"]],
                                   **dict(zip(("coarse", "middle", "fine"), map(four_digits, found)))})
    with open(HERE / page / "convergence.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, ["refined", "values", "quantity", "coarse", "middle", "fine", "apart_percent", "verdict"], restval="")
        writer.writeheader()
        writer.writerows(lines)


if __name__ == "__main__":
    main()
