#!/usr/bin/python3
"""The terrain of this page, mountain.asc: the flank of a mountain with a winding gully, and relief at all scales. `terrain.py` writes it anew.

East x and north y in m from the corner (500000, 5200000):

    z = 1000 + 520 exp(-x / 800) + 55 (1 - exp(-((y - y_c) / 130)^2)) + relief,    y_c = 300 + 90 sin(2 pi (x - 100) / 1300)

The flank falls with 33 degrees at x = 0 and 6 degrees at x = 1400 m; the gully follows y_c. The relief is a sum of waves of 400, 200, 100, 50 and 25 m, four
directions each, with amplitudes of 0.5 % of their length: as rough at one scale as at the next.
"""

import pathlib

import numpy as np

COLUMNS, ROWS, CELL = 141, 61, 10  # values, and the distance between them [m]
CORNER = (500000, 5200000)  # as a national grid has it [m]
DIRECTIONS = 4


def elevation(x, y):
    middle = 300 + 90 * np.sin(2 * np.pi * (x - 100) / 1300)
    z = 1000 + 520 * np.exp(-x / 800) + 55 * (1 - np.exp(-(((y - middle) / 130) ** 2)))
    random = np.random.default_rng(20)
    for length in (400, 200, 100, 50, 25):
        for azimuth, phase in zip(random.uniform(0, np.pi, DIRECTIONS), random.uniform(0, 2 * np.pi, DIRECTIONS)):
            z = z + 0.005 * length * np.sin(2 * np.pi * (x * np.sin(azimuth) + y * np.cos(azimuth)) / length + phase)
    return z


def main():
    x, y = np.meshgrid(CELL * np.arange(COLUMNS), CELL * np.arange(ROWS))
    head = f"ncols {COLUMNS}\nnrows {ROWS}\nxllcenter {CORNER[0]}\nyllcenter {CORNER[1]}\ncellsize {CELL}\nNODATA_value -9999\n"
    rows = [" ".join(f"{value:.2f}" for value in row) for row in elevation(x, y)[::-1]]
    (pathlib.Path(__file__).parent / "mountain.asc").write_text(head + "\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
