#!/usr/bin/python3
"""The pictures of this page from a run of its scene:  figure.py TALUS FOLDER"""

import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
COPIED = {"slide.png": "displacement_large.png", "history.png": "history_displacement.png", "slide.gif": "movie_displacement.gif"}


def main():
    talus, folder = sys.argv[1:]
    subprocess.run([talus, "plot", folder, "--movie", "--fields", "displacement"], check=True)
    for name, source in COPIED.items():
        shutil.copy(f"{folder}/pictures/{source}", HERE / name)


if __name__ == "__main__":
    main()
