"""The ground of a run in 3D: heights of the soil's surface and of the mesh's bottom over a level grid, and fields inside the soil."""

import numpy as np

from talus_tiles import EDGE, GAP, Frame, shifted, tiles

MOST_CELLS = 700  # of the level grid along its longer side
MOST_BOXES = 12_000_000  # of the grid in space that holds a field
BOX, EMPTY = 1.25, 0.3  # size of such a box, over the spacing of particles, and weight of one that has none
KNOWN = 0.4  # share of the particles near a place, within one or two boxes, that have a value where the field has one: single particles without do not count
LOOSE = 1.5  # most heights of soil over the height that its volume fills
BESIDE = 5  # rounds, each of two cells, in which heights go on beyond the ground for its shading
SMOOTH = 1.0  # standard deviation of the smoothing of the surface, over the spacing of particles


class Ground:
    """A level grid over the soil, with the bottom of the mesh. Arrays on it are [cells along, cells aside]; heights are in m."""

    def __init__(self, low, high, spacing, level, up, mesh):
        """`low`, `high` are the corners of what is shown [3, m], `level` the two level axes, `up` the third, `mesh` (nodes, tetrahedra)."""
        self.level, self.up, self.spacing = list(level), up, spacing
        node, cell = mesh
        if len(cell):
            low, high = np.maximum(low, node.min(axis=0)), np.minimum(high, node.max(axis=0))
        self.low, self.high = low, high
        size = (high - low)[self.level]
        self.cell = max(spacing / 2, size.max() / MOST_CELLS)
        self.shape = tuple(np.maximum(2, np.ceil(size / self.cell - 1e-6).astype(int)))
        self.base = self._bottom(node, cell) if len(cell) else np.full(self.shape, low[up])
        self.inside = np.isfinite(self.base)
        self.floor = float(self.base[self.inside].min()) if self.inside.any() else float(low[up])  # the lowest point that is shown
        self.base = beside(self.base, self.inside, self.floor)

    def number(self, position):
        """The cell of each place as one number, -1 outside the grid."""
        index = np.floor((position[:, self.level] - self.low[self.level]) / self.cell).astype(int)
        outside = ((index < 0) | (index >= self.shape)).any(axis=1)
        return np.where(outside, -1, index[:, 0] * self.shape[1] + index[:, 1])

    def highest(self, position, sign=1.0):
        """The highest place in each cell, or the lowest for a `sign` of -1; minus or plus infinity where there is none."""
        number, height = self.number(position), sign * position[:, self.up]
        number, height = number[number >= 0], height[number >= 0]
        order = np.argsort(number, kind="stable")
        found, first = np.unique(number[order], return_index=True)
        result = np.full(self.shape[0] * self.shape[1], -np.inf)
        if len(found):
            result[found] = np.maximum.reduceat(height[order], first)
        return sign * result.reshape(self.shape)

    def _bottom(self, node, cell):
        """The lowest height of the mesh in each cell of the grid; not finite outside the mesh."""
        faces = np.sort(np.concatenate([np.delete(cell, k, axis=1) for k in range(4)]), axis=1).astype(np.int64)
        _, first, count = np.unique((faces[:, 0] * len(node) + faces[:, 1]) * len(node) + faces[:, 2], return_index=True, return_counts=True)
        corner = node[faces[first[count == 1]]]  # [faces of the boundary, 3 corners, 3]
        longest = np.sqrt(max_of((corner - np.roll(corner, 1, axis=1))[:, :, self.level]))
        steps = np.maximum(1, np.ceil(longest / (0.6 * self.cell)).astype(int))
        lowest = np.full(self.shape, np.inf)
        for count in np.unique(steps):
            first, second = (part.ravel() for part in np.meshgrid(np.arange(count + 1), np.arange(count + 1)))
            keep = first + second <= count
            share = np.stack([first[keep], second[keep], count - first[keep] - second[keep]], axis=1) / count
            lowest = np.minimum(lowest, self.highest((share @ corner[steps == count]).reshape(-1, 3), sign=-1.0))
        return self._without_overhangs(lowest, float(np.median(longest)))

    def _without_overhangs(self, lowest, width):
        """Cells of the mesh that hang over a place where it has none, at the rough edge of a hole, are no ground: narrow peaks, higher than wide."""
        hole = ~np.isfinite(lowest)
        if not hole.any():
            return lowest
        reach = max(1, int(round(width / self.cell)))
        opened = widest(np.where(hole, -np.inf, -widest(-lowest, reach)), reach)
        return np.where(~hole & (widest(hole.astype(float), reach) > 0) & (lowest > opened + width), np.inf, lowest)

    def surface(self, position, size, volume):
        """Heights of the soil's surface, and where there is soil, from the places [n, 3], widths [n] and volumes [n] of the particles. The surface is
        the envelope of the highest particles, closed over gaps as wide as in sections, smoothed, and raised by the half width that soil reaches beyond
        its particles. Soil that flies or spreads so thin that it would stand on mostly air is laid down: widths are in steps, and would not tell how
        much air is in it."""
        frame = Frame(self.low[self.level][::-1], (self.low[self.level] + np.array(self.shape) * self.cell)[::-1], self.shape[1])
        owner = tiles(position[:, self.level[::-1]], size, frame)[:self.shape[0], :self.shape[1]]
        soil = (owner >= 0) & self.inside
        highest, number = self.highest(position), self.number(position)
        held = np.bincount(number[number >= 0], volume[number >= 0], self.base.size).reshape(self.shape) / self.cell**2
        top = self.base.copy()
        over, count = (smoothed(np.where(soil, of, 0.0), 2 * self.spacing / self.cell) for of in (np.log2(size[owner] / self.spacing), 1.0))
        coarser = np.where(soil, np.clip(np.round(over / np.maximum(count, 1e-9)), 0, 5), -1)  # how much larger particles are there, as a power of two
        for power in np.unique(coarser[soil]):
            width = 2**power * self.spacing / self.cell
            reach = max(1, int(round(GAP * width)))
            closed = -widest(np.where(soil, -widest(highest, reach), -np.inf), reach)
            known = soil & np.isfinite(closed)
            weight, height = smoothed(known.astype(float), SMOOTH * width), smoothed(np.where(known, closed, 0.0), SMOOTH * width)
            height = np.divide(height, weight, out=self.base.copy(), where=weight > 1e-6) + EDGE * width * self.cell
            wide = 1.5 * width
            thick = np.divide(smoothed(held, wide), smoothed(soil.astype(float), wide), out=np.zeros(self.shape), where=soil)
            limit = np.where(soil, self.base + LOOSE * thick + 0.5 * width * self.cell, np.inf)
            mine = (coarser == power) | (~soil & (power == 0))
            top = np.where(mine, np.clip(height, self.base, limit), top)
        return top, soil

    def below(self, position, top):
        """The places of particles, laid down where they are above the surface `top`."""
        number = self.number(position)
        result = position.copy()
        result[:, self.up] = np.where(number >= 0, np.minimum(position[:, self.up], top.ravel()[number] - EDGE * self.spacing), position[:, self.up])
        return result


def max_of(edges):
    return (edges**2).sum(axis=-1).max(axis=1)


def widest(values, reach):
    """The largest value within so many cells along both axes."""
    for axis in range(values.ndim):
        at, size = (slice(None),) * axis, values.shape[axis]
        result = np.pad(values, [(reach, reach) if along == axis else (0, 0) for along in range(values.ndim)], mode="edge")
        width, whole = 1, 2 * reach + 1
        while width < whole:  # the largest of so many cells from each one on
            step = min(width, whole - width)
            np.maximum(result[(*at, slice(None, -step))], result[(*at, slice(step, None))], out=result[(*at, slice(None, -step))])
            width += step
        values = result[(*at, slice(size))]
    return values


def smoothed(values, deviation):
    """Values smoothed by a Gaussian bell of this standard deviation [cells]; nothing beyond the edges."""
    reach = max(1, int(np.ceil(2.5 * deviation)))
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) / deviation) ** 2)
    for axis in range(values.ndim):
        result = np.zeros_like(values)
        for by, weight in zip(range(-reach, reach + 1), bell / bell.sum()):
            to, source = shifted(values.shape[axis], by)
            at = (slice(None),) * axis
            result[(*at, to)] += weight * values[(*at, source)]
        values = result
    return values


def beside(values, known, otherwise):
    """Values around those that are known: means of the cells beside them, some cells away `otherwise`."""
    for _ in range(BESIDE if not known.all() else 0):
        weight, total = (smoothed(array, 1.0) for array in (known.astype(float), np.where(known, values, 0.0)))
        found = ~known & (weight > 1e-6)
        values = np.where(found, total / np.maximum(weight, 1e-6), values)
        known = known | found
    return np.where(known, values, otherwise)


class Filling:
    """A field inside the soil: means over boxes in space of about the spacing of particles, interpolated linearly. Single particles whose value is not
    a number do not count; where most are such, as in soil of a law without this field, it has no value."""

    def __init__(self, position, value, spacing):
        known = np.isfinite(value)
        self.low = position.min(axis=0) - 1.5 * spacing if len(position) else np.zeros(3)
        size = position.max(axis=0) + 1.5 * spacing - self.low if len(position) else np.ones(3)
        self.box = max(BOX * spacing, float((np.prod(size) / MOST_BOXES) ** (1 / 3)))
        self.shape = np.ceil(size / self.box).astype(int) + 1
        index = np.floor((position - self.low) / self.box).astype(int)
        number = np.ravel_multi_index(index.T, self.shape)
        total, count = (np.bincount(number[known], weights, np.prod(self.shape)).reshape(self.shape) for weights in (value[known], None))
        near_total, near_count = (smoothed(array.astype(float), 1.0) for array in (total, count))
        # boxes that chance left empty have the mean of their neighbours, with a smaller weight
        self.weight = np.where(count > 0, 1, EMPTY * np.minimum(near_count, 1)).ravel().astype(np.float32)
        near_mean, mean = (np.divide(*parts, out=np.zeros(self.shape), where=parts[1] > 1e-9) for parts in ((near_total, near_count), (total, count)))
        self.mean = np.where(count > 0, mean, near_mean).ravel().astype(np.float32)
        self.all = None  # where not all have a value: particles near each box, and the share of those that have one
        if not known.all():
            near_all = smoothed(np.bincount(number, None, np.prod(self.shape)).reshape(self.shape).astype(float), 1.0)
            self.all = near_all.ravel().astype(np.float32)
            self.share = np.divide(near_count, near_all, out=np.zeros(self.shape), where=near_all > 1e-9).ravel().astype(np.float32)

    def at(self, places):
        """The field at places [n, 3]; not a number where no particle is near, or where few of those have a value."""
        field = self._interpolated(places, self.mean, self.weight)
        return field if self.all is None else np.where(self._interpolated(places, self.share, self.all) >= KNOWN, field, np.nan)

    def _interpolated(self, places, mean, of_box):
        exact = np.clip((places - self.low) / self.box - 0.5, 0, self.shape - 1.001)
        first = exact.astype(np.int32)
        share = (exact - first).astype(np.float32)
        stride = np.array([self.shape[1] * self.shape[2], self.shape[2], 1])
        row = first @ stride
        total, count = (np.zeros(len(places), np.float32) for _ in range(2))
        for corner in np.ndindex(2, 2, 2):
            weight = np.ones(len(places), np.float32)
            for axis, upper in enumerate(corner):
                weight *= share[:, axis] if upper else 1 - share[:, axis]
            at = row + int(corner @ stride)
            weight *= of_box[at]
            total += weight * mean[at]
            count += weight
        return np.divide(total, count, out=np.full(len(places), np.nan), where=count > 1e-9)
