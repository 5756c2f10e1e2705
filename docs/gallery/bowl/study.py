#!/usr/bin/python3
"""The bowl on two meshes, on 1 and 2 ranks, beside plane strain through its middle.

    study.py TALUS [runs|pictures ...]

TALUS is the program (build/release/bin/talus). `runs` writes runs.csv beside this file, `pictures` runs the scene.
"""
import csv
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

from talus_results import read_events  # noqa: E402

RATE = 3.0  # of the excess pressure [kPa/s]


def scene(dimension, size):
    text = (HERE / "scene.toml").read_text().replace("../../../meshes", str(HERE.parents[2] / "meshes"))
    text = re.sub(r"^size = .*$", f"size = {size}", text, flags=re.M)
    text = re.sub(r"^interval = .*$", "interval = 0", text, flags=re.M)
    if dimension == 2:  # the soft middle alone
        text = re.sub(r"\[body.firm\].*?(?=\[boundary)", "", text, flags=re.S)
        text = re.sub(r"\[boundary.sides\].*?(?=\[boundary)", "", text, flags=re.S)
        text = re.sub(r"^(thickness|cuts|layers).*\n", "", text, flags=re.M)
        text = text.replace("dimension = 3", "dimension = 2").replace("_2\"", "\"").replace(', "0", "0", "0"]', ', "0"]')
        text = re.sub(r"^position = \[([^,]*, [^,]*), .*\]$", r"position = [\1]", text, flags=re.M)
    return text


def run(talus, dimension, size, ranks):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        path.write_text(scene(dimension, size))
        command = [talus, "run", path, "-o", f"{folder}/run", "--no-pictures", "--force"]
        if ranks > 1:
            command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks)] + command
        start = time.time()
        done = subprocess.run(command, capture_output=True, text=True)
        wall = time.time() - start
        failure = read_events(f"{folder}/run", "failure")
        rows = list(csv.DictReader(open(f"{folder}/run/history.csv")))
    load = failure[0]["load_time_s"] if failure else float("nan")
    last = rows[-1]
    return {"dimension": dimension, "size_m": size, "ranks": ranks, "particles": int(float(last["particles"])), "steps": int(last["step"]),
            "excess_kPa": round(RATE * load, 1), "crest_m": round(float(last["crest_displacement_m"]), 3),
            "side_m": round(float(last["side_displacement_m"]), 3) if dimension == 3 else "", "status": done.returncode, "wall_s": round(wall, 1)}


def runs(talus):
    rows = []
    for dimension, size, ranks in ((2, 2.2, 1), (2, 1.5, 1), (2, 0.7, 1), (3, 2.2, 1), (3, 2.2, 2), (3, 1.5, 1)):
        rows.append(run(talus, dimension, size, ranks))
        print(rows[-1], flush=True)
        with open(HERE / "runs.csv", "w", newline="") as out:
            writer = csv.DictWriter(out, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)


def pictures(talus):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([talus, "run", HERE / "scene.toml", "-o", folder, "--force"], check=True)
        shutil.copy(f"{folder}/pictures/displacement_large.png", HERE / "bowl.png")


def main():
    what = sys.argv[2:] or ["runs", "pictures"]
    for name in what:
        {"runs": runs, "pictures": pictures}[name](sys.argv[1])


if __name__ == "__main__":
    main()
