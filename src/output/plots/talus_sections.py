"""Pictures of the particles: sections in plane strain, slices from the side, bodies cut through and from above."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm, Normalize, PowerNorm
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

import talus_style as style
from talus_tiles import Frame, outline_of_cells, outline_of_points, tiles

WIDTH, LEFT, RIGHT, HEAD, TITLE, FOOT = 12.0, 0.62, 1.0, 0.42, 0.3, 0.75  # of a sheet [inch]
BESIDE, BELOW, STACKED = 0.5, 0.38, 0.55  # between blocks, and between the views of one block [inch]
DOTTED, HALO = (0, (1, 1.6)), withStroke(linewidth=2, foreground="#ffffffaa")  # seen on pale and on dark soil
OUTLINE_PIXELS = 900
TIME = 0.2  # share of time, against motion, in the choice of snapshots
APART = 0.1  # crosses of particles that left the mesh [inch]


class View:
    """A way to look at the particles: two axes, and which particles are seen."""

    def __init__(self, name, across, up, choose=None):
        self.name, self.across, self.up, self._choose = name, across, up, choose

    def rows(self, position):
        return np.arange(len(position)) if self._choose is None else np.flatnonzero(self._choose(position))

    def flat(self, position):
        return position[:, [self.across, self.up]]

    def seen(self, position):
        return self.flat(position)[self.rows(position)]


def views_of(results):
    """The views that suit a run: one of a section or a thin slice; of a body its central section and the top."""
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
    moved = np.abs(end - start)
    along = max(level, key=lambda axis: moved[:, axis].sum())
    aside = next(axis for axis in level if axis != along)
    centre = weighted_median(start[:, aside], moved[:, along]) if len(start) else np.median(first[:, aside])
    spacing = spacing_of(results)
    name = f"section at {'xyz'[aside]} = {centre:.3g} m"
    return [
        View(name, along, up, lambda at: np.abs(at[:, aside] - centre) <= spacing),
        View("from above", along, aside, lambda at: on_top(at, along, aside, up, spacing)),
    ]


def on_top(position, along, aside, up, spacing):
    """Which particles have no other above them."""
    column = np.floor(position[:, [along, aside]] / spacing).astype(int)
    _, number = np.unique(column, axis=0, return_inverse=True)
    number = number.reshape(-1)
    highest = np.full(number.max(initial=-1) + 1, -np.inf)
    np.maximum.at(highest, number, position[:, up])
    return position[:, up] > highest[number] - 0.9 * spacing


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


def chosen_snapshots(results, times=None, count=6):
    """Snapshots nearest to `times`; else first, last and some between: evenly by how far things moved, and by a share of TIME also by time, so
    that a long wait before a failure is one picture and not three. Of those that have soil: all of it may have left the mesh."""
    snapshots = [snapshot for snapshot in results.snapshots if len(snapshot.ids())]
    at = np.array([snapshot.time for snapshot in snapshots])
    if times:
        return [snapshots[k] for k in sorted({int(np.abs(at - time).argmin()) for time in times})]
    if len(snapshots) <= count:
        return snapshots
    travel = np.concatenate([[0], np.cumsum([advance(a, b) for a, b in zip(snapshots, snapshots[1:])])])
    pace = sum((share * part / part[-1] for share, part in ((TIME, at - at[0]), (1 - TIME, travel)) if part[-1] > 0), np.zeros(len(at)))
    wanted = np.linspace(0, pace[-1], count)
    return [snapshots[k] for k in sorted({int(np.abs(pace - share).argmin()) for share in wanted})]


def advance(before, after):
    """How far the fastest hundredth of the particles that are in both snapshots moved between them [m]."""
    start, end = in_both(before, after)
    return float(np.percentile(np.linalg.norm(end - start, axis=1), 99)) if len(start) else 0.0


def in_both(before, after):
    """Places in two snapshots of the particles that are in both [m]."""
    _, a, b = np.intersect1d(before.ids(), after.ids(), assume_unique=True, return_indices=True)
    return before.position()[a], after.position()[b]


class Colours:
    """The scale that all pictures of a field share: from 0, or the least value if negative, to nearly the largest. That of plastic strain is even
    in its square root, so that the thin band at failure is seen beside the large strain of the slide."""

    def __init__(self, field, snapshots, log=False):
        self.map = style.colours_of(field)
        values = np.concatenate([snapshot.scalar(field)[0] for snapshot in snapshots])
        values = values[np.isfinite(values)]
        low, high = np.percentile(values, [0.1, 99.9]) if len(values) else (0.0, 0.0)
        self.factor, self.unit = style.readable_unit(max(abs(low), abs(high)), snapshots[0].scalar(field)[1])
        low, high = -rounded_up(-min(low, 0.0) * self.factor), rounded_up(max(high, 0.0) * self.factor)
        if low == high:
            high = 1.0
        if field == "state":
            low, high = -0.5, len(style.STATES) - 0.5
        self.names = style.STATES if field == "state" else ()
        self.beyond = len(values) > 0 and values.max() * self.factor > high
        self.rooted = field == "plastic_strain" and low == 0 and not log
        self.norm = LogNorm(1e-3 * high, high, clip=True) if log and low == 0 else PowerNorm(0.5, low, high) if self.rooted else Normalize(low, high)


def rounded_up(value):
    """The next number of two digits: 1.834 -> 1.9."""
    if value <= 0:
        return 0.0
    step = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(np.ceil(round(value / step, 6)) * step)


class Painter:
    """Draws one run at chosen times; what does not depend on the field is worked out once."""

    def __init__(self, results, snapshots, resolution=style.RESOLUTION):
        self.results, self.snapshots, self.resolution = results, snapshots, resolution
        self.views, self.spacing = views_of(results), spacing_of(results)
        self.corners = [self._limits(view) for view in self.views]
        self.outlines = [self._outline(view, corners) for view, corners in zip(self.views, self.corners)]
        self._tiles = {}
        self.marked_escaped = 0

    def _limits(self, view):
        """Corners of what is seen at all times, with room for the edge of the soil [m]."""
        clouds = [seen for snapshot in (self.results.snapshots[0], *self.snapshots) if len(seen := view.seen(snapshot.position()))]
        if self.results.escaped and len(self.results.escaped.position):
            clouds.append(view.flat(self.results.escaped.position))
        low, high = (np.array([of(cloud, axis=0) for cloud in clouds]) for of in (np.min, np.max))
        low, high = low.min(axis=0), high.max(axis=0)
        margin = 0.012 * (high - low) + 2 * self.spacing
        return low - margin, high + margin

    def _outline(self, view, corners):
        """Polylines (around the soil, between bodies) at the start."""
        first = self.results.snapshots[0]
        position = first.position()
        node, cell = self.results.mesh()
        if position.shape[1] == 2 and len(cell):
            return outline_of_cells(node, cell, position, first.body())
        return outline_of_points(view.seen(position), self.spacing, Frame(*corners, OUTLINE_PIXELS)), []

    def _tiled(self, snapshot, k, frame):
        """Particle in each pixel of the k-th view of a snapshot, -1 outside the soil."""
        key = (snapshot.step, k, frame.shape)
        if key not in self._tiles:
            position = snapshot.position()
            rows = self.views[k].rows(position)
            owner = tiles(self.views[k].flat(position)[rows], self.spacing, frame)
            self._tiles[key] = np.append(rows, -1)[owner]  # a section may have no particles any more
        return self._tiles[key]

    def over_time(self, field, colours, path):
        """All chosen times on one sheet."""
        columns = min(2 if len(self.views) == 1 else 3, len(self.snapshots))
        return style.save(self._sheet(field, colours, self.snapshots, columns), path)

    def large(self, field, colours, path):
        """The time that says most: the last, unless the field had faded by then."""
        values = [snapshot.scalar(field)[0] for snapshot in self.snapshots]
        tops = [np.percentile(known, 99) if (known := one[np.isfinite(one)]).size else 0.0 for one in values]
        best = self.snapshots[-1] if tops[-1] >= 0.8 * max(tops) else self.snapshots[int(np.argmax(tops))]
        return style.save(self._sheet(field, colours, [best], 1, named_points=True), path)

    def frame(self, field, colours, snapshot, note, path):
        """One frame of a film, with a note in its title."""
        figure = self._sheet(field, colours, [snapshot], 1, note=note)
        self._tiles.clear()  # those of all frames would fill the memory
        return style.save(figure, path, dpi=self.resolution)

    def _sheet(self, field, colours, snapshots, columns, named_points=False, note=""):
        """The figure of some snapshots in so many columns."""
        spans = [high - low for low, high in self.corners]
        wide = (WIDTH - LEFT - RIGHT - BESIDE * (columns - 1)) / columns
        heights = [wide * span[1] / span[0] for span in spans]
        block = TITLE + sum(heights) + STACKED * (len(heights) - 1)
        count = -(-len(snapshots) // columns)
        height = HEAD + count * block + (count - 1) * BELOW + FOOT
        figure = plt.figure(figsize=(WIDTH, height))
        for n, snapshot in enumerate(snapshots):
            row, column = divmod(n, columns)
            left, top = LEFT + column * (wide + BESIDE), height - HEAD - TITLE - row * (block + BELOW)
            for k, view in enumerate(self.views):
                top -= heights[k]
                axes = figure.add_axes([left / WIDTH, top / height, wide / WIDTH, heights[k] / height])
                top -= STACKED
                self._panel(axes, snapshot, field, k, colours, named_points)
                axes.set_title("  ·  ".join(self._title(snapshot, k, note)), loc="left", pad=5)
                lowest = n + columns >= len(snapshots)
                if lowest and k == len(self.views) - 1:
                    axes.set_xlabel(f"{'xyz'[view.across]} [m]")
                if column == 0:
                    axes.set_ylabel(f"{'xyz'[view.up]} [m]")
        self._frame_sheet(figure, field, colours)
        return figure

    def _title(self, snapshot, k, note):
        """Time, stage and a note above a block, the view's name where there are several."""
        when = [style.at_time(snapshot.time, self.results.snapshots[-1].time), snapshot.stage, *filter(None, [note])] if k == 0 else []
        return when + ([self.views[k].name] if len(self.views) > 1 else [])

    def _panel(self, axes, snapshot, field, k, colours, named_points):
        """One snapshot in one view; `axes` has its final size."""
        low, high = self.corners[k]
        inches = axes.get_position().width * WIDTH
        frame = Frame(low, high, int(inches * self.resolution))
        owner = self._tiled(snapshot, k, frame)
        value = snapshot.scalar(field)[0] * colours.factor
        image = np.ma.masked_where(owner < 0, value[owner])
        axes.imshow(image, extent=frame.extent(), origin="lower", cmap=colours.map, norm=colours.norm, aspect="auto")
        around, between = self.outlines[k]
        for line in around:
            axes.plot(*line.T, color=style.INK, linestyle=DOTTED, linewidth=1.1, path_effects=[HALO])
        for line in between:
            axes.plot(*line.T, color=style.SOFT, linestyle=DOTTED, linewidth=0.8, path_effects=[HALO])
        self._mark_escaped(axes, self.views[k], snapshot.time, (high[0] - low[0]) / inches)
        if named_points:
            self._mark_points(axes, self.views[k], snapshot.time)
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        tall = inches * (high[1] - low[1]) / (high[0] - low[0])
        axes.xaxis.set_major_locator(MaxNLocator(max(3, int(inches / 0.6)), steps=[1, 2, 5, 10]))
        axes.yaxis.set_major_locator(MaxNLocator(max(2, int(tall / 0.4)), steps=[1, 2, 5, 10]))

    def _mark_points(self, axes, view, time):
        """The named points of history.csv, where they are at a time."""
        history = self.results.history
        for name, place in (history.points(time) if history else {}).items():
            if len(place) <= max(view.across, view.up) or not np.isfinite(place).all():
                continue
            at = (place[view.across], place[view.up])
            axes.plot(*at, "o", markersize=5, markerfacecolor="white", markeredgecolor=style.INK, markeredgewidth=1.0)
            axes.annotate(style.words(name), at, xytext=(6, 6), textcoords="offset points", fontsize=8.5,
                          bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.8})

    def _mark_escaped(self, axes, view, time, metres):
        """Where particles have left the mesh up to a time: one cross for all that left at about the same place. An inch of the picture is so many
        `metres`."""
        escaped = self.results.escaped
        if escaped is None or not (escaped.time <= time).any():
            return
        place = view.flat(escaped.position[escaped.time <= time])
        _, first = np.unique(np.floor(place / (APART * metres)), axis=0, return_index=True)
        axes.plot(*place[first].T, "x", markersize=3, markeredgewidth=0.7, color=style.INK, alpha=0.6)
        self.marked_escaped = max(self.marked_escaped, len(place))

    def _frame_sheet(self, figure, field, colours):
        """Headline, colour bar, and what the dotted line is."""
        height = figure.get_figheight()
        panels = [axes.get_position() for axes in figure.axes]
        top, bottom = max(panel.y1 for panel in panels), min(panel.y0 for panel in panels)
        tall = min(top - bottom, 3.4 / height)
        bar = figure.add_axes([1 - (RIGHT - 0.22) / WIDTH, top - tall, 0.15 / WIDTH, tall])
        scale = plt.cm.ScalarMappable(colours.norm, colours.map)
        figure.colorbar(scale, cax=bar, extend="max" if colours.beyond else "neither")
        bar.tick_params(length=2)
        if colours.names:
            bar.set_yticks(range(len(colours.names)), colours.names, rotation=90, va="center")
        bar.set_title(colours.unit, fontsize=9, pad=6)
        headline = "  ".join(filter(None, (style.capital(style.words(field)), style.SYMBOL.get(field))))
        figure.text(LEFT / WIDTH, 1 - 0.24 / height, headline, fontsize=13, fontweight="bold", va="center")
        right = 1 - 0.25 / WIDTH
        figure.text(right, 1 - 0.24 / height, self.results.title, fontsize=9, color=style.SOFT, va="center", ha="right")
        legend = ("colours even in the square root; " if colours.rooted else "") + "dotted: outline at the start" + (f"; crosses: {self.marked_escaped} particles left the mesh here" if self.marked_escaped else "")
        figure.text(right, 0.16 / height, legend, fontsize=7.5, color=style.SOFT, ha="right")


def draw_sections(results, fields, times, folder, log=False):
    """FIELD_large.png and FIELD.png of each field that the run has; plastic strain on a logarithmic scale if `log`.
    Returns [(field, path of the large one, path of the sheet over time)]."""
    if not len(results.snapshots[0].position()):
        return []
    painter = Painter(results, chosen_snapshots(results, times))
    pictures = []
    for field in fields:
        if any(snapshot.scalar(field) is None for snapshot in painter.snapshots):
            continue
        if not any(np.isfinite(snapshot.scalar(field)[0]).any() for snapshot in painter.snapshots):
            continue  # such as the mobilised friction of soil without friction
        colours = Colours(field, painter.snapshots, log and field == "plastic_strain")
        pictures.append((field, painter.large(field, colours, folder / f"{field}_large.png"),
                         painter.over_time(field, colours, folder / f"{field}.png")))
    return pictures
