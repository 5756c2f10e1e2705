"""What a run is looked at from: a section in plane strain, a slice from the side, a body whole, cut open and from above."""

import numpy as np

from talus_moments import in_both
from talus_relief import Eye
from talus_sliding import slides
from talus_tiles import GAP_IN_SPACE, tiles
from talus_units import length, of_length
from talus_way import Way

ASTRAY = 2.0  # how far the way of a slide may leave a plane of two axes, over the spacing of particles, and is still shown there
STATIONS = 20  # places of the centre of mass on the way of a slide, or some more
AHEAD = 0.005  # share of the soil that slides which single particles before its front are at most


class View:
    """A view of the particles along an axis: two axes, and how far they are from the plane of a section [m]."""

    def __init__(self, name, across, up, plane=None):
        self.name, self.across, self.up, self.plane = name, across, up, plane

    @property
    def labels(self):
        return [of_length('xyz'[axis]) for axis in (self.across, self.up)]

    def flat(self, position):
        return position[:, [self.across, self.up]]

    def limits(self, low, high):
        """Corners of what it shows of a box."""
        return self.flat(np.array([low, high]))

    def line(self, ground, count):
        """Places of the section: along the picture, and their coordinates by level axes."""
        along = np.linspace(ground.low[self.across], ground.high[self.across], count)
        return along, {self.across: along, self.plane[0]: np.full(count, self.plane[1])}

    def aside(self, position):
        """Distance from the plane of the section; zero if there is none."""
        return np.zeros(len(position)) if self.plane is None else np.abs(position[:, self.plane[0]] - self.plane[1])

    def tiles(self, position, size, frame, of=tiles):
        """What `of`, tiles or outline_of_points, makes of the particles that may be nearest to a place of the plane; and which these are."""
        aside = self.aside(position)
        rows = np.flatnonzero(aside <= GAP_IN_SPACE * size)
        return of(self.flat(position)[rows], size[rows], frame, aside[rows] if self.plane else None), rows


class WayView(View):
    """The section along the way of a slide, laid out flat."""

    def __init__(self, name, way, level, up):
        super().__init__(name, None, up, plane=way)
        self.level = level

    @property
    def labels(self):
        return [of_length("distance along the slide"), of_length('xyz'[self.up])]

    def flat(self, position):
        return np.column_stack([self.plane.beside(position[:, self.level])[0], position[:, self.up]])

    def aside(self, position):
        return self.plane.beside(position[:, self.level])[1]

    def limits(self, low, high):
        return np.array([0, low[self.up]]), np.array([self.plane.length, high[self.up]])

    def line(self, ground, count):
        along = np.linspace(0, self.plane.length, count)
        return along, dict(zip(self.level, self.plane.at(along).T))


class MapView(View):
    """From above, with shades. A map of a terrain has the east to the right and the north on top."""

    def __init__(self, name, across, up, of_terrain=False):
        super().__init__(name, across, up)
        self.of_terrain = of_terrain

    @property
    def labels(self):
        return [of_length("x, east"), of_length("y, north")] if self.of_terrain else super().labels


class Oblique:
    """From above in front: the body whole, or cut open along a vertical plane, its level normal [3] and its place along that [m]."""

    def __init__(self, name, eye, cut=None):
        self.name, self.eye, self.cut = name, eye, cut

    def flat(self, position):
        return self.eye.flat(position)

    def aside(self, position):
        """Distance from the cut, of what is cut away."""
        if self.cut is None:
            return np.zeros(len(position))
        normal, place = self.cut
        return np.maximum(0, (place - position @ normal) * np.sign(self.eye.level @ normal))


def views_of(results):
    """The views that suit a run: one of a section or a thin slice; of a body the whole one, cut open, its central section, and from above. The
    section follows the way of a slide that leaves the plane of two axes, and the cut leads through the middle of its deposit."""
    first = results.snapshots[0].position()
    if first.shape[1] == 2:
        return [View("section", 0, 1)]
    up = results.up_axis()
    level = [axis for axis in range(3) if axis != up]
    extent = np.ptp(first, axis=0)
    thin, wide = sorted(level, key=lambda axis: extent[axis])
    if extent[thin] < 0.2 * min(extent[wide], extent[up]):
        return [View("section", wide, up)]
    start, end = in_both(results.snapshots[0], results.snapshots[-1])  # particles may have left the mesh
    moved = end - start
    along = max(level, key=lambda axis: np.abs(moved[:, axis]).sum())
    aside = next(axis for axis in level if axis != along)
    centre = weighted_median(start[:, aside], np.abs(moved[:, along])) if len(start) else np.median(first[:, aside])
    above = MapView("from above", 0, 1, on_terrain(results)) if up == 2 else MapView("from above", along, aside)
    way = way_of(results, moved, level)
    if way is not None and np.abs(way.ahead[:, level.index(aside)] - centre).max() > ASTRAY * spacing_of(results):
        ahead, normal = np.zeros(3), np.zeros(3)
        ahead[level] = way.chord()
        normal[level] = np.array([-1, 1]) * way.chord()[::-1]
        eye = Eye.before(ahead, up)
        return [Oblique("from above in front", eye), Oblique("cut open along the slide", eye, (normal, way.end @ normal[level])),
                WayView("section along the slide", way, level, up), above]
    at = f"at {'xyz'[aside]} = {centre * length()[0]:.3g} {length()[1]}"
    eye = Eye.in_front(moved[:, along].sum(), along, up)
    return [Oblique("from above in front", eye), Oblique(f"cut open {at}", eye, (np.eye(3)[aside], centre)), View(f"section {at}", along, up, (aside, centre)),
            above]


def on_terrain(results):
    """Has the run the coordinates of a map?"""
    return "terrain" in results.scene.get("mesh", {}) or (results.folder / "origin.json").exists()


def way_of(results, moved, level):
    """The way of the soil that slides, on the level axes; None where no soil slides. `moved` is from the first to the last snapshot."""
    first, last = results.snapshots[0], results.snapshots[-1]
    ids = np.intersect1d(first.ids(), last.ids(), assume_unique=True)
    size = np.linalg.norm(moved, axis=1)
    ids = ids[slides(size, np.quantile(size, 0.999) if len(size) else 0.0, spacing_of(results))]
    if not len(ids):
        return None
    every = max(1, len(results.snapshots) // STATIONS)
    clouds = [shown.position()[np.isin(shown.ids(), ids, assume_unique=True)] for shown in (*results.snapshots[::every], last)]
    path = np.array([cloud[:, level].mean(axis=0) for cloud in clouds])
    up, size = results.up_axis(), spacing_of(results)
    start, end = clouds[0], clouds[-1][:, level]
    distance = np.linalg.norm(end - start[start[:, up].argmax()][level], axis=1)
    return Way.of(path, start[:, level], start[:, up], end[distance <= np.quantile(distance, 1 - AHEAD)], size)


def weighted_median(values, weights):
    order = np.argsort(values)
    total = np.cumsum(weights[order])
    return values[order[np.searchsorted(total, total[-1] / 2)]] if total[-1] > 0 else np.median(values)


def spacing_of(results):
    """Mean distance of neighbouring particles at the start [m]."""
    first = results.snapshots[0]
    position = first.position()
    volume = first.column("volume").values.sum() if "volume" in first else np.prod(np.ptp(position, axis=0))
    return float((volume / len(position)) ** (1 / position.shape[1])) or 1.0
