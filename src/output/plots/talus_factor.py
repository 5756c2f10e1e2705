"""Pictures of a factor of safety: the mechanism with its slip surface, and displacement against the factor."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patheffects import Normal, Stroke
from matplotlib.tri import Triangulation

import talus_style as style
from talus_results import read_factor
from talus_units import of_length, span

BRIGHT = 0.97  # share of the soil that shears less than the end of the colour scale
ARROWS = 22  # squares over the longer side of the soil, with an arrow each
LONGEST = 1.3  # length of an arrow over the side of its square
MECHANISM_AND_SURFACE = "mechanism and slip surface"  # name of the first picture of a factor in plane strain
TOO_FAR = 0.2  # displacement over the height of the soil, beyond which it has no meaning, as next to a mechanism: the balance of forces alone counts; also in factor_of_safety.cpp
FLOWS = (("own", style.LINES[0], "psi < phi"), ("associated", style.LINES[1], "psi = phi"), ("davis", style.LINES[2], "strength of Davis"), ("undrained", style.LINES[3], "no flow of pore water"))
WATER = {True: "no flow during failure (undrained)", False: "with the pore pressure of the stage held"}
MOVES = 0.1  # of the largest displacement: less has no arrow
WIDTH, BESIDE, AROUND = 9.0, 1.9, 1.5  # of the picture, left and right of the soil, above and below it [inch]


def short(bracket):
    """'1.234'; a bracket that is not decided has no number."""
    return f"{bracket['value']:.3f}" if bracket["decided"] else f"between {bracket['equilibrium']:.3f} and {bracket['mechanism']:.3f}"


def in_words(bracket):
    """'1.234 (equilibrium at 1.231, mechanism at 1.237)', or what lies between the two."""
    if bracket["equilibrium"] == 0 or bracket["mechanism"] == 0:
        return "none, the soil does not " + ("fail" if bracket["mechanism"] == 0 else "stand")
    if not bracket["decided"]:
        return f"between {bracket['equilibrium']:.4g} (equilibrium) and {bracket['mechanism']:.4g} (mechanism)"
    return f"{short(bracket)} (equilibrium at {bracket['equilibrium']:.4g}, mechanism at {bracket['mechanism']:.4g})"


def about_water(factor):
    """What the factor assumes of the pore water where it moves, before the number."""
    return f", {WATER[factor['flow'] == 'undrained']}:" if "undrained" in factor["by_flow"] else ""


def factor_lines(factor):
    """Sentences for the report: the factor, what it assumes, and what was done to the strength."""
    lines = [f"Factor of safety{about_water(factor)} {in_words(factor['factor_of_safety'])}."]
    if "undrained" in factor["by_flow"]:
        undrained = factor["flow"] == "undrained"
        other = "undrained" if not undrained else "own" if "own" in factor["by_flow"] else "associated"
        lines.append(f"Factor of safety, {WATER[not undrained]}: {in_words(factor['by_flow'][other])}.")
    if "own" in factor["by_flow"]:
        of = f" of the factor {WATER[False]}" if "undrained" in factor["by_flow"] else ""
        lines.append("Some soil has psi < phi, whose factor scatters with mesh and initial stress. "
                     f"Upper bound{of}, psi = phi as limit equilibrium assumes: {in_words(factor['by_flow']['associated'])}. "
                     f"Lower estimate, strength of Davis (1968): {in_words(factor['by_flow']['davis'])}.")
    for number, mechanism in enumerate(factor["mechanisms"][1:], 2):
        lines.append(f"Mechanism {number}, from x = {span(mechanism['low_m'][0], mechanism['high_m'][0], 'm')}, which moves "
                     f"{100 * mechanism['share_of_critical_soil']:.0f} % of the soil of mechanism 1 too: "
                     f"{in_words(mechanism['factor_of_safety'])}.")
    if not factor["factor_of_safety"]["decided"]:
        lines.append("Trials between the two ends found neither an equilibrium nor a mechanism, so there is no number.")
    if factor["stages_without_equilibrium"]:
        lines.append(f"{lost_stages(factor).capitalize()}.")
    return lines


def lost_stages(factor):
    """What stages without equilibrium mean, in words."""
    of = f"stage {', '.join(factor['stages_without_equilibrium'])} found no equilibrium"
    if factor["factor_of_safety"]["equilibrium"] < 1:
        return f"{of}: the soil does not stand with its own strength"
    return f"{of} by its load steps, though the soil stands: displacement and stress of that stage are not those of this soil"


def draw_factor(results, folder):
    """factor_mechanism.png (plane strain) and factor_displacement.png. Returns [(what, path)]."""
    factor = read_factor(results)
    if factor is None:
        return []
    headline = f"Factor of safety{about_water(factor)} {in_words(factor['factor_of_safety'])}"
    pictures = [("displacement against factor", draw_displacement(factor, headline, results.title, folder / "factor_displacement.png", height_of(results)))]
    if factor["mechanisms"][0]["slip_surface_m"] and results.snapshots[-1].position().shape[1] == 2:
        pictures.insert(0, (MECHANISM_AND_SURFACE, draw_mechanism(results, factor, headline, folder / "factor_mechanism.png")))
    return pictures


def field_of_cells(results, position, values):
    """The cells of the mesh that have points, as triangles, and at each node the mean of the values in its cells."""
    nodes, cells = results.mesh()
    of = Triangulation(*nodes.T, cells).get_trifinder()(*position.T)
    sums, counts = np.bincount(of[of >= 0], values[of >= 0], len(cells)), np.bincount(of[of >= 0], minlength=len(cells))
    filled = np.flatnonzero(counts)
    corners = cells[filled]
    total, times = np.zeros(len(nodes)), np.zeros(len(nodes))
    for corner in corners.T:
        np.add.at(total, corner, sums[filled] / counts[filled])
        np.add.at(times, corner, 1)
    return Triangulation(*nodes.T, corners), total / np.maximum(times, 1)


def arrows_of(position, displacement):
    """Places and mean displacements [n, 2] in squares of the soil that moves."""
    side = np.ptp(position, axis=0).max() / ARROWS
    _, square = np.unique(np.floor(position / side), axis=0, return_inverse=True)
    square = square.ravel()
    count = np.bincount(square)
    place, way = (np.column_stack([np.bincount(square, column) / count for column in values.T]) for values in (position, displacement))
    size = np.linalg.norm(way, axis=1)
    moves = size > MOVES * size.max()
    return place[moves], way[moves] / max(size.max(), 1e-300) * LONGEST * side


def draw_mechanism(results, factor, headline, path):
    """Shear strain of the mechanism, its motion and the slip surface."""
    last = results.snapshots[-1]
    position = last.position()
    strain = last.scalar("shear_strain")[0]
    extent = np.ptp(position, axis=0)
    height = float(np.clip((WIDTH - BESIDE) * extent[1] / max(extent[0], 1e-300), 1.6, 6.4))
    width = max(min(WIDTH, height * extent[0] / max(extent[1], 1e-300) + BESIDE), 6.0)  # of a high section; the title needs room
    figure, axes = plt.subplots(figsize=(width, height + AROUND), layout="constrained")
    triangles, at_nodes = field_of_cells(results, position, strain / max(np.quantile(strain, BRIGHT), 1e-300))
    field = axes.tripcolor(triangles, at_nodes, shading="gouraud", cmap=style.colours_of("plastic_strain"), vmin=0, vmax=1)
    place, way = arrows_of(position, last.values("displacement"))
    axes.quiver(*place.T, *way.T, angles="xy", scale_units="xy", scale=1, width=0.0018, color=style.SOFT)
    several = len(factor["mechanisms"]) > 1
    for number, mechanism in enumerate(factor["mechanisms"], 1):
        label = f"slip surface {number}: {short(mechanism['factor_of_safety'])}" if several else "slip surface"
        axes.plot(*np.array(mechanism["slip_surface_m"]).T, color=style.INK if number == 1 else style.LINES[(number - 2) % len(style.LINES)],
                  lw=1.2, ls=(0, (4, 2)), label=label, path_effects=[Stroke(linewidth=3, foreground="white", alpha=0.7), Normal()])  # on a dark band
    axes.set_aspect("equal")
    axes.set(xlabel=of_length("x"), ylabel=of_length("y"))
    style.places(axes.xaxis), style.places(axes.yaxis)
    axes.set_title("arrows: the motion of the mechanism, whose size is free", loc="left", fontsize=7.5, color=style.SOFT)
    style.headline(figure, headline, results.title)
    axes.legend(loc="best")
    figure.colorbar(field, ax=axes, label=f"shear strain over its\n{100 * BRIGHT:.0f} % quantile", shrink=0.8, aspect=14)
    return style.save(figure, path)


def height_of(results):
    """Of the soil at the start [m]."""
    return float(np.ptp(results.snapshots[0].position()[:, results.up_axis()]))


def draw_displacement(factor, headline, title, path, height=np.inf):
    """Largest displacement of the trials in equilibrium, and lines at the factors for which it grows without bound."""
    figure, axes = plt.subplots(figsize=(7.6, 4.0), layout="constrained")
    for flow, colour, name in FLOWS:
        trials = [t for t in factor["trials"] if t["flow"] == flow and t["search"] == 1]
        stable = sorted((t["factor"], t["displacement_m"]) for t in trials if t["outcome"] == "equilibrium")
        if stable:
            axes.plot(*np.array(stable).T, "o-", color=colour, ms=4, label=f"equilibrium, {name}")
        for k, failed in enumerate(sorted(t["factor"] for t in trials if t["outcome"] == "mechanism")):
            axes.axvline(failed, color=colour, lw=0.8, ls=":", label=f"mechanism, {name}, the lowest at {failed:.4g}" if k == 0 else None)
        for k, open_one in enumerate(sorted(t["factor"] for t in trials if t["outcome"] == "undecided")):
            axes.axvline(open_one, color=style.ACCENT, ls="--", lw=0.8, label="undecided" if k == 0 else None)
    if any(t["outcome"] == "equilibrium" and t["displacement_m"] > TOO_FAR * height for t in factor["trials"]):
        axes.axhline(TOO_FAR * height, color=style.SOFT, lw=0.8)
        axes.set_title(f"above the line ({100 * TOO_FAR:g} % of the height of the soil) displacement has no meaning: the balance of forces alone counts", loc="left", fontsize=7.5, color=style.SOFT)
    axes.set_xlabel("factor by which strength is divided"), axes.set_ylabel(of_length("largest displacement"))
    style.places(axes.yaxis)
    style.headline(figure, headline, title)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, fontsize="small")  # lines at the factors would run through its words
    return style.save(figure, path)
