#!/usr/bin/python3
"""Way of an elastic block on a level base that weakens with slip, for `weakens_with_the_slip_of_the_place`.

The block (plane strain, Poisson's ratio 0) slides as a whole and is in elastic equilibrium with its deceleration. The base
holds its lower side at y = 0 and rubs with tan(phi(slip of the place)) times the normal stress, which therefore follows
from elasticity. It is not that of a rigid block: at the front it is up to 2.7 times the mean, on ground that has slipped
least. Finite elements: bilinear squares, whose forces at the base are linear in friction and deceleration.
"""
import numpy as np

GRAVITY, DENSITY, LENGTH, HEIGHT, SPEED = 9.81, 2000.0, 1.0, 0.2, 3.5


def friction(slip: np.ndarray) -> np.ndarray:
    return np.tan(np.radians(8 + 22 * np.exp(-slip / 0.3)))


def normal_forces(nx: int, ny: int) -> np.ndarray:
    """Forces at the nodes of the base (columns) by weight, by a unit acceleration and by a unit thrust at each of them."""
    hx, hy = LENGTH / nx, HEIGHT / ny
    element = np.zeros((8, 8))
    for a in (-(3**-0.5), 3**-0.5):
        for b in (-(3**-0.5), 3**-0.5):
            slope = np.array([[-(1 - b), 1 - b, 1 + b, -(1 + b)], [-(1 - a), -(1 + a), 1 + a, 1 - a]]) / 4 * [[2 / hx], [2 / hy]]
            strain = np.zeros((3, 8))
            strain[0, 0::2] = strain[2, 1::2] = slope[0]
            strain[1, 1::2] = strain[2, 0::2] = slope[1]
            element += strain.T @ np.diag([1, 1, 0.5]) @ strain * hx * hy / 4
    size, base = 2 * (nx + 1) * (ny + 1), np.arange(nx + 1)
    stiffness, load = np.zeros((size, size)), np.zeros((size, nx + 3))
    for j in range(ny):
        for i in range(nx):
            node = j * (nx + 1) + i + np.array([0, 1, nx + 2, nx + 1])
            rows = np.stack([2 * node, 2 * node + 1], axis=1).ravel()
            stiffness[np.ix_(rows, rows)] += element
            load[2 * node + 1, 0] -= DENSITY * GRAVITY * hx * hy / 4
            load[2 * node, 1] -= DENSITY * hx * hy / 4
    load[2 * base, 2 + base] = 1
    held = np.append(2 * base + 1, 2 * (nx // 2))
    free = np.setdiff1d(np.arange(size), held)
    moved = np.zeros_like(load)
    moved[free] = np.linalg.solve(stiffness[np.ix_(free, free)], load[free])
    return (stiffness @ moved - load)[2 * base + 1]


def way(nx: int, ny: int, step: float) -> float:
    force, mass = normal_forces(nx, ny), DENSITY * LENGTH * HEIGHT
    along = np.linspace(0, LENGTH, nx + 1)[:, None] + ((np.arange(8) + 0.5) / 8 - 0.5) * LENGTH / nx
    along = np.clip(along, 0, LENGTH)
    slid, speed = 0.0, SPEED
    while speed > 0:
        place = along + slid
        rub = friction(np.where(place <= LENGTH, slid, slid - (place - LENGTH))).mean(axis=1)
        pressed = np.linalg.solve(np.eye(nx + 1) + force[:, 2:] * rub + np.outer(force[:, 1], rub) / mass, force[:, 0])
        speed -= rub @ pressed / mass * step
        slid += speed * step
    return slid


for cells in ((40, 8), (80, 16)):
    print(f"{cells[0]} by {cells[1]} elements: {way(*cells, 1e-3):.4f} m")
