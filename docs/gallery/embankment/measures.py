"""How the embankment slides, and how quietly: measures of numbers.toml beside those of src/output/plots/talus_measures.py."""

import numpy as np

WET, DRY = 0.97, 0.95  # degrees of saturation: the front has passed; water is missing again
WEIGHT_OF_WATER = 9810.0  # [N/m3]
GROUND, TOP = 5.0, 15.0  # elevation of the level ground and of the crest [m]


def while_it_slides(results, by=0.5):
    """Snapshots of the last stage after some soil has moved by more than `by`, and which particles the front had passed before each."""
    passed = np.zeros(len(results.snapshots[0].ids()), bool)
    for snapshot in results.snapshots:
        if snapshot.stage != results.snapshots[-1].stage:
            continue
        wet = snapshot.scalar("saturation")[0] > WET
        passed = passed | wet
        if snapshot.scalar("displacement")[0].max() > by:
            yield snapshot, passed


def surface(snapshot):
    """Columns two particles wide: the x of their middles, the highest particle in each, and the column of each particle."""
    place = snapshot.position()
    x, y = place[:, 0], place[:, 1]
    wide = 2 * snapshot.column("volume").values.mean() ** (1 / place.shape[1])
    column = np.floor((x - x.min()) / wide).astype(int)
    top = np.full(column.max() + 1, -np.inf)
    np.maximum.at(top, column, y)
    return x.min() + wide * (np.arange(len(top)) + 0.5), top, column


def depth(snapshot):
    """Depth of the particles below the highest one in their column [m]."""
    _, top, column = surface(snapshot)
    return top[column] - snapshot.position()[:, 1]


def start_of_rain(results):
    """End of the first stage, `gravity` [s]."""
    history = results.history
    return max(time for time, stage in zip(history.time, history.stage) if stage == "gravity")


def share_of_strength(results, point):
    """Share of the friction angle's sine that a point mobilises when the rain begins; 1 at yield."""
    columns, k, soil = results.history.columns, np.searchsorted(results.history.time, start_of_rain(results) - 0.01), results.scene["body"]["soil"]
    strength = soil["friction_angle"] + soil["suction_friction_rate"] * columns[f"{point}_suction_Pa"][k]
    return float(np.sin(np.radians(columns[f"{point}_mobilised_friction_deg"][k])) / np.sin(np.radians(strength)))


def yields_after(results, point, share=0.98):
    """Time of rain until a point first mobilises this share of its strength [s]; nan where it never does."""
    history, soil = results.history, results.scene["body"]["soil"]
    strength = soil["friction_angle"] + soil["suction_friction_rate"] * history.columns[f"{point}_suction_Pa"]
    mobilised = np.sin(np.radians(history.columns[f"{point}_mobilised_friction_deg"])) / np.sin(np.radians(strength))
    since = np.asarray(history.time) - start_of_rain(results)
    found = np.flatnonzero((since > 0) & (mobilised >= share))
    return float(since[found[0]]) if len(found) else float("nan")


def part_of_the_slide(results, point, part, slow=0.1, fast=0.8):
    """Time between these shares of a point's largest speed, before it is that fast (`part` = "faster") or after (`part` = "slower") [s]."""
    time, speed = np.asarray(results.history.time), results.history.columns[f"{point}_velocity_m_s"]
    share = speed / np.nanmax(speed)
    quick = np.flatnonzero(share > fast)
    if part == "faster":
        return float(time[quick[0]] - time[np.flatnonzero(share[:quick[0]] < slow)[-1]])
    ends = quick[-1] + np.flatnonzero(share[quick[-1]:] < slow)
    return float(time[ends[0]] - time[quick[-1]]) if len(ends) else np.nan  # it moves to the end


def largest_acceleration(results, point):
    """Largest acceleration of a point in the rain [m/s2]."""
    rain = np.asarray(results.history.time) > start_of_rain(results)
    return float(np.nanmax(results.history.columns[f"{point}_acceleration_m_s2"][rain]))


def share_that_yields(results):
    """Share of the particles that are at their strength when the rain begins."""
    at = min(results.snapshots, key=lambda each: abs(each.time - start_of_rain(results)))
    return float((at.scalar("state")[0] > 0).mean())


def toe_of_the_slope(snapshot, above=0.5):
    """The x beyond which the surface is less than this much above the level ground [m], between columns by a line."""
    x, top, _ = surface(snapshot)
    k = np.flatnonzero(top > GROUND + above)[-1]
    return float(x[k] + (x[k + 1] - x[k]) * (top[k] - GROUND - above) / (top[k] - top[k + 1]))


def run_out_of_the_toe(results):
    """Distance between the toes of the slope at the start and at the end [m]."""
    return toe_of_the_slope(results.snapshots[-1]) - toe_of_the_slope(results.snapshots[0])


def displacement_at_mid_height(results, within=1.2):
    """Largest displacement at the end of soil that was within this distance of S2 when the rain began [m]."""
    place = results.scene["output"]["point"]["S2"]["position"][:2]
    start, last = min(results.snapshots, key=lambda each: abs(each.time - start_of_rain(results))), results.snapshots[-1]
    return float(last.scalar("displacement")[0][np.linalg.norm(start.position()[:, :2] - place, axis=1) < within].max())


def angle_of_the_face(snapshot, margin=1.0):
    """Inclination of a line through the surface between 1 m above the ground and 1 m below the crest [deg]."""
    x, top, _ = surface(snapshot)
    inside = (top > GROUND + margin) & (top < TOP - margin)
    return float(-np.degrees(np.arctan(np.polyfit(x[inside], top[inside], 1)[0])))


def flattening(results):
    """By how much the face is flatter at the end than at the start [deg]."""
    return angle_of_the_face(results.snapshots[0]) - angle_of_the_face(results.snapshots[-1])


def share_behind_the_front_that_is_dry(results):
    """Mean over the slide of the share of the particles passed by the wetting front whose saturation is below 0.95 again."""
    return float(np.mean([(snapshot.scalar("saturation")[0][passed] < DRY).mean() for snapshot, passed in while_it_slides(results)]))


def largest_pressure_while_it_slides(results):
    """Largest pore pressure of a particle in the snapshots of the slide [Pa]."""
    return float(max(snapshot.scalar("pore_pressure")[0].max() for snapshot, _ in while_it_slides(results)))


def hydrostatic_pressure_behind_the_front(results):
    """Largest depth of saturated particles in the snapshots of the slide, as pressure of still water [Pa]."""
    return float(max(WEIGHT_OF_WATER * depth(snapshot)[snapshot.scalar("saturation")[0] > 0.99].max() for snapshot, _ in while_it_slides(results)))


MEASURES = {function.__name__: function for function in (share_of_strength, yields_after, part_of_the_slide, largest_acceleration, share_that_yields,
                                                         run_out_of_the_toe, flattening, displacement_at_mid_height, share_behind_the_front_that_is_dry,
                                                         largest_pressure_while_it_slides, hydrostatic_pressure_behind_the_front)}
