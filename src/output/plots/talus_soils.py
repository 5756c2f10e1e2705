"""The soils of a section: their colours where a field has nothing to show, the lines between them, and where their outline has moved."""

import numpy as np
from matplotlib.colors import to_rgb

import talus_style as style
from talus_ground import widest
from talus_tiles import touching

LINE = 0.6  # how dark the line between two soils is
SHORTEST = 4  # pieces of an outline that are seen, over the reach within which it counts as the present edge


def tints(names):
    """Colours of these soils [soils, 3], as in the picture of the model."""
    return np.array([to_rgb(colour) for colour in style.soil_colours(names)])


def without_islands(plain, reach):
    """Of a mask [rows, columns] what is wider than about twice `reach` [pixels], with the corners and ends of it: a single cell whose value happens to be
    nothing would look like a hole."""
    if reach < 1 or not plain.any() or plain.all():
        return plain
    kept = ~widest(~plain, reach)
    for _ in range(4 * reach):
        before, kept = kept, touching(kept) & plain
        if np.array_equal(kept, before):
            break
    return kept


def painted(owner, value, body, tint, colours, reach=0):
    """The picture [rows, columns, 4] of a section: `owner` numbers the particle of each pixel, -1 outside the soil; `value` and `body` belong to the
    particles, and `tint` holds the colours of the bodies. Soil has its own colour where the field is nothing in areas wider than twice `reach`."""
    soil = owner >= 0
    mine = owner[soil]
    # the colours of particles, of which there are fewer than of pixels: those of their soils, then those of the field
    colour = np.concatenate([tint[body], colours.map(np.ma.filled(colours.norm(value), np.nan))[:, :3]]).astype(np.float32)
    plain = np.ones(owner.shape, bool)
    plain[soil] = colours.plain(value)[mine]
    plain = plain[soil] if colours.names else without_islands(plain, reach)[soil] | ~np.isfinite(value)[mine]
    picture = np.zeros((*owner.shape, 4), np.float32)
    picture[soil, :3] = colour[np.where(plain, mine, len(value) + mine)]
    picture[soil, 3] = 1
    dark = borders(np.where(soil, body[owner], -1)) if len(tint) > 1 else np.zeros(owner.shape, bool)
    picture[dark, :3] = (1 - LINE) * picture[dark, :3] + LINE * np.array(to_rgb(style.INK))
    return picture


def borders(body):
    """Pixels beside another soil; `body` is -1 outside the soil."""
    found = np.zeros(body.shape, bool)
    for axis in (0, 1):
        before, after = (slice(None),) * axis + (slice(None, -1),), (slice(None),) * axis + (slice(1, None),)
        other = (body[before] != body[after]) & (body[before] >= 0) & (body[after] >= 0)
        found[before] |= other
        found[after] |= other
    return found


def middles(body):
    """{number: (row, column)} of a pixel in the middle of each soil, in which its name can stand."""
    found = {}
    for number in np.unique(body[body >= 0]):
        rows, columns = np.nonzero(body == number)
        away = (rows - rows.mean()) ** 2 + (columns - columns.mean()) ** 2
        found[int(number)] = (rows[away.argmin()], columns[away.argmin()])
    return found


def moved_away(line, soil, frame, reach):
    """A polyline [n, 2] with gaps (not a number) where the edge of the soil [rows, columns] is within `reach` [m]: an outline of the start that lies on the
    present one says nothing and is not seen."""
    step = np.linalg.norm(np.diff(line, axis=0), axis=1)
    along = np.concatenate([[0], np.cumsum(step)])
    if along[-1] == 0:
        return np.full((1, 2), np.nan)
    at = np.linspace(0, along[-1], int(np.ceil(along[-1] / frame.pixel)) + 1)
    points = np.column_stack([np.interp(at, along, line[:, k]) for k in (0, 1)])
    wide = max(1, int(round(reach / frame.pixel)))
    size = 2 * wide + 1
    sums = np.pad(np.pad(soil, size).astype(np.int64).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    column, row = (np.clip(((points[:, k] - frame.low[k]) / frame.pixel).astype(int), -wide, soil.shape[1 - k] - 1 + wide) + size for k in (0, 1))
    low, high = np.array([row, column]) - wide, np.array([row, column]) + wide + 1
    count = sums[high[0], high[1]] - sums[low[0], high[1]] - sums[high[0], low[1]] + sums[low[0], low[1]]
    apart = (count == 0) | (count == size**2)
    ends = np.flatnonzero(np.diff(np.concatenate([[0], apart.astype(int), [0]])))
    for first, last in zip(ends[::2], ends[1::2]):
        if last - first < SHORTEST * wide:
            apart[first:last] = False
    return np.where(apart[:, None], points, np.nan)
