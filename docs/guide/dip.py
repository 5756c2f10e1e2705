#!/usr/bin/python3
"""Draws dip.png: how `ellipsoid` counts dip and dip direction, seen from above and in the section along the dip direction."""
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Arc, Ellipse

SOIL, LINE, GREY = "#e8d5b0", "#0b7285", "#64748b"
A, B, C, DIP, DIRECTION = 3.0, 2.0, 1.1, np.radians(25), 60  # half lengths; the direction is an azimuth [degrees]


def arrow(axes, begin, end, text, at):
    axes.annotate("", xy=end, xytext=begin, arrowprops={"arrowstyle": "-|>", "color": LINE, "lw": 1.6})
    axes.text(*at, text, color=LINE, ha="center", va="center")


figure, (above, section) = plt.subplots(1, 2, figsize=(9, 3.9), layout="constrained")
towards = np.array([np.sin(np.radians(DIRECTION)), np.cos(np.radians(DIRECTION))])
across = np.array([-towards[1], towards[0]])
above.add_patch(Ellipse((0, 0), 2 * A * np.cos(DIP), 2 * B, angle=90 - DIRECTION, facecolor=SOIL, edgecolor=GREY))
above.annotate("", xy=(0, 3.4), xytext=(0, 0), arrowprops={"arrowstyle": "-|>", "color": GREY})
above.text(0, 3.7, "north (y)", color=GREY, ha="center")
arrow(above, (0, 0), 3.6 * towards, "dip direction", 4.2 * towards + (0.4, 0.1))
above.add_patch(Arc((0, 0), 3.4, 3.4, theta1=90 - DIRECTION, theta2=90, color=LINE))
above.text(1.0, 1.75, f"{DIRECTION}°", color=LINE, ha="center")
above.plot(*np.array([(0, 0), A * np.cos(DIP) * -towards]).T, color=GREY, lw=1)
above.text(*(-1.5 * towards + 0.3 * across), "a", color=GREY)
above.plot(*np.array([(0, 0), -B * across]).T, color=GREY, lw=1)
above.text(*(-1.1 * across + (0.1, 0.15)), "b", color=GREY)
above.set(title="seen from above", xlim=(-4, 5.6), ylim=(-3.2, 4.2), aspect="equal")

angle = np.linspace(np.pi, 2 * np.pi, 100)
spoon = np.array([A * np.cos(angle), C * np.sin(angle)])
spoon = np.array([[np.cos(DIP), np.sin(DIP)], [-np.sin(DIP), np.cos(DIP)]]) @ spoon
section.fill(*spoon, color=SOIL)
section.plot([-4.5, 4.5], [4.5 * np.tan(DIP), -4.5 * np.tan(DIP)], color="#333333")
section.plot(*spoon, color=LINE, lw=2)
down = np.array([np.cos(DIP), -np.sin(DIP)])
arrow(section, (0, 0), A * down, "", (0, 0))
section.text(*(1.4 * down + (0.15, 0.25)), "a", color=LINE)
section.plot(*np.array([(0, 0), C * np.array([-np.sin(DIP), -np.cos(DIP)])]).T, color=GREY, lw=1)
section.text(-0.05, -0.6, "c", color=GREY)
section.plot([0, 2.6], [0, 0], color=GREY, lw=0.8, ls="--")
section.add_patch(Arc((0, 0), 4, 4, theta1=-np.degrees(DIP), theta2=0, color=LINE))
section.text(2.2, -0.45, "dip", color=LINE)
section.plot(0, 0, "o", color=LINE, ms=4)
section.text(0.1, 0.25, "centre", color=LINE)
section.text(-4.4, 2.35, "ground", color="#333333")
section.text(-2.4, -0.75, "slip surface", color=LINE, ha="center")
section.set(title="section along the dip direction", xlim=(-4.6, 4.6), ylim=(-2.6, 2.9), aspect="equal")
for axes in (above, section):
    axes.axis("off")
figure.savefig(Path(__file__).with_name("dip.png"), dpi=130)
