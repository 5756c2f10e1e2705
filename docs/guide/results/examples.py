#!/usr/bin/python3
"""Draws examples.png: the commands of docs/reference/python.md one after the other, and their pictures side by side.  examples.py TALUS FOLDER"""
import os
import subprocess
import sys
from pathlib import Path

from PIL import Image

HERE = Path(__file__).parent
SCENE = HERE.parent / "slope.toml"
talus, folder = sys.argv[1], Path(sys.argv[2])
folder.mkdir(parents=True, exist_ok=True)
modules = subprocess.run([talus, "--python-path"], check=True, capture_output=True, text=True).stdout.strip()


def draw(script, *words):
    subprocess.run([sys.executable, "-B", HERE / script, *map(str, words)], check=True, env={**os.environ, "PYTHONPATH": modules})


subprocess.run([talus, "run", SCENE, "-o", folder / "slope", "--no-pictures"], check=True)
subprocess.run([talus, "compare", SCENE, "--series", "residual: body.clay.residual_friction_angle=8,11,14,17", "-o", folder / "residual"], check=True)
draw("front.py", folder / "slope", folder / "front.png")
draw("profile.py", folder / "slope", "displacement", 12, folder / "profile.png", 17.5, 18, 20.5)
draw("outcomes.py", folder / "residual", folder / "outcomes.png")

front, profile, outcomes = (Image.open(folder / f"{name}.png").convert("RGB") for name in ("front", "profile", "outcomes"))
gap = 20  # pixels
width, height = max(front.width, outcomes.width), front.height + gap + outcomes.height
page = Image.new("RGB", (width + gap + profile.width, height), "white")
page.paste(front, (0, 0))
page.paste(outcomes, (0, front.height + gap))
page.paste(profile, (width + gap, (height - profile.height) // 2))
page.quantize(64).save(HERE / "examples.png", optimize=True)
