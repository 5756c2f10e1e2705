"""Structures in the soil, structure_NAME.csv: their lines in pictures, coloured by utilisation, and what they bear in the report."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap

import talus_style as style
from talus_symbols import WHITE
from talus_units import brief, words

USE = LinearSegmentedColormap.from_list("utilisation", ["#3b6ea5", "#d9a400", "#b3261e"])  # 0, a half, 1
WIDTH = 2.2


def lines_at(results, time):
    """{name: (points [n + 1, 2], utilisation [n])} of the structures that are there at a time [s], in plane strain."""
    found = {}
    for name, table in results.structures().items():
        before = np.flatnonzero(table.time <= time * (1 + 1e-9))
        if not len(before) or ("z_m" in table.columns):
            continue
        row = before[-1]
        if table.time[row] < last_row_before(results, time):  # it was removed since
            continue
        middles = np.column_stack([table["x_m"][row], table["y_m"][row]])
        found[name] = ends_of(middles, table["distance_m"][row]), table["utilisation"][row]
    return found


def last_row_before(results, time):
    history = results.history
    if not history or not len(history.time):
        return -np.inf
    before = history.time[history.time <= time * (1 + 1e-9)]
    return before[-1] * (1 - 1e-9) if len(before) else -np.inf


def ends_of(middles, distance):
    """Ends of elements with these middles at these distances from the head of the line."""
    if len(middles) == 1:
        return np.vstack([middles, middles])
    lengths = [2 * distance[0]]  # of the elements: the first begins at the head
    for k in range(1, len(distance)):
        lengths.append(max(2 * (distance[k] - distance[k - 1]) - lengths[-1], 0))
    lengths = np.array(lengths)
    share = lengths[:-1] / np.maximum(lengths[:-1] + lengths[1:], 1e-300)
    between = middles[:-1] + share[:, None] * (middles[1:] - middles[:-1])
    return np.vstack([2 * middles[0] - between[0], between, 2 * middles[-1] - between[-1]])


def draw(axes, results, time):
    """The structures on a section of the soil."""
    for points, use in lines_at(results, time).values():
        segments = np.stack([points[:-1], points[1:]], axis=1)
        axes.add_collection(LineCollection(segments, colors="white", linewidths=WIDTH + 1.4, zorder=4), autolim=False)
        axes.add_collection(LineCollection(segments, colors=USE(np.clip(use, 0, 1)), linewidths=WIDTH, zorder=5), autolim=False)
        axes.plot(*points[0], marker="s", markersize=4, color=style.INK, zorder=6)


def draw_model(axes, model):
    """The structures as they are drawn in the scene, with their names."""
    texts = []
    for one in model.data.get("structures", []):
        points = np.array(one["points"])
        axes.plot(*points.T, color=style.INK, linewidth=WIDTH, zorder=5)
        axes.plot(*points[0], marker="s", markersize=5, color=style.INK, zorder=6)
        middle = points.mean(axis=0)
        texts.append((axes.text(*middle, one["name"], ha="center", va="bottom", zorder=8, fontsize=9, path_effects=[WHITE]), middle))
    return texts


def rows(results):
    """A table of what each structure bears at the end and at most, the first row the names of its columns; empty without structures."""
    kinds = {name: values.get("kind", "anchor") for name, values in results.scene.get("structure", {}).items()}
    columns = results.history.columns if results.history else {}
    found = []
    for name, kind in kinds.items():
        force = columns.get(f"{name}_axial_force_N")
        if force is None or not len(force):
            continue
        use, slip, slipping = (columns[f"{name}_{what}"] for what in ("utilisation", "bond_slip_m", "slipping"))
        most = int(np.argmax(np.abs(force)))
        unit = "N/m" if kind == "geogrid" else "N"
        found.append([words(name), kind, brief(force[-1], unit), f"{brief(force[most], unit)} ({results.history.stage[most]})", f"{100 * use[-1]:.0f} %",
                      f"{100 * slipping[-1]:.0f} %", brief(slip[-1], "m")])
    return [["structure", "kind", "force at the end", "largest force (stage)", "utilisation", "bond that slips", "largest slip"]] + found if found else []
