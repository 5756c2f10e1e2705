#!/usr/bin/python3
"""Factor of safety of the Selborne section at peak strength by Bishop's simplified method over circles, for excess pore pressures
e [kPa] at the base: with the excess under x < 24 m as in the scene, and everywhere. Takes some minutes."""
import numpy as np

WATER, SOIL = 9.81, 2.2 * 9.81  # unit weights [kN/m3]


def ground(x):
    return np.interp(x, [0, 18, 36, 56], [15, 15, 6, 6])


def factor(xc, yc, radius, excess, reach, slices=60):
    """Factor of safety of one circle; None where it is no slip circle of this slope."""
    if yc < radius:
        return None
    x = np.linspace(0, 56, 4001)
    inside = np.abs(x - xc) < radius
    inside &= yc - np.sqrt(np.maximum(radius**2 - (x - xc) ** 2, 0)) < ground(x)
    cut = np.flatnonzero(inside)
    if len(cut) < 50 or cut[-1] - cut[0] + 1 != len(cut) or cut[0] == 0:
        return None
    edges = np.linspace(x[cut[0]], x[cut[-1]], slices + 1)
    width, x = np.diff(edges), (edges[1:] + edges[:-1]) / 2
    rise = np.sqrt(radius**2 - (x - xc) ** 2)
    base = yc - rise
    height, angle = ground(x) - base, -np.arctan2(x - xc, rise)
    weight = SOIL * height * width
    pressure = WATER * height + np.where(x < reach, excess * (1 - base / ground(x)), 0)
    cohesion, friction = np.where(base > 7.5, 13, 25.0), np.tan(np.radians(np.where(base > 7.5, 24.5, 26.0)))
    driving = (weight * np.sin(angle)).sum()
    if driving <= 0:
        return None
    safety = 1.0
    for _ in range(60):
        m = np.cos(angle) + np.sin(angle) * friction / safety
        if (m < 0.1).any():
            return None
        previous, safety = safety, ((cohesion * width + (weight - pressure * width) * friction) / m).sum() / driving
        if abs(safety - previous) < 1e-6:
            break
    return safety if safety > 0.2 else None


for reach in (24, 56):
    for excess in (0, 45, 55, 63, 75, 86, 95):
        circles = ((factor(xc, yc, r, excess, reach), xc, yc, r)
                   for xc in np.arange(22, 44) for yc in np.arange(14, 50) for r in np.arange(5, yc, 0.5))
        best = min(c for c in circles if c[0])
        print(f"excess under x < {reach} m, {excess} kPa: F = {best[0]:.3f}, centre ({best[1]}, {best[2]}), radius {best[3]}", flush=True)
