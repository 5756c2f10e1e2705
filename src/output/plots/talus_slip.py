"""The slip surface of a run in plane strain or a slice: the line of largest plastic strain, where its soil was at the start."""

import csv
import sys

import numpy as np

from talus_measures import at, failure
from talus_sections import Painter
from talus_units import quantity, span
from talus_views import spacing_of

LEAST = 0.2  # of the largest plastic strain: soil with less is no part of the surface
STEEPEST = 3  # rows by which the surface may rise or fall from one column to the next: 72 degrees
COLUMN = 2  # width of a column and height of a row, in distances of neighbouring particles
RUN = 6  # columns in a row that are worth a word
BASES = ("friction", "heated_friction")  # kinds of boundary on which soil slips
NEAR = 0.15  # of the height of the soil: a line that ends deeper below the ground has not come out


def slip_surface(results, time=None):
    """Points [n, 2] of the surface in the undeformed section, from left to right, and the snapshot that shows it: the one nearest to `time`, else the
    first from the failure on whose surface leads from ground to ground, else the first of which no end is buried, else the last. The surface is a connected path through columns and rows of soil;
    in each column it passes through the centre of the larger half of the strain near the path. Raises ValueError where there is none."""
    if time is not None:
        return surface_at(results, at(results, time))
    try:
        begin = at(results, failure(results)[0]).time
    except (LookupError, OSError):
        return surface_at(results, results.snapshots[-1])
    almost = None
    for snapshot in results.snapshots:
        if snapshot.time < begin:
            continue
        try:
            found = surface_at(results, snapshot)
        except ValueError:
            continue
        if not deep_ends(results, found[0], found[2]):
            return found
        if almost is None and not buried_ends(found[0], found[2]):
            almost = found
    return almost or surface_at(results, results.snapshots[-1])


def surface_at(results, snapshot):
    """The surface that one snapshot shows, as slip_surface gives it."""
    first = results.snapshots[0]
    if "plastic_strain" not in snapshot:
        raise ValueError(f"{results.folder} has no field plastic_strain, whose band is the slip surface")
    kept = np.isin(snapshot.ids(), first.ids())
    up = results.up_axis()
    across = max((axis for axis in range(first.position().shape[1]) if axis != up), key=lambda axis: np.ptp(first.position()[:, axis]))
    place = first.position()[np.searchsorted(first.ids(), snapshot.ids()[kept])][:, [across, up]]
    strain = np.nan_to_num(snapshot.scalar("plastic_strain")[0][kept])
    top = np.percentile(strain, 99.8)
    if top <= 0:
        raise ValueError(f"no soil of {results.folder} has plastic strain at t = {snapshot.time:g} s; name another time with --times")
    column, row = np.floor((place - place.min(axis=0)) / (COLUMN * spacing_of(results))).astype(int).T
    sums, counts = np.zeros((2, column.max() + 1, row.max() + 1))
    np.add.at(sums, (column, row), strain)
    np.add.at(counts, (column, row), 1)
    path = path_of_most(np.where(counts > 0, sums / np.maximum(counts, 1) / top - LEAST, -1))
    points = []
    for number, middle in path:
        mine = (column == number) & (np.abs(row - middle) <= 1)
        if mine.any() and strain[mine].max() > 0:
            points.append(np.average(place[mine], axis=0, weights=np.where(strain[mine] > 0.5 * strain[mine].max(), strain[mine], 0)))
    if len(points) < 3:
        raise ValueError(f"plastic strain of {results.folder} forms no surface at t = {snapshot.time:g} s; name another time with --times")
    return smoothed(np.array(points)), snapshot, place, strain


class Undeformed:
    """A snapshot whose particles are where they were at the start; those that came later are not there."""

    def __init__(self, snapshot, first):
        self._snapshot, self._first, self._kept = snapshot, first, np.isin(snapshot.ids(), first.ids())
        self.time, self.stage, self.step = snapshot.time, snapshot.stage, -1

    def __contains__(self, name):
        return name in self._snapshot

    def ids(self):
        return self._snapshot.ids()[self._kept]

    def body(self):
        return self._snapshot.body()[self._kept]

    def position(self):
        return self._first.position()[np.searchsorted(self._first.ids(), self.ids())]

    def column(self, name):
        column = self._snapshot.column(name)
        column.values = column.values[self._kept]
        return column

    def scalar(self, name):
        values, unit = self._snapshot.scalar(name)
        return values[self._kept], unit


def path_of_most(worth):
    """The path (column, row), ... from left to right whose bins have the largest sum of `worth` [columns, rows], of all that begin and end anywhere and
    rise or fall by at most STEEPEST rows a column. The rows that a steep step passes count where their worth is negative, so that the path does not leap
    over soil without strain from one band to another. By dynamic programming: the best path to a bin continues one of the best paths to its neighbours."""
    columns, rows = worth.shape
    best, before = worth.copy(), np.full(worth.shape, -1)  # of the paths that end in a bin; -1: they begin there
    for c in range(1, columns):
        lost = np.concatenate([[0], np.cumsum(np.minimum(worth[c], 0))])  # of all rows below
        for r in range(rows):
            for other in range(max(0, r - STEEPEST), min(rows, r + STEEPEST + 1)):
                low, high = sorted((r, other))
                value = worth[c, r] + best[c - 1, other] + (lost[high] - lost[low + 1] if high > low else 0)
                if value > best[c, r]:
                    best[c, r], before[c, r] = value, other
    c, r = np.unravel_index(np.argmax(best), best.shape)
    path = []
    while r >= 0:
        path.append((c, r))
        c, r = c - 1, before[c, r]
    return path[::-1]


def depth_of_ends(line, place):
    """Depth of the left and of the right end of the line below the ground."""
    reach = max(np.ptp(line[:, 0]) / len(line), np.ptp(place[:, 0]) / 200)
    return {side: place[np.abs(place[:, 0] - x) <= reach, 1].max(initial=y) - y for side, (x, y) in (("left", line[0]), ("right", line[-1]))}


def buried_ends(line, place):
    """Those of the words left and right at which the line ends inside the soil, further below the ground than a share NEAR of the soil's height."""
    return [side for side, depth in depth_of_ends(line, place).items() if depth > NEAR * np.ptp(place[:, 1])]


def deep_ends(results, line, place):
    """Depth of the ends of the line that are further below the ground than a row is high: the others are at the ground."""
    return {side: depth for side, depth in depth_of_ends(line, place).items() if depth > COLUMN * spacing_of(results)}


def said_of_ends(results, line, place, snapshot):
    """A sentence about ends of the line that are not at the ground; empty if there are none."""
    deep = deep_ends(results, line, place)
    if not deep:
        return ""
    ends = " and ".join(f"{quantity(depth, 'm', '.2g')} below the ground on the {side}" for side, depth in deep.items())
    band = f"soil with more than {LEAST:g} of the largest plastic strain"
    if not buried_ends(line, place):
        return f"the line ends inside the soil, {ends}: {band} ends there"
    more = "the last time of the run" if snapshot is results.snapshots[-1] else "a later time (--times) may show the whole surface"
    return f"the line ends inside the soil, {ends}: no connected path of {band} leads from ground to ground at t = {snapshot.time:g} s; {more}"


def said_of_line(results, line, place, strain):
    """Sentences about parts of the line that are no slip surface: those along the ground, those in soil that has hardly sheared, and that slip on a base is
    none of its strain."""
    row, top = COLUMN * spacing_of(results), np.percentile(strain, 99.8)
    near = [np.linalg.norm(place - point, axis=1) <= row for point in line]
    ground = [place[np.abs(place[:, 0] - x) <= row, 1].max(initial=y) - y <= row for x, y in line]
    weak = [strain[mine].max(initial=0) < LEAST * top for mine in near]
    said = []
    if along := spans(line, ground):
        said.append(f"the line follows the ground {along}: soil has sheared at the surface there, and this part is no slip surface")
    if without := spans(line, weak):
        said.append(f"the line passes soil with less than {LEAST:g} of the largest plastic strain {without}: the band is not continuous there")
    if bases := [name for name, boundary in results.scene.get("boundary", {}).items() if boundary.get("kind") in BASES]:
        said.append(f"slip on the boundary {' and '.join(bases)} is no plastic strain: where soil slides on it the line, which shows shear in the soil alone, need not follow it")
    return said


def spans(line, marked):
    """Where RUN points of the line or more in a row are marked, in words."""
    edges = np.flatnonzero(np.diff([0, *map(int, marked), 0]))
    return " and ".join(f"from x = {span(line[a, 0], line[b - 1, 0], 'm')}" for a, b in zip(edges[::2], edges[1::2]) if b - a >= RUN)


def smoothed(line):
    """Elevations as medians of three neighbours, so that one column beside the band does not kink it."""
    inner = np.median([line[:-2, 1], line[1:-1, 1], line[2:, 1]], axis=0)
    return np.column_stack([line[:, 0], np.concatenate([line[:1, 1], inner, line[-1:, 1]])])


def draw_slip_surface(results, folder, time=None):
    """slip_surface.csv and slip_surface.png; prints the line as [output.line.NAME] takes it."""
    line, snapshot, place, strain = slip_surface(results, time)
    folder.mkdir(exist_ok=True)
    with open(folder / "slip_surface.csv", "w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(("x_m", "elevation_m"))
        rows.writerows([f"{value:.6g}" for value in point] for point in line)
    undeformed = Undeformed(snapshot, results.snapshots[0])
    painter = Painter(results, [undeformed])
    part = "part of the slip surface" if buried_ends(line, place) else "slip surface"
    painter.picture_of_line(undeformed, "plastic_strain", line, f"{part}, in the section as it was at the start", folder / "slip_surface.png")
    if said := said_of_ends(results, line, place, snapshot):
        print(f"talus: {said}", file=sys.stderr)
    for said in said_of_line(results, line, place, strain):
        print(f"talus: {said}", file=sys.stderr)
    if results.snapshots[0].position().shape[1] == 2:
        print("[output.line.slip_surface]\npoints = [" + ", ".join(f"[{x:.4g}, {y:.4g}]" for x, y in line) + "]")
    return [("slip surface", folder / "slip_surface.png")]
