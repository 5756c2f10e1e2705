"""What the page on Vaiont states besides the measures of all pages. Displacements are horizontal and count from the start of the stage "water"."""

import numpy as np

from talus_lines import means

KINK = np.array([550.6, 640.0])  # of the base
WINDOW = 2.0  # s; a mean speed over it is without vibration
MOVING = ("water", "slide")


def levels(results):
    """Level of the water above the horizontal plane in the rows of the history [m]; below zero before it rises."""
    history, rising = results.history, results.scene["functions"]["hw"]
    table = np.array(rising if isinstance(rising, list) else [[0, rising]], float)
    return np.where(np.isin(history.stage, MOVING), np.interp(history.columns["load_time_s"], *table.T), -1.0)


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


def rows_of(results, stage):
    return np.flatnonzero(np.array(results.history.stage) == stage)


def way_at_level(results, point, level):
    """Way of a point when the rising water reached a level [m]; nan where it never did."""
    reached = np.flatnonzero(levels(results) >= level - 1e-9)
    return way(results, point)[0][reached[0]] if len(reached) else np.nan


def way_before_slide(results, point):
    """Way of a point at the end of the stage "water" [m]."""
    return way(results, point)[0][rows_of(results, "water")[-1]]


def way_in_all(results, point):
    """Largest way of a point in the run [m]."""
    return way(results, point)[0].max()


def mean_speed_in_stage(results, point, stage):
    """Largest mean speed of a point in a stage [m/s]."""
    return mean_speed(results, point)[rows_of(results, stage)].max()


def mean_speed_left(results, point):
    """Mean speed of a point at the end of the stage "water" [m/s]."""
    return mean_speed(results, point)[rows_of(results, "water")[-1]]


def speed_in_stage(results, point, stage):
    """Largest speed of a point in a stage [m/s]."""
    return results.history.columns[f"{point}_velocity_m_s"][rows_of(results, stage)].max()


def energy_of_slide(results):
    """From the start of the stage "slide" to its largest kinetic energy [J per m of width]: works of gravity, water and base, what the rock dissipates, the
    kinetic energy gained; besides, the drop of the centre of mass [m] and the mean speed if nothing but gravity and water worked [m/s]."""
    columns, rows = results.history.columns, rows_of(results, "slide")
    last, mass = rows[columns["kinetic_J"][rows].argmax()], columns["mass_kg"][rows[0]]
    gained = {name: columns[column][last] - columns[column][rows[0]] for name, column in
              (("gravity", "work_gravity_J"), ("water", "work_imposed_J"), ("base", "work_bed_J"), ("rock", "dissipated_J"), ("kinetic", "kinetic_J"))}
    return gained | {"drop": gained["gravity"] / mass / 9.81, "frictionless": np.sqrt(2 * (gained["gravity"] + gained["water"]) / mass)}


def level_of_yield(results, line="plane"):
    """Level of the water at which the last place of a line has yielded [m]; nan where it never does."""
    followed = results.lines()[line]
    yielded = np.flatnonzero((means(followed)["share_elastic"] < 0.05) & (np.interp(followed.time, results.history.time, levels(results)) >= 0))
    return np.interp(followed.time[yielded[0]], results.history.time, levels(results)) if len(yielded) else np.nan


def strain_at_end(results, point):
    """Plastic strain of a point at the end."""
    return results.history.columns[f"{point}_plastic_strain"][-1]


def first_yield(results, point, least=1e-4):
    """Time after the base begins to lose its friction at which the plastic strain of a point passes a value [s]; nan where it never does."""
    rows = rows_of(results, "slide")
    yielded = np.flatnonzero(results.history.columns[f"{point}_plastic_strain"][rows] > least)
    return results.history.time[rows[yielded[0]]] - results.history.time[rows[0]] if len(yielded) else np.nan


def drop_of_slide(results):
    """Drop of the centre of mass from the start of the stage "slide" to its largest kinetic energy [m]."""
    return energy_of_slide(results)["drop"]


def share_of_rock(results):
    """Share of the work of gravity and water that the rock dissipates in this time."""
    energy = energy_of_slide(results)
    return energy["rock"] / (energy["gravity"] + energy["water"])


def at_load(results, t):
    """The snapshot of the stages "water" and "slide" nearest to a load time [s]; the last before them for 0."""
    rows = rows_of(results, "water")
    begin = results.history.time[rows][0] - results.history.columns["load_time_s"][rows][0]
    return min(results.snapshots, key=lambda each: abs(each.time - begin - t))


def height_of_band(results, least=1e-4, reach=60.0):
    """Height above the kink up to which rock within `reach` of it sideways has more than a plastic strain after gravity [m]."""
    start = at_load(results, 0)
    place = start.position()[:, :2] - KINK
    sheared = (np.abs(place[:, 0]) < reach) & (start.scalar("plastic_strain")[0] > least)
    return place[sheared, 1].max(initial=0.0)


def plane_of_motion(results, start, end, upper="m4", lower="m9"):
    """Inclination of the plane between the wedges by how the rock moved between two load times [deg]: from the horizontal, uphill side,
    so that 90 is vertical and 108 the bisector. The wedges keep together if their velocities have the same component across it."""
    rows = np.isin(results.history.stage, MOVING)
    load = results.history.columns["load_time_s"][rows]
    above, below = (np.array([np.interp(end, load, part) - np.interp(start, load, part) for part in way(results, point)[:, rows]]) for point in (upper, lower))
    across = above - below
    return np.degrees(np.arctan2(across[1], -across[0])) % 180


MEASURES = {each.__name__: each for each in (way_at_level, way_before_slide, way_in_all, mean_speed_in_stage, mean_speed_left, speed_in_stage, drop_of_slide,
                                             share_of_rock, height_of_band, level_of_yield, plane_of_motion, first_yield, strain_at_end)}
