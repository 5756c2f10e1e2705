"""Draws DIR/compare.png from the DIR/compare.csv of `talus compare`: error against processor time and against the refined key, and the
values themselves; one line a series."""

import argparse
import csv
import pathlib

from talus_style import FAINT, INK, LINES, np, plt, save


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def draw(rows, reference, path):
    rows = [r for r in rows if not r["failure"]]
    uncertainty = float(reference["uncertainty"])
    figure, (cost, order, values) = plt.subplots(1, 3, figsize=(10.6, 3.4), layout="constrained")
    for k, name in enumerate(dict.fromkeys(r["series"] for r in rows)):
        of = [r for r in rows if r["series"] == name]
        x, y, h, v = (np.array([float(r[c]) for r in of]) for c in ("processor_s", "error", "parameter", "value"))
        colour = LINES[k % len(LINES)]
        seen = y > 0
        cost.plot(x[seen], y[seen], "o-", color=colour, label=name, markersize=4, linewidth=1)
        order.plot(h[seen], y[seen], "o-", color=colour, markersize=4, linewidth=1)
        values.plot(h, v, "o-", color=colour, markersize=4, linewidth=1)
    best = sorted(((float(r["processor_s"]), float(r["error"])) for r in rows if r["pareto"] == "1"))
    best = [(x, y) for x, y in best if y > 0]
    if best:
        cost.step(*zip(*best), where="post", color=INK, linewidth=0.8, linestyle=":", label="Pareto front")
    if np.isfinite(uncertainty) and uncertainty > 0:
        cost.axhspan(cost.get_ylim()[0] if cost.get_ylim()[0] > 0 else uncertainty / 10, uncertainty, color=FAINT, alpha=0.4, label="reference uncertain")
    cost.set(xscale="log", yscale="log", xlabel="processor time [s]", ylabel="error of " + reference["measure"])
    values.axhline(float(reference["value"]), color=INK, linewidth=0.8, linestyle=":")
    order.set(xscale="log", yscale="log", xlabel="refined key")
    values.set(xscale="log", xlabel="refined key", ylabel=reference["measure"])
    around = np.median([float(r["value"]) for r in rows])
    spread = 5 * np.median([abs(float(r["value"]) - around) for r in rows])
    low, high = values.get_ylim()
    if spread > 0:  # a series that misses by far would flatten the others
        values.set_ylim(max(low, around - spread), min(high, around + spread))
    cost.legend()
    save(figure, path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("dir", type=pathlib.Path)
    folder = parser.parse_args().dir
    draw(read(folder / "compare.csv"), read(folder / "reference.csv")[0], folder / "compare.png")
