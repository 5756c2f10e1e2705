"""Pictures of maps: a hill-shaded map of the deposit, and a section along the path of the slide."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import offset_copy

import talus_style as style
from talus_ground import smoothed
from talus_relief import between, without_flats
from talus_units import length, of_length

STATES = 5  # surfaces in the section, at most
LAMPS = ((315, 0.6), (270, 0.2), (0, 0.2))  # azimuths of the light on a map and their shares: one alone leaves slopes along it without relief
HEIGHT = 45  # of the lamps above the horizon [deg]
DARK, LIGHT = 0.45, 0.95  # greys of slopes in shade and in full light: neither black nor white
MOVED = 0.3  # of the size of particles: a surface that changed by less stands still in the section
LEVEL = 1 / 40  # of the shorter side of the map: level ground is wider than twice this
ARROW = np.array([0.45, 0.8])  # room for the arrow to the north, from its corner on [inch]
AROUND = 0.15  # of the length of what moved: what is shown of the section before and behind it


def extent(low, cell, shape, origin):
    """Corners of a grid as matplotlib's imshow takes them, in the coordinates of the map."""
    low = low + origin
    return (low[0], low[0] + shape[0] * cell, low[1], low[1] + shape[1] * cell)


def round_length(longest):
    """The largest of 1, 2, 5, 10, ... m that is no longer."""
    power = 10.0 ** np.floor(np.log10(longest))
    return power * max(factor for factor in (1, 2, 5) if factor * power <= longest)


def smoothed_evenly(height, deviation):
    """Heights smoothed by a bell of this standard deviation [cells]; beyond the edges slopes go on."""
    beyond = min(int(np.ceil(3 * deviation)), min(height.shape) - 1)
    return smoothed(np.pad(height, beyond, mode="reflect", reflect_type="odd"), deviation)[beyond:-beyond, beyond:-beyond]


def shade(height, cell):
    """How light a level grid of heights [to the east, to the north] is, from DARK to LIGHT."""
    east, north = np.gradient(height, cell)
    size = np.sqrt(east**2 + north**2 + 1)
    light = 0
    for azimuth, share in LAMPS:
        towards = np.cos(np.radians(HEIGHT)) * np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))])
        light = light + share * np.clip((np.sin(np.radians(HEIGHT)) - east * towards[0] - north * towards[1]) / size, 0, 1)
    return DARK + (LIGHT - DARK) * light


def near(mask, cells):
    """Cells that are this near to one of the mask."""
    for _ in range(cells):
        wider = np.pad(mask, 1)
        mask = wider[1:-1, 1:-1] | wider[:-2, 1:-1] | wider[2:, 1:-1] | wider[1:-1, :-2] | wider[1:-1, 2:]
    return mask


def places_of_labels(lines, low, high, taken, apart):
    """Places for the heights of contours, each on its line: away from the edges of the map, not in what is `taken` (a function of places
    [n, 2]), and `apart` [m] from each other. A line without such a place has no label."""
    found = np.empty((0, 2))
    for segments in lines.allsegs:
        for line in sorted(segments, key=len, reverse=True)[:2]:
            inside = line[((line > low + 0.7 * apart) & (line < high - 0.7 * apart)).all(axis=1)]
            free = inside[~taken(inside)]
            if len(free) and len(found):
                nearest = np.linalg.norm(free[:, None] - found, axis=2).min(axis=1)
                free = free[nearest > apart]
            if len(free):
                middle = free[np.argmin(np.linalg.norm(free - free.mean(axis=0), axis=1))]
                found = np.vstack([found, middle])
    return found


def covered(soil, spacing, low, high):
    """How many cells of a mask lie between two corners, which count from that of the mask [m]."""
    (west, south), (east, north) = (np.floor(np.array(end) / spacing).astype(int) for end in (low, high))
    return np.count_nonzero(soil[max(west, 0):east + 1, max(south, 0):north + 1])


def corner_of_arrow(soil, spacing, low, shown, inch):
    """The corner of what is `shown` of the ground, as two numbers 0 or 1 to the east and to the north, in which the arrow to the north stands on a map with so
    much soil (a mask of cells from `low` on): that with least soil, the first of those that have none."""
    size = ARROW * inch

    def on_soil(corner):
        at = np.where(corner, shown[1] - size, shown[0]) - low
        return covered(soil, spacing, at, at + size)

    return min([(1, 1), (0, 1), (1, 0), (0, 0)], key=on_soil)


def place_of_scale(soil, spacing, low, shown, length, inch, arrow=(1, 1)):
    """The left end of a scale so long [m] in the corner that has least soil, of those that the arrow leaves."""
    edge, tall = 0.04 * (shown[1] - shown[0]), 0.3 * inch  # with its number above it
    (west, south), (east, north) = shown[0] + edge - low, shown[1] - edge - low
    corners = {(0, 0): [west, south], (1, 0): [east - length, south], (0, 1): [west, north - tall], (1, 1): [east - length, north - tall]}
    return low + min((at for corner, at in corners.items() if corner != arrow), key=lambda at: covered(soil, spacing, at, np.add(at, [length, tall])))


def ticks_of(axes, width, height, factor=1.0):
    """As many ticks as numbers with this many digits leave room for, none so near to an end that its number passes it; `width`, `height` of the map
    [inch], `factor` of the unit of the numbers."""
    number = 0.085 * max(len(f"{factor * value:.0f}") for value in (*axes.get_xlim(), *axes.get_ylim()))  # its length [inch]
    for axis, long, (low, high) in ((axes.xaxis, width, axes.get_xlim()), (axes.yaxis, height, axes.get_ylim())):
        beside = 0.5 * number / long * (high - low)
        first = int(np.clip(long / (1.4 * number + 0.2), 1, 8))
        for most in range(first, first + 3):  # two of them, if they do not touch
            ticks = MaxNLocator(most, min_n_ticks=2).tick_values(factor * low, factor * high) / factor
            inside = ticks[(ticks >= low + beside) & (ticks <= high - beside)]
            if most == first or (len(inside) == 2 and inside[1] - inside[0] > 2.3 * beside):
                axis.set_ticks(inside)
            if len(inside) > 1:
                break


def draw_map(maps, path):
    """Hill-shaded ground before the slide with contours; thickness, outline and path of the slide upon it."""
    ground, grid, origin, (factor, unit) = maps.ground, maps.grid, maps.axes.origin[:2], length()
    of_places = (1.0, "m") if maps.axes.spacing else (factor, unit)  # coordinates of a terrain file are those of its projection
    size = np.array(grid.shape) * grid.spacing
    tall = np.clip(7.0 * size[1] / size[0], 2.0, 9.0)  # of the map, in inches
    wide = np.clip(tall * size[0] / size[1], 5.0, 7.0)
    figure, axes = plt.subplots(figsize=(wide + 1.4, tall + 1.4), layout="constrained")
    east, north = (origin[k] + ground.low[k] + (np.arange(ground.shape[k]) + 0.5) * ground.cell for k in (0, 1))
    before = smoothed_evenly(maps.before, grid.spacing / (2 * ground.cell))
    light = np.ma.masked_where(~ground.inside, shade(before, ground.cell))
    axes.imshow(light.T, cmap="gray", vmin=0, vmax=1, origin="lower", extent=extent(ground.low[:2], ground.cell, ground.shape, origin))
    levels = MaxNLocator(12).tick_values(factor * before.min(), factor * before.max()) / factor
    level = np.ma.masked_where(~ground.inside, without_flats(before, levels, max(1, int(LEVEL * min(before.shape)))))
    lines = axes.contour(east, north, level.T, levels, colors=style.SOFT, linewidths=0.5)
    deposit = np.ma.masked_where(~maps.covered[-1], maps.thickness[-1])
    image = axes.imshow(factor * deposit.T, cmap=style.colours_of("thickness"), vmin=0, origin="lower", alpha=0.85, zorder=2,
                        extent=extent(grid.low, grid.spacing, grid.shape, origin))
    figure.colorbar(image, ax=axes, shrink=0.75, label=f"thickness at {maps.moment()} [{unit}]")
    for rings, dashes in ((maps.rings(maps.covered[-1]), "-"), (maps.rings(maps.covered[0]), "--")):
        for ring in rings:
            axes.plot(*ring.T, color=style.INK, lw=1.0, ls=dashes, zorder=3)
    way = maps.path[:, :2] + origin
    axes.plot(*way.T, color=style.ACCENT, lw=1.6, zorder=4, label="path of the centre of mass")
    axes.plot(*way[-1], "o", color=style.ACCENT, ms=4, zorder=4)
    axes.plot([], [], color=style.INK, lw=1.0, label=f"outline of the {'soil that slid' if maps.moving else 'deposit'}")
    axes.plot([], [], color=style.INK, lw=1.0, ls="--", label="outline at the start")
    low, high = origin + grid.low, origin + grid.low + size
    shown = origin + [ground.low[:2], ground.high[:2]]  # the outermost cells of the grid reach beyond it
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel=f"east [{of_places[1]}]   {maps.reference()[:60]}".rstrip(), ylabel=f"north [{of_places[1]}]", aspect="equal")
    ticks_of(axes, min(wide, tall * size[0] / size[1]), min(tall, wide * size[1] / size[0]), of_places[0])
    axes.ticklabel_format(useOffset=False, style="plain")
    if of_places[0] != 1:
        style.number_places(axes.xaxis), style.number_places(axes.yaxis)
    axes.tick_params(axis="y", labelrotation=90)
    bar = round_length(0.25 * size[0] * factor) / factor
    inch = size[0] / min(wide, tall * size[0] / size[1])  # [m]
    soil = near(maps.covered[-1] | maps.covered[0], int(np.ceil(0.2 * inch / grid.spacing)))
    corner = np.array(corner_of_arrow(soil, grid.spacing, low, shown, inch))
    at = place_of_scale(soil, grid.spacing, low, shown, bar, inch, tuple(corner))

    def taken(place):
        """By the scale, the arrow to the north, and the soil at the start and at the end."""
        scale = ((place > at - 0.3 * inch) & (place < at + [bar + 0.3 * inch, 0.45 * inch])).all(axis=1)
        arrow = (np.where(corner, shown[1] - place, place - shown[0]) < ARROW * inch).all(axis=1)
        column, row = np.clip(((place - low) / grid.spacing).astype(int), 0, np.array(grid.shape) - 1).T
        return scale | arrow | soil[column, row]

    if len(places := places_of_labels(lines, *shown, taken, 0.4 * inch)):
        axes.clabel(lines, fontsize=6, fmt=lambda level: f"{round(factor * level, 6):g}", colors=style.INK, manual=[tuple(place) for place in places])
    axes.plot([at[0], at[0] + bar], [at[1]] * 2, color=style.INK, lw=3, solid_capstyle="butt", zorder=5)
    axes.annotate(f"{factor * bar:g} {unit}", (at[0] + bar / 2, at[1]), (0, 4), textcoords="offset points", ha="center", fontsize=8, zorder=5,
                  bbox={"fc": "white", "ec": "none", "alpha": 0.7, "pad": 1})
    head, foot = (offset_copy(axes.transData, figure, -14 if corner[0] else 14, (0 if corner[1] else 57) + down, units="points") for down in (-20, -46))
    tip = shown[corner, [0, 1]]
    axes.annotate("N", tip, tip, xycoords=foot, textcoords=head, ha="center", fontsize=10, zorder=5,
                  arrowprops={"arrowstyle": "<-", "color": style.INK, "lw": 1.4})
    # in the middle of the figure, which is wider than some maps
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 0), bbox_transform=figure.transFigure, ncols=3, fontsize=8).set_in_layout(False)
    figure.supxlabel(" ", fontsize=12)  # keeps the room
    style.headline(figure, maps.headline(), maps.results.title)
    return style.save(figure, path)


def line_along(maps):
    """Places [n, 2] along the way of the slide, half a cell apart, and their distances [m]."""
    way = maps.way
    distance = np.arange(0, way.length, maps.ground.cell)
    place = way.at(distance)
    low = maps.ground.low[:2]
    inside = ((place >= low) & (place <= low + np.array(maps.ground.shape) * maps.ground.cell)).all(axis=1)
    there, = between(maps.ground.inside[..., None], [(place[:, k] - low[k]) / maps.ground.cell for k in (0, 1)])
    inside &= there > 0.5
    return place[inside], distance[inside] - distance[inside][0]


def around_motion(lines, least):
    """The part of a section, as a slice, in which some of the surfaces differ from the first by more than `least` [m], with AROUND of its length on both
    sides; all of it where none does."""
    moved = np.flatnonzero(np.abs(np.array(lines[1:]) - lines[0]).max(axis=0) > least)
    if not len(moved):
        return slice(None)
    beside = int(np.ceil(AROUND * (moved[-1] - moved[0])))
    return slice(max(0, moved[0] - beside), moved[-1] + beside + 1)


def with_ends(mask):
    """Places of a line that are in the mask or next to it, where the surface of soil comes down to the ground."""
    wider = np.pad(mask, 1)
    return wider[:-2] | wider[1:-1] | wider[2:]


def draw_section(maps, path):
    """Section along the path of the slide: ground before, bottom of the mesh, and the surface at several times."""
    place, distance = line_along(maps)
    index = [(place[:, k] - maps.ground.low[k]) / maps.ground.cell for k in (0, 1)]
    chosen = np.unique(np.round(np.linspace(0, len(maps.times) - 1, STATES)).astype(int))[1:]
    tops = [maps.before] + [maps.surface(maps.results.snapshots[k]) for k in chosen]
    base, *lines = between(np.stack([maps.ground.base, *tops], axis=-1), index)
    shown = around_motion(lines, MOVED * maps.size)
    base, lines, distance = base[shown], [line[shown] for line in lines], distance[shown] - distance[shown][0]
    height = np.ptp(np.array([base, *lines]))
    figure, axes = plt.subplots(figsize=(8.6, np.clip(7.4 * height / np.ptp(distance), 1.6, 6.0) + 1.9), layout="constrained")
    style.headline(figure, "Section along the path of the slide", maps.results.title)
    axes.fill_between(distance, base, base.min() - 0.05 * height, color="#d9cfbd", lw=0)
    axes.fill_between(distance, base, lines[-1], color="#b8b2a7", lw=0)
    axes.plot(distance, base, color=style.INK, lw=0.9, label="bottom of the mesh")
    axes.plot(distance, lines[0], color=style.INK, lw=1.0, ls="--", label="surface before")
    colours = plt.get_cmap("viridis")(np.linspace(0.75, 0.1, len(chosen)))
    for k, colour, line in zip(chosen, colours, lines[1:]):
        axes.plot(distance, np.where(with_ends(line > base + 1e-3 * maps.size), line, np.nan), color=colour, lw=1.1, label=f"surface at {maps.moment(k)}")
    axes.set(xlabel=of_length("distance along the path of the slide"), ylabel=of_length("elevation"), aspect="equal", xlim=(0, distance[-1]), ylim=(base.min() - 0.05 * height, None))
    axes.ticklabel_format(useOffset=False, style="plain")
    style.places(axes.xaxis), style.places(axes.yaxis)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.01), ncols=3, fontsize=8)
    return style.save(figure, path)
