#!/usr/bin/python3
"""Draws what scenes of the guide model, each as NAME.png in few colours.  models.py TALUS"""
import subprocess
import sys
from pathlib import Path

from PIL import Image

HERE = Path(__file__).parent
for name in ("anchors", "factor", "fill", "wedge"):
    picture = HERE / f"{name}.png"
    subprocess.run([sys.argv[1], "check", HERE / f"{name}.toml", "--picture", picture], check=True, stdout=subprocess.DEVNULL)
    Image.open(picture).convert("RGB").quantize(64, Image.Quantize.MAXCOVERAGE).save(picture, optimize=True)
