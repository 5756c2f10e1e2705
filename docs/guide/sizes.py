#!/usr/bin/python3
"""Do the cells decide? `sizes.py TALUS FOLDER` runs `talus converge` on the slope of the guide, as it is and with brittle softening, with eight
cell sizes; writes sizes.csv beside itself, and of the three default sizes converge.txt, what the program prints, and FOLDER/three/outcomes.png."""

import csv
import pathlib
import subprocess
import sys
import textwrap

HERE = pathlib.Path(__file__).parent
SIZES = (0.8, 0.6, 0.5, 0.45, 0.4, 0.35, 0.3, 0.25)  # [m]
BRITTLE = 100  # shape factor; the scene has 30
WIDTH = 150  # of the page [characters]
SHOWN = ("The slope fails", "The load time", "The crest displacement", "The travel distance", "The volume")


def converge(talus, folder, *options):
    """The rows of study.csv, and what is printed. Status 1 is the verdict that the cells decide something."""
    ended = subprocess.run([talus, "converge", HERE / "slope.toml", "-o", folder, "--force", *options], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True)
    print(ended.stdout)
    if ended.returncode not in (0, 1):
        sys.exit("talus converge failed")
    with open(folder / "study.csv", newline="") as file:
        return list(csv.DictReader(file)), ended.stdout


def on_the_page(text):
    """The sentences that a page shows."""
    return "\n".join(textwrap.fill(line, WIDTH) for line in text.splitlines() if line.startswith(SHOWN)) + "\n"


def main():
    talus, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    values = ["--values", ",".join(map(str, SIZES)), "--no-plot"]
    (HERE / "converge.txt").write_text(on_the_page(converge(talus, folder / "three")[1]))
    with open(HERE / "sizes.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["softening", "size_m", "load_time_s", "crest_m", "travel_m", "fails"])
        for name, factor in (("shape_factor 30", 30), (f"shape_factor {BRITTLE}", BRITTLE)):
            for row in converge(talus, folder / str(factor), *values, "--set", f"body.clay.shape_factor={factor}")[0]:
                numbers = [f"{float(row[key]):.3f}" if row[key] else "" for key in ("load_time_of_failure_s", "crest_displacement_m", "travel_distance_m")]
                writer.writerow([name, row["value"], *numbers, row["fails"]])


if __name__ == "__main__":
    main()
