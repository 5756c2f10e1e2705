"""Pictures of the particles: sections in plane strain, slices from the side, bodies cut through and from above."""

import functools

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import offset_copy

import talus_structures
import talus_style as style
from talus_colours import Colours
from talus_factor import short
from talus_ground import Ground
from talus_modelled import read_model
from talus_moments import chosen_snapshots, origins, scaled_by, since_reset, telling, with_stress
from talus_outcomes import cell_size
from talus_perspective import edges
from talus_relief import EARTH, SOIL, between, seen, seen_from_above, without_flats
from talus_results import MECHANISM, read_factor, together
from talus_soils import middles, moved_away, painted, tints
from talus_symbols import AROUND as SIDES, WHITE, keep_apart, movable
from talus_tiles import GAP, GAP_IN_SPACE, Frame, outline_of_cells, outline_of_points
from talus_units import capital, words
from talus_views import MapView, Oblique, View, spacing_of, views_of

WIDTH, LEFT, RIGHT, HEAD, TITLE, FOOT = 12.0, 0.62, 1.0, 0.42, 0.3, 0.75  # of a sheet [inch]
BESIDE, BELOW, STACKED = 0.5, 0.38, 0.55  # between blocks, and between the views of one block [inch]
DOTTED, HALO = (0, (1, 1.6)), withStroke(linewidth=2, foreground="#ffffffaa")  # seen on pale and on dark soil
OUTLINE_PIXELS = 900
MOVED = 0.8  # of the spacing of particles: an outline that is nearer to the present edge of the soil is not drawn
LINE, LETTER = 0.17, 0.078  # height of a line of a title, and width of a letter of it [inch]
TALLEST = 0.8  # height of a map over the width of its column
ISLAND = 0.35  # half the width of one or two cells that are not shown as soil without a value amid others, over their size
BODIES = 0.15  # most of the size of the soil, by which rigid bodies beside it make a picture larger
AROUND = 0.06  # of the size of the soil: what is shown of the mesh's bottom beside it
ROOM = 0.28  # which the name of a point needs above it [inch]
RELIEF = 2.0  # least difference of heights that has contours, over the spacing of particles: the surface is rough by about one, the least interval
APART = 0.1  # crosses of particles that left the mesh [inch]


class Painter:
    """Draws one run at chosen times; what does not depend on the field is worked out once."""

    def __init__(self, results, snapshots, resolution=style.RESOLUTION, as_asked=False):
        self.results, self.snapshots, self.resolution, self.as_asked = results, snapshots, resolution, as_asked
        self.views, self.spacing = views_of(results), spacing_of(results)
        self.cell = cell_size(results) if len(results.mesh()[1]) else 0.0
        self.section = next(k for k, view in enumerate(self.views) if isinstance(view, View))
        clouds = [snapshot.position() for snapshot in (results.snapshots[0], *snapshots) if len(snapshot.ids())]
        if results.escaped and len(results.escaped.position):
            clouds.append(results.escaped.position)
        self.low, self.high = (of([of(cloud, axis=0) for cloud in clouds], axis=0) for of in (np.min, np.max))
        self.ground = self._ground() if len(self.views) > 1 else None
        self.corners = [self._limits(view) for view in self.views]
        self.outlines = [self._outline(view, corners) for view, corners in zip(self.views, self.corners)]
        self._tiles, self._surfaces = {}, {}
        # a section alone shows soils in the colours of the model; views in space shade all soil alike
        self.flat = len(self.views) == 1
        self.tints = tints(results.bodies) if self.flat else None
        self.marked_escaped, self.drawn_outline = 0, False
        self.slips = []  # (name, points [n, 2], style of the line) of slip surfaces, which pictures of one time show in a section alone
        self.reset, self.since = "", {}  # stage at whose end the field was last set to 0; {step: what it counts from}, where that differs

    def _ground(self):
        """What is shown of the ground in 3D: the soil at all times with some of the mesh's bottom around it."""
        up = self.results.up_axis()
        around = np.maximum(AROUND * (self.high - self.low), 2 * self.spacing)
        around[up] = 0.5 * self.spacing
        top = self.views[-1]
        return Ground(self.low - around, self.high + around, self.spacing, (top.across, top.up), up, self.results.mesh())

    def _box(self):
        """Corners of the box whose dimensions a picture in 3D states: that of the ground, as high as the soil is: from the lowest to the highest place of
        particles' centres and of corners of the model's soil, since half a particle above a centre may be beyond the soil."""
        low, high, up = self.ground.low.copy(), self.ground.high.copy(), self.results.up_axis()
        model = read_model(self.results.folder)
        heights = [self.low[up], self.high[up], *(model.corners[..., up].ravel() if model else (low[up], high[up]))]
        low[up], high[up] = min(heights), max(heights)
        return low, high

    def _limits(self, view):
        """Corners of what is seen at all times, with room for the edge of the soil [m]."""
        if isinstance(view, Oblique):
            corners = np.array(np.meshgrid(*zip(self.ground.low, self.ground.high))).reshape(3, -1).T
            flat = view.flat(corners)
            margin = np.ptp(flat, axis=0).max() * np.array([0.1, 0.05])  # for the dimensions
            return flat.min(axis=0) - margin, flat.max(axis=0) + margin
        low, high = view.limits(*((self.low, self.high) if self.ground is None else (self.ground.low, self.ground.high)))
        if view.plane:  # as far as the ground is shown, and as high: above the crown of a slide it rises over all soil
            along, base = self._line_of_bottom(view)
            if (shown := np.isfinite(base)).any():
                low, high = np.array([along[shown].min(), low[1]]), np.array([along[shown].max(), max(high[1], base[shown].max())])
        if len(self.views) == 1:
            low, high = self._with_bodies(low, high)
        margin = 0.012 * (high - low) + (GAP if self.ground is None else GAP_IN_SPACE) * self._sizes(self.results.snapshots[0]).max()
        return low - margin, high + margin

    def _with_bodies(self, low, high):
        """The same corners with room for rigid bodies, which may be much larger than the soil."""
        bodies = [corners for snapshot in self.results.snapshots for corners in self.results.rigid_outlines(snapshot.time).values()]
        if not bodies:
            return low, high
        corners, most = np.concatenate(bodies), BODIES * (high - low)
        return np.clip(corners.min(axis=0), low - most, low), np.clip(corners.max(axis=0), high, high + most)

    def _outline(self, view, corners):
        """Polylines around the soil at the start."""
        first = self.results.snapshots[0]
        position = first.position()
        if isinstance(view, Oblique):
            return []
        moved = getattr(self.results, "counts_since", "")  # soil that has moved is not made of whole cells
        if position.shape[1] == 2 and not moved and len((mesh := self.results.mesh())[1]):
            return outline_of_cells(*mesh, position)
        return view.tiles(position, self._sizes(first), Frame(*corners, OUTLINE_PIXELS), outline_of_points)[0]

    def _sizes(self, snapshot):
        """The widths of the particles [m]: the spacing, or 2, 4, 8 ... times that where cells are much larger than the mean."""
        first = self.results.snapshots[0]
        if "mass" not in snapshot or "mass" not in first:
            return np.full(len(snapshot.ids()), self.spacing)
        share = snapshot.column("mass").values[:, 0] / first.column("mass").values.mean()
        return self.spacing * 2 ** np.clip(np.floor(np.log2(share) / first.position().shape[1] + 0.25), 0, 5)

    def _tiled(self, snapshot, k, frame):
        """Particle in each pixel of the k-th view of a snapshot, -1 outside the soil."""
        key = (snapshot.step, k, frame.shape)
        if key not in self._tiles:
            owner, rows = self.views[k].tiles(snapshot.position(), self._sizes(snapshot), frame)
            self._tiles[key] = np.append(rows, -1)[owner]  # a section may have no particles any more
        return self._tiles[key]

    def _surface(self, snapshot):
        """Heights of the ground at a snapshot, and where there is soil."""
        if snapshot.step not in self._surfaces:
            size = self._sizes(snapshot)
            volume = snapshot.column("volume").values[:, 0] if "volume" in snapshot else size**3
            self._surfaces[snapshot.step] = self.ground.surface(snapshot.position(), size, volume)
        return self._surfaces[snapshot.step]

    def _sight(self, snapshot, k, columns):
        """What the k-th view, an oblique one or one from above, sees of a snapshot."""
        key = (snapshot.step, k, columns)
        if key not in self._tiles:
            view, (low, high), ground = self.views[k], self.corners[k], (self.ground, *self._surface(snapshot))
            oblique = isinstance(view, Oblique)
            self._tiles[key] = seen(*ground, view.eye, low, high, columns, view.cut) if oblique else \
                seen_from_above(*ground, self.views[0].eye, low, high, columns)
        return self._tiles[key]

    def _image(self, snapshot, field, k, colours, frame):
        """The picture of a field, bytes [rows, columns, 3 or 4]."""
        value = snapshot.scalar(field)[0] * colours.factor
        reach = int(round(max(ISLAND * self.cell, 0.75 * self.spacing) / frame.pixel))
        if isinstance(self.views[k], (Oblique, MapView)):
            laid = self.ground.below(snapshot.position(), self._surface(snapshot)[0])
            image = self._sight(snapshot, k, frame.shape[1]).painted(laid, value, colours, self.spacing, reach)
        else:
            image = painted(self._tiled(snapshot, k, frame), value, snapshot.body(), self.tints if self.flat else np.tile(SOIL, (len(self.results.bodies), 1)), colours, reach)
        return np.round(255 * image).astype(np.uint8)

    def count_from(self, field, snapshots):
        """Lets the pictures say what these snapshots count the field from: each in its title where that differs."""
        said, self.reset = origins(self.results, snapshots, field)
        self.since = {snapshot.step: words for snapshot, words in zip(snapshots, said)}

    def colours(self, field, snapshots, log=False):
        """The scale that the pictures of these snapshots share: that of those after the last reset, unless nothing has moved since."""
        later = scaled_by(self.results, snapshots, field)
        of = [Colours(field, some, log and field == "plastic_strain", self.spacing, snapshots) for some in ([later] if later is snapshots else [later, snapshots])]
        return of[-1] if of[0].nothing else of[0]

    def over_time(self, field, colours, snapshots, path):
        """All these times on one sheet; of times that the program has chosen those at which something else is seen."""
        shown = snapshots if self.as_asked else telling(snapshots, field, colours, self.spacing)
        shown = snapshots[-1:] if colours.nothing and len(shown) == 1 else shown
        columns = min(2 if len(self.views) == 1 else 3, len(shown))
        return style.save(self._sheet(field, colours, shown, columns, [[0]] if len(self.views) == 1 else [[0], [self.section]]), path)

    def large(self, field, colours, snapshots, path):
        """The time that says most: the last, unless the field had faded by then. Of thickness always the last, the deposit, thinner as it is."""
        values = [snapshot.scalar(field)[0] for snapshot in snapshots]
        tops = [np.percentile(known, 99) if (known := one[np.isfinite(one)]).size else 0.0 for one in values]
        best = snapshots[-1] if field == "thickness" or tops[-1] >= 0.8 * max(tops) else snapshots[int(np.argmax(tops))]
        rows = [[0]] if len(self.views) == 1 else [[0, 1], [2, 3]]
        return style.save(self._sheet(field, colours, [best], 1, rows, named_points=True), path)

    def picture_of_line(self, snapshot, field, line, name, path):
        """A field in the section, and a line [n, 2] upon it, whose name stands in the title."""
        figure = self._sheet(field, Colours(field, [snapshot], spacing=self.spacing), [snapshot], 1, [[self.section]], note=f"line: {name}")
        axes = figure.axes[0]
        axes.plot(*line.T, color="white", lw=3.4)
        axes.plot(*line.T, color=style.ACCENT, lw=1.8)
        return style.save(figure, path)

    def frame(self, field, colours, snapshot, note, path):
        """One frame of a film, with a note in its title."""
        figure = self._sheet(field, colours, [snapshot], 1, [[0]] if len(self.views) == 1 else [[0, 1]], note=note, lines=1 if len(self.views) == 1 else 2)
        self._tiles.clear()  # those of all frames would fill the memory
        self._surfaces.clear()
        return style.save(figure, path, dpi=self.resolution)

    def _sheet(self, field, colours, snapshots, columns, rows, named_points=False, note="", lines=1):
        """The figure of some snapshots in so many columns of blocks; a block has the views whose numbers are in `rows`, and room for so many `lines` of
        its title or more. The size of a film's frames may not depend on their titles."""
        spans = [high - low for low, high in self.corners]
        wide = (WIDTH - LEFT - RIGHT - BESIDE * (columns - 1)) / columns
        widths = {k: (wide - BESIDE * (len(row) - 1)) / len(row) for row in rows for k in row}
        for k in widths:  # a map may be much longer to the north than to the east, and a column is taller than wide
            tallest = TALLEST if isinstance(self.views[k], MapView) else 1.0
            widths[k] = min(widths[k], tallest * widths[k] * spans[k][0] / spans[k][1])
        heights = {k: widths[k] * spans[k][1] / spans[k][0] for k in widths}
        since = {self.since.get(snapshot.step) for snapshot in snapshots}
        titles = {(n, k): wrapped(self._title(snapshot, k, note if k == rows[0][0] else None, len(since) > 1), widths[k])
                  for n, snapshot in enumerate(snapshots) for row in rows for k in row}
        above = TITLE + LINE * (max(lines, *(titles[n, rows[0][0]].count("\n") + 1 for n in range(len(snapshots)))) - 1)
        block = above + sum(max(heights[k] for k in row) for row in rows) + STACKED * (len(rows) - 1)
        count = -(-len(snapshots) // columns)
        height = HEAD + count * block + (count - 1) * BELOW + FOOT
        figure = plt.figure(figsize=(WIDTH, height))
        self.marked_escaped, self.drawn_outline = 0, False
        for n, snapshot in enumerate(snapshots):
            block_row, column = divmod(n, columns)
            left, top = LEFT + column * (wide + BESIDE), height - HEAD - above - block_row * (block + BELOW)
            for row in rows:
                for place, k in enumerate(row):
                    at = left + place * ((wide - BESIDE * (len(row) - 1)) / len(row) + BESIDE)
                    axes = figure.add_axes([at / WIDTH, (top - heights[k]) / height, widths[k] / WIDTH, heights[k] / height])
                    self._panel(axes, snapshot, field, k, colours, named_points, len(snapshots) == 1)
                    if named_points:
                        keep_apart(axes)
                    axes.set_title(titles[n, k], loc="left", pad=5, y=1.0)  # which need not be found
                    if isinstance(self.views[k], Oblique):
                        continue
                    if n + columns >= len(snapshots) and row is rows[-1]:
                        axes.set_xlabel(self.views[k].labels[0])
                    if column == 0:
                        axes.set_ylabel(self.views[k].labels[1])
                top -= max(heights[k] for k in row) + STACKED
        said = f"since the end of stage {self.reset}" if self.reset else since.pop() if len(since) == 1 else None
        self._frame_sheet(figure, field, colours, [k for row in rows for k in row], said)
        return figure

    def _title(self, snapshot, k, note, with_since=True):
        """Time, stage and a note above a block, which has a note or "" in its first view alone; the view's name where there are several."""
        stage = "mechanism, whose size is free" if snapshot.stage == MECHANISM else snapshot.stage
        when = [] if note is None and k else [self.results.when(snapshot), stage, *filter(None, [note, self.since.get(snapshot.step) if with_since else None])]
        return when + ([self.views[k].name] if len(self.views) > 1 else [])

    def _panel(self, axes, snapshot, field, k, colours, named_points=False, alone=False):
        """One snapshot in one view; `axes` has its final size. A snapshot that is `alone` on its sheet has its dimensions."""
        view, (low, high) = self.views[k], self.corners[k]
        inches = axes.get_position().width * WIDTH
        metres = (high[0] - low[0]) / inches  # in an inch
        frame = Frame(low, high, int(inches * self.resolution))
        image = self._image(snapshot, field, k, colours, frame)
        axes.imshow(image, extent=frame.extent(), origin="lower", aspect="auto", interpolation="nearest")
        for line in self.outlines[k]:
            if not isinstance(view, MapView):
                line = moved_away(line, self._tiled(snapshot, k, frame) >= 0, frame, MOVED * self.spacing)
            if np.isfinite(line).any():
                axes.plot(*line.T, color=style.INK, linestyle=DOTTED, linewidth=1.1, path_effects=[HALO])
                self.drawn_outline = True
        for corners in self.results.rigid_outlines(snapshot.time).values() if self.flat else []:
            axes.fill(*corners.T, facecolor=style.FAINT, edgecolor=style.INK, linewidth=1.0, zorder=3)
        if self.flat:
            talus_structures.draw(axes, self.results, snapshot.time)
        if alone and self.flat:
            for name, line, dash in self.slips:
                axes.plot(*line.T, color="white", lw=3.2)
                axes.plot(*line.T, color=style.ACCENT, lw=1.8, ls=dash, label=name)
        self._mark_escaped(axes, view, snapshot.time, metres)
        if alone and self.flat and len(self.results.bodies) > 1:
            self._name_soils(axes, snapshot, self._tiled(snapshot, k, frame), frame)
        if named_points:
            self._mark_points(axes, view, snapshot.time, high[1] - ROOM * metres)
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        if isinstance(view, Oblique):
            axes.axis("off")
            if alone:
                edges(axes, view.eye, *self._box(), metres)
            return
        if isinstance(view, MapView):
            self._mirror_as_needed(axes, view)
            self._contours(axes, snapshot)
            if view.of_terrain:
                self._north(axes)
        elif view.plane:
            self._bottom(axes, view)
        tall = inches * (high[1] - low[1]) / (high[0] - low[0])
        style.places(axes.xaxis, max(3, int(inches / 0.6)))
        style.places(axes.yaxis, max(2, int(tall / 0.4)))

    def _mirror_as_needed(self, axes, view):
        """A view from above is not one from below: the second axis runs downward where the two and the upward axis are left-handed."""
        if (view.up - view.across) % 3 == 2:
            axes.invert_yaxis()

    def _north(self, axes):
        """The arrow to the north, in the upper right corner of the ground, off its edge and the outline of soil there."""
        head, foot = (offset_copy(axes.transData, axes.figure, -12, down, units="points") for down in (-16, -40))
        corner = self.ground.high[self.ground.level]
        axes.annotate("N", corner, corner, xycoords=foot, textcoords=head, ha="center", fontsize=9, zorder=5, path_effects=[HALO],
                      arrowprops={"arrowstyle": "<-", "color": style.INK, "lw": 1.2})

    def _contours(self, axes, snapshot):
        """Lines of equal height of the soil."""
        top, soil = self._surface(snapshot)
        at = [self.ground.low[axis] + (np.arange(count) + 0.5) * self.ground.cell for axis, count in zip(self.ground.level, self.ground.shape)]
        heights = np.ma.masked_where(~soil, top).T
        particles = (heights.max() - heights.min()) / self.spacing
        if particles < RELIEF:
            return
        levels = MaxNLocator(int(min(particles, 10))).tick_values(heights.min(), heights.max())
        levels = levels + 0.5 * (levels[1] - levels[0])  # level ground often lies at a round height
        heights = without_flats(heights, levels, int(np.ceil(self.spacing / self.ground.cell)))
        axes.contour(*at, heights, levels=levels, colors=style.INK, linewidths=0.4, alpha=0.5)

    def _bottom(self, axes, view):
        """The bottom of the mesh below a section."""
        along, base = self._line_of_bottom(view)
        axes.fill_between(along, base, axes.get_ylim()[0], color=EARTH, linewidth=0)
        axes.plot(along, base, color=style.SOFT, linewidth=0.8)

    def _line_of_bottom(self, view):
        """The bottom of the mesh in a section: places along the picture, and heights, which are no numbers beyond what is shown of the ground."""
        ground = self.ground
        along, at = view.line(ground, 400)
        base, inside = between(np.stack([ground.base, ground.inside], axis=-1), [(at[axis] - ground.low[axis]) / ground.cell for axis in ground.level])
        beyond = np.any([(at[axis] < ground.low[axis]) | (at[axis] > ground.high[axis]) for axis in ground.level], axis=0)
        return along, np.where((inside > 0.5) & ~beyond, base, np.nan)

    def _mark_points(self, axes, view, time, highest):
        """The named points of history.csv, where they are at a time, those that are the same particle with one name; names of points that are higher than
        `highest` stand below them, away from the title, and all of them beside each other."""
        history = self.results.history
        places = history.points(time) if history else {}
        for names in together({name: history.way(name) for name in places}):
            place = places[names[0]][None]
            if place.shape[1] < self.low.size or not np.isfinite(place).all() or view.aside(place)[0] > 2 * self.spacing:
                continue
            at = view.flat(place)[0]
            axes.plot(*at, "o", markersize=5, markerfacecolor="white", markeredgecolor=style.INK, markeredgewidth=1.0)
            around = [side for side in SIDES if side[1] < 0] if at[1] > highest else SIDES
            name = axes.annotate(", ".join(map(words, names)), at, around[0][:2], textcoords="offset points", ha=around[0][2], fontsize=8.5, path_effects=[WHITE])
            movable(name, around)

    def _name_soils(self, axes, snapshot, owner, frame):
        """The names of the soils in the middle of each."""
        for number, (row, column) in middles(np.where(owner >= 0, snapshot.body()[owner], -1)).items():
            at = frame.low + (np.array([column, row]) + 0.5) * frame.pixel
            axes.text(*at, words(self.results.bodies[number]), fontsize=8.5, ha="center", va="center", path_effects=[withStroke(linewidth=2.2, foreground="white")])

    def _mark_escaped(self, axes, view, time, metres):
        """Where particles have left the mesh up to a time, of those that left in the shown part: one cross for all that left at about the same place. An
        inch of the picture is so many `metres`."""
        escaped = self.results.escaped
        if escaped is None:
            return
        left = escaped.position[escaped.time <= time]
        left = left[view.aside(left) <= 2 * self.spacing]
        if not len(left):
            return
        place = view.flat(left)
        _, first = np.unique(np.floor(place / (APART * metres)), axis=0, return_index=True)
        axes.plot(*place[first].T, "x", markersize=3, markeredgewidth=0.7, color=style.INK, alpha=0.6)
        self.marked_escaped = max(self.marked_escaped, len(place))

    def _frame_sheet(self, figure, field, colours, views, since):
        """Headline with what all panels count the field from, colour bar, and what colours and lines mean in the views with these numbers."""
        height = figure.get_figheight()
        panels = [axes.get_position() for axes in figure.axes]
        top, bottom = max(panel.y1 for panel in panels), min(panel.y0 for panel in panels)
        tall = min(top - bottom, 3.4 / height)
        colours.bar(figure, [1 - (RIGHT - 0.22) / WIDTH, top - tall, 0.15 / WIDTH, tall])
        headline = "  ".join(filter(None, (capital(words(field)), style.SYMBOL.get(field))))
        written = figure.text(LEFT / WIDTH, 1 - 0.24 / height, headline, fontsize=13, fontweight="bold", va="center")
        beside = ", ".join(filter(None, (since, colours.nothing)))
        if beside:
            figure.text(written.get_window_extent(figure.canvas.get_renderer()).x1 / figure.bbox.width + 0.15 / WIDTH, 1 - 0.24 / height, beside, fontsize=10, va="center")
        right = 1 - 0.25 / WIDTH
        figure.text(right, 1 - 0.24 / height, self.results.title, fontsize=9, color=style.SOFT, va="center", ha="right")
        legend = [colours.in_words("in the colour of its soil" if self.flat else "grey")]
        legend += [colours.uneven] * bool(colours.uneven)
        legend += ["dotted: outline at the start"] * self.drawn_outline
        legend += [f"crosses: {self.marked_escaped} particles left the mesh here"] * bool(self.marked_escaped)
        figure.text(right, 0.16 / height, "; ".join(legend), fontsize=7.5, color=style.SOFT, ha="right")
        if self.flat:
            self._legend_of_soils(figure)

    def _legend_of_soils(self, figure):
        """The soils and their colours, below on the left."""
        lines = figure.axes[0].get_legend_handles_labels()
        if lines[0]:  # above the soils
            figure.add_artist(figure.legend(*lines, loc="lower left", bbox_to_anchor=(LEFT / WIDTH - 0.006, 0.28 / figure.get_figheight()), fontsize=7.5, borderpad=0,
                                            borderaxespad=0.5, handlelength=2.4, ncols=2, columnspacing=1.4, labelcolor=style.SOFT))
        handles = [plt.Rectangle((0, 0), 1, 1, fc=tint, ec=style.SOFT, lw=0.5) for tint in self.tints]
        figure.legend(handles, map(words, self.results.bodies), loc="lower left", bbox_to_anchor=(LEFT / WIDTH - 0.006, 0.09 / figure.get_figheight()),
                      ncols=8, fontsize=7.5, borderpad=0, borderaxespad=0.5, handlelength=1.6, handleheight=0.9, columnspacing=1.4, labelcolor=style.SOFT)


def wrapped(parts, width):
    """The parts of a title beside each other, on as many lines as a panel of this width [inch] needs."""
    lines = [parts[0]]
    for part in parts[1:]:
        longer = f"{lines[-1]}  ·  {part}"
        if LETTER * len(longer) <= width:
            lines[-1] = longer
        else:
            lines.append(part)
    return "\n".join(lines)


def slip_surfaces(results, folder):
    """What is known of slip surfaces of a run in plane strain or a slice: the line that `talus plot --slip-surface` has found, and that of the least factor of
    safety. [(name, points [n, 2], style of the line)]"""
    found = []
    path, run = folder / "slip_surface.csv", results.folder / "run.h5"
    if path.exists() and not (run.exists() and run.stat().st_mtime > path.stat().st_mtime):  # that of an earlier run in this folder is not its own
        found.append(("slip surface, where its soil was at the start", np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2), "-"))
    factor = read_factor(results)
    if factor and factor["mechanisms"][0]["slip_surface_m"]:
        found.append((f"slip surface of the factor of safety, {short(factor['factor_of_safety'])}", np.array(factor["mechanisms"][0]["slip_surface_m"]), (0, (4, 2))))
    return found


def section_tasks(results, fields, times, folder, log=False, over_time=None):
    """Functions, one for each field that the run has. Each draws FIELD_large.png, and FIELD.png of those `over_time`, or of all; plastic strain on a logarithmic
    scale if `log`. The program chooses snapshots without `times`. They return (field, path of the large one, path of the sheet over time or None)."""
    if not len(results.snapshots[0].position()):
        return []
    chosen = chosen_snapshots(results, times)
    after, _ = ([], "") if times else since_reset(results, chosen, "displacement")
    painter = Painter(results, chosen + after, as_asked=bool(times))
    painter.slips = slip_surfaces(results, folder)

    def draw(field):
        snapshots, painter.reset = (chosen, "") if times else since_reset(results, with_stress(results, chosen, field), field)
        if times:
            painter.count_from(field, snapshots)
        colours = painter.colours(field, snapshots, log)
        large = painter.large(field, colours, scaled_by(results, snapshots, field), folder / f"{field}_large.png")
        sheet = painter.over_time(field, colours, snapshots, folder / f"{field}.png") if over_time is None or field in over_time else None
        return field, large, sheet

    return [functools.partial(draw, field) for field in fields if not any(snapshot.scalar(field) is None for snapshot in chosen)
            and any(np.isfinite(snapshot.scalar(field)[0]).any() for snapshot in chosen)]  # nowhere: such as the mobilised friction of soil without friction
