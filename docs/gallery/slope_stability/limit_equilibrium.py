#!/usr/bin/python3
"""Factors of safety by limit equilibrium, independent of the program: the least factor of Morgenstern & Price (1965) with a
constant ratio of the forces between slices (Spencer 1967), over circles, circles cut off by a weak layer, and three-part
surfaces along it.

    limit_equilibrium.py              # prints the factors of SLOPES
    limit_equilibrium.py --davis      # the same with the strength of Davis (1968) for psi = 0

Equations: Zhu, Lee, Qian & Chen (2005), Canadian Geotechnical Journal 42(1), 272-278. Units: m, kPa, kN/m3, degrees.
"""
import math
import sys

import numpy as np
from scipy.optimize import minimize

SLICES = 60


class Slope:
    """Layers (top line or None for all below, c, phi, gamma), from the top down; `ground` and top lines are polylines, toe at the
    right. `seam`: height of a level slip line, if there is one. `ru`: pore pressure over the weight per area above."""

    def __init__(self, ground, layers, seam=None, deepest=-math.inf, ru=0):
        self.ground, self.layers, self.seam, self.deepest, self.ru = np.array(ground, float), layers, seam, deepest, ru

    def surface(self, x):
        return np.interp(x, *self.ground.T)

    def tops(self, x):
        ground = self.surface(x)
        return [ground if top is None else np.minimum(ground, np.interp(x, *np.array(top, float).T)) for top, *_ in self.layers]

    def weight_and_strength(self, x, y):
        """Weight per width of the columns from the ground down to y, and c and phi at their bases."""
        tops = self.tops(x)
        weight, c, phi = np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
        for k, (_, cohesion, friction, gamma) in enumerate(self.layers):
            below = tops[k + 1] if k + 1 < len(tops) else np.full_like(x, -1e9)
            weight += gamma * np.clip(tops[k] - np.maximum(below, y), 0, None)
            here = (y <= tops[k] + 1e-9) & (y > below + 1e-9)
            c[here], phi[here] = cohesion, math.radians(friction)
        return weight, c, phi


def factor(slope, x, y, davis=False):
    """Factor of safety of the slip line (x, y), or infinity where it is none."""
    middle, base = (x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2
    width, alpha = np.diff(x), np.arctan2(-np.diff(y), np.diff(x))
    if np.any(base > slope.surface(middle) + 1e-6) or np.any(base < slope.deepest - 1e-6) or alpha.min() < -math.radians(45):
        return math.inf
    weight, c, phi = slope.weight_and_strength(middle, base)
    weight = weight * width
    F, ratio = 1.2, 0.1
    for _ in range(300):
        tangent, cohesion = np.tan(phi), c
        if davis:  # strength on a slip plane of soil with psi = 0, at the reduced strength: both times cos(phi_F)
            lost = np.cos(np.arctan(tangent / F))
            tangent, cohesion = tangent * lost, c * lost
        resisting = weight * (np.cos(alpha) - slope.ru / np.cos(alpha)) * tangent + cohesion * width / np.cos(alpha)
        driving = weight * np.sin(alpha)
        inner = np.where(np.arange(len(alpha)) < len(alpha) - 1, 1.0, 0.0)  # no force behind the last slice
        outer = np.concatenate([[0.0], inner[:-1]])
        phi_now = (np.sin(alpha) - ratio * inner * np.cos(alpha)) * tangent + (np.cos(alpha) + ratio * inner * np.sin(alpha)) * F
        psi = ((np.sin(alpha) - ratio * outer * np.cos(alpha)) * tangent + (np.cos(alpha) + ratio * outer * np.sin(alpha)) * F)[1:] / phi_now[:-1]
        if np.any(phi_now <= 0) or np.any(psi <= 0):
            return math.inf
        carried = np.concatenate([np.cumprod(psi[::-1])[::-1], [1.0]])
        new = (resisting * carried).sum() / (driving * carried).sum()
        if not 0.05 < new < 50:
            return math.inf
        force = np.zeros(len(alpha) + 1)
        for i in range(len(alpha)):
            before = psi[i - 1] * force[i] * phi_now[i - 1] if i else 0.0
            force[i + 1] = (before + new * driving[i] - resisting[i]) / phi_now[i]
        force[-1] = 0
        share = (width * (force[1:] + force[:-1]) * np.tan(alpha)).sum() / (width * (inner * force[1:] + outer * force[:-1])).sum()
        settled = abs(new - F) < 1e-6 and abs(share - ratio) < 1e-5
        F, ratio = (F + new) / 2 if davis else new, min(max((ratio + share) / 2, -1.0), 1.5)
        if settled:
            return F
    return math.inf


def circle(slope, entry, exit, depth, seam=None):
    """The arc from `entry` to `exit` on the ground that sags by `depth`; not deeper than a seam."""
    a, b = np.array([entry, slope.surface(entry)]), np.array([exit, slope.surface(exit)])
    chord = b - a
    length = np.hypot(*chord)
    if length < 0.5 or depth < 0.01 * length or depth > 0.9 * length:
        return None
    radius = (length**2 / 4 + depth**2) / (2 * depth)
    normal = np.array([-chord[1], chord[0]]) / length
    centre = (a + b) / 2 + normal * (radius - depth)
    x = np.linspace(a[0], b[0], SLICES + 1)
    inside = radius**2 - (x - centre[0])**2
    if np.any(inside < 0) or centre[0] - radius > a[0]:
        return None
    y = centre[1] - np.sqrt(inside)
    y[0], y[-1] = a[1], b[1]
    return x, y if seam is None else np.maximum(y, seam)


def along_seam(slope, entry, first, second, exit):
    """Down from the ground at `entry` to the seam, along it, and up to the ground at `exit`."""
    if not entry < first < second < exit:
        return None
    corner = np.array([entry, first, second, exit])
    height = np.array([slope.surface(entry), slope.seam, slope.seam, slope.surface(exit)])
    x = np.unique(np.concatenate([np.linspace(p, q, SLICES // 3 + 1) for p, q in zip(corner, corner[1:])]))
    return x, np.interp(x, corner, height)


def least(slope, davis=False):
    """(factor, kind of surface, its parameters) of the worst surface."""
    left, right = slope.ground[0][0], slope.ground[-1][0]
    span = right - left
    best = (math.inf, "", None)
    rng = np.random.default_rng(1)
    kinds = {"circle": (3, lambda p: circle(slope, *p))}
    if slope.seam is not None:
        kinds |= {"circle cut off by the seam": (3, lambda p: circle(slope, *p, seam=slope.seam)), "along the seam": (4, lambda p: along_seam(slope, *p))}
    for kind, (count, make) in kinds.items():
        def value(p):
            if not (left <= p[0] < p[-1 if count == 4 else 1] <= right):
                return 1e3
            line = make(p)
            if line is None:
                return 1e3
            found = factor(slope, *line, davis)
            return found if math.isfinite(found) else 1e3
        tried = []
        for _ in range(1500):
            p = np.sort(left + span * rng.random(4)) if count == 4 else [*np.sort(left + span * rng.random(2)), span * 0.4 * rng.random()**2]
            tried.append((value(p), tuple(p)))
        for _, start in sorted(tried)[:8]:
            found = minimize(value, start, method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-5, "maxiter": 800})
            if found.fun < best[0]:
                best = (float(found.fun), kind, [round(float(v), 2) for v in found.x])
    return best


SLOPES = {
    "ACADS-1a": Slope([(20, 35), (50, 35), (70, 25), (80, 25)], [(None, 3, 19.6, 20)], deepest=20),
    "AT-1": Slope([(0, 35), (18, 35), (48, 15), (66, 15)], [(None, 41.65, 15, 18.82)], deepest=0),
    "GL-1": Slope([(0, 15.24), (18.288, 15.24), (48.768, 0)], [(None, 14.9626, 20, 19.6359)], deepest=0),
    "GL-2": Slope([(0, 15.24), (18.288, 15.24), (48.768, 0), (79.248, 0)], [(None, 14.9626, 20, 19.6359)], deepest=-7.62),
    "SP-1969": Slope([(-10, 40), (10, 40), (70, 10), (100, 10)], [(None, 10.8, 40, 18)], deepest=0, ru=0.5),
    "weak seam": Slope([(0, 10), (15, 10), (35, 0), (50, 0)],
                       [(None, 10, 30, 19), ([(0, -1), (50, -1)], 2, 12, 18)], seam=-1.39, deepest=-1.4),
    "layered": Slope([(0, 10), (15, 10), (35, 0), (50, 0)],
                     [(None, 0, 36, 18), ([(0, 5), (50, 5)], 8, 20, 19), ([(0, -3), (50, -3)], 20, 28, 20)], deepest=-8),
}

if __name__ == "__main__":
    davis = "--davis" in sys.argv[1:]
    for name, slope in SLOPES.items():
        found, kind, parameters = least(slope, davis)
        print(f"{name}: {found:.3f}, {kind} {parameters}", flush=True)
