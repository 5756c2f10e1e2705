"""Draws the ground in 3D: the soil's surface with a field on it, shaded, the body whole or cut open, and the bottom of the mesh below it.

The surface is one height over each place, so a parallel projection can be drawn column by column of the picture: along the line of sight the first
sample that rises above all nearer ones is what is seen. This needs no graphics card, no display and no further package: VTK of Debian 12 draws
only through an X server.
"""

import numpy as np
from matplotlib.colors import to_rgb

from talus_ground import Filling, smoothed
from talus_soils import without_islands

SOIL, EARTH = np.array(to_rgb("#b8b2a7")), np.array(to_rgb("#d9cfbd"))  # of soil without a value, and of the mesh's bottom
FINER = 2  # samples per pixel along each axis
RAISED, TURNED = np.radians(30), np.radians(50)  # the eye above the horizon, and beside the direction of the slide
DARKEST = 0.55
NOTHING, GROUND, BODY = 0, 1, 2  # what a pixel shows
FLAT = 0.005  # of the interval of contours: ground that differs by less is level


class Eye:
    """Parallel projection: `forward` points from the eye into the picture on the level [3], `up` is the upward axis [3]."""

    def __init__(self, forward, up):
        self.level, self.up = forward / np.linalg.norm(forward), up
        self.right = np.cross(self.level, up)
        self.top = np.cos(RAISED) * up + np.sin(RAISED) * self.level

    @classmethod
    def in_front(cls, motion, along, up):
        """One that sees the front of soil that moves along an axis with this sign, to the right of the picture."""
        return cls.before(np.sign(motion or 1) * np.eye(3)[along], up)

    @classmethod
    def before(cls, along, up):
        """The same of soil that moves in a level direction [3]."""
        up = np.eye(3)[up]
        return cls(-np.cos(TURNED) * along + np.sin(TURNED) * np.cross(up, along), up)

    def flat(self, points):
        """Points [..., 3] on the picture [..., 2] in m."""
        return np.stack([points @ self.right, points @ self.top], axis=-1)


class Sight:
    """What is seen of the ground at one time: the place [rows, columns, 3], what it is, and how light it is, for each sample of a picture."""

    def __init__(self, place, what, light):
        self.place, self.what, self.light = place, what, light

    def painted(self, position, value, colours, spacing, reach=0):
        """The picture [rows, columns, 3] of a field of the particles; `reach` [pixels] as in talus_soils.painted."""
        rgb = np.where((self.what == NOTHING)[..., None], np.float32(1), EARTH.astype(np.float32) * self.light[..., None].astype(np.float32))
        body = self.what == BODY
        fields = [value == number for number in range(len(colours.names))] or [value]  # a mean of states would be another state
        found = np.array([Filling(position, field.astype(float), spacing).at(self.place[body]) for field in fields])
        found = np.where(np.isfinite(found[0]), found.argmax(axis=0), np.nan) if colours.names else found[0]
        level = np.ma.filled(colours.norm(found), np.nan)
        plain = np.ones(self.what.shape, bool)
        plain[body] = colours.plain(found)
        plain = plain[body] if colours.names else without_islands(plain, FINER * reach)[body] | ~np.isfinite(found)
        rgb[body] = np.where(plain[:, None], SOIL.astype(np.float32), colours.map(level, bytes=True)[:, :3] / np.float32(255)) * self.light[body][:, None]
        rows, columns = (count // FINER * FINER for count in self.what.shape)
        return sum(rgb[i:rows:FINER, j:columns:FINER] for i in range(FINER) for j in range(FINER)) / FINER**2


def lightness(normal, eye):
    """How light a face is, from DARKEST to 1, under a lamp above the eye's left shoulder."""
    lamp = -0.6 * eye.right + 0.65 * eye.up - 0.3 * eye.level
    return DARKEST + (1 - DARKEST) * np.clip(normal @ (lamp / np.linalg.norm(lamp)), 0, 1)


def shades(ground, top, soil, eye):
    """How light the surface is in each cell of the grid. Soil that stands on the bottom of the mesh darkens what is beside it, but does not light it."""
    light = []
    for height in (np.where(soil, top, ground.base), ground.base):
        slope = np.gradient(smoothed_inside(height, ground.spacing / ground.cell), ground.cell)
        normal = np.ones((*ground.shape, 3))
        normal[..., ground.level[0]], normal[..., ground.level[1]] = -slope[0], -slope[1]
        light.append(lightness(normal / np.linalg.norm(normal, axis=-1, keepdims=True), eye))
    return np.where(soil, light[0], np.minimum(*light))


def seen_from_above(ground, top, soil, eye, low, high, columns):
    """As `seen`, but vertically from above: the first level axis to the right, the second up."""
    pixel = (high[0] - low[0]) / (columns * FINER)
    first, second = (low[k] + (np.arange(int(round((high[k] - low[k]) / pixel))) + 0.5) * pixel for k in (0, 1))
    second, first = np.meshgrid(second, first, indexing="ij")
    place = [(at - ground.low[axis]) / ground.cell for at, axis in zip((first, second), ground.level)]
    light, height, covered, filled = between(np.stack([shades(ground, top, soil, eye), top, soil, ground.inside], axis=-1), place)
    beyond = np.any([(at < ground.low[axis]) | (at > ground.high[axis]) for at, axis in zip((first, second), ground.level)], axis=0)
    point = np.zeros((*first.shape, 3))
    for axis, at in zip((*ground.level, ground.up), (first, second, height - 0.5 * ground.spacing)):
        point[..., axis] = at
    return Sight(point, np.where(beyond | (filled <= 0.5), NOTHING, np.where(covered > 0.5, BODY, GROUND)), light)


def seen(ground, top, soil, eye, low, high, columns, cut=None):
    """The Sight of a picture with corners `low`, `high` [m on the picture] and so many columns. `top` and `soil` are those of Ground.surface. What is
    nearer to the eye than the vertical plane `cut`, its level normal [3] and its place along that [m], is cut away."""
    box = np.array([ground.low, ground.high])
    pixel = (high[0] - low[0]) / (columns * FINER)
    across = low[0] + (np.arange(columns * FINER) + 0.5) * pixel
    upward = low[1] + (np.arange(int(round((high[1] - low[1]) / pixel))) + 0.5) * pixel
    # each column of the picture is a vertical plane: where it enters and leaves the box
    start = np.outer(across, eye.right)
    into = [at if abs(at := eye.level[axis]) > 1e-6 else 1e-6 for axis in ground.level]  # never along a side of the box
    ends = np.stack([(box - start[:, None, :])[:, :, axis] / at for axis, at in zip(ground.level, into)], axis=-1)  # [columns, 2, 2]
    nearer, further = ends.min(axis=1), ends.max(axis=1)
    enters, leaves = nearer.max(axis=1), further.min(axis=1)
    face = np.array(ground.level)[nearer.argmax(axis=1)]  # the axis of the side through which it enters
    wall = -np.sign(eye.level[face])[:, None] * np.eye(3)[face]
    if cut:
        normal, place = cut
        first = (place - start @ normal) / (eye.level @ normal)
        wall = np.where((first > enters)[:, None], -np.sign(eye.level @ normal) * normal, wall)
        enters = np.maximum(enters, first)
    count = int(np.ceil(max((leaves - enters).max(), 0) / (0.7 * ground.cell))) + 2
    deep = enters[:, None] + np.linspace(0, 1, count) * np.maximum(leaves - enters, 0)[:, None]
    place = [(start[:, None, axis] + deep * eye.level[axis] - ground.low[axis]) / ground.cell for axis in ground.level]
    top, base, light, covered, filled = between(np.stack([top, ground.base, shades(ground, top, soil, eye), soil, ground.inside], axis=-1), place)
    covered, filled = covered > 0.5, (filled > 0.5) & (leaves > enters)[:, None]
    height = np.where(filled, np.where(covered, np.maximum(top, base), base), ground.floor)
    # before the first sample a wall rises from the floor
    deep, base, covered, filled, light = (np.concatenate([array[:, :1], array], axis=1) for array in (deep, base, covered, filled, light))
    height = np.concatenate([np.full((len(across), 1), ground.floor), height], axis=1)
    shown = np.cos(RAISED) * height + np.sin(RAISED) * deep
    risen = np.maximum.accumulate(shown, axis=1)
    # the first sample of each column that is at least as high as the row: one search in all columns, one lifted above the other
    lift = np.arange(len(across)) * 2.0 * (max(risen.max(), upward[-1]) - min(risen.min(), upward[0]) + 1.0)
    k = np.searchsorted((risen + lift[:, None]).ravel(), (upward + lift[:, None]).ravel()).reshape(len(across), -1)
    k -= np.arange(len(across))[:, None] * deep.shape[1]
    hit = (k > 0) & (k < deep.shape[1])
    k = np.clip(k, 1, deep.shape[1] - 1)

    def take(array, number):
        return np.take_along_axis(array, number, axis=1)

    before, after = take(shown, k - 1), take(shown, k)
    share = np.clip(np.divide(upward - before, after - before, out=np.ones_like(after), where=after > before), 0, 1)
    depth = take(deep, k - 1) * (1 - share) + take(deep, k) * share
    tall = take(height, k - 1) * (1 - share) + take(height, k) * share
    what = np.where(hit & take(filled, k), np.where(take(covered, k) & (tall > take(base, k)), BODY, GROUND), NOTHING)
    point = start[:, None, :] + depth[..., None] * eye.level
    on_wall = take(height, k) - tall > 0.5 * ground.spacing  # elsewhere the field is that of half a spacing down, among the particles
    point[..., ground.up] = np.where(on_wall, tall, tall - 0.5 * ground.spacing)
    side = lightness(wall, eye)
    shine = np.where(k == 1, side[:, None], take(light, k))
    return Sight(point.transpose(1, 0, 2), what.T, shine.T)


def without_flats(height, levels, reach):
    """Heights [rows, columns] without those that are level ground at one of the `levels` of contours, wider than twice `reach` [cells]: there a contour would
    follow round-off."""
    off = np.abs((height - levels[0]) / (levels[1] - levels[0]) % 1 - 0.5)  # half an interval at a level, 0 between two
    return np.ma.masked_where(without_islands(np.ma.filled(off > 0.5 - FLAT, False), reach), height)


def smoothed_inside(values, deviation):
    """Values smoothed, at the edges of the grid with what is inside it."""
    return smoothed(values, deviation) / smoothed(np.ones_like(values), deviation)


def between(values, place):
    """Values on the grid [cells, cells, n] interpolated at places [cells]: n arrays. Beyond the centres of the outermost cells theirs."""
    values = values.astype(np.float32)
    at = [np.clip(along - 0.5, 0, size - 1) for along, size in zip(place, values.shape)]
    (i, j) = (np.minimum(one.astype(np.int32), size - 2) for one, size in zip(at, values.shape))
    (x, y) = ((one - first).astype(np.float32)[..., None] for one, first in zip(at, (i, j)))
    result = (values[i, j] * (1 - x) + values[i + 1, j] * x) * (1 - y) + (values[i, j + 1] * (1 - x) + values[i + 1, j + 1] * x) * y
    return np.moveaxis(result, -1, 0)
