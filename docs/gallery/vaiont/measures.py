"""Measures of this page alone, written like those of src/output/plots/talus_measures.py. Displacements count from the start of the stage "water"."""

import numpy as np

KINK = np.array([550.6, 640.0])  # of the base
WINDOW = 2.0  # s; a mean speed over it is without vibration


def levels(results):
    """Level of the water above the horizontal plane in the rows of the history [m]; below zero before it rises."""
    history = results.history
    of_load = np.interp(history.columns["load_time_s"], *np.array(results.scene["functions"]["hw"], float).T)
    return np.where(np.isin(history.stage, ("water", "slide")), of_load, -1.0)


def way(results, point):
    """Displacement of a point in the rows of the history [m]; an array of the components x and y."""
    columns = results.history.columns
    moved = np.array([columns[f"{point}_displacement_{axis}_m"] for axis in "xy"])
    before = np.flatnonzero(levels(results) < 0)
    return moved - moved[:, before[-1] if len(before) else 0, None] * (not results.scene["stage"][1].get("reset_displacement", False))


def mean_speed(results, point):
    """Mean speed of a point over the last WINDOW in the rows of the history [m/s]; none of it before the water rises."""
    time, moved = results.history.time, way(results, point)
    begin = time[np.flatnonzero(levels(results) >= 0)[0]]
    earlier = np.array([np.interp(np.maximum(time - WINDOW, begin), time, part) for part in moved])
    return np.where(time > begin, np.linalg.norm(moved - earlier, axis=0), 0) / WINDOW


def displacement_at_level(results, point, level):
    """Displacement of a point when the rising water reached a level [m]."""
    return np.linalg.norm(way(results, point), axis=0)[np.flatnonzero(levels(results) >= level - 1e-9)[0]]


def displacement_before_slide(results, point):
    """Displacement of a point at the end of the stage "water" [m]."""
    return np.linalg.norm(way(results, point), axis=0)[np.flatnonzero(np.array(results.history.stage) == "water")[-1]]


def level_of_failure(results, point, speed=0.1):
    """Level of the water when the mean speed of a point passed a value [m]; nan where it never did."""
    passed = np.flatnonzero((np.array(results.history.stage) == "water") & (mean_speed(results, point) > speed))
    return levels(results)[passed[0]] if len(passed) else np.nan


def mean_speed_in_stage(results, point, stage):
    """Largest mean speed of a point in a stage [m/s]."""
    return mean_speed(results, point)[np.array(results.history.stage) == stage].max()


def speed_in_stage(results, point, stage):
    """Largest speed of a point in a stage [m/s]."""
    rows = np.array(results.history.stage) == stage
    return results.history.columns[f"{point}_velocity_m_s"][rows].max()


def run_out(results, point):
    """Largest horizontal displacement of a point [m], to whichever side."""
    return np.abs(way(results, point)[0]).max()


def at_load(results, t):
    """The snapshot of the stages "water" and "slide" nearest to a load time [s]; the last before them for 0."""
    rows = np.array(results.history.stage) == "water"
    begin = results.history.time[rows][0] - results.history.columns["load_time_s"][rows][0]
    return min(results.snapshots, key=lambda each: abs(each.time - begin - t))


def plane_of_motion(results, start, end, upper="m4", lower="m10"):
    """Inclination of the plane between the wedges by how the rock moved between two load times [deg]: from the horizontal, uphill side,
    so that 90 is vertical and 108 the bisector. The wedges keep together if their velocities have the same component across it."""
    rows = np.isin(results.history.stage, ("water", "slide"))
    load = results.history.columns["load_time_s"][rows]
    above, below = (np.array([np.interp(end, load, part) - np.interp(start, load, part) for part in way(results, point)[:, rows]]) for point in (upper, lower))
    across = above - below
    return np.degrees(np.arctan2(across[1], -across[0])) % 180


def plane_of_strain(results, start, end, reach=120.0, foot=15.0):
    """The same by a line through the band where plastic strain grew between two load times, weighted by its growth: the inclination [deg]
    and the root of the mean square distance from the line [m]. Only rock within `reach` of the kink sideways and above `foot` counts."""
    first, last = at_load(results, start), at_load(results, end)
    grown = last.scalar("plastic_strain")[0] - first.scalar("plastic_strain")[0]
    place = last.position()[:, :2] - KINK
    inside = (np.abs(place[:, 0]) < reach) & (place[:, 1] > foot) & (grown > 0)
    weight, place = grown[inside] * last.column("volume").values[inside, 0], place[inside]
    away = place - np.average(place, axis=0, weights=weight)
    spread, axes = np.linalg.eigh(np.einsum("p,pi,pj->ij", weight, away, away) / weight.sum())
    return np.degrees(np.arctan2(axes[1, 1], -axes[0, 1])) % 180, np.sqrt(spread[0])


MEASURES = {each.__name__: each for each in (displacement_at_level, displacement_before_slide, level_of_failure, mean_speed_in_stage, speed_in_stage, run_out,
                                             plane_of_motion)}
MEASURES["plane_of_strain"] = lambda results, start, end: plane_of_strain(results, start, end)[0]
