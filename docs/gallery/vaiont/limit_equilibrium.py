#!/usr/bin/python3
"""Factor of safety of the section by limit equilibrium of two wedges, independent of the program: the least over all inclinations
of the plane between them.

    limit_equilibrium.py [SECTION.csv]     # table over the water level, for both flow rules of the rock

The upper wedge slides on the inclined plane, the lower one on the horizontal plane, and both against each other on a plane through
the kink. Strength of rock and base is divided by the same factor. Rock with psi = 0 has the strength of Davis (1968) on the plane
between the wedges, beta c and beta tan(phi) with beta = cos(phi) of the divided strength; the base is a plane already and has its
own friction. Water is hydrostatic below the level, inside the mass and on its toe. Units: m, kN, kPa, degrees.
"""
import csv
import math
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
SECTION = HERE.parents[2] / "meshes/vaiont.csv"
GRAVITY, SOLID, WATER, POROSITY = 9.81, 2.7, 1.0, 0.2  # [m/s2], [t/m3]
PEAK, RESIDUAL = (300.0, 42.0), (0.0, 36.0)            # cohesion [kPa], friction angle [deg]
LEVELS = (0, 30, 53, 57, 60)                           # of the water above the horizontal plane [m]
LOWER_HEAD = 9.5                                       # by which the ground of the head is lower where the lake does not rest on the toe [m]


def read_section(path):
    """Ground, from the scarp to the top of the toe; kink of the base; foot of the toe."""
    with open(path) as file:
        rows = [r for r in csv.reader(line for line in file if not line.startswith("#"))][1:]
    of = lambda part: [(float(x), float(y)) for name, x, y in rows if name == part]
    ground, (_, kink, foot) = of("interface0"), of("b_slide_surface")
    return ground[:-1], kink, foot


def below(polygon, level):
    """Area and its share below a level, by cutting the polygon."""
    def area(points):
        x, y = np.array(points).T
        return abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
    wet = []
    for a, b in zip(polygon, polygon[1:] + polygon[:1]):
        if a[1] <= level:
            wet.append(a)
        if (a[1] - level) * (b[1] - level) < 0:
            s = (level - a[1]) / (b[1] - a[1])
            wet.append((a[0] + s * (b[0] - a[0]), level))
    return area(polygon), area(wet) if len(wet) > 2 else 0.0


def wedges(ground, kink, foot, angle):
    """Polygons of the wedges for a plane at `angle` to the horizontal, measured from uphill, and its length."""
    direction = np.array([-math.cos(angle), math.sin(angle)])
    for k, (a, b) in enumerate(zip(ground, ground[1:])):
        side = np.subtract(b, a)
        system = np.column_stack([direction, -side])
        if abs(np.linalg.det(system)) < 1e-12:
            continue
        length, share = np.linalg.solve(system, np.subtract(a, kink))
        if length > 0 and 0 <= share <= 1:
            top = tuple(np.add(kink, length * direction))
            return [kink, top] + ground[k::-1], [kink, top] + ground[k + 1:] + [foot], length
    return None


def factor(section, level, base, rock, angle, dilating, thrust=True):
    """Factor of safety for one plane between the wedges; infinity where there is none."""
    ground, kink, foot = section
    split = wedges(ground, kink, foot, angle)
    if split is None:
        return math.inf
    upper, lower, length = split
    unit, zero = WATER * GRAVITY, kink[1]
    weight = []
    for polygon in (upper, lower):
        area, wet = below(polygon, zero + level)
        weight.append(GRAVITY * (SOLID * (1 - POROSITY) * area + WATER * POROSITY * wet))
    dip = math.atan2(ground[0][1] - kink[1], kink[0] - ground[0][0])
    on_slope, on_plane = unit * level**2 / 2 / math.sin(dip), unit * level * (foot[0] - kink[0])
    between, on_toe = unit * level**2 / 2 / math.sin(angle), unit * level**2 / 2 if thrust else 0.0
    normal, up = np.array([math.sin(dip), math.cos(dip)]), np.array([-math.cos(dip), math.sin(dip)])
    push, along = np.array([-math.sin(angle), -math.cos(angle)]), np.array([-math.cos(angle), math.sin(angle)])

    def missing(F):
        """Force that drives the lower wedge beyond its friction."""
        tangent, cohesion = math.tan(math.radians(rock[1])) / F, rock[0] / F
        if not dilating:
            beta = math.cos(math.atan(tangent))
            tangent, cohesion = beta * tangent, beta * cohesion
        friction = math.tan(math.radians(base)) / F
        system = np.column_stack([normal + friction * up, push + tangent * along])
        known = on_slope * normal + between * push + cohesion * length * along + [0, -weight[0]]
        pressing, squeezing = np.linalg.solve(system, -known)
        if pressing < 0 or squeezing < 0:
            return math.nan
        force = -(squeezing + between) * push - (tangent * squeezing + cohesion * length) * along
        return force[0] - on_toe - friction * (weight[1] - force[1] - on_plane)

    low, high = 0.3, 5.0
    if not missing(high) > 0:
        return math.inf
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (low, middle) if missing(middle) > 0 else (middle, high)
    return (low + high) / 2


def least(section, level, base=12.0, rock=PEAK, dilating=False, thrust=True):
    """Least factor over all inclinations, and that inclination."""
    return min((factor(section, level, base, rock, math.radians(a), dilating, thrust), a) for a in np.arange(45, 135.5, 0.5))


def print_tables(path):
    section = read_section(path)
    ground, kink, foot = section
    area = below(ground + [foot, kink], 0)[0]
    print(f"area {area:.0f} m2, dip {math.degrees(math.atan2(ground[0][1] - kink[1], kink[0] - ground[0][0])):.1f} deg, "
          f"{np.interp(kink[0], *np.array(ground).T) - kink[1]:.0f} m over the kink")
    lower = ([ground[0], (ground[1][0], ground[1][1] - LOWER_HEAD), *ground[2:]], kink, foot)
    print("level_m,peak_psi_0,angle,peak_psi_phi,residual_psi_0,no_lake,no_lake_lower_head,no_lake_base_12.3")
    for level in LEVELS:
        peak, angle = least(section, level)
        others = (least(section, level, dilating=True), least(section, level, rock=RESIDUAL), least(section, level, thrust=False),
                  least(lower, level, thrust=False), least(section, level, base=12.3, thrust=False))
        print(f"{level},{peak:.3f},{angle:.1f}," + ",".join(f"{factor:.3f}" for factor, _ in others))


if __name__ == "__main__":
    print_tables(sys.argv[1] if len(sys.argv) > 1 else SECTION)
