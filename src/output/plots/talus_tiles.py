"""Turns particles into areas: each pixel shows its nearest particle, so that the soil has no gaps and a sharp edge."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.tri import Triangulation

GAP = 1.4   # widest gap between particles that is closed, as a radius over their spacing
GAP_IN_SPACE = 2.2  # the same in 3D, where the few particles of a tetrahedron leave larger gaps
EDGE = 0.5  # soil beyond its outermost particles, over their spacing
POINT = 4000  # pixels that take as long as what a point takes whatever its size


class Frame:
    """A rectangle of the plane in pixels: `low`, `high` are its corners [m], row 0 is at the bottom."""

    def __init__(self, low, high, columns):
        self.low, self.high = np.asarray(low, float), np.asarray(high, float)
        self.pixel = (self.high[0] - self.low[0]) / columns
        self.shape = (max(1, int(round((self.high[1] - self.low[1]) / self.pixel))), columns)

    def extent(self):
        return (self.low[0], self.high[0], self.low[1], self.high[1])


def tiles(points, size, frame, aside=None):
    """For each pixel the number of its nearest particle, -1 outside the soil. `size` [m] is the width of all particles or of each, which measures
    distances; `aside` are their distances from the plane of the pixels [m]."""
    if not len(points):
        return np.full(frame.shape, -1, np.int32)
    gap = GAP if aside is None else GAP_IN_SPACE
    size = np.broadcast_to(np.asarray(size, np.float32) / frame.pixel, len(points))
    owner, _ = nearest((points - frame.low) / frame.pixel, frame.shape, gap, size, None if aside is None else aside / frame.pixel)
    soil = owner >= 0
    rim = np.argwhere(~soil & touching(soil))[:, ::-1] + 0.5
    _, depth = nearest(rim, frame.shape, (gap - EDGE) * size.max(initial=0), np.ones(len(rim), np.float32))
    owner[soil & (depth <= (gap - EDGE) * size[owner])] = -1
    return owner


def nearest(points, shape, reach, size, aside=None):
    """Number of and distance to the nearest of some points (in pixels: column, row, and their distance aside), -1 and infinity beyond `reach`.
    Distances are counted in the size of the point."""
    owner = np.full(shape, -1, np.int32)
    if not len(points):
        return owner, np.full(shape, np.inf, np.float32)
    x, y = points.astype(np.float32).T
    scale = (1 / size**2).astype(np.float32)
    z2 = np.zeros_like(x) if aside is None else aside.astype(np.float32) ** 2
    row, column = y.astype(int), x.astype(int)
    seen = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
    jumps = [*(2**k for k in range(int(np.ceil(np.log2(max(reach * np.max(size), 1)))) - 1, -1, -1)), 1]
    pixels_around = (2 * reach * size[seen].astype(float)) ** 2
    if np.sum(pixels_around + POINT) < 8 * len(jumps) * owner.size:
        squared = by_points(np.flatnonzero(seen), x, y, z2, scale, reach * size, owner)
    else:
        squared = by_jumps(seen, jumps, x, y, z2, scale, owner)
    far = squared > reach**2
    owner[far] = -1
    distance = np.sqrt(squared)
    distance[far] = np.inf
    return owner, distance


def by_points(seen, x, y, z2, scale, half, owner):
    """The squares of the distances to the nearest points, whose numbers `owner` gets: point by point, in the square of `half` a width around it. Cheap where
    points are few and large."""
    shape = owner.shape
    squared = np.full(shape, np.inf, np.float32)
    centre_y, centre_x = (np.arange(size, dtype=np.float32) + 0.5 for size in shape)
    centre = np.column_stack([y, x])
    low, high = (np.clip(np.floor(centre + side * half[:, None]).astype(int), 0, shape) for side in (-1, 1))
    for k in seen:
        around = slice(low[k, 0], high[k, 0] + 1), slice(low[k, 1], high[k, 1] + 1)
        distance = (centre_x[around[1]] - x[k]) ** 2 + ((centre_y[around[0]] - y[k]) ** 2 + z2[k])[:, None]
        distance *= scale[k]
        nearer = distance < squared[around]
        np.copyto(squared[around], distance, where=nearer)
        np.copyto(owner[around], k, where=nearer)
    return squared


def by_jumps(seen, jumps, x, y, z2, scale, owner):
    """The same for all pixels at once, which ask those so many jumps away for their points. Cheap where points are many.

    Jump flooding: Rong & Tan (2006), Jump flooding in GPU with applications to Voronoi diagrams."""
    shape = owner.shape
    row, column = y.astype(int), x.astype(int)
    seen = np.flatnonzero(seen)[np.argsort(-(scale * z2)[seen], kind="stable")]  # of several in a pixel the one nearest to the plane stays
    owner[row[seen], column[seen]] = seen
    centre_y, centre_x = (np.arange(size, dtype=np.float32) + 0.5 for size in shape)
    squared = np.full(shape, np.inf, np.float32)
    # what is known of the owner of each pixel, beside the pixel: to look it up by number for all pixels would take most of the time
    its_x, its_y, its_z2, its_scale = (np.full(shape, value, np.float32) for value in (0, 0, 0, np.inf))

    def own(pixels, points, distance):
        for field, values in ((owner, points), (squared, distance), (its_x, x[points]), (its_y, y[points]), (its_z2, z2[points]),
                              (its_scale, scale[points])):
            field.ravel()[pixels] = values

    pixels = np.flatnonzero(owner >= 0)
    rows, columns = np.divmod(pixels, shape[1])
    mine = owner.ravel()[pixels]
    own(pixels, mine, scale[mine] * ((x[mine] - centre_x[columns]) ** 2 + (y[mine] - centre_y[rows]) ** 2 + z2[mine]))
    for step in jumps:
        for down, right in ((i, j) for i in (-step, 0, step) for j in (-step, 0, step) if i or j):
            to_rows, from_rows = shifted(shape[0], down)
            to_columns, from_columns = shifted(shape[1], right)
            there = from_rows, from_columns
            distance, along_y = its_x[there] - centre_x[to_columns], its_y[there] - centre_y[to_rows, None]
            distance *= distance
            along_y *= along_y
            distance += along_y
            distance += its_z2[there]
            distance *= its_scale[there]
            nearer = np.flatnonzero(distance < squared[to_rows, to_columns])
            rows, columns = np.divmod(nearer, max(1, distance.shape[1]))
            pixels = (rows + to_rows.start) * shape[1] + columns + to_columns.start
            own(pixels, owner.ravel()[pixels + down * shape[1] + right], distance.ravel()[nearer])
    return squared


def shifted(size, by):
    """Slices of an axis that pair each place with the one `by` further on."""
    if abs(by) >= size:
        return slice(0, 0), slice(0, 0)
    return slice(max(0, -by), size - max(0, by)), slice(max(0, by), size + min(0, by))


def touching(mask):
    """Places beside or in a mask."""
    wide = mask.copy()
    for axis in (0, 1):
        for by in (-1, 1):
            to, from_ = shifted(mask.shape[axis], by)
            wide[(slice(None),) * axis + (to,)] |= mask[(slice(None),) * axis + (from_,)]
    return wide


def outline_of_points(points, size, frame, aside=None):
    """Polylines around the soil."""
    soil = tiles(points, size, frame, aside) >= 0
    centres = [frame.low[k] + (np.arange(soil.shape[1 - k]) + 0.5) * frame.pixel for k in (0, 1)]
    figure, axes = plt.subplots()
    contour = axes.contour(*centres, soil.astype(float), levels=[0.5])
    plt.close(figure)
    return [line for line in contour.allsegs[0] if len(line) > 20]


def outline_of_cells(node, cell, position):
    """Polylines around the triangles that soil fills: exact, since bodies are made of cells."""
    mesh = Triangulation(node[:, 0], node[:, 1], cell)
    inside = mesh.get_trifinder()(position[:, 0], position[:, 1])
    filled = np.zeros(len(cell), bool)
    filled[inside[inside >= 0]] = True
    beside = np.where(mesh.neighbors >= 0, filled[mesh.neighbors], False)
    cells, sides = np.nonzero(filled[:, None] & ~beside)
    edges = np.column_stack([mesh.triangles[cells, sides], mesh.triangles[cells, (sides + 1) % 3]])
    return [node[chain] for chain in chained(edges)]


def chained(edges):
    """Edges as polylines of nodes, so that a dotted line runs on around them."""
    beside = {}
    for a, b in edges:
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    chains = []
    for start in [node for node, others in beside.items() if len(others) != 2] + list(beside):
        while beside[start]:
            chain = [start]
            while beside[chain[-1]]:
                following = beside[chain[-1]].pop()
                beside[following].remove(chain[-1])
                chain.append(following)
            chains.append(chain)
    return chains
