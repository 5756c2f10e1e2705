#!/usr/bin/python3
"""Draws what a scene models, from the document that the program makes of it: soils, mesh, boundaries with the symbols of the field, loads, water,
named points, dimensions, stages. A section in plane strain, two perspective views in 3D."""

import argparse
import json
import pathlib
import sys
import textwrap
import tomllib

try:
    import numpy as np
    import talus_style as style
except ImportError as error:
    sys.exit(f"talus_model: pictures need Python with NumPy and Matplotlib (Debian: python3-matplotlib): {error}")

from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from talus_units import Keys, duration, quantity, span

WIDTH, MARGIN, LINE = 12.0, 0.45, 0.19  # of the picture, its edges and a line of its text [inch]
SYMBOL = 0.11  # size of a boundary's symbol [inch]
GROUND = ("#e8d5b0", "#c2a278", "#b9bfa4", "#a9a29a", "#e0b88a", "#d5cfc9", "#a8895f", "#d8c774")  # of the soils
EARTH, WATER, LOAD, BASE, PLATE, GAS = style.INK, "#1971c2", "#c92a2a", "#a0410d", "#5f3dc4", "#862e9c"
UNBROKEN = "\u00a0"  # a blank at which no line ends
WHITE = withStroke(linewidth=2.2, foreground="white")
# parameters of soils that the legend has, by key
PARAMETERS = {"unit_weight": "γ", "saturated_unit_weight": "γₛₐₜ", "density": "ρ", "porosity": "n", "grain_density": "ρₛ", "young_modulus": "E",
              "shear_modulus": "G", "bulk_modulus": "K", "poisson_ratio": "ν", "cohesion": "c", "friction_angle": "φ", "dilation_angle": "ψ",
              "residual_cohesion": "cᵣ", "residual_friction_angle": "φᵣ", "hydraulic_conductivity": "k", "permeability": "k"}
# what a boundary does to the soil: words, colour, symbol in perspective
ON_SOIL = {"fixed": ("fixed", EARTH, "s"), "roller": ("roller", EARTH, "o"), "base": ("base with friction", BASE, "X"),
           "load": ("load", LOAD, "v"), "velocity": ("moving plate", PLATE, "D"), "dashpot": ("non-reflecting", GAS, "P")}
ON_WATER = {"wall": "no flow", "pressure": "pore pressure", "seepage": "water level, above it a seepage face", "flux": "inflow", "outflow": "outflow"}


class Model:
    """The document of the program: see src/simulation/model.h."""

    def __init__(self, text):
        self.data = json.loads(text)
        self.title = self.data["title"]
        self.dimension = self.data["dimension"]
        self.scene = tomllib.loads(self.data["scene"])
        self.keys = Keys(self.data["keys"])
        self.bodies = [body["name"] for body in self.data["bodies"]]
        self.there = [body["there"] for body in self.data["bodies"]]
        self.corners = np.array([cell["corners"] for cell in self.data["cells"]]).reshape(-1, 3, self.dimension)
        self.normal = np.array([cell["normal"] for cell in self.data["cells"]]).reshape(-1, self.dimension)  # of the faces in 3D
        self.body = np.array([cell["body"] for cell in self.data["cells"]], int)
        self.boundaries = [Boundary(one, self.dimension) for one in self.data["boundaries"]]
        if self.dimension == 3:  # symbols alone do not tell boundaries apart
            for k, boundary in enumerate(self.boundaries):
                boundary.colour = style.LINES[k % len(style.LINES)]
        self.stages = self.data["stages"]

    def colour(self, body):
        return GROUND[body % len(GROUND)]

    def soil_line(self, name):
        """Law and main parameters of a soil."""
        given = self.scene.get("body", {}).get(name, {})
        law = given.get("law", "")
        values = [f"{symbol} = {self.keys.text('body.NAME', law, key, given[key])}".replace(" ", UNBROKEN) for key, symbol in PARAMETERS.items() if key in given]
        return f"{style.words(law)}: {', '.join(values)}"

    def water_lines(self):
        """Polylines of the water tables at the start, level beyond their ends, over the width of the model: [(body, points)]."""
        left, right = self.corners[..., 0].min(), self.corners[..., 0].max()
        lines = []
        for table in self.data["water"]["tables"]:
            points = np.array(table["points"])
            x = np.unique(np.concatenate([[left, right], points[(points[:, 0] > left) & (points[:, 0] < right), 0]]))
            lines.append((table["body"], np.column_stack([x, np.interp(x, points[:, 0], points[:, 1])])))
        return lines


def read_model(folder):
    """The model of a run, or None where the run has left no document of it."""
    path = folder / "run" / "model.json"
    return Model(path.read_text()) if path.exists() else None


class Boundary:
    """A boundary with its faces: corners [faces, dim, dim], normals and vectors (load or velocity) [faces, dim]."""

    def __init__(self, data, dimension):
        self.name, self.soil, self.water, self.gas = data["name"], data["soil"], data["water"], data["gas"]
        self.groups, self.values, self.changes, self.level = data["groups"], data["values"], data["changes"], data["level"]
        faces = data["faces"]
        self.has_soil = np.array([face["soil"] for face in faces], bool)
        self.corners = np.array([face["corners"] for face in faces]).reshape(-1, dimension, dimension)
        self.normal = np.array([face["normal"] for face in faces]).reshape(-1, dimension)
        self.vector = np.array([face["vector"] for face in faces]).reshape(-1, dimension)
        self.colour = ON_SOIL[self.soil][1] if self.soil in ON_SOIL else GAS if self.gas == "pressure" else WATER
        if self.soil in ("load", "none"):  # act on soil only
            keep = self.has_soil
            self.corners, self.normal, self.vector, self.has_soil = self.corners[keep], self.normal[keep], self.vector[keep], self.has_soil[keep]

    def marker(self):
        return ON_SOIL[self.soil][2] if self.soil in ON_SOIL else "."

    def what(self):
        """What it does, in words."""
        if self.soil in ON_SOIL:
            return ON_SOIL[self.soil][0]
        return "gas pressure" if self.gas == "pressure" else ON_WATER.get(self.water, "no effect")

    def at_start(self):
        """Its values at the start, in words; empty if it has none."""
        said = [f"{one['name']} {span(one['low'], one['high'], one['unit'])}" for one in self.values if self.soil != "base" or one["high"] or len(self.values) == 1
                or one["name"] == "friction angle"]
        if self.level is not None:
            said = [f"water level {quantity(self.level, 'm')}"]
        return ", ".join(said) + (" at the start, changes with time" if self.changes else "")

    def line(self):
        values = self.at_start()
        told = values.startswith(self.what()) or (values and self.soil == "load")
        return f"{self.name}: {values if told else ', '.join(filter(None, (self.what(), values)))}"


# ---- stages ----

def stage_rows(model):
    """What a table of the stages says: the names of its columns, then a row for each stage."""
    rows = [("stage", "kind", "at most", "ends with", "what acts")]
    for stage in model.stages:
        kind = style.words(stage["kind"]) + (f", {stage['integrator']}" if stage["kind"] == "dynamic" else ", steady" if stage["steady"] else "")
        rows.append((stage["name"], kind, duration(stage["duration"]), ending(stage), "; ".join(actions(stage, model))))
    return rows


def ending(stage):
    if stage["when_lost"] == "next_stage":
        return "duration, or loss of equilibrium"
    if stage["until"] == "failure":
        return f"failure of {stage['failure_point']}, from {quantity(stage['failure_speed'], 'm/s')}"
    if stage["until"] == "rest":
        return f"rest, below {quantity(stage['rest_speed'], 'm/s')}"
    return stage["until"]


def actions(stage, model):
    """What acts in a stage, in words."""
    said = []
    size = float(np.linalg.norm(model.data["gravity"]))
    if size:
        said.append(f"gravity {quantity(size, 'm/s2')}" + (f", growing from 0 in {duration(stage['gravity_ramp'])}" if stage["gravity_ramp"] else ""))
    if stage["seismic_coefficient"]:
        said.append(f"pseudo-static inertia of ({', '.join(f'{k:g}' for k in stage['seismic_coefficient'])}) times the weight")
    phases = model.data["phases"]
    if phases == "drained":
        said.append({"seepage": "water seeps, soil at rest", "consolidation": "water seeps, soil consolidates"}.get(stage["kind"], "prescribed pore pressure"))
    elif phases != "dry":
        said.append("pore fluids move" if stage["pore_flow"] else "pore pressure of the start")
    standing = [one.name for one in model.boundaries if one.soil in ("load", "velocity")]
    if standing:
        said.append("on the soil: " + ", ".join(standing))
    if stage["changes"]:
        said.append("changing with time: " + ", ".join(style.words(one.replace(".", " ")) for one in stage["changes"]))
    elif stage["hold_loads"]:
        said.append("functions of time stand still")
    if stage["initial_stress"] == "k0":
        said.append("stress at the start by k0")
    for key, verb in (("add", "adds"), ("remove", "removes")):
        if stage[key]:
            said.append(f"{verb} {', '.join(stage[key])}")
    if stage["kind"] == "dynamic":
        said.append(f"damping {stage['damping']:g}" if stage["damping"] else "no damping")
    if not stage["softening"]:
        said.append("soil keeps its strength")
    if stage["reset_displacement"]:
        said.append("displacement set to 0 at its end")
    return said


# ---- lines of facets in plane strain ----

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
        elif boundary.soil == "roller":
            self.axes.plot(*points.T, color=boundary.colour, lw=1.0, **under)
            at, n, _ = along(points, normals, 1.9 * self.size)
            for centre in at + 0.42 * self.size * n:
                self.axes.add_patch(style.plt.Circle(centre, 0.38 * self.size, fc="white", ec=boundary.colour, lw=0.8, zorder=6))
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


# ---- the picture ----

class Sheet:
    """The page: a title, the view, the legend and the stages below it. Sizes in inches; heights count from the top."""

    def __init__(self, model, view_height):
        self.soils = [(k, name, textwrap.wrap(model.soil_line(name), 92)) for k, name in enumerate(model.bodies)]
        self.boundaries = [(one, textwrap.wrap(one.line(), 78)) for one in model.boundaries]
        self.stages = []
        for name, kind, longest, end, acting in stage_rows(model)[1:]:
            lasts = longest if end == "duration" else f"at most {longest}, ends with {end}"
            self.stages.append((name, textwrap.wrap(f"{kind}, {lasts}: {acting}", 150)))
        left = sum(1 + len(lines) for _, _, lines in self.soils) + 2 * bool(notes(model)) + len(notes(model))
        legend = 1.5 + max(left, sum(len(lines) for _, lines in self.boundaries))
        stages = 1.5 + sum(len(lines) for _, lines in self.stages)
        self.legend_height, self.stages_height = LINE * legend, LINE * stages
        self.view_top = 0.55
        self.height = self.view_top + view_height + self.legend_height + self.stages_height + 0.35
        self.figure = style.plt.figure(figsize=(WIDTH, self.height))
        self.figure.text(MARGIN / WIDTH, 1 - 0.22 / self.height, textwrap.shorten(model.title or "Model", 120, placeholder=" …"), fontsize=12, weight="bold", va="center")
        kind = "plane strain" if model.dimension == 2 else "3D"
        self.figure.text(MARGIN / WIDTH, 1 - 0.42 / self.height, f"{model.data['phases']}, {kind}; the model at the start", fontsize=9, color=style.SOFT, va="center")
        self.view_height = view_height

    def axes(self, left, top, width, height):
        return self.figure.add_axes((left / WIDTH, 1 - (top + height) / self.height, width / WIDTH, height / self.height))

    def words(self, model):
        """Legend and stages."""
        top = self.view_top + self.view_height + 0.1
        page = self.axes(0, top, WIDTH, self.legend_height + self.stages_height)
        page.set(xlim=(0, WIDTH), ylim=(self.legend_height + self.stages_height, 0))
        page.axis("off")
        y = self.heading(page, MARGIN, 0.5 * LINE, "Soils")
        for k, name, lines in self.soils:
            page.add_patch(style.plt.Rectangle((MARGIN, y - 0.06), 0.26, 0.13, fc=model.colour(k), ec=style.SOFT, lw=0.6, hatch=None if model.there[k] else "///"))
            page.text(MARGIN + 0.36, y, name + ("" if model.there[k] else ", added by a stage"), va="center", fontsize=8.5, weight="bold")
            y = self.paragraph(page, MARGIN + 0.36, y + LINE, lines)
        if notes(model):
            y = self.heading(page, MARGIN, y + 0.5 * LINE, "Water")
            y = self.paragraph(page, MARGIN, y, notes(model))
        y = self.heading(page, WIDTH / 2 + 0.5, 0.5 * LINE, "Boundaries")
        symbols = Symbols(page, 0.1)
        for boundary, lines in self.boundaries:
            left = WIDTH / 2 + 0.5
            if model.dimension == 2:
                arrows = boundary.soil in ("load", "velocity")  # above the line, the other symbols below it; y points down here
                line = np.array([[left, y], [left + 0.5, y]]) + (0, 0.06 if arrows else -0.03)
                down = np.array([[0.0, -1.0 if arrows else 1.0]])
                symbols.draw(boundary, line, down, np.array([[0.0, 0.5]]) * np.linalg.norm(boundary.vector, axis=1).max(initial=0))
            else:
                page.plot(left + 0.25, y, boundary.marker(), color=boundary.colour, ms=6, mfc="none" if boundary.marker() == "o" else None)
            y = self.paragraph(page, left + 0.62, y, lines)
        y = self.heading(page, MARGIN, self.legend_height + 0.5 * LINE, "Stages")
        for k, (name, lines) in enumerate(self.stages):
            page.text(MARGIN, y, f"{k + 1}  {name}", va="center", fontsize=8.5, weight="bold")
            y = self.paragraph(page, MARGIN + 1.75, y, lines)

    @staticmethod
    def heading(page, x, y, text):
        page.text(x, y, text, va="center", fontsize=9.5, weight="bold", color=style.ACCENT)
        return y + 1.15 * LINE

    @staticmethod
    def paragraph(page, x, y, lines):
        for line in lines:
            page.text(x, y, line, va="center", fontsize=8.2)
            y += LINE
        return y


def notes(model):
    """Lines on the water."""
    water = model.scene.get("water", {})
    said = []
    if model.data["water"]["tables"]:
        said.append("blue line: water table at the start" + (", rises and falls: level = " + model.keys.text("water", "", "level", water["level"]) if "level" in water else ""))
    if model.data["water"]["line"]:
        said.append("dashed blue line: where the pore pressure at the start ends in the soil")
    for key in ("suction", "excess"):
        if key in water:
            said.append(f"{key}: {model.keys.text('water', '', key, water[key])}")
    return [line for text in said for line in textwrap.wrap(text, 98)]


def draw_model(model, path):
    """Draws the picture as PNG and returns its path. `model` is a Model."""
    with style.plt.rc_context({"text.parse_math": False}):  # a scene may write $ in its names
        sheet = section(model) if model.dimension == 2 else perspectives(model)
        sheet.words(model)
        return style.save(sheet.figure, path)


def section(model):
    """The section in plane strain."""
    low, high = model.corners.min(axis=(0, 1)), model.corners.max(axis=(0, 1))
    pad, above, scale = 0.85, 0.5, 0.65  # for symbols and dimensions, and for the scales beside and below the axes [inch]
    extent = high - low
    metres = max(extent[0] / (WIDTH - 2 * MARGIN - 2 * pad - scale), extent[1] / 6.0)  # per inch
    width, height = extent[0] / metres + 2 * pad, extent[1] / metres + pad + above
    sheet = Sheet(model, height + scale - 0.2)
    axes = sheet.axes((WIDTH - width + scale) / 2, sheet.view_top, width, height)
    axes.set(xlim=(low[0] - pad * metres, high[0] + pad * metres), ylim=(low[1] - pad * metres, high[1] + above * metres), aspect="equal",
             xlabel="x [m]", ylabel="y [m]")
    for body in range(len(model.bodies)):
        cells = model.corners[model.body == body]
        edge = np.linalg.norm(cells[:, 1] - cells[:, 0], axis=1).mean() / metres if len(cells) else 1  # [inch]
        axes.add_collection(PolyCollection(cells, fc=model.colour(body), ec="#8d7b5c", lw=np.clip(5 * edge, 0.04, 0.45), zorder=2,
                                           hatch=None if model.there[body] else "///", alpha=1 if model.there[body] else 0.5), autolim=False)
        axes.add_collection(LineCollection(outline(cells), colors="#6b5a3c", linewidths=0.9, zorder=3), autolim=False)
        name_body(axes, cells, model.bodies[body], weight="bold", fontsize=10)
    name_body(axes, model.corners[model.body < 0], "free space", color=style.SOFT, fontsize=9)
    axes.add_collection(LineCollection(outline(model.corners), colors=style.FAINT, linewidths=0.8, zorder=1), autolim=False)
    symbols = Symbols(axes, SYMBOL * metres)
    for boundary in model.boundaries:
        facets = boundary.corners
        by_middle = {tuple(np.round(facet.mean(axis=0) / metres, 5)): vector for facet, vector in zip(facets, boundary.vector)}
        for points, normals in chains(facets, boundary.normal):
            middles = (points[1:] + points[:-1]) / 2
            vectors = np.array([by_middle[tuple(np.round(middle / metres, 5))] for middle in middles])
            symbols.draw(boundary, points, normals, vectors)
            if boundary.soil in ("base", "load", "velocity"):
                label(axes, boundary, points, normals, symbols.size)
        if boundary.level is not None and len(facets):
            outer_level(symbols, boundary)
    water(axes, model, symbols, low, high)
    named_points(axes, model, lambda x: np.asarray(x, float)[..., :2], symbols.size)
    dimensions(axes, model, low, high, metres)
    return sheet


def outline(cells):
    """Edges that only one cell has."""
    if not len(cells):
        return []
    edges = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    size = np.ptp(edges.reshape(-1, 2), axis=0).max()
    key = np.sort(np.round(edges / (1e-7 * size)).astype(np.int64).view([("x", np.int64), ("y", np.int64)])[..., 0], axis=1)
    _, first, count = np.unique(key, axis=0, return_index=True, return_counts=True)
    return edges[first[count == 1]]


def name_body(axes, cells, name, **look):
    if not len(cells):
        return
    centres = cells.mean(axis=1)
    a, b = cells[:, 1] - cells[:, 0], cells[:, 2] - cells[:, 0]
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    middle = (centres * area[:, None]).sum(axis=0) / area.sum()
    at = centres[np.argmin(((centres - middle) ** 2).sum(axis=1))]  # which lies in the body
    axes.text(*at, name, ha="center", va="center", zorder=8, path_effects=[WHITE], **look)


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


def outer_level(symbols, boundary):
    """A water level outside the faces that it wets: on the side where there is room."""
    middle, side = boundary.corners.mean(axis=(0, 1)), boundary.normal.mean(axis=0)
    x = middle[0] + 2 * symbols.size * (1 if side[0] >= 0 else -1)
    symbols.lines([[(x - 1.3 * symbols.size, boundary.level), (x + 1.3 * symbols.size, boundary.level)]], WATER, 1.4)
    symbols.level(x, boundary.level)


def water(axes, model, symbols, low, high):
    for body, points in model.water_lines():
        axes.plot(*points.T, color=WATER, lw=1.5, ls="-" if not body else (0, (6, 1.5)), zorder=6)
        x = low[0] + 0.12 * (high[0] - low[0])
        symbols.level(x, np.interp(x, *points.T))
        if body:
            axes.text(points[-1, 0], points[-1, 1], f" water of {body}", fontsize=8, color=WATER, va="center", path_effects=[WHITE], zorder=9)
    pieces = np.array(model.data["water"]["line"]).reshape(-1, 2, 2)
    if len(pieces):
        for points, _ in chains(pieces, np.zeros((len(pieces), 2))):
            axes.plot(*points.T, color=WATER, lw=1.5, ls=(0, (4, 2)), zorder=6)
        if not model.data["water"]["tables"]:
            ends = pieces.reshape(-1, 2)
            symbols.level(*ends[np.argmin(np.abs(ends[:, 0] - ends[:, 0].min() - 0.12 * np.ptp(ends[:, 0])))])


def named_points(axes, model, flat, size):
    for line in model.data["lines"]:
        points = flat(line["points"])
        axes.plot(*points.T, color=style.INK, lw=1.0, ls=(0, (1, 1.4)), zorder=8)
        axes.annotate(line["name"], points[0], (0, 5), textcoords="offset points", fontsize=7.5, ha="center", zorder=9, path_effects=[WHITE], style="italic")
    for point in model.data["points"]:
        at = flat(point["position"])
        axes.plot(*at, "o", ms=4.2, mfc=style.INK, mec="white", mew=0.8, zorder=9)
        axes.annotate(point["name"], at, (4, 4), textcoords="offset points", fontsize=8, zorder=9, path_effects=[WHITE])


def dimensions(axes, model, low, high, metres):
    """Dimension lines: width and height of the mesh and of the soil that is there."""
    soil = model.corners[np.isin(model.body, np.flatnonzero(model.there))]
    soil = soil if len(soil) else model.corners
    first, last = soil.min(axis=(0, 1)), soil.max(axis=(0, 1))
    away = 0.44 * metres
    spans = [((first[0], low[1] - away), (last[0], low[1] - away))]
    if last[0] - first[0] < 0.999 * (high[0] - low[0]):
        spans.append(((low[0], low[1] - 1.6 * away), (high[0], low[1] - 1.6 * away)))
    spans.append(((high[0] + away, first[1]), (high[0] + away, last[1])))
    if last[1] - first[1] < 0.999 * (high[1] - low[1]):
        spans.append(((high[0] + 1.6 * away, low[1]), (high[0] + 1.6 * away, high[1])))
    for begin, end in spans:
        dimension(axes, np.array(begin), np.array(end))


def dimension(axes, begin, end):
    """A dimension line with its length, upright where it stands."""
    axes.annotate("", begin, end, zorder=9, annotation_clip=False, arrowprops={"arrowstyle": "<->", "color": style.SOFT, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
    upright = abs(end[1] - begin[1]) > abs(end[0] - begin[0])
    axes.text(*(begin + end) / 2, quantity(float(f"{np.linalg.norm(end - begin):.4g}"), "m"), rotation=90 if upright else 0, ha="center", va="center", fontsize=8, color=style.INK, zorder=10,
              bbox={"fc": "white", "ec": "none", "pad": 1.2})


# ---- 3D ----

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


def perspectives(model):
    """From above in front, and from below behind."""
    low, high = model.corners.min(axis=(0, 1)), model.corners.max(axis=(0, 1))
    gravity = np.array(model.data["gravity"] if np.any(model.data["gravity"]) else [0, -1, 0], float)
    steepest = np.abs(gravity).argmax()
    up = -np.sign(gravity[steepest]) * np.eye(3)[steepest]
    across = np.eye(3)[np.flatnonzero(up == 0)]  # the level axes
    views = [Camera(low, high, 0.55 * across[0] + 0.75 * across[1] + 0.5 * up, up), Camera(low, high, -0.55 * across[0] - 0.75 * across[1] - 0.5 * up, up)]
    box = np.array([[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    widths, gap = (6.4, 4.5), 0.2  # of the two views [inch]
    flat = [camera.flat(box) for camera in views]
    scale = [max(np.ptp(points[:, 0]) / (width - 1.0), np.ptp(points[:, 1]) / 4.6) for points, width in zip(flat, widths)]  # metres per inch
    height = max(np.ptp(points[:, 1]) / one for points, one in zip(flat, scale)) + 1.0
    sheet = Sheet(model, height)
    left = MARGIN
    for k, (camera, points, width) in enumerate(zip(views, flat, widths)):
        axes = sheet.axes(left, sheet.view_top, width, height)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        axes.set(xlim=middle[0] + np.array([-0.5, 0.5]) * width * scale[k], ylim=middle[1] + np.array([-0.5, 0.5]) * height * scale[k])
        axes.axis("off")
        view(axes, model, camera, scale[k], (low, high), main=k == 0)
        axes.set_title(("from above", "from below, seen from behind")[k], loc="left", fontsize=8.5, color=style.SOFT, y=0.92)
        left += width + gap
    return sheet


def view(axes, model, camera, metres, extent, main):
    centres = model.corners.mean(axis=1)
    order = np.argsort(-camera.depth(centres))
    order = order[camera.sees(centres, model.normal)[order]]
    light = camera.right * -0.35 + camera.top * 0.8 - camera.forward * 0.5
    shade = 0.72 + 0.28 * np.clip(model.normal @ light, 0, 1)
    colours = np.array([style.matplotlib.colors.to_rgb(model.colour(body)) for body in model.body]) * shade[:, None]
    thin = np.clip(40 / np.sqrt(len(model.corners)), 0.08, 0.4)
    axes.add_collection(PolyCollection(camera.flat(model.corners[order]), fc=colours[order], ec="#8d7b5c", lw=thin, zorder=2), autolim=False)
    for boundary in model.boundaries:
        middle = boundary.corners.mean(axis=1)
        seen = camera.sees(middle, boundary.normal) & boundary.has_soil
        at = camera.flat(middle[seen])
        _, first = np.unique(np.floor(at / (0.26 * metres)).astype(int), axis=0, return_index=True)  # not all: one in a quarter of an inch
        hollow = {"mfc": "white"} if boundary.marker() == "o" else {}
        axes.plot(*at[first].T, boundary.marker(), color=boundary.colour, ms=4.2, mew=0.8, ls="none", zorder=4, **hollow)
        largest = np.linalg.norm(boundary.vector, axis=1).max(initial=0)
        for k in np.flatnonzero(seen)[first] if largest else ():
            way = 0.4 * metres * boundary.vector[k] / largest
            start = middle[k] - way if boundary.soil == "load" else middle[k]
            axes.annotate("", camera.flat(start + way), camera.flat(start), zorder=5, arrowprops={"arrowstyle": "-|>", "color": boundary.colour, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
    low, high = extent
    if main:
        front = high[2] if camera.eye[2] > camera.middle[2] else low[2]
        symbols = Symbols(axes, SYMBOL * metres)
        for body, points in model.water_lines():
            line = camera.flat(np.column_stack([points, np.full(len(points), front)]))
            axes.plot(*line.T, color=WATER, lw=1.6, zorder=6)
            symbols.level(*(0.88 * line[0] + 0.12 * line[1]))
        named_points(axes, model, camera.flat, symbols.size)
    edges(axes, camera, low, high, metres)


def edges(axes, camera, low, high, metres):
    """The three dimensions of the soil, each beside that edge of its box that lies lowest in the picture, or furthest right."""
    middle = camera.flat((low + high) / 2)
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
        lowest = lowest + 0.28 * metres * away / np.linalg.norm(away)
        axes.annotate("", *lowest, zorder=9, annotation_clip=False, arrowprops={"arrowstyle": "<->", "color": style.SOFT, "lw": 0.8, "shrinkA": 0, "shrinkB": 0})
        axes.text(*lowest.mean(axis=0), f"{'xyz'[axis]}: {quantity(float(f'{high[axis] - low[axis]:.4g}'), 'm')}", ha="center", va="center", fontsize=8, zorder=10,
                  bbox={"fc": "white", "ec": "none", "pad": 1.2})


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", type=pathlib.Path, help="the document of the program (JSON)")
    parser.add_argument("picture", type=pathlib.Path, help="PNG file to write")
    given = parser.parse_args()
    try:
        draw_model(Model(given.model.read_text()), given.picture)
    except OSError as error:
        sys.exit(f"talus_model: {error}")


if __name__ == "__main__":
    main()
