"""What is compared with the aluminium-bar experiment, measured alike in a run and, where it can be, in the experiment."""

import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "src/output/plots"))

from talus_results import Results  # noqa: E402,F401

AREA = 0.2 * 0.1      # of the block [m2]
STILL = 1e-3          # soil that moved less is still [m]
STRIP = 0.01          # width over which the height of the deposit and the failure line are taken [m]
LINE = (0.02, 0.18)   # where the failure line was measured [m]
FOOT = (0.10, 0.18)   # its lower half, which a straight line carries on to the base [m]
THIN = 1.5e-3         # height of the outermost measured point [m]


def measured(name):
    """Points x, y [m] of measured_surface.csv or measured_failure.csv."""
    return np.genfromtxt(HERE / f"measured_{name}.csv", delimiter=",", skip_header=3)


def heights(snapshot, width=STRIP):
    """Middles of strips, and the area of soil in each over its width [m]: a height that conserves the area."""
    x, mass = snapshot.position()[:, 0], snapshot.column("mass").values[:, 0]
    strip = (x / width).astype(int)
    area = np.bincount(strip, weights=mass) / mass.sum() * AREA
    return (np.arange(len(area)) + 0.5) * width, area / width


def profile_error(snapshot):
    """Mean of |height - measured| over the strips from the wall to the measured toe [m]."""
    surface = measured("surface")
    x, height = heights(snapshot)
    within = np.arange(0.5 * STRIP, surface[-1, 0] + 0.5 * STRIP, STRIP)
    return np.abs(np.interp(within, x, height, right=0) - np.interp(within, *surface.T)).mean()


def toe(snapshot, share=0.995):
    """Where this share of the mass lies behind [m]."""
    x, mass = snapshot.position()[:, 0], snapshot.column("mass").values[:, 0]
    order = np.argsort(x)
    return x[order][np.searchsorted(np.cumsum(mass[order]), share * mass.sum())]


def measured_toe(share=0.995):
    """Where this share of the measured area lies behind [m]."""
    surface = measured("surface")
    x = np.linspace(0, surface[-1, 0], 10000)
    area = np.cumsum(np.interp(x, *surface.T))
    return x[np.searchsorted(area, share * area[-1])]


def thin_end(snapshot):
    """Where the height first falls below THIN [m]."""
    x, height = heights(snapshot)
    k = int(np.argmax(height < THIN)) if (height < THIN).any() else len(height) - 1
    return x[k - 1] + STRIP * (height[k - 1] - THIN) / (height[k - 1] - height[k])


def failure_line(snapshot):
    """Boundary between still and moved soil, x and y [m]: in each strip half-way from the highest still particle to the
    lowest moved one."""
    position, moved = snapshot.position(), snapshot.scalar("displacement")[0] >= STILL
    points = []
    for left in np.arange(LINE[0], LINE[1] - 0.5 * STRIP, STRIP):
        inside = (position[:, 0] >= left) & (position[:, 0] < left + STRIP)
        if (inside & moved).any():
            top = position[inside & ~moved, 1].max(initial=0)
            points.append((left + STRIP / 2, (top + position[inside & moved, 1].min()) / 2))
    return np.array(points)


def line_error(line):
    """Mean of |y - measured| along the failure line [m]."""
    return np.abs(line[:, 1] - np.interp(line[:, 0], *measured("failure").T)).mean()


def foot(line, between=FOOT):
    """Where the straight line through the points of a range of x reaches the base [m], and its dip [deg]."""
    chosen = (line[:, 0] > between[0] - 1e-3) & (line[:, 0] < between[1])
    slope, height = np.polyfit(*line[chosen].T, 1)
    return -height / slope, np.degrees(np.arctan(-slope))


def measures(snapshot):
    """Name -> number, all in metres but the dip."""
    line = failure_line(snapshot)
    lower, dip = foot(line)
    whole, _ = foot(line, LINE)
    return {"profile": profile_error(snapshot), "toe": toe(snapshot), "thin_end": thin_end(snapshot),
            "foot": lower, "foot_whole": whole, "dip": dip, "line": line_error(line)}


# as numbers.toml asks for them, each of the run's last state
MEASURES = {name: lambda results, name=name: measures(results.snapshots[-1])[name]
            for name in ("profile", "toe", "thin_end", "foot", "foot_whole", "dip", "line")}
