#!/usr/bin/python3
"""Draws the element tests of the laws' pages: draw.py TALUS [NAME ...] runs `TALUS soil NAME.toml` and keeps its plot as NAME.png."""

import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

here = pathlib.Path(__file__).parent
talus, names = sys.argv[1], sys.argv[2:] or sorted(p.stem for p in here.glob("*.toml"))
for name in names:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([talus, "soil", here / f"{name}.toml", "-o", folder], check=True)
        picture = Image.open(pathlib.Path(folder) / "soil.png").convert("RGB")
        picture.resize((1100, round(1100 * picture.height / picture.width)), Image.LANCZOS).quantize(256).save(here / f"{name}.png", optimize=True)
