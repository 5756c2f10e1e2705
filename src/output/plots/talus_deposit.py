"""The deposit of a slide in 3D on a level grid: its thickness, outline and numbers, which report, study and maps share."""

import json
import sys

import numpy as np

from talus_sliding import Thickness, largest_displacement, still_moving
from talus_units import quantity, span

LIMIT = 0.5  # least thickness of soil that counts, over the size of particles: thinner soil is single particles
LEFT_OUT = 0.02  # share of the volume that slid: less that moved and is not mapped is not told
SPACING = 2.0  # of the grids where there is no terrain file, over the size of particles
EVEN = 3.0  # length over which thickness is evened out, over the size of particles: about the edge of a cell of the mesh with a few particles
MOST_CELLS = 50_000_000  # of one grid


def warn(text):
    print(f"warning: {text}", file=sys.stderr)


def metres(value):
    return quantity(value, "m", ".3g")


def left_mesh(results):
    """Numbers of the particles that are in the first snapshot and no longer in the last."""
    return np.setdiff1d(results.snapshots[0].ids(), results.snapshots[-1].ids(), assume_unique=True)


class Axes:
    """From the coordinates of the mesh to those of a map: east, north, elevation. With y up the map looks from above too: its north is -z."""

    def __init__(self, results):
        self.up = results.up_axis()
        path = results.folder / "origin.json"
        found = json.loads(path.read_text()) if path.exists() else {}
        self.origin = np.array([*found.get("origin_m", (0.0, 0.0)), 0.0])
        self.projection = found.get("projection", "")
        self.spacing = found.get("spacing_m")  # of the terrain file; None without one

    def level(self, vectors):
        """Vectors [n, 3] in the order east, north, up, without the origin."""
        return vectors if self.up == 2 else vectors[:, [0, 2, 1]] * [1, -1, 1]


class Grid:
    """Square cells over the extent of the mesh. Arrays on the grid are [cells to the east, cells to the north]; coordinates are without the origin of the
    map. The southwest corner of the mesh is the centre of a cell of the terrain file, whose spacing is `terrain` [m]: the grid begins at the edge of that
    cell, so that its cells hold whole cells of the terrain where its spacing is a multiple of theirs. Without a terrain its own first cell has its centre
    there."""

    def __init__(self, low, high, spacing, terrain=None):
        beyond = terrain or spacing  # by half of this the outermost cells reach beyond the mesh
        self.spacing, self.low = spacing, low[:2] - beyond / 2
        count = np.ceil(((high - low)[:2] + (beyond if terrain else spacing / 2)) / spacing - 1e-6)
        if count.prod() > MOST_CELLS:
            raise ValueError(f"--spacing {spacing:g} m makes {count.prod():.3g} cells, more than {MOST_CELLS:.3g}: choose a larger spacing")
        self.shape = tuple(count.astype(int).tolist())

    def centres(self):
        return [low + (np.arange(count) + 0.5) * self.spacing for low, count in zip(self.low, self.shape)]

    def number(self, position):
        """The cell of each place as one number; places beyond the edge count for the outermost cells."""
        index = np.clip(np.floor((position[:, :2] - self.low) / self.spacing).astype(int), 0, np.array(self.shape) - 1)
        return np.ravel_multi_index(index.T, self.shape)

    def spread(self, position, size, values):
        """Sums over cells [n, cells, cells] of values [n, particles], each spread evenly over the level square of width `size` [m] of its particle.
        Nothing is lost: what is beyond the edge counts for the outermost cells."""
        least = (position[:, :2] - size[:, None] / 2 - self.low) / self.spacing
        most = least + size[:, None] / self.spacing
        first = np.floor(least).astype(int)
        result = np.zeros((len(values), np.prod(self.shape)))
        reach = int(np.ceil((size / self.spacing).max(initial=0))) + 1
        share = [[np.clip(np.minimum(most[:, axis], first[:, axis] + k + 1) - np.maximum(least[:, axis], first[:, axis] + k), 0, None)
                  / (most - least)[:, axis] for k in range(reach)] for axis in (0, 1)]
        for corner in np.ndindex(reach, reach):
            index = np.clip(first + corner, 0, np.array(self.shape) - 1)
            number, weight = np.ravel_multi_index(index.T, self.shape), share[0][corner[0]] * share[1][corner[1]]
            for sums, value in zip(result, values):
                sums += np.bincount(number, weight * value, len(sums))
        return result.reshape(-1, *self.shape)

    def evened_out(self, values, where, length):
        """Values [cells, cells] whose differences between neighbouring cells of the mask `where` have evened out by diffusion, as far as a cell of the mesh
        with linear shape functions of this length [m] would spread them. The sum stays, the mask's edge stays sharp, and so do uniform values."""
        result = values.copy()
        if not where.any():
            return result
        part = tuple(slice(at.min(), at.max() + 1) for at in np.nonzero(where))
        turns = length**2 / 6 / (2 * self.spacing**2)  # a hat function that ends at +-length has the variance length^2 / 6
        count = int(np.ceil(turns / 0.2))
        ways = [(some, both[1:] & both[:-1]) for some, both in ((result[part], where[part]), (result[part].T, where[part].T))]
        for _ in range(count):
            for some, both in ways:
                flow = turns / count * np.where(both, np.diff(some, axis=0), 0)
                some[:-1] += flow
                some[1:] -= flow
        return result


class Deposit:
    """The soil that slid at the end, on a grid: its outline and the numbers that report, study and maps give of it."""

    def __init__(self, results, spacing=None, limit=None, beyond=None):
        self.results, self.axes = results, Axes(results)
        first, last = results.snapshots[0], results.snapshots[-1]
        node, self.cells = results.mesh()
        self.node = self.axes.level(node)
        sliding = Thickness(last, self.axes.up).sliding if beyond is None else last.ids()[last.scalar("displacement")[0] > beyond]
        self.sliding = np.union1d(sliding, left_mesh(results))
        self.size = self._size_of(first)
        moved = largest_displacement(last)
        if not len(self.sliding) or (moved < self.size and not len(left_mesh(results))):
            least = f"the spacing of particles, {metres(self.size)}" if beyond is None or moved < self.size else f"--moved {beyond:g} m"
            raise ValueError(f"{results.folder}: no soil has slid far enough for a map: the largest displacement, {metres(moved)}, is below {least}")
        self.limit = LIMIT * self.size if limit is None else limit
        terrain = self.axes.spacing
        self.grid = Grid(self.node.min(axis=0), self.node.max(axis=0), spacing or terrain or SPACING * self.size, terrain)
        if self.grid.spacing < 1.5 * self.size:
            wider = SPACING * self.size if not terrain else terrain * np.ceil(SPACING * self.size / terrain)
            warn(f"cells of {metres(self.grid.spacing)} are not much wider than the particles ({metres(self.size)}): single particles show in the outline and "
                 f"where the soil is thin; less so with --spacing {wider:.4g}{f', a multiple of the spacing of the terrain file,' if terrain else ''} or more")
        self.moving = still_moving(last, self.sliding)
        self.last = last
        self._accumulate(self.mapped())
        if not self.covered[-1].any():
            raise ValueError(f"the deposit is nowhere as thick as --limit {self.limit:g} m; its largest thickness is {metres(self.thickness[-1].max())}"
                             + (f". {self.beside(beyond)}" if self.left_out()[0] > LEFT_OUT * self.volume[-1] else ""))
        self._ends(first, last)

    def mapped(self):
        """The snapshots that are put on the grid."""
        return self.results.snapshots[-1:]

    def _size_of(self, first):
        """Mean size of the particles that slide, or of all where none does [m]: those of a slide may be much smaller than those of the ground below it."""
        volume = first.column("volume").values[:, 0]
        slides = np.isin(first.ids(), self.sliding, assume_unique=True)
        return float((volume[slides] if slides.any() else volume).mean()) ** (1 / 3)

    def released(self):
        """Volumes at the start of the soil that is mapped, with what has left the mesh, and of the latter alone [m3]. The deposit has less: it is without what
        left and it is denser, and its outline encloses less still, as soil that is thinner than the limit does not count."""
        first = self.results.snapshots[0]
        volume = first.column("volume").values[:, 0]
        return tuple(float(volume[np.isin(first.ids(), of, assume_unique=True)].sum()) for of in (self.sliding, left_mesh(self.results)))

    def left_out(self):
        """Volume that moved by more than the size of particles and is not mapped [m3], and its least and largest displacement [m]."""
        moved = self.last.scalar("displacement")[0]
        some = (moved > self.size) & ~np.isin(self.last.ids(), self.sliding, assume_unique=True)
        if not some.any():
            return 0.0, (0.0, 0.0)
        return float(self.last.column("volume").values[some, 0].sum()), (float(moved[some].min()), float(moved[some].max()))

    def beside(self, beyond):
        """What is not mapped though it moved, in words; `beyond` is the displacement that was asked for [m], or None."""
        left_out, moved = self.left_out()
        return (f"{quantity(left_out, 'm³', '.3g')} that moved by {span(*moved, 'm')} are not mapped, and are {100 * left_out / (left_out + self.volume[-1]):.3g} % of "
                "what moved by more than a particle: soil slides in these maps where it moved by more than "
                + (f"--moved {beyond:g} m" if beyond else "a tenth of the largest displacement, which 99.9 % of the mass have at most")
                + f"; --moved {self.size:.2g} maps all of it")

    def limit_of(self, share):
        """The limit of thickness [m], of two digits, with which the outline holds this share of the deposit."""
        thickness = np.sort(self.thickness[-1], axis=None)[::-1]
        limit = thickness[np.searchsorted(np.cumsum(thickness), share * thickness.sum())]
        step = 10.0 ** (np.floor(np.log10(limit)) - 1)
        return float(np.floor(limit / step) * step)

    def _even(self, held):
        """Thickness [m] from the volumes above cells. Particles lie where the mesh put them and where the motion took them, so that a column holds one more
        or one less: this evens out within soil that is thick enough to count, so that neither outline nor volume change."""
        thickness = held / self.grid.spacing**2
        return self.grid.evened_out(thickness, thickness >= self.limit, EVEN * self.size)

    def _accumulate(self, snapshots):
        self.times, self.thickness, self.covered, self.path, self.volume = [], [], [], [], []
        nothing = np.full(self.grid.shape, np.nan)
        self.largest_speed, self.arrival = nothing.copy(), nothing.copy()
        for snapshot in snapshots:
            moves = np.isin(snapshot.ids(), self.sliding, assume_unique=True)
            place, volume = self.axes.level(snapshot.position())[moves], snapshot.column("volume").values[moves, 0]
            velocity = self.axes.level(snapshot.column("velocity").values)[moves]
            held, *flow = self.grid.spread(place, np.cbrt(volume), [volume, *(volume * velocity.T)])
            there = held >= self.limit * self.grid.spacing**2
            speed = np.linalg.norm(np.divide(flow, held, out=np.zeros_like(flow), where=there), axis=0)
            self.largest_speed = np.where(there, np.fmax(self.largest_speed, speed), self.largest_speed)
            self.arrival = np.where(there & ~np.isfinite(self.arrival), snapshot.time, self.arrival)
            self.times.append(snapshot.time)
            self.thickness.append(self._even(held))
            self.covered.append(there)
            self.volume.append(volume.sum())
            self.path.append(np.average(place, axis=0, weights=volume) if len(place) else np.full(3, np.nan))
        self.thickness, self.path = np.array(self.thickness), np.array(self.path)

    def _ends(self, first, last):
        """The crown at the start and the toe of the deposit."""
        self.start = self.axes.level(first.position())[np.isin(first.ids(), self.sliding, assume_unique=True)]
        self.crown = self.start[self.start[:, 2].argmax()]
        # the toe is the cell of the deposit that is furthest from the crown; its elevation is that of the lowest particle there
        east, north = (at[self.covered[-1]] for at in np.meshgrid(*self.grid.centres(), indexing="ij"))
        far = np.hypot(east - self.crown[0], north - self.crown[1]).argmax()
        toe = np.array([east[far], north[far], 0.0])
        slid = np.isin(last.ids(), self.sliding, assume_unique=True)
        end, size = self.axes.level(last.position())[slid], np.cbrt(last.column("volume").values[slid, 0])
        near = np.abs(end[:, :2] - toe[:2]).max(axis=1) <= 1.000001 * (self.grid.spacing + size) / 2
        self.toe = np.array([*toe[:2], end[near, 2].min()])

    def numbers(self):
        """Measures of the deposit, by their names with units, as attributes of its outline."""
        deposit, area = self.thickness[-1], self.covered[-1].sum() * self.grid.spacing**2
        way = (self.toe - self.crown)[:2]
        travel, fall = np.linalg.norm(way), self.crown[2] - self.toe[2]
        front = ((self.start[:, :2] - self.crown[:2]) @ way).max() / max(travel, 1e-300)  # at the start, in the same direction
        inside = deposit[self.covered[-1]].sum() * self.grid.spacing**2
        return {"area_m2": area, "volume_in_outline_m3": inside, "travel_distance_m": travel, "run_out_from_toe_m": travel - front, "fall_height_m": fall,
                "angle_of_reach_deg": np.degrees(np.arctan2(fall, travel)), "mean_thickness_m": inside / area,
                "largest_thickness_m": deposit.max(), "least_thickness_m": self.limit, "time_s": self.times[-1]}
