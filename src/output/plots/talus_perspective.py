"""Perspective views of what a scene models in 3D."""

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb

import talus_style as style
from talus_modelled import WATER, common_edges
from talus_symbols import SYMBOL, Symbols, keep_apart, named_points
from talus_units import quantity

EARTH, EARTH_NAME = "#dfe5e8", "grey"  # ground without soil
BESIDE = np.radians(20)  # of the eye, from the direction to which soil faces
LEVEL = 0.05  # slope of the top of soil that faces nowhere
LOWER = -0.05  # upward part of the outward normal of the bottom of the mesh


class Camera:
    """Central projection onto a plane. `towards` points from the middle of the soil to the eye; `up` is up."""

    def __init__(self, low, high, towards, up):
        self.up, self.middle, size = up, (low + high) / 2, np.linalg.norm(high - low)
        forward = -np.asarray(towards) / np.linalg.norm(towards)
        self.right = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
        self.top, self.forward = np.cross(self.right, forward), forward
        self.distance = 2.6 * size
        self.eye = self.middle - self.distance * forward

    def flat(self, points):
        """Points [..., 3] on the picture [..., 2], in metres at the middle of the soil."""
        from_eye = np.asarray(points, float) - self.eye
        shrink = self.distance / (from_eye @ self.forward)
        return np.stack([from_eye @ self.right * shrink, from_eye @ self.top * shrink], axis=-1)

    def sees(self, centres, normals):
        return ((self.eye - centres) * normals).sum(axis=-1) > 0

    def depth(self, points):
        return (np.asarray(points) - self.eye) @ self.forward


class Views:
    """The soil from above, from the side of the largest level coordinates, and from below, from the side of the smallest ones. On a terrain the first
    view looks at the ground around the soil too, from the side to which the soil faces."""

    WIDTHS = (6.4, 4.5)  # [inch]
    TALLEST, ROOM = 4.6, 1.0  # of the soil in a view, and beside it for dimensions [inch]

    def __init__(self, model):
        self.model = model
        self.up = np.eye(3)["xyz".index(model.data["up"])]
        level = np.eye(3)[np.flatnonzero(self.up == 0)]
        self.ground, self.rim = ground_of(model, self.up) if model.terrain else (np.zeros((0, 3, 3)), np.zeros((0, 2, 3)))
        self.towards = 0.55 * level[0] + 0.75 * level[1]
        downhill = facing(model, self.up) if model.terrain else None
        if downhill is not None:
            self.towards = np.linalg.norm(self.towards) * (np.cos(BESIDE) * downhill + np.sin(BESIDE) * np.cross(self.up, downhill))
        seen = [np.concatenate([model.corners, self.ground]), model.corners]
        self.lows, self.highs = ([of(corners, axis=(0, 1)) for corners in seen] for of in (np.min, np.max))
        self.cameras = [Camera(*box, side * (self.towards + 0.5 * self.up), self.up) for *box, side in zip(self.lows, self.highs, (1, -1))]
        boxes = [camera.flat(np.stack(np.meshgrid(*zip(low, high)), axis=-1).reshape(-1, 3)) for camera, low, high in zip(self.cameras, self.lows, self.highs)]
        self.middles = [(box.min(axis=0) + box.max(axis=0)) / 2 for box in boxes]
        sizes = [np.ptp(box, axis=0) for box in boxes]
        self.metres = [max(size[0] / (width - self.ROOM), size[1] / self.TALLEST) for size, width in zip(sizes, self.WIDTHS)]  # per inch
        self.height = max(size[1] / metres for size, metres in zip(sizes, self.metres)) + self.ROOM  # [inch]

    def title(self, number):
        """From where a view looks. Names of groups do not say it: the group front of a section is that at z = 0, which is seen in the second view."""
        height, end = (("above", "largest"), ("below", "smallest"))[number]
        if self.model.terrain:
            what = f"terrain ({EARTH_NAME}) and soil " * (len(self.ground) > 0 and number == 0)
            return f"{what}from {height}, from the {compass((1, -1)[number] * self.towards)}"
        level = " and ".join(axis for axis in "xyz" if axis != self.model.data["up"])
        return f"from {height}, from the side of the {end} {level}"

    def draw(self, axes, number):
        """Draws one of the views into axes of its width and of the common height."""
        camera, metres, middle = self.cameras[number], self.metres[number], self.middles[number]
        half = np.array([self.WIDTHS[number], self.height]) * metres / 2
        axes.set(xlim=(middle[0] - half[0], middle[0] + half[0]), ylim=(middle[1] - half[1], middle[1] + half[1]))
        axes.axis("off")
        self.faces(axes, camera, self.ground if number == 0 else self.ground[:0])
        for boundary in self.model.boundaries:
            symbols_of(axes, boundary, camera, metres)
        if number == 0:
            if len(self.rim):
                seen = self.rim[~hidden(self.rim, np.concatenate([self.model.corners, self.ground]), camera)]
                axes.add_collection(LineCollection(camera.flat(seen), colors=style.INK, linewidths=0.9, zorder=3), autolim=False)
            self.water(axes, camera, metres)
            named_points(axes, self.model, camera.flat)
        lines = edges(axes, camera, self.lows[number], self.highs[number], metres)
        soil = camera.flat(np.concatenate([self.model.corners, self.ground if number == 0 else self.ground[:0]]).reshape(-1, 3))
        directions(axes, camera, metres, ("x, east", "y, north", "z") if self.model.terrain else "xyz", np.concatenate([soil, *lines]))
        keep_apart(axes)

    def faces(self, axes, camera, ground):
        """The faces of the soil and of the ground that the camera sees, the furthest first."""
        model = self.model
        corners = np.concatenate([model.corners, ground])
        normal = np.concatenate([model.normal, normals_of(ground, self.up)])
        colours = np.array([to_rgb(colour) for colour in (*model.colours, EARTH)])[np.concatenate([model.body, np.full(len(ground), len(model.bodies))])]
        centres = corners.mean(axis=1)
        order = np.argsort(-camera.depth(centres))
        order = order[camera.sees(centres, normal)[order]]
        light = camera.right * -0.35 + camera.top * 0.8 - camera.forward * 0.5
        of_ground = np.arange(len(corners)) >= len(model.corners)
        lamp = -0.8 * camera.right + 0.5 * self.up  # low, from the left: the relief of the ground is weak beside that of cells
        shade = np.where(of_ground, 0.4 + 0.6 * np.clip(normal @ lamp / np.linalg.norm(lamp), 0, 1), 0.72 + 0.28 * np.clip(normal @ light, 0, 1))
        colours = colours * shade[:, None]
        thin = np.clip(40 / np.sqrt(len(corners)), 0.08, 0.4)
        line = np.where(of_ground[:, None], 0.94 * colours, to_rgb("#8d7b5c"))
        axes.add_collection(PolyCollection(camera.flat(corners[order]), fc=colours[order], ec=line[order], lw=thin, zorder=2), autolim=False)

    def water(self, axes, camera, metres):
        """The water tables on the side of the soil that faces the camera; a table is a line of x and y. Tables that are functions of the place are seen
        through the ground."""
        surface = np.array(self.model.data["water"].get("surface") or np.zeros((0, 3, 3)), float)
        axes.add_collection(PolyCollection(camera.flat(surface), fc=WATER, alpha=0.45, lw=0, zorder=3.5), autolim=False)
        low, high = self.lows[1], self.highs[1]
        front = high[2] if camera.eye[2] > camera.middle[2] else low[2]
        for _, points in self.model.water_lines():
            line = camera.flat(np.column_stack([points, np.full(len(points), front)]))
            axes.plot(*line.T, color=WATER, lw=1.6, zorder=6)
            Symbols(axes, SYMBOL * metres).level(*(0.88 * line[0] + 0.12 * line[1]))


def normals_of(faces, up):
    """Upward unit normals [n, 3] of triangles [n, 3, 3]."""
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return normal * np.where(normal @ up < 0, -1, 1)[:, None]


def ground_of(model, up):
    """The bottom of the mesh where no soil lies on it, triangles [n, 3, 3], and the rim of the soil upon it, pieces of a line [m, 2, 3]: where soil ends
    at the edge of the mesh there is none. Of faces on which some boundary acts."""
    faces = [(boundary.corners, boundary.has_soil, boundary.normal @ up < LOWER) for boundary in model.boundaries if len(boundary.corners)]
    if not faces:
        return np.zeros((0, 3, 3)), np.zeros((0, 2, 3))
    corners, soil, down = (np.concatenate(parts) for parts in zip(*faces))
    _, first = np.unique(np.round(corners.mean(axis=1), 6), axis=0, return_index=True)  # of two boundaries
    corners, soil, down = corners[first], soil[first], down[first]
    ground = corners[~soil & down]
    return ground, common_edges(corners[soil], ground)


def hidden(edges, faces, camera):
    """Which of some edges [n, 2, 3] lie behind faces [m, 3, 3], by more than their own length: soil has steps as high as a cell is."""
    result = np.zeros(len(edges), bool)
    flat, depth = camera.flat(faces), camera.depth(faces)
    low, high, nearest = flat.min(axis=1), flat.max(axis=1), depth.min(axis=1)
    middle = edges.mean(axis=1)
    sight = camera.depth(middle) - np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)
    for k, at in enumerate(camera.flat(middle)):
        near = np.flatnonzero((nearest < sight[k]) & (low <= at).all(axis=1) & (high >= at).all(axis=1))
        corner = flat[near] - at
        second, third = np.roll(corner, -1, axis=1), np.roll(corner, -2, axis=1)
        share = second[..., 0] * third[..., 1] - second[..., 1] * third[..., 0]  # of each corner, times twice the area
        total = share.sum(axis=1)
        inside = (share * np.sign(total)[:, None] >= 0).all(axis=1) & (total != 0)
        result[k] = ((share[inside] * depth[near[inside]]).sum(axis=1) / total[inside] < sight[k]).any()
    return result


def facing(model, up):
    """The level direction [3] to which the top of the soil faces, None where that is level."""
    top = model.normal @ up > 0
    face, normal = model.corners[top], model.normal[top]
    area = np.linalg.norm(np.cross(face[:, 1] - face[:, 0], face[:, 2] - face[:, 0]), axis=1)
    level = area @ normal * (up == 0)
    return level / np.linalg.norm(level) if np.linalg.norm(level) > LEVEL * area.sum() else None


def compass(direction):
    """The quarter from which a direction [3] to the eye comes, as a word; x is east and y north."""
    names = ("east", "northeast", "north", "northwest", "west", "southwest", "south", "southeast")
    return names[int(round(np.arctan2(direction[1], direction[0]) / (np.pi / 4))) % 8]


def symbols_of(axes, boundary, camera, metres):
    """The symbol of a boundary on some of its faces that the camera sees, and arrows of what it exerts there."""
    middle = boundary.corners.mean(axis=1)
    seen = np.flatnonzero(camera.sees(middle, boundary.normal) & boundary.has_soil)
    _, first = np.unique(np.floor(camera.flat(middle[seen]) / (0.26 * metres)).astype(int), axis=0, return_index=True)  # one in a quarter of an inch
    some = seen[first]
    hollow = {"mfc": "white"} if boundary.marker() == "o" else {}
    axes.plot(*camera.flat(middle[some]).T, boundary.marker(), color=boundary.colour, ms=4.2, mew=0.8, ls="none", zorder=4, **hollow)
    largest = np.linalg.norm(boundary.vector, axis=1).max(initial=0)
    for k in some if largest else ():
        way = 0.4 * metres * boundary.vector[k] / largest
        start = middle[k] - way if boundary.soil == "load" else middle[k]
        axes.annotate("", camera.flat(start + way), camera.flat(start), zorder=5,
                      arrowprops={"arrowstyle": "-|>", "color": boundary.colour, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})


def edges(axes, camera, low, high, metres):
    """The three dimensions of the soil, each beside that edge of its box that lies lowest in the picture, or furthest right. Points along the three lines, each
    [21, 2]."""
    middle = camera.flat((low + high) / 2)
    lines = []
    for axis in range(3):
        others = [one for one in range(3) if one != axis]
        ends = []
        for i in (0, 1):
            for j in (0, 1):
                begin = np.array((low, high)[0], float)
                begin[others[0]], begin[others[1]] = (low, high)[i][others[0]], (low, high)[j][others[1]]
                end = begin.copy()
                end[axis] = high[axis]
                ends.append(camera.flat([begin, end]))
        lowest = min(ends, key=lambda edge: -edge[:, 0].mean() if camera.up[axis] else edge[:, 1].mean())
        away = lowest.mean(axis=0) - middle
        lines.append(np.linspace(*(lowest + 0.28 * metres * away / np.linalg.norm(away)), 21))
    labelled = []
    for axis, line in enumerate(lines):
        axes.annotate("", line[0], line[-1], zorder=9, annotation_clip=False,
                      arrowprops={"arrowstyle": "<->", "color": style.SOFT, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
        beside = np.concatenate(lines[:axis] + lines[axis + 1:])
        places = line[[10, 7, 13, 4, 16]]  # the middle, unless another line or its label is there
        free = [min(gap(place[None], beside), 0.5 * gap(place[None], np.array(labelled))) if labelled else gap(place[None], beside) for place in places]
        at = places[next((k for k, distance in enumerate(free) if distance > 0.45 * metres), int(np.argmax(free)))]
        labelled.append(at)
        axes.text(*at, f"{'xyz'[axis]}: {quantity(high[axis] - low[axis], 'm', '.3g')}", ha="center", va="center", fontsize=8, zorder=10,
                  bbox={"fc": "white", "ec": "none", "pad": 1.2})
    return lines


def gap(some, others):
    """The least distance between points [n, 2] and [m, 2]."""
    return np.linalg.norm(some[:, None] - others[None], axis=2).min()


def directions(axes, camera, metres, names, taken):
    """Arrows along the axes of coordinates in the lower left corner, or at the lower or upper right, which are free of titles, where they are further from the
    points `taken` [n, 2]."""
    limits = np.array([axes.get_xlim(), axes.get_ylim()])
    ways = 0.34 * metres * np.array([[axis @ camera.right, axis @ camera.top] for axis in np.eye(3)])
    lengths = np.maximum(np.linalg.norm(ways, axis=1, keepdims=True), 0.05 * metres)
    beyond = ways * (1 + 0.12 * metres / lengths)
    level = np.where(ways[:, :1] > 0.1 * metres, 1, np.where(ways[:, :1] < -0.1 * metres, -1, 0))
    words = [beyond + share * metres * np.concatenate([level, 0 * level], axis=1) for share in (0, 0.25, 0.5)]
    corners = [np.array([limits[0][i] + (0.45, -0.45)[i] * metres, limits[1][j] + (0.36, -0.36)[j] * metres]) for i, j in ((0, 0), (1, 0), (1, 1))]
    free = [gap(corner + np.concatenate([ways, *words]), taken) for corner in corners]
    corner = corners[0 if free[0] > 0.15 * metres else int(np.argmax(free))]
    for way, label, name, side in zip(ways, beyond, names, level[:, 0]):
        axes.annotate("", corner + way, corner, zorder=9, arrowprops={"arrowstyle": "->", "color": style.INK, "lw": 0.9, "shrinkA": 0, "shrinkB": 0})
        axes.text(*(corner + label), name, ha=("center", "left", "right")[side], va="top" if way[1] < -0.1 * metres else "center", fontsize=7.5, zorder=10)
