#!/usr/bin/python3
"""Collapse of round columns in 3D, a quarter of each between two rollers: runs them, writes axisymmetric.csv, draws axisymmetric.png.

    axisymmetric.py -o DIR        runs what DIR does not hold yet (about ten minutes on one core), then draws
    axisymmetric.py               draws axisymmetric.csv again
"""

import argparse
import csv
import dataclasses
import itertools
import pathlib
import subprocess
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path.insert(0, str(ROOT / "src/output/plots"))

import matplotlib.pyplot as plt  # noqa: E402
import talus_style as style  # noqa: E402
from talus_results import Results  # noqa: E402

RADIUS, GRAVITY, DENSITY = 0.1, 9.81, 1600  # R0 [m], [m/s2], [kg/m3]
MASS = 0.995  # share of the mass behind the front


@dataclasses.dataclass(frozen=True)
class Series:
    cells: int  # over R0
    friction: float = 30  # [deg]
    base: float | None = None  # friction angle [deg]; None: no slip
    peak: float | None = None  # friction angle that softens to `friction` [deg], with dilation that ends; None: constant
    aspects: tuple = (0.8, 2, 4)
    relaxation: int = 400  # transfer.relaxation; 400: the default

    def name(self):
        angle = f"{self.friction}°" if self.peak is None else f"{self.peak} to {self.friction}°"
        relaxed = "" if self.relaxation == 400 else f", relaxation {self.relaxation}"
        return f"{angle}, {'no slip' if self.base is None else f'base {self.base}°'}, R₀/{self.cells}{relaxed}"

    def strength(self):
        """Keys of the soil: dense sand dilates by 8 degrees at its peak, and has lost 63 % of this and of its peak at a plastic strain of 0.2."""
        if self.peak is None:
            return f"friction_angle = {self.friction}"
        return (f"friction_angle = {self.peak}\nresidual_friction_angle = {self.friction}\nresidual_cohesion = 0\n"
                f"dilation_angle = 8\nresidual_dilation_angle = 0\nshape_factor = 5\nreference_size = {RADIUS / 10}")


SERIES = (Series(7), Series(10), Series(14, aspects=(0.8, 2)), Series(7, base=22), Series(10, base=22), Series(10, friction=26),
          Series(10, peak=38, aspects=(0.8,)), Series(10, base=22, peak=38, aspects=(0.8, 2)), Series(7, relaxation=100, aspects=(2,)),
          Series(7, relaxation=1600, aspects=(0.8, 2)), Series(7, friction=38, aspects=(2,)), Series(7, friction=45, aspects=(2,)))

SCENE = """title = "Round column, H0 / R0 = {aspect:g}"
dimension = 3
gravity = {gravity}
[mesh]
file = "column.msh"
leaving_particles = "remove"
[transfer]
relaxation = {relaxation}
[body.sand]
region = "sand"
density = {density}
law = "mohr_coulomb"
young_modulus = "2 MPa"
poisson_ratio = 0.3
cohesion = 0
{strength}
stress = ["{lateral} * ({height} - y)", "{vertical} * ({height} - y)", "{lateral} * ({height} - y)", "0", "0", "0"]
[boundary.base]
{base}
[boundary.side_x]
kind = "roller"
[boundary.side_z]
kind = "roller"
[[stage]]
name = "collapse"
duration = {duration}
until = "rest"
rest_speed = 0.005
"""


def run_out(aspect):
    """(R - R0) / R0 by Lube et al. (2004)."""
    aspect = np.asarray(aspect, float)
    return np.where(aspect < 1.7, 1.24 * aspect, 1.6 * np.sqrt(aspect))


def mesh(path, aspect, cells):
    """Rings of a quarter of a disc, in layers, each block of six tetrahedra: all of it up to 1.5 R0, where the column stands, and
    beyond it a layer in which the front runs out."""
    h = RADIUS / cells
    rings = int(np.ceil(cells * (1.6 + 1.3 * float(run_out(aspect)))))
    top, low = int(np.ceil(aspect * cells)) + 2, int(np.ceil(cells * (0.4 + 0.3 * aspect))) + 2
    inner = int(1.5 * cells)
    height = lambda i, j: top if max(i, j) < inner else low  # layers of the block (i, j)

    u = np.arange(rings + 1)
    i, j = np.meshgrid(u, u, indexing="ij")
    norm = np.hypot(i, j)
    scale = h * np.divide(np.maximum(i, j), norm, out=np.ones_like(norm), where=norm > 0)
    x, z = scale * i, scale * j
    number, nodes = {}, []

    def node(a, b, k):
        if (a, b, k) not in number:
            number[a, b, k] = len(nodes) + 1
            nodes.append((x[a, b], aspect * RADIUS * k / round(aspect * cells), z[a, b]))
        return number[a, b, k]

    ways = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    cells_of, faces = {"sand": [], "air": []}, {"base": [], "side_x": [], "side_z": []}
    for a in range(rings):
        for b in range(rings):
            for k in range(height(a, b)):
                region = "sand" if max(a, b) < cells and k < round(aspect * cells) else "air"
                for way in ways:
                    at, corners = [a, b, k], [node(a, b, k)]
                    places = [tuple(at)]
                    for axis in way:
                        at[axis] += 1
                        places.append(tuple(at))
                        corners.append(node(*at))
                    cells_of[region].append(corners)
                    for group, axis in (("side_x", 0), ("side_z", 1), ("base", 2)):
                        side = [c for c, place in zip(corners, places) if place[axis] == 0]
                        if len(side) == 3:
                            faces[group].append(side)
    names = {"base": (2, 1), "side_x": (2, 2), "side_z": (2, 3), "sand": (3, 4), "air": (3, 5)}
    with open(path, "w") as file:
        file.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n%d\n" % len(names))
        file.writelines(f'{dimension} {tag} "{name}"\n' for name, (dimension, tag) in names.items())
        file.write(f"$EndPhysicalNames\n$Nodes\n{len(nodes)}\n")
        file.writelines(f"{n} {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}\n" for n, p in enumerate(nodes, 1))
        elements = [(2, names[g][1], s) for g in faces for s in faces[g]] + [(4, names[r][1], c) for r in cells_of for c in cells_of[r]]
        file.write(f"$EndNodes\n$Elements\n{len(elements)}\n")
        file.writelines(f"{n} {kind} 2 {tag} {tag} {' '.join(map(str, corners))}\n" for n, (kind, tag, corners) in enumerate(elements, 1))
        file.write("$EndElements\n")


def write_scene(folder, aspect, series):
    folder.mkdir(parents=True, exist_ok=True)
    mesh(folder / "column.msh", aspect, series.cells)
    height = aspect * RADIUS
    (folder / "scene.toml").write_text(SCENE.format(
        aspect=aspect, gravity=GRAVITY, density=DENSITY, strength=series.strength(), height=height, relaxation=series.relaxation,
        base='kind = "fixed"' if series.base is None else f'kind = "friction"\nfriction_angle = {series.base}',
        vertical=-GRAVITY * DENSITY, lateral=-GRAVITY * DENSITY * 0.3 / 0.7, duration=f"{1 + 8 * np.sqrt(height / GRAVITY):.3f}"))


def measure(folder):
    """Front and crest of the deposit over R0, and the same front in three sectors of 30 degrees."""
    results = Results(folder)
    last = results.snapshots[-1]
    position, mass = last.position(), last.column("mass").values[:, 0]
    radius, angle = np.hypot(position[:, 0], position[:, 2]), np.degrees(np.arctan2(position[:, 2], position[:, 0]))

    def front(which, share):
        order = np.argsort(radius[which])
        sums = np.cumsum(mass[which][order])
        return radius[which][order[np.searchsorted(sums, share * sums[-1])]] / RADIUS - 1

    every = np.ones(len(radius), bool)
    sectors = [front((angle >= a) & (angle < a + 30), MASS) for a in (0, 30, 60)]
    return {"runout": front(every, MASS), "runout_99": front(every, 0.99), "runout_999": front(every, 0.999),
            "sector_0": sectors[0], "sector_30": sectors[1], "sector_60": sectors[2],
            "crest": np.max(position[radius < 0.1 * RADIUS, 1]) / RADIUS, "time_s": last.time, "particles": len(radius)}


def run_all(folder, program):
    rows = []
    for series, aspect in ((series, aspect) for series in SERIES for aspect in series.aspects):
        here = folder / "".join(letter for letter in f"a{aspect:g} {series.name()}" if letter.isascii() and letter.isalnum())
        if not (here / "done").exists():
            write_scene(here, aspect, series)
            done = subprocess.run([program, "run", str(here / "scene.toml"), "-o", str(here), "--no-pictures", "--force"], capture_output=True, text=True)
            if done.returncode:
                print(f"a = {aspect:g}, {series.name()}: {done.stderr.strip().splitlines()[-1]}", file=sys.stderr)
                continue
            (here / "done").touch()
        row = {"series": series.name(), "aspect": aspect}
        row |= {name: f"{value:.4g}" if isinstance(value, float) else value for name, value in measure(here).items()}
        rows.append(row)
        print(", ".join(f"{name} {value}" for name, value in row.items()), flush=True)
    with open(HERE / "axisymmetric.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def draw(path):
    """Run-out and crest over the aspect ratio, with the measured laws."""
    with open(HERE / "axisymmetric.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    figure, grid = plt.subplots(1, 2, figsize=(8.6, 3.8))
    a = np.linspace(0.5, 4.5, 200)
    laws = (run_out(a), np.where(a < 0.74, a, 0.88 * a ** (1 / 6)))
    for axes, law, column, label in zip(grid, laws, ("runout", "crest"), ("run-out (R − R₀) / R₀", "height of the crest over R₀")):
        axes.fill_between(a, 0.9 * law, 1.1 * law, color="#e6eef0", lw=0, zorder=0)
        axes.plot(a, law, color=style.SOFT, lw=1.3, ls=(0, (4, 2)), label="Lube et al. (2004), ± 10 %")
        for colour, series in zip(itertools.cycle(style.LINES), SERIES):
            points = np.array([(float(row["aspect"]), float(row[column])) for row in rows if row["series"] == series.name()]).T
            varied = series.relaxation != 400 or series.friction > 30  # the first colours come again
            axes.plot(*points, "s--" if series.peak else "^:" if varied else "o-", color=colour, ms=4.5, lw=1, label=series.name())
        axes.set(xlabel="aspect ratio a = H₀ / R₀", xlim=(0.5, 4.5), ylim=(0, None))
        axes.set_title(label, loc="left")
    grid[1].legend(*grid[0].get_legend_handles_labels(), fontsize=6.5, ncols=2, loc="lower center")
    figure.tight_layout()
    style.save(figure, path)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", metavar="DIR", type=pathlib.Path, help="folder of the runs")
    parser.add_argument("--program", default=str(ROOT / "talus"), help="the talus program")
    given = parser.parse_args()
    if given.output:
        run_all(given.output.resolve(), given.program)
    draw(HERE / "axisymmetric.png")
