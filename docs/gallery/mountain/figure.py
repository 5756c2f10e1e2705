#!/usr/bin/python3
"""The pictures of this page from a run of its scene:  figure.py TALUS FOLDER"""

import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
COPIED = {"map.png": "maps/map.png", "section.png": "maps/section.png", "slide.png": "pictures/displacement_large.png",
          "slide.gif": "pictures/movie_displacement.gif"}


def main():
    talus, folder = sys.argv[1:]
    subprocess.run([talus, "maps", folder], check=True)
    subprocess.run([talus, "plot", folder, "--movie", "--fields", "displacement"], check=True)
    for name, source in COPIED.items():
        shutil.copy(f"{folder}/{source}", HERE / name)


if __name__ == "__main__":
    main()
