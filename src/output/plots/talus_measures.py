"""What the pages of the gallery state of a run: one function a measure, under the name by which a numbers.toml asks for it.

Each takes the results of the run (talus_results.Results) and the keys that the line of numbers.toml gives besides, and returns one number
in SI units. A page may have measures of its own in a file measures.py beside its numbers.toml, written alike.
"""

import typing

import numpy as np

from talus_deposit import Deposit
from talus_results import read_factor
from talus_sliding import Thickness, largest_displacement, sliding, spacing

MEASURES = {}


def measure(function):
    MEASURES[function.__name__] = function
    return function


def at(results, time):
    """The snapshot nearest to a time [s]; the last one for None."""
    return results.snapshots[-1] if time is None else min(results.snapshots, key=lambda each: abs(each.time - time))


# ---- cost ----

@measure
def steps(results):
    """Time steps of the motion."""
    return results.history.step[-1]


@measure
def particles(results):
    """Particles at the end."""
    return results.history.columns["particles"][-1]


@measure
def particle_updates(results):
    """Steps times particles: the work of the motion."""
    return steps(results) * particles(results)


# ---- failure ----

def failure(results):
    """Time of failure and load time at failure [s]: when the watched point passed its speed. Raises LookupError where nothing failed."""
    found = results.events("failure")
    if not found:
        raise LookupError("nothing failed")
    return found[0]["time_s"], found[0]["load_time_s"]


@measure
def time_of_failure(results):
    """Time at which the watched point passed its speed and its soil failed [s]."""
    return failure(results)[0]


@measure
def load_time_of_failure(results):
    """What the clock of the loads showed then [s]."""
    return failure(results)[1]


@measure
def factor_of_safety(results, mechanism=1, flow=None):
    """The middle of its bracket, of the critical mechanism or a further one; of soil with psi < phi also by another `flow`: davis, associated."""
    found = read_factor(results)["mechanisms"][mechanism - 1]
    return (found["by_flow"][flow] if flow else found["factor_of_safety"])["value"]


@measure
def share_of_loads(results, stage):
    """Share of a quasi-static stage's loads beyond which there was no equilibrium; 1 if there was one to the end."""
    found = [event for event in results.events("equilibrium_lost") if event["stage"] == stage]
    return found[0]["values"]["share_of_loads"] if found else 1.0


# ---- motion ----


@measure
def displacement(results, point, stage=None):
    """Displacement of a tracked point at the end of the run, or of a stage [m]."""
    history = results.history
    last = max(k for k, name in enumerate(history.stage) if stage in (None, name))
    return history.columns[f"{point}_displacement_m"][last]


@measure
def largest_speed(results, point):
    """Largest speed of a tracked point in the rows of the history [m/s]."""
    return np.nanmax(results.history.columns[f"{point}_velocity_m_s"])


@measure
def front(results, share=0.995):
    """The x behind which this share of the mass lies at the end [m]."""
    x, mass = results.snapshots[-1].position()[:, 0], results.snapshots[-1].column("mass").values[:, 0]
    order = np.argsort(x)
    return x[order][np.searchsorted(np.cumsum(mass[order]), share * mass.sum())]


@measure
def end_of_stage(results, stage):
    """Time at which a stage ended [s]."""
    return max(time for time, name in zip(results.history.time, results.history.stage) if name == stage)


@measure
def largest_share_displacement(results, share=0.999):
    """The displacement that this share of the mass has at most at the end [m]: the largest, without single particles."""
    return largest_displacement(results.snapshots[-1], share)


class Slide(typing.NamedTuple):
    """The soil that slides at the end (talus_sliding.sliding). In plane strain the travel distance is the level one from its rear at the start to its front at
    the end along the mean direction of its motion, in 3D that of the maps, from the crown to the toe of the deposit; `from_toe` is how far the front went
    beyond where it was at the start, and the fall is from the highest place at the start to the lowest of the front. The area is that of the deposit, in 3D
    alone. The depth is the largest one of the lower face below the ground, `deepest` its x, both in the undeformed section; they are known to the spacing of
    particles. Zeros where nothing moved [m, m3 or m3/m, m2]."""

    travel: float = 0.0
    volume: float = 0.0
    depth: float = 0.0
    deepest: float = 0.0
    from_toe: float = 0.0
    fall: float = 0.0
    area: float | None = None

    def reach(self):
        """The angle of reach, whose tangent is the fall over the travel distance [deg]; None without travel."""
        return float(np.degrees(np.arctan2(self.fall, self.travel))) if self.travel else None


def slide(results):
    """The Slide of a run. Snapshots without `displacement` or `volume` raise KeyError."""
    last = results.snapshots[-1]
    moved = last.column("displacement").values
    inside = sliding(last)
    if not inside.any():
        return Slide()
    up = results.up_axis()
    level = [axis for axis in range(moved.shape[1]) if axis != up]
    mean = moved[inside][:, level].mean(axis=0)
    along = mean / np.linalg.norm(mean) if np.linalg.norm(mean) > 0 else np.eye(len(level))[0]
    end = last.position()
    start = end - moved
    volume = last.column("volume").values[:, 0]
    before, after = start[inside][:, level] @ along, end[inside][:, level] @ along
    travel, from_toe = after.max() - before.min(), after.max() - before.max()
    front = after >= after.max() - spacing(last)
    fall, area = start[inside, up].max() - end[inside][front, up].min(), None
    if mapped := deposit(results):
        travel, from_toe, fall, area = (mapped[name] for name in ("travel_distance_m", "run_out_from_toe_m", "fall_height_m", "area_m2"))
    column = np.floor(start[:, level] / (volume.mean() ** (1 / moved.shape[1]) * 1.5)).astype(int)
    _, number = np.unique(column, axis=0, return_inverse=True)
    number = number.reshape(-1)
    ground, base = np.full(number.max() + 1, -np.inf), np.full(number.max() + 1, np.inf)
    np.maximum.at(ground, number, start[:, up])
    np.minimum.at(base, number[inside], start[inside, up])
    deepest = int(np.argmax(ground - base))
    place = start[number == deepest, level[0]].mean()
    return Slide(float(travel), float(volume[inside].sum()), float(ground[deepest] - base[deepest]), float(place), float(from_toe), float(fall), area and float(area))


def deposit(results):
    """The numbers of the maps of a run in 3D as `talus maps` writes them without options; None in plane strain, and where nothing slid far enough."""
    if results.snapshots[-1].position().shape[1] != 3 or not len(results.mesh()[1]) or "velocity" not in results.snapshots[-1]:
        return None
    try:
        return Deposit(results).numbers()
    except ValueError:
        return None


def flow(results, states=10):
    """In 3D, of the soil that has slid by the end (talus_sliding.sliding), where it has left its outline at the start: the median of its thickness by volume
    and the largest one without single particles, and the mean size of the cells where it is, over some states after the start [m]. The thick soil that stays
    in the scarp does not count, unless none went further. None where nothing slid."""
    last = results.snapshots[-1]
    if last.position().shape[1] != 3 or len(results.snapshots) < 2:
        return None
    thickness = Thickness(last, results.up_axis())
    node, cell = results.mesh()
    if not len(thickness.sliding) or not len(cell):
        return None
    level = [axis for axis in range(3) if axis != results.up_axis()]
    corner = node[cell]
    size = (np.sqrt(2) * np.abs(np.linalg.det(corner[:, 1:] - corner[:, :1]))) ** (1 / 3)  # edge of a regular tetrahedron of this volume
    side, low = size.max(), node[:, level].min(axis=0)  # no square between the largest cells is without a cell
    count = np.floor(np.ptp(node[:, level], axis=0) / side).astype(int) + 1
    def square(place):
        return np.ravel_multi_index(np.clip(np.floor((place - low) / side).astype(int), 0, count - 1).T, count)
    of_cell = square(corner.mean(axis=1)[:, level])
    cells, total = np.bincount(of_cell, minlength=np.prod(count)), np.bincount(of_cell, size, np.prod(count))
    first, chosen = results.snapshots[0], results.snapshots[1:]
    depth, there, left = [], [], []
    wide = Thickness.WIDE * spacing(first)
    def footprint(place):
        return [tuple(one) for one in np.floor((place[:, level] - low) / wide).astype(int)]
    outline = set(footprint(first.position()[np.isin(first.ids(), thickness.sliding, assume_unique=True)]))
    for snapshot in chosen[:: -(-len(chosen) // states)]:
        moves = np.isin(snapshot.ids(), thickness.sliding, assume_unique=True)
        depth.append(thickness(snapshot)[0][moves])
        place = snapshot.position()[moves]
        at = square(place[:, level])
        there.append(np.divide(total[at], cells[at], out=np.full(len(at), np.nan), where=cells[at] > 0))
        left.append(np.array([one not in outline for one in footprint(place)], bool))
    depth, there, left = map(np.concatenate, (depth, there, left))
    if left.any():
        depth, there = depth[left], there[left]
    there = there[np.isfinite(there)]
    return (float(np.median(depth)), float(np.percentile(depth, 99)), float(there.mean())) if len(depth) and len(there) else None


# ---- fields ----

def known(snapshot, field):
    """The values of a field that are numbers: elastic soil has no plastic strain, and soil without stress mobilises no friction. Raises KeyError without
    one."""
    values = snapshot.scalar(field)[0]
    values = values[np.isfinite(values)]
    if not len(values):
        raise KeyError(f"no particle has a value of {field}")
    return values


@measure
def largest(results, field, time=None):
    """Largest value of a field over the particles that have one, at a time or at the end."""
    return known(at(results, time), field).max()


@measure
def mean(results, field, time=None):
    """Mean of a field over the particles that have a value, at a time or at the end."""
    return known(at(results, time), field).mean()


@measure
def largest_in_history(results, column):
    """Largest magnitude in a column of history.csv; rows without a number do not count."""
    return np.nanmax(np.abs(results.history.columns[column]))


@measure
def last_in_history(results, column):
    """Last value of a column of history.csv."""
    return results.history.columns[column][-1]
