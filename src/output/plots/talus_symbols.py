"""The symbols of the field: supports, loads, water levels, dimension lines, named points."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Bbox

import talus_style as style
from talus_modelled import ON_SOIL, WATER
from talus_units import quantity

SYMBOL = 0.11  # size of a boundary's symbol [inch]
DOT = 4.2  # size of the dot of a named point [pt]
WHITE = withStroke(linewidth=2.2, foreground="white")


def chains(corners, normals):
    """Facets [n, 2, 2] joined end to end: [(points [m + 1, 2], normals [m, 2])]."""
    size = max(np.ptp(corners.reshape(-1, 2), axis=0).max(), 1e-30) if len(corners) else 1
    ends = [tuple(map(tuple, np.round(facet / (1e-7 * size)).astype(np.int64))) for facet in corners]
    at = {}
    for k, facet in enumerate(ends):
        for end in facet:
            at.setdefault(end, []).append(k)
    left, found = set(range(len(ends))), []
    starts = [end for end, facets in at.items() if len(facets) == 1] + list(at)  # open lines first, then rings
    for start in starts:
        while any(k in left for k in at[start]):
            points, sides, end = [], [], start
            while True:
                k = next((k for k in at[end] if k in left), None)
                if k is None:
                    break
                left.remove(k)
                first = 0 if ends[k][0] == end else 1
                points, sides = points or [corners[k][first]], sides + [normals[k]]
                points.append(corners[k][1 - first])
                end = ends[k][1 - first]
            found.append((np.array(points), np.array(sides)))
    return found


def along(points, normals, spacing, values=None):
    """Evenly spaced places on a line: positions, normals and, of values per piece, those there."""
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    total = np.concatenate([[0], np.cumsum(length)])
    count = max(int(round(total[-1] / spacing)), 1)
    where = (np.arange(count) + 0.5) * total[-1] / count
    piece = np.clip(np.searchsorted(total, where, side="right") - 1, 0, len(length) - 1)
    share = ((where - total[piece]) / length[piece])[:, None]
    return points[piece] * (1 - share) + points[piece + 1] * share, normals[piece], piece


class Symbols:
    """Draws boundaries with the symbols of the field into axes in which a symbol has the size `size`, in the units of the axes."""

    def __init__(self, axes, size):
        self.axes, self.size = axes, size

    def draw(self, boundary, points, normals, vectors=None):
        """Along a line of pieces."""
        under = {"zorder": 5, "solid_capstyle": "butt"}
        if boundary.soil not in ON_SOIL:
            self.water(boundary, points, normals, under)
        elif boundary.soil in ("fixed", "base"):
            self.axes.plot(*points.T, color=boundary.colour, lw=1.6, **under)
            self.hatch(points, normals, boundary.colour)
        elif boundary.soil in ("roller", "tied"):
            self.axes.plot(*points.T, color=boundary.colour, lw=1.0, **under)
            at, n, _ = along(points, normals, 1.9 * self.size)
            for centre in at + 0.42 * self.size * n:
                self.axes.add_artist(plt.Circle(centre, 0.38 * self.size, fc="white", ec=boundary.colour, lw=0.8, zorder=6))
        elif boundary.soil == "dashpot":
            self.axes.plot(*points.T, color=boundary.colour, lw=1.0, **under)
            self.dashpots(points, normals, boundary.colour)
        else:
            self.axes.plot(*points.T, color=boundary.colour, lw=1.0, **under)
            self.arrows(boundary, points, normals, np.zeros_like(normals) if vectors is None else vectors)

    def lines(self, pieces, colour, width=0.8):
        self.axes.add_collection(LineCollection(pieces, colors=colour, linewidths=width, zorder=6), autolim=False)

    def hatch(self, points, normals, colour):
        at, n, _ = along(points, normals, 0.75 * self.size)
        slant = np.column_stack([n[:, 0] - n[:, 1], n[:, 1] + n[:, 0]]) * 0.6 * self.size
        self.lines(np.stack([at, at + slant], axis=1), colour)

    def dashpots(self, points, normals, colour):
        at, n, _ = along(points, normals, 2.5 * self.size)
        across = np.column_stack([-n[:, 1], n[:, 0]]) * 0.35 * self.size
        middle, far = at + 0.55 * self.size * n, at + 1.3 * self.size * n
        wall = middle + 0.25 * self.size * n
        for one in ((at, middle), (middle - across, middle + across), (wall - across, wall + across), (wall, far)):
            self.lines(np.stack(one, axis=1), colour)

    def arrows(self, boundary, points, normals, vectors):
        """Loads point at the face; velocities point away from it where they pull."""
        at, n, piece = along(points, normals, 2.2 * self.size)
        largest = np.linalg.norm(boundary.vector, axis=1).max(initial=0)
        here = vectors[piece] / largest if largest else -n * 0.7  # nothing at the start: its place
        length = 3.2 * self.size * here
        begin = at - length if boundary.soil == "load" else at
        for start, way in zip(begin, length):
            if np.hypot(*way) > 0.05 * self.size:
                self.axes.annotate("", start + way, start, zorder=6, annotation_clip=False,
                                   arrowprops={"arrowstyle": "-|>,head_width=0.14,head_length=0.28", "color": boundary.colour, "lw": 0.9, "shrinkA": 0,
                                               "shrinkB": 0, "linestyle": "-" if largest else ":"})

    def water(self, boundary, points, normals, under):
        colour = boundary.colour
        if boundary.water == "wall":
            self.axes.plot(*points.T, color=style.SOFT, lw=3.0, **under)
            return
        self.axes.plot(*points.T, color=colour, lw=3.2, alpha=0.55, ls=(0, (1.5, 1)) if boundary.water == "outflow" else "-", **under)
        entering = [one["high"] for one in boundary.values if one["name"] in ("inflow", "supply")]
        if entering and (entering[0] > 0 or boundary.changes):
            at, n, _ = along(points, normals, 3 * self.size)
            for start, way in zip(at + 1.6 * self.size * n, -1.4 * self.size * n):
                self.axes.annotate("", start + way, start, zorder=6, annotation_clip=False,
                                   arrowprops={"arrowstyle": "->,head_width=0.12,head_length=0.2", "color": colour, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})

    def level(self, x, y):
        """The triangle on a water level, and the dashes under it."""
        s = 1.3 * self.size
        self.axes.add_patch(Polygon([(x, y), (x - 0.55 * s, y + s), (x + 0.55 * s, y + s)], fc="white", ec=WATER, lw=0.9, zorder=7))
        self.lines([[(x - w * s, y - d * s), (x + w * s, y - d * s)] for w, d in ((0.45, 0.3), (0.22, 0.55))], WATER)


def label(axes, boundary, points, normals, size):
    """The value of a boundary beside it."""
    if not boundary.at_start() or np.linalg.norm(np.diff(points, axis=0), axis=1).sum() < 6 * size:
        return
    at, n, _ = along(points, normals, np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    text = boundary.at_start().replace("friction angle", "φ =").replace(" at the start, changes with time", " at the start")
    away = 4.6 if boundary.soil == "load" else 1.8
    x, y = at[0] + away * size * n[0]
    axes.text(x, y, text, fontsize=8, color=boundary.colour, zorder=9, path_effects=[WHITE], ha="left" if n[0][0] > 0.5 else "right" if n[0][0] < -0.5 else "center",
              va="bottom" if n[0][1] > 0.5 else "top" if n[0][1] < -0.5 else "center")


AROUND = [(side * x, y, "left" if side > 0 else "right", "baseline") for y, x in ((4, 4), (-10, 4), (12, 2), (-18, 2)) for side in (1, -1)]  # of a point [points]
ABOVE = [(0, y, align, "baseline") for y in (5, -11, 14, -20) for align in ("center", "left", "right")]


def keep_apart(axes, lines=()):
    """Moves names in axes that stand on other texts or on named points: those of points and followed lines to another side of them, those of soils to another of
    their `places`, where none of `lines` (each [n, 2]) runs through them either. Texts that cannot move stay where they are."""
    renderer = axes.figure.canvas.get_renderer()
    placed = [text.get_window_extent(renderer) for text in axes.texts if text.get_text() and not hasattr(text, "places")]
    placed += [Bbox([place, place]).padded(DOT / 2 * axes.figure.dpi / 72) for dot in axes.lines if hasattr(dot, "of_point")
               for place in axes.transData.transform(dot.get_xydata())]
    marks = np.array([point for line in lines for point in axes.transData.transform(between(np.asarray(line), axes))]).reshape(-1, 2)

    def crowd(text, through):
        box = text.get_window_extent(renderer).padded(1)
        shared = sum(common.width * common.height for one in placed if (common := box.intersection(box, one)) is not None)
        return shared + 20 * (through and np.count_nonzero(((marks > box.min) & (marks < box.max)).all(axis=1)))

    for text in sorted((one for one in axes.texts if hasattr(one, "places")), key=lambda one: one.of_soil):
        best = np.inf
        for place in text.places:
            kept = text.get_position(), text.get_ha(), text.get_va()
            put(text, place)
            if (here := crowd(text, text.of_soil)) < best:
                best = here
            else:
                put(text, (*kept[0], *kept[1:]))
            if best == 0:
                break
        placed.append(text.get_window_extent(renderer))


def put(text, place):
    text.set_position(place[:2])
    if len(place) > 2:
        text.set(ha=place[2], va=place[3])


def between(line, axes):
    """Points on a polyline, so near to each other that none passes a word unseen."""
    step = 0.004 * np.ptp(axes.get_xlim())
    parts = [a + np.linspace(0, 1, min(400, 2 + int(np.linalg.norm(b - a) / step)))[:, None] * (b - a) for a, b in zip(line[:-1], line[1:])]
    return np.concatenate(parts) if parts else np.asarray(line)


def movable(text, places, of_soil=False):
    """A text that keep_apart may put to any of these places (x, y, alignments)."""
    text.places, text.of_soil = places, of_soil


def named_points(axes, model, flat):
    """Named points and followed lines; `flat` gives the place in the picture of places [..., dim]."""
    places = [flat(point["position"]) for point in model.data["points"]]
    near = 0.03 * np.ptp(axes.get_xlim())
    for line in model.data["lines"]:
        points = flat(line["points"])
        beside = any(np.linalg.norm(place - points[0]) < near for place in places)  # a point, whose name stands to the right
        axes.plot(*points.T, color=style.INK, lw=1.0, ls=(0, (1, 1.4)), zorder=8)
        name = axes.annotate(line["name"], points[0], (-3 if beside else 0, 5), textcoords="offset points", fontsize=7.5, ha="right" if beside else "center",
                             zorder=9, path_effects=[WHITE], style="italic")
        movable(name, [(*name.get_position(), name.get_ha(), "baseline"), *ABOVE])
    for point, at in zip(model.data["points"], places):
        [dot] = axes.plot(*at, "o", ms=DOT, mfc=style.INK, mec="white", mew=0.8, zorder=9)
        dot.of_point = True
        movable(axes.annotate(point["name"], at, (4, 4), textcoords="offset points", fontsize=8, zorder=9, path_effects=[WHITE]), AROUND)


def dimension(axes, begin, end):
    """A dimension line with its length, upright where it stands."""
    line = axes.annotate("", begin, end, zorder=9, annotation_clip=False, arrowprops={"arrowstyle": "<->", "color": style.SOFT, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
    line.of_line = True
    upright = abs(end[1] - begin[1]) > abs(end[0] - begin[0])
    length = quantity(np.linalg.norm(end - begin), "m", ".4g")
    name = axes.text(*(begin + end) / 2, length, rotation=90 if upright else 0, ha="center", va="center", fontsize=8, zorder=10,
                     bbox={"fc": "white", "ec": "none", "pad": 1.2})
    name.of_line = False
