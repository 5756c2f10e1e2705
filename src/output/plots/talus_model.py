#!/usr/bin/python3
"""Draws what a scene models: soils, mesh, boundaries with the symbols of the field, loads, water, named points, dimensions, stages. A section in
plane strain, two perspective views in 3D."""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import pathlib
import textwrap

import matplotlib.pyplot as plt
import numpy as np
import talus_structures
import talus_style as style
from matplotlib.collections import LineCollection, PolyCollection
from talus_modelled import WATER, Model, notes, outline, stage_rows
from talus_perspective import Views
from talus_symbols import SYMBOL, WHITE, Symbols, chains, dimension, keep_apart, label, movable, named_points
from talus_units import of_length, use

WIDTH, MARGIN, LINE = 12.0, 0.45, 0.19  # of the picture, its edges and a line of its text [inch]


def draw_model(model, path):
    """Draws the picture as PNG and returns its path. `model` is a Model."""
    with plt.rc_context({"text.parse_math": False}):  # a scene may write $ in its names
        if not len(model.corners):  # in 3D, where all soil comes later
            sheet = Sheet(model, 0.0)
        else:
            sheet = section(model) if model.dimension == 2 else perspectives(model)
        sheet.words()
        return style.save(sheet.figure, path)


class Sheet:
    """The page: a title, the view, the legend and the stages below it. Sizes in inches; heights count from the top."""

    def __init__(self, model, view_height):
        self.model, self.view_height = model, view_height
        self.water = [line for text in notes(model) for line in textwrap.wrap(text, 98)]
        self.soils = [(k, name, textwrap.wrap(model.soil_line(name), 92)) for k, name in enumerate(model.bodies)]
        self.boundaries = [(one, textwrap.wrap(one.line(), 78)) for one in model.boundaries]
        self.stages = []
        for name, kind, longest, end, acting in stage_rows(model)[1:]:
            at_most = f"at most {longest}, " if longest != "-" else ""
            lasts = longest if end == "duration" else f"{at_most}ends with {end}"
            self.stages.append((name, textwrap.wrap(f"{kind}, {lasts}: {acting}", 150)))
        left = sum(1 + len(lines) for _, _, lines in self.soils) + 2 * bool(self.water) + len(self.water)
        legend = 1.5 + max(left, sum(len(lines) for _, lines in self.boundaries))
        stages = 1.5 + sum(len(lines) for _, lines in self.stages)
        self.legend_height, self.stages_height = LINE * legend, LINE * stages
        self.view_top = 0.55
        self.height = self.view_top + view_height + self.legend_height + self.stages_height + 0.35
        self.figure = plt.figure(figsize=(WIDTH, self.height))
        title = textwrap.shorten(model.title or "Model", 120, placeholder=" …")
        self.figure.text(MARGIN / WIDTH, 1 - 0.22 / self.height, title, fontsize=12, weight="bold", va="center")
        kind = "plane strain" if model.dimension == 2 else f"3D, terrain of {model.terrain}" if model.terrain else "3D"
        subtitle = f"{model.data['phases']}, {kind}; the model at the start"
        self.figure.text(MARGIN / WIDTH, 1 - 0.42 / self.height, subtitle, fontsize=9, color=style.SOFT, va="center")

    def axes(self, left, top, width, height):
        return self.figure.add_axes((left / WIDTH, 1 - (top + height) / self.height, width / WIDTH, height / self.height))

    def words(self):
        """Legend and stages."""
        model = self.model
        top = self.view_top + self.view_height + 0.1
        page = self.axes(0, top, WIDTH, self.legend_height + self.stages_height)
        page.set(xlim=(0, WIDTH), ylim=(self.legend_height + self.stages_height, 0))
        page.axis("off")
        y = self.heading(page, MARGIN, 0.5 * LINE, "Soils")
        for k, name, lines in self.soils:
            page.add_patch(plt.Rectangle((MARGIN, y - 0.06), 0.26, 0.13, fc=model.colours[k], ec=style.SOFT, lw=0.6, hatch=None if model.there[k] else "///"))
            page.text(MARGIN + 0.36, y, name + ("" if model.there[k] else ", added by a stage"), va="center", fontsize=8.5, weight="bold")
            y = self.paragraph(page, MARGIN + 0.36, y + LINE, lines)
        if self.water:
            y = self.heading(page, MARGIN, y + 0.5 * LINE, "Water")
            y = self.paragraph(page, MARGIN, y, self.water)
        y = self.heading(page, WIDTH / 2 + 0.5, 0.5 * LINE, "Boundaries")
        symbols, short = Symbols(page, 0.1), Symbols(page, 0.06)  # arrows keep to their row
        for boundary, lines in self.boundaries:
            left = WIDTH / 2 + 0.5
            if model.dimension == 2:
                arrows = boundary.soil in ("load", "velocity")  # above the line, the other symbols below it; y points down here
                line = np.array([[left, y], [left + 0.5, y]]) + (0, {"load": 0.06, "velocity": -0.07}.get(boundary.soil, -0.03))
                down = np.array([[0.0, -1.0 if arrows else 1.0]])
                (short if arrows else symbols).draw(boundary, line, down, np.array([[0.0, 0.5]]) * np.linalg.norm(boundary.vector, axis=1).max(initial=0))
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


def perspectives(model):
    """Two views in 3D."""
    views = Views(model)
    sheet = Sheet(model, views.height)
    left = MARGIN
    for k, width in enumerate(Views.WIDTHS):
        axes = sheet.axes(left, sheet.view_top, width, views.height)
        axes.set_title(views.title(k), loc="left", fontsize=8.5, color=style.SOFT, y=0.92)
        views.draw(axes, k)
        left += width + 0.2
    return sheet


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
             xlabel=of_length("x"), ylabel=of_length("y"))
    style.places(axes.xaxis, 8), style.places(axes.yaxis, 8)
    for body in range(len(model.bodies)):
        cells = model.corners[model.body == body]
        edge = np.linalg.norm(cells[:, 1] - cells[:, 0], axis=1).mean() / metres if len(cells) else 1  # [inch]
        axes.add_collection(PolyCollection(cells, fc=model.colours[body], ec="#8d7b5c", lw=np.clip(5 * edge, 0.04, 0.45), zorder=2,
                                           hatch=None if model.there[body] else "///", alpha=1 if model.there[body] else 0.5), autolim=False)
        axes.add_collection(LineCollection(outline(cells), colors="#6b5a3c", linewidths=0.9, zorder=3), autolim=False)
        name_body(axes, model, cells, model.bodies[body], metres, weight="bold", fontsize=10)
    name_body(axes, model, model.corners[model.body < 0], "free space", metres, color=style.SOFT, fontsize=9)
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
    for body in model.data.get("rigid", []):
        corners = np.array(body["polygon"])
        axes.fill(*corners.T, facecolor=style.FAINT, edgecolor=style.INK, linewidth=1.2, zorder=4)
        movable(axes.text(*body["centre"], body["name"], ha="center", va="center", zorder=8, fontsize=9, path_effects=[WHITE]), [body["centre"]])
    for text, middle in talus_structures.draw_model(axes, model):
        movable(text, [middle])
    water(axes, model, symbols, low, high)
    named_points(axes, model, np.asarray)
    dimensions(axes, model, low, high, metres)
    keep_apart(axes, [line.get_xydata() for line in axes.lines if line.get_zorder() >= 6])
    return sheet


def name_body(axes, model, cells, name, metres, **look):
    """Writes a name into the middle of some cells, or beside it where keep_apart finds it on something else."""
    if not len(cells):
        return
    centres = cells.mean(axis=1)
    a, b = cells[:, 1] - cells[:, 0], cells[:, 2] - cells[:, 0]
    area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    middle = (centres * area[:, None]).sum(axis=0) / area.sum()
    away = ((centres - middle) ** 2).sum(axis=1)
    order = np.argsort(away)[:6000]  # all of which lie in the body
    _, first = np.unique(np.floor((centres[order] - middle) / (0.12 * metres)), axis=0, return_index=True)
    nearest = centres[order[np.sort(first)[:400]]]
    movable(axes.text(*nearest[0], name, ha="center", va="center", zorder=8, path_effects=[WHITE], **look), nearest, of_soil=True)


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


def dimensions(axes, model, low, high, metres):
    """Dimension lines: width and height of the mesh and of the soil that is there."""
    soil = model.corners[np.isin(model.body, np.flatnonzero(model.there))]
    soil = soil if len(soil) else model.corners
    first, last = soil.min(axis=(0, 1)), soil.max(axis=(0, 1))
    away = 0.48 * metres
    spans = [((first[0], low[1] - away), (last[0], low[1] - away))]
    if last[0] - first[0] < 0.999 * (high[0] - low[0]):
        spans.append(((low[0], low[1] - 1.6 * away), (high[0], low[1] - 1.6 * away)))
    spans.append(((high[0] + away, first[1]), (high[0] + away, last[1])))
    if last[1] - first[1] < 0.999 * (high[1] - low[1]):
        spans.append(((high[0] + 1.6 * away, low[1]), (high[0] + 1.6 * away, high[1])))
    boxes = [text.get_window_extent().padded(3).transformed(axes.transData.inverted()) for text in axes.texts if text.get_text()]
    for begin, end in map(np.array, spans):
        if begin[0] == end[0]:  # upright: on the left if names are in its way on the right only
            mirrored = np.array([low[0] + high[0] - begin[0], begin[1]]), np.array([low[0] + high[0] - end[0], end[1]])
            begin, end = min((begin, end), mirrored, key=lambda ends: sum(crosses(box, *ends) for box in boxes))
        dimension(axes, begin, end)
    for text in axes.texts:  # others keep off
        if hasattr(text, "of_line") or hasattr(text, "places") or not text.get_text():
            continue
        box = text.get_window_extent().transformed(axes.transData.inverted())
        if any(crosses(box, line.xy, line.xyann) for line in axes.texts if getattr(line, "of_line", False)):
            text.set(bbox={"fc": "white", "ec": "none", "pad": 1.2}, zorder=11)


def crosses(box, begin, end):
    """Does a level or upright line run through a box?"""
    return box.x0 < max(begin[0], end[0]) and box.x1 > min(begin[0], end[0]) and box.y0 < max(begin[1], end[1]) and box.y1 > min(begin[1], end[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", type=pathlib.Path, help="the document of the program (JSON)")
    parser.add_argument("picture", type=pathlib.Path, help="PNG file to write")
    given = parser.parse_args()
    model = Model(given.model.read_text())
    use(model.scene)
    draw_model(model, given.picture)


if __name__ == "__main__":
    main()
