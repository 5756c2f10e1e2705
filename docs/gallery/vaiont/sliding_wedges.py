#!/usr/bin/python3
"""How far and how fast two rigid wedges slide while the water rises, independent of the program:  sliding_wedges.py [TABLE.csv]

The wedges of limit_equilibrium.py with a vertical plane through the kink, which has the least factor of safety but for half a percent.
Rock that passes the plane leaves the slope for the horizontal part of the base, so that the upper wedge gets lighter and the ground
sinks: x is the horizontal way of both wedges. Their two momentum balances give the normal forces of slope, plane and horizontal base
and the acceleration; the rock on the plane softens with the slip x tan(dip) in a band of the scene's width, as in theory (2.7), and
rock that reaches the plane later is taken for softened. Nothing else resists. Units: m, s, t, kN, kPa, degrees.
"""
import csv
import math
import pathlib
import sys

import numpy as np

from limit_equilibrium import GRAVITY, HERE, PEAK, POROSITY, RESIDUAL, SECTION, SOLID, WATER, read_section

LEVEL = np.array([(0, 0), (20, 30), (40, 53), (50, 57), (60, 60)], float).T  # times [s] and levels of the scene
BASE, SHAPE, BAND = 12.0, 150.0, 24.0  # friction angle of the base, eta, reference_size
CASES = (("rock at its peak", 1.0, 1.0), ("rock that has lost half of what it can lose", 0.5, 1.0), ("rock at its residual strength", 0.0, 1.0),
         ("rock at its peak, all strength 2 % higher", 1.0, 1.02), ("rock that has lost half, all strength 2 % higher", 0.5, 1.02),
         ("rock at its residual strength, all strength 2 % higher", 0.0, 1.02))
COLUMNS = ("case", "starts_at_m", "at_53_m", "at_60_m", "rest_m", "speed_m_s")


class Wedges:
    """The section in vertical slices, moved by x."""

    def __init__(self, path):
        ground, self.kink, self.foot = read_section(path)
        corners = np.array(ground)
        self.x = np.linspace(corners[0, 0], corners[-1, 0], 2001)
        self.y = np.interp(self.x, *corners.T)
        self.slope = (corners[0, 1] - self.kink[1]) / (self.kink[0] - corners[0, 0])

    def areas(self, moved, level):
        """Area and area below the water of the upper and of the lower wedge, and the length of the plane between them."""
        x, width = self.x + moved, self.x[1] - self.x[0]
        y = self.y - self.slope * np.clip(self.kink[0] - self.x, 0, moved)
        bed = self.kink[1] + self.slope * np.clip(self.kink[0] - x, 0, None)
        high, wet, upper = np.clip(y - bed, 0, None), np.clip(np.minimum(y, self.kink[1] + level) - bed, 0, None), x < self.kink[0]
        return [(width * high[part].sum(), width * wet[part].sum()) for part in (upper, ~upper)], np.interp(self.kink[0], x, y) - self.kink[1]

    def acceleration(self, moved, level, cohesion, friction, strength):
        """Horizontal acceleration of both wedges [m/s2]; all strength is multiplied by `strength`."""
        (upper, lower), length = self.areas(moved, level)
        mass = [SOLID * (1 - POROSITY) * area + WATER * POROSITY * wet for area, wet in (upper, lower)]
        dip, unit = math.atan(self.slope), WATER * GRAVITY
        on_slope, on_plane = unit * level**2 / 2 / math.sin(dip), unit * level * (self.foot[0] + moved - self.kink[0])
        normal, up = np.array([math.sin(dip), math.cos(dip)]), np.array([-math.cos(dip), math.sin(dip)])
        push, along = np.array([-1.0, 0.0]), np.array([0.0, 1.0])
        thrust = unit * level**2 / 2  # of the water between the wedges and of that on the toe
        tangent = strength * math.tan(math.radians(friction))
        davis = math.cos(math.atan(tangent))
        tangent, force, rub = davis * tangent, davis * strength * cohesion * length, strength * math.tan(math.radians(BASE))
        system, known = np.zeros((4, 4)), np.zeros(4)  # of the effective normal forces of slope, plane and base, and the acceleration
        system[:2, 0], system[:2, 1], system[:2, 3] = normal + rub * up, push + tangent * along, [-mass[0], mass[0] * self.slope]
        known[:2] = on_slope * normal + thrust * push + force * along + [0, -GRAVITY * mass[0]]
        system[2:, 1], system[2:, 2], system[2:, 3] = -push - tangent * along, [-rub, 1], [-mass[1], 0]
        known[2:] = -thrust * push - force * along + [-thrust, on_plane - GRAVITY * mass[1]]
        return np.linalg.solve(system, -known)[3]

    def slide(self, share, strength, step=0.02):
        """Time, level, way and speed until rest at the last level; the rock starts with `share` of what softening takes from it."""
        time = way = speed = 0.0
        rows = []
        while time < LEVEL[0, -1] or speed > 0:
            level = np.interp(time, *LEVEL)
            left = share * math.exp(-SHAPE * way * self.slope / (math.sqrt(3) * BAND))
            cohesion, friction = (low + left * (high - low) for low, high in zip(RESIDUAL, PEAK))
            speed = max(0.0, speed + step * self.acceleration(way, level, cohesion, friction, strength))
            way, time = way + step * speed, time + step
            rows.append((time, level, way, speed))
        return np.array(rows).T


def table():
    wedges = Wedges(SECTION)
    for case, share, strength in CASES:
        time, level, way, speed = wedges.slide(share, strength)
        starts = f"{level[np.argmax(speed > 0)]:.0f}" if way[-1] else "stands"
        at = {f"at_{h}_m": f"{np.interp(np.interp(h, *LEVEL[::-1]), time, way):.1f}" for h in (53, 60)}
        yield {"case": case, "starts_at_m": starts, **at, "rest_m": f"{way[-1]:.1f}", "speed_m_s": f"{speed.max():.2f}"}


if __name__ == "__main__":
    with open(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "wedges.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader(), writer.writerows(table())
