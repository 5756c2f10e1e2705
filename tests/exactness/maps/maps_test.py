"""Maps of bodies that fly at a known velocity without gravity, so that thickness, outline, speed and arrival time are known.

    maps_test.py TALUS MPIEXEC"""

import contextlib
import io
import os
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock
import xml.dom.minidom

import h5py
import numpy as np
from osgeo import gdal, ogr, osr

TALUS, MPIEXEC = sys.argv[1:3]
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "src/output/plots"))
import talus_deposit
import talus_map_pictures
import talus_maps
import talus_units
from talus_style import plt

gdal.UseExceptions()
ogr.UseExceptions()

# a block of 0.5 m x 0.5 m, 0.6 m deep, in a box of 3 m x 2 m x 0.6 m
FLIGHT = """part,x,y
outline,0,0
outline,3,0
outline,3,2
outline,0,2
interface0,0.5,0.5
interface0,0.5,1
interface0,1,1
interface0,1,0.5
interface1,0.5,0.5
interface1,1,0.5
region_block,0.75,0.75
region_air,2,1.5
region_air,2,0.25
"""
SOIL = """law = "linear_elastic"
density = 2000
young_modulus = "1 MPa"
poisson_ratio = 0.3
"""
BLOCK = f"""gravity = 0
dimension = 3
[mesh]
section = "flight.csv"
size = 0.25
thickness = 0.6
leaving_particles = "remove"
[body.block]
region = "block"
velocity = ["10", "0", "0"]
{SOIL}
[output]
interval = 0.01
[[stage]]
duration = 0.1
"""
# a plane that falls by 0.2 to the east and by 0.1 to the north, whose soil flies up and, more slowly, to the northeast
WEST, SOUTH, SPACING = 600000.0, 200000.0, 5.0
PLANE = f"""gravity = 0
dimension = 3
up = "z"
[mesh]
size = 5
leaving_particles = "remove"
[mesh.terrain]
file = "plane.tif"
slip_surface = "slip.tif"
air = 25
[body.soil]
region = "slide"
velocity = ["4", "2", "16"]
{SOIL}
[output]
interval = 0.25
[[stage]]
duration = 1
"""


def write_terrain(folder):
    east, north = np.meshgrid(np.arange(21) * SPACING, np.arange(15) * SPACING)
    ground = 300 - 0.2 * east - 0.1 * north
    pit = (east >= 15) & (east <= 45) & (north >= 15) & (north <= 45)
    for name, height in (("plane.tif", ground), ("slip.tif", ground - np.where(pit, 10, -1))):
        made = gdal.GetDriverByName("GTiff").Create(str(folder / name), 21, 15, 1, gdal.GDT_Float64)
        made.SetGeoTransform((WEST - SPACING / 2, SPACING, 0, SOUTH + 14.5 * SPACING, 0, -SPACING))
        reference = osr.SpatialReference()
        reference.ImportFromEPSG(2056)
        made.SetSpatialRef(reference)
        made.GetRasterBand(1).WriteArray(height[::-1])
        made.FlushCache()


def talus(*words, ranks=1, status=0):
    """What the program says, standard output and error together."""
    start = [MPIEXEC, "--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", str(ranks)] if ranks > 1 else []
    ended = subprocess.run([*start, TALUS, *map(str, words)], cwd=FOLDER, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                           env={**os.environ, "OMP_NUM_THREADS": "1"})
    assert ended.returncode == status, f"talus {words} ended with {ended.returncode}: {ended.stdout}"
    return ended.stdout


def mapped(results, *options, status=0):
    """What the script of `talus maps` says, without the start of the program and the pictures, which take most of the time."""
    said, ended = io.StringIO(), 0
    words = ["talus_maps.py", str(FOLDER / results), *map(str, options)]
    with (unittest.mock.patch.object(sys, "argv", words), unittest.mock.patch.object(talus_maps, "draw_map"),
          unittest.mock.patch.object(talus_maps, "draw_section"), contextlib.redirect_stdout(said), contextlib.redirect_stderr(said)):
        try:
            talus_maps.main()
        except SystemExit as end:
            ended = end.code
    assert ended == status, f"maps of {results} {options} ended with {ended}: {said.getvalue()}"
    return said.getvalue()


def read(path):
    """Values [to the east, to the north], not a number where there are none; the corner in the southwest and the spacing."""
    file = gdal.Open(str(path))
    band, map_ = file.GetRasterBand(1), file.GetGeoTransform()
    assert band.GetNoDataValue() == -9999
    values = band.ReadAsArray()[::-1].T.astype(float)
    return np.where(values == -9999, np.nan, values), np.array([map_[0], map_[3] + map_[5] * file.RasterYSize]), map_[1]


def feature(results, layer):
    file = ogr.Open(str(FOLDER / results / "maps/deposit.gpkg"))
    one = file.GetLayer(layer).GetNextFeature()
    return one.items(), one.GetGeometryRef().Clone(), file.GetLayer(layer).GetSpatialRef()


def volume_of(results, snapshot=-1):
    snapshots = list(h5py.File(FOLDER / results / "run.h5")["snapshots"].values())
    return snapshots[snapshot]["volume"][...].sum()


class Pictures(unittest.TestCase):
    def test_no_slope_is_burnt_out(self):
        """Slopes of 45 degrees to all sides, the steepest to the lamp in the northwest: all have relief, and none is white or black."""
        east, north = np.meshgrid(np.linspace(-1, 1, 41), np.linspace(-1, 1, 41), indexing="ij")
        for to_east, to_north in ((1, 0), (0, 1), (-1, 0), (0, -1), (-0.7, 0.7), (0.7, -0.7)):
            light = talus_map_pictures.shade(-(to_east * east + to_north * north) + 0.05 * np.sin(8 * east + 5 * north), 0.05)
            self.assertGreater(np.ptp(light), 0.01)
            self.assertGreaterEqual(light.min(), 0.45)
            self.assertLessEqual(light.max(), 0.95)

    def test_a_section_shows_what_moved(self):
        before = np.zeros(1000)
        after = before + np.where(np.abs(np.arange(1000) - 500) <= 100, 2.0, 0.1)
        shown = talus_map_pictures.around_motion([before, before, after], 0.5)
        self.assertEqual((shown.start, shown.stop), (370, 631))
        self.assertEqual(talus_map_pictures.around_motion([before, before], 0.5), slice(None))


class Grids(unittest.TestCase):
    """A box of cubes, 1 m x 0.5 m, 0.3 m high, from (0.33, 0.21) on: thickness and volume are exact to round-off."""

    def setUp(self):
        corner = np.stack(np.meshgrid(np.arange(10), np.arange(5), np.arange(3), indexing="ij"), axis=-1).reshape(-1, 3) * 0.1
        self.place, self.size = corner + [0.33, 0.21, 0] + np.full(3, 0.05), np.full(len(corner), 0.1)

    def test_thickness_of_a_box_of_cubes(self):
        for spacing in (0.25, 0.07):  # wider and narrower than a particle
            grid = talus_deposit.Grid(np.zeros(3), np.array([2.0, 1.0, 1.0]), spacing)
            self.assertAlmostEqual(grid.centres()[0][0], 0, delta=1e-12)  # as those of a terrain file
            thickness, = grid.spread(self.place, self.size, [self.size**3]) / spacing**2
            share = [np.clip(np.minimum(at + spacing / 2, high) - np.maximum(at - spacing / 2, low), 0, None) / spacing
                     for at, low, high in zip(grid.centres(), (0.33, 0.21), (1.33, 0.71))]
            np.testing.assert_allclose(thickness, 0.3 * np.outer(*share), atol=1e-12)

    def test_nothing_is_lost_at_the_edge(self):
        grid = talus_deposit.Grid(np.zeros(3), np.ones(3), 0.25)  # ends within the box
        volume, = grid.spread(self.place, self.size, [self.size**3])
        self.assertAlmostEqual(volume.sum(), 0.15, delta=1e-12)


    def test_thickness_evens_out_within_the_soil(self):
        grid = talus_deposit.Grid(np.zeros(3), np.array([20.0, 20.0, 1.0]), 1.0)
        east, north = np.meshgrid(*grid.centres(), indexing="ij")
        point = np.where((east == 10) & (north == 10), 4.0, 0.0)
        even = grid.evened_out(point, point >= 0, 6.0)
        self.assertAlmostEqual(even.sum(), 4, delta=1e-12)
        for place in (east, north):
            self.assertAlmostEqual((even * (place - 10) ** 2).sum() / 4, 6, delta=0.02)  # the variance of a hat function of half-width 6
        soil = np.hypot(east - 9, north - 11) < 6
        np.testing.assert_array_equal(grid.evened_out(np.where(soil, 2.0, 0.1), soil, 6.0), np.where(soil, 2.0, 0.1))
        rough = np.where(soil, 2 + np.sin(7 * east + 3 * north), 0.1)
        even = grid.evened_out(rough, soil, 6.0)
        np.testing.assert_array_equal(even[~soil], 0.1)
        self.assertAlmostEqual(even.sum(), rough.sum(), delta=1e-12)
        self.assertLess(np.abs(even[soil] - 2).max(), 0.3)
        nothing = np.zeros(grid.shape)
        np.testing.assert_array_equal(grid.evened_out(nothing, nothing > 0, 6.0), nothing)

    def test_cells_hold_whole_cells_of_the_terrain(self):
        for spacing in (2.5, 5.0, 10.0, 15.0):
            grid = talus_deposit.Grid(np.zeros(3), np.array([100.0, 70.0, 1.0]), spacing, 5.0)
            np.testing.assert_allclose(grid.low, -2.5)
            self.assertEqual(grid.shape, tuple(int(np.ceil(one / spacing)) for one in (105, 75)))


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        (FOLDER / "flight.csv").write_text(FLIGHT)
        (FOLDER / "block.toml").write_text(BLOCK)
        (FOLDER / "plane.toml").write_text(PLANE)
        write_terrain(FOLDER)
        for ranks in (1, 2):
            for name in ("block", "plane"):
                talus("run", f"{name}.toml", "-o", f"{name}{ranks}", "--no-pictures", ranks=ranks)
        (FOLDER / "plane.tif").unlink()

    def test_block_with_y_up(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                results, cell = f"block{ranks}", 0.25
                said = talus("maps", results, "--spacing", cell, "--limit", 0.2, "--ascii")
                self.assertIn("projection: none, coordinates are local", said)
                thickness, low, spacing = read(FOLDER / results / "maps/thickness.tif")
                self.assertEqual(spacing, cell)
                # east is x and north is -z: the block is at x from 1.5 to 2 m, over all of z from 0 to 0.6 m
                np.testing.assert_allclose(low, [-cell / 2, -0.6 - cell / 2], atol=1e-9)
                self.assertAlmostEqual(thickness.sum() * cell**2, volume_of(results), delta=1e-6 * volume_of(results))
                self.assertAlmostEqual(volume_of(results), 0.5 * 0.5 * 0.6, delta=1e-9)
                self.assertAlmostEqual(thickness.sum(axis=1) @ (low[0] + (np.arange(len(thickness)) + 0.5) * cell) / thickness.sum(), 1.75, delta=0.01)
                # over the depth of the block, 0.6 m, it is 0.5 m thick: particles are as irregular as the tetrahedra they are in
                self.assertAlmostEqual(thickness[7].sum() * cell / 0.6, 0.5, delta=0.03)
                numbers, outline, reference = feature(results, "outline")
                self.assertEqual((reference.GetName(), reference.IsGeographic()), ("Undefined Cartesian SRS", 0))
                with contextlib.closing(sqlite3.connect(FOLDER / results / "maps/deposit.gpkg")) as package:
                    self.assertEqual(package.execute("select distinct srs_id from gpkg_geometry_columns").fetchall(), [(-1,)])
                    self.assertEqual(package.execute("select f_table_name, useAsDefault from layer_styles").fetchall(), [("outline", 1), ("path", 1)])
                style = xml.dom.minidom.parse(str(FOLDER / results / "maps/thickness.qml"))  # by which QGIS opens the grid
                self.assertEqual(float(style.getElementsByTagName("item")[0].getAttribute("value")), 0)
                self.assertEqual({path.stem for path in (FOLDER / results / "maps").glob("*.qml")}, {"thickness", "largest_thickness", "largest_speed", "arrival_time", "change"})
                west, east, south, north = outline.GetEnvelope()
                np.testing.assert_allclose([west, east, south, north], [1.5, 2, -0.6, 0], atol=cell)
                self.assertAlmostEqual(numbers["area_m2"], outline.GetArea(), delta=1e-9)
                speed, _, _ = read(FOLDER / results / "maps/largest_speed.tif")
                np.testing.assert_allclose(speed[np.isfinite(speed)], 10, atol=1e-3)
                # the front is at x = 1 + 10 t: it crosses half of the cell from 1.625 to 1.875 m at 0.075 s
                arrival, _, _ = read(FOLDER / results / "maps/arrival_time.tif")
                self.assertAlmostEqual(arrival[3, 1], 0, delta=1e-9)
                self.assertAlmostEqual(arrival[7, 1], 0.075, delta=0.016)
                self.assertTrue(np.isnan(arrival[11]).all())
                numbers, path, _ = feature(results, "path")
                self.assertAlmostEqual(numbers["length_m"], 1.0, delta=1e-3)
                np.testing.assert_allclose(path.GetPoint(0), [0.75, -0.3, 0.75], atol=0.02)
                np.testing.assert_allclose(path.GetPoint(path.GetPointCount() - 1), [1.75, -0.3, 0.75], atol=0.02)
                ascii_grid, ascii_low, _ = read(FOLDER / results / "maps/thickness.asc")
                np.testing.assert_allclose(ascii_grid, thickness, rtol=1e-6)
                np.testing.assert_allclose(ascii_low, low, atol=1e-9)
                numbers, _, _ = feature(results, "outline")
                inside = np.where(thickness >= 0.2, thickness, 0)
                self.assertAlmostEqual(numbers["volume_in_outline_m3"], inside.sum() * cell**2, delta=1e-6)
                self.assertAlmostEqual(numbers["mean_thickness_m"], numbers["volume_in_outline_m3"] / numbers["area_m2"], delta=1e-9)
                self.assertAlmostEqual(numbers["largest_thickness_m"], thickness.max(), delta=1e-6)
                self.assertAlmostEqual(numbers["least_thickness_m"], 0.2, delta=1e-12)
                self.assertAlmostEqual(numbers["time_s"], 0.1, delta=1e-12)
                # it flies on at 10 m/s: this is no deposit
                self.assertEqual(numbers["still_moving"], 1)
                self.assertAlmostEqual(numbers["speed_m_s"], 10, delta=1e-3)
                self.assertIn("soil at 0.100 s, 100 % of it still moving, at up to 10 m/s", said)
                self.assertIn("100 % of what slid is faster than 0.1 m/s", said)
                # from the crown, at the upper face of the block at the start, to the middle of the furthest cell
                self.assertTrue(0.5 < numbers["travel_distance_m"] < np.hypot(1.5, 0.6) + cell)
                self.assertTrue(0.7 < numbers["run_out_from_toe_m"] < 1 + cell)  # the block flew by 1 m, nearly in this direction
                self.assertTrue(0.3 < numbers["fall_height_m"] < 0.5)  # particles lie inside of the block, 0.5 m high
                angle = np.degrees(np.arctan(numbers["fall_height_m"] / numbers["travel_distance_m"]))
                self.assertAlmostEqual(numbers["angle_of_reach_deg"], angle, delta=1e-9)
                change, _, _ = read(FOLDER / results / "maps/change.tif")
                self.assertLess(change[3, 1], -0.4)
                self.assertAlmostEqual(change.sum(), 0, delta=1e-5)

    def test_plane_with_z_up(self):
        for ranks in (1, 2):
            with self.subTest(ranks=ranks):
                results = f"plane{ranks}"
                talus("maps", results)
                thickness, low, spacing = read(FOLDER / results / "maps/thickness.tif")
                # the cells are those of the terrain file, which need not be there any more
                self.assertEqual((spacing, thickness.shape), (SPACING, (21, 15)))
                np.testing.assert_array_equal(low, [WEST - SPACING / 2, SOUTH - SPACING / 2])
                volume = volume_of(results)
                self.assertAlmostEqual(thickness.sum() * SPACING**2, volume, delta=1e-6 * volume)
                reference = osr.SpatialReference()
                reference.ImportFromEPSG(2056)
                for of in (gdal.Open(str(FOLDER / results / "maps/thickness.tif")).GetSpatialRef(), feature(results, "outline")[2]):
                    self.assertTrue(of.IsSame(reference))
                # the body, about 10 m thick below a square around (30, 30), has moved by (4, 2) after 1 s
                self.assertAlmostEqual(thickness[7, 6], 10, delta=1.5)
                _, path, _ = feature(results, "path")
                np.testing.assert_allclose(np.subtract(path.GetPoint(path.GetPointCount() - 1), path.GetPoint(0)), [4, 2, 16], rtol=0.01)
                np.testing.assert_allclose(path.GetPoint(0)[:2], [WEST + 30, SOUTH + 30], atol=2)
                # north is up: grid and outline are where the particles are
                centre = [thickness.sum(axis=1 - k) @ (low[k] + (np.arange(thickness.shape[k]) + 0.5) * SPACING) / thickness.sum() for k in (0, 1)]
                np.testing.assert_allclose(centre, path.GetPoint(path.GetPointCount() - 1)[:2], atol=0.5)
                _, outline, _ = feature(results, "outline")
                np.testing.assert_allclose(outline.Centroid().GetPoint()[:2], centre, atol=2)
                speed, _, _ = read(FOLDER / results / "maps/largest_speed.tif")
                np.testing.assert_allclose(np.nanmedian(speed), np.sqrt(276), rtol=0.01)

    def test_outline_has_holes(self):
        grid = talus_deposit.Grid(np.zeros(3), np.array([6.0, 6.0, 1.0]), 1.0)
        axes = types.SimpleNamespace(origin=np.array([WEST, SOUTH, 0.0]), projection="")
        maps = types.SimpleNamespace(grid=grid, axes=axes, results=types.SimpleNamespace(title=""))
        mask = np.zeros(grid.shape, bool)
        mask[1:6, 1:5] = True
        mask[2, 3] = mask[4, 2] = False
        outline = talus_maps.Maps.polygons(maps, mask)
        self.assertEqual(outline.GetGeometryCount(), 1)
        self.assertEqual(outline.GetGeometryRef(0).GetGeometryCount(), 3)  # the outer ring and two holes
        self.assertAlmostEqual(outline.GetArea(), 18, delta=1e-9)
        np.testing.assert_allclose(outline.GetEnvelope(), [WEST + 0.5, WEST + 5.5, SOUTH + 0.5, SOUTH + 4.5])
        hole = outline.GetGeometryRef(0).GetGeometryRef(1).GetEnvelope()
        self.assertIn(tuple(np.round(hole, 6)), [(WEST + 1.5, WEST + 2.5, SOUTH + 2.5, SOUTH + 3.5), (WEST + 3.5, WEST + 4.5, SOUTH + 1.5, SOUTH + 2.5)])

    def test_map_shows_contours_outline_and_path(self):
        maps = talus_maps.Maps(talus_maps.checked(FOLDER / "plane1"))
        with unittest.mock.patch.object(talus_map_pictures.style, "save", side_effect=lambda figure, path: figure):
            axes = talus_map_pictures.draw_map(maps, "map.png").axes[0]
        self.assertEqual(axes.get_xlabel(), "east [m]   CH1903+ / LV95")
        lines = {line.get_label(): line.get_xydata() for line in axes.lines}
        np.testing.assert_allclose(lines["path of the centre of mass"], maps.path[:, :2] + [WEST, SOUTH])
        contours = [path.vertices for collection in axes.collections for path in collection.get_paths() if len(path.vertices) > 3]
        self.assertGreater(len(contours), 4)
        # the ground falls by 0.2 to the east and 0.1 to the north: far from the pit a contour runs along (1, -2)
        for contour in contours:
            away = contour[(contour[:, 0] > WEST + 60) & (contour[:, 0] < WEST + 95)]
            if len(away) > 3:
                np.testing.assert_allclose(0.2 * away[:, 0] + 0.1 * away[:, 1], np.mean(0.2 * away[:, 0] + 0.1 * away[:, 1]), atol=0.3)
        drawn = [line.get_xydata() for line in axes.lines if len(line.get_xydata()) > 4]
        for ring in maps.rings(maps.covered[-1]):
            self.assertTrue(any(one.shape == ring.shape and np.allclose(one, ring) for one in drawn))

    def test_only_soil_at_rest_is_a_deposit(self):
        maps = talus_maps.Maps(talus_maps.checked(FOLDER / "block1"))
        with unittest.mock.patch.object(talus_map_pictures.style, "save", side_effect=lambda figure, path: figure):
            said = []
            for maps.moving in (maps.moving, None):
                figure = talus_map_pictures.draw_map(maps, "map.png")
                said.append((figure._suptitle.get_text().strip(), [text.get_text() for text in figure.axes[0].get_legend().get_texts()][1]))
        self.assertEqual(said, [("Soil at 0.100 s, 100 % of it still moving, at up to 10 m/s", "outline of the soil that slid"), ("Deposit at 0.100 s", "outline of the deposit")])

    def test_texts_of_a_map_keep_apart(self):
        for results in ("block1", "plane1"):
            maps = talus_maps.Maps(talus_maps.checked(FOLDER / results))
            for east, north in ((WEST, SOUTH), (2.6e6, 1.2e6)):  # also with many digits
                maps.axes.origin = np.array([east, north, 0.0])
                with unittest.mock.patch.object(talus_map_pictures.style, "save", side_effect=lambda figure, path: figure):
                    figure = talus_map_pictures.draw_map(maps, "map.png")
                figure.canvas.draw()
                axes = figure.axes[0]
                texts = [text for text in (*axes.texts, *axes.get_xticklabels(), *axes.get_yticklabels()) if text.get_text()]
                self.assertTrue({"N"} < {text.get_text() for text in texts})
                boxes = [text.get_window_extent().frozen() for text in texts]
                for k, one in enumerate(boxes):
                    for other, text in zip(boxes[:k], texts):
                        self.assertFalse(one.overlaps(other), f"{results}: {texts[k].get_text()} over {text.get_text()}")

    def test_contours_of_a_map_do_not_follow_round_off_on_level_ground(self):
        maps = talus_maps.Maps(talus_maps.checked(FOLDER / "plane1"))
        east, _ = np.meshgrid(*(np.arange(count) * maps.ground.cell for count in maps.ground.shape), indexing="ij")
        maps.before = 300 + np.maximum(0, east - 60) + 1e-6 * np.random.default_rng(1).standard_normal(east.shape)
        with unittest.mock.patch.object(talus_map_pictures.style, "save", side_effect=lambda figure, path: figure):
            axes = talus_map_pictures.draw_map(maps, "map.png").axes[0]
        contours = np.concatenate([path.vertices for collection in axes.collections for path in collection.get_paths() if len(path.vertices)])
        self.assertGreater(len(contours), 50)
        self.assertGreater(contours[:, 0].min() - WEST, 60)

    def test_a_section_leads_through_crown_and_toe_or_soil_as_far(self):
        maps = talus_maps.Maps(talus_maps.checked(FOLDER / "plane1"))
        first = maps.results.snapshots[0]
        start = maps.axes.level(first.position())[np.isin(first.ids(), maps.sliding, assume_unique=True)]
        as_high = start[start[:, 2] >= maps.crown[2] - maps.size]  # the way leads through that of these places which lies straightest on
        self.assertLess(maps.way.beside(as_high[:, :2])[1].min(), 2 * maps.size)
        place, _ = talus_map_pictures.line_along(maps)
        east, north = np.floor((place - maps.grid.low) / maps.grid.spacing).astype(int).T
        on_soil = place[maps.covered[-1][np.clip(east, 0, 20), np.clip(north, 0, 14)]]
        run_out = np.linalg.norm((maps.toe - maps.crown)[:2])
        self.assertGreater(np.linalg.norm(on_soil - maps.crown[:2], axis=1).max(), 0.95 * run_out - maps.grid.spacing)

    def legend_is_whole(self, maps):
        with unittest.mock.patch.object(talus_map_pictures.style, "save", side_effect=lambda figure, path: figure):
            figure = talus_map_pictures.draw_map(maps, "map.png")
        figure.canvas.draw()
        axes = figure.axes[0]
        box = axes.get_legend().get_window_extent()
        self.assertGreaterEqual(box.x0, 0)
        self.assertLessEqual(box.x1, figure.bbox.x1)
        self.assertGreaterEqual(box.y0, 0)
        self.assertLess(box.y1, axes.xaxis.label.get_window_extent().y0)

    def test_legend_of_a_wide_and_of_a_narrow_map_is_not_cut_off(self):
        self.legend_is_whole(talus_maps.Maps(talus_maps.checked(FOLDER / "block1")))
        maps = talus_maps.Maps(talus_maps.checked(FOLDER / "plane1"))
        self.legend_is_whole(maps)
        cells = 5  # of 15 to the north
        count = int(cells * maps.grid.spacing / maps.ground.cell)
        maps.grid.shape, maps.ground.shape = (cells, 15), (count, maps.ground.shape[1])
        maps.ground.high[0] = maps.ground.low[0] + count * maps.ground.cell
        maps.ground.inside = maps.ground.inside[:count]
        maps.before, maps.thickness, maps.covered = maps.before[:count], maps.thickness[:, :cells], [one[:cells] for one in maps.covered]
        self.legend_is_whole(maps)

    def test_an_outline_that_leaves_out_much_of_the_deposit_is_told(self):
        said = talus("maps", "block1", "--spacing", 0.25, "--limit", 0.5)
        found = re.search(r"the outline holds (\S+) m³ of the deposit of (\S+) m³: the other \S+ % are thinner than the limit of 0.5 m; "
                          r"--limit (\S+) takes in 95 % of it", said)
        inside, whole, limit = map(float, found.groups())
        numbers, _, _ = feature("block1", "outline")
        self.assertAlmostEqual(inside, numbers["volume_in_outline_m3"], delta=1e-5 * inside)
        self.assertAlmostEqual(whole, volume_of("block1"), delta=1e-5 * whole)
        self.assertLess(inside, 0.9 * whole)
        said = mapped("block1", "--spacing", 0.25, "--limit", limit)
        self.assertNotIn("the outline holds", said)
        numbers, _, _ = feature("block1", "outline")
        self.assertGreaterEqual(numbers["volume_in_outline_m3"], 0.95 * whole)

    def test_words_pictures_and_legends_have_the_units_of_the_scene(self):
        def us(_):
            talus_units.use({"output": {"units": "US"}})
        self.addCleanup(talus_units.use, {})
        with unittest.mock.patch.object(talus_maps, "use", us):
            said = mapped("block1")
            self.assertIn("at up to 32.8 ft/s", said)
            self.assertRegex(said, r"least thickness +0\.\d+ ft\n")
            legend = xml.dom.minidom.parse(str(FOLDER / "block1/maps/largest_speed.qml")).getElementsByTagName("item")[-1]
            self.assertAlmostEqual(float(legend.getAttribute("value")), 10, delta=1e-2)  # of the grid, which is in SI
            self.assertEqual(legend.getAttribute("label"), "32.8 ft/s")
            for results, unit in (("block1", "ft"), ("plane1", "m")):  # places of a terrain file are its own
                with unittest.mock.patch.object(talus_map_pictures.style, "save", lambda figure, path: figure):
                    figure = talus_map_pictures.draw_map(talus_maps.Maps(talus_maps.checked(FOLDER / results)), None)
                    self.assertTrue(figure.axes[0].get_xlabel().startswith(f"east [{unit}]"), results)
                    self.assertTrue(figure.axes[1].get_ylabel().endswith("[ft]"))
                    plt.close(figure)

    def test_arrow_and_scale_lie_on_the_ground_where_cells_reach_beyond_it(self):
        maps = talus_maps.Maps(talus_maps.checked(FOLDER / "plane1"), 50.0)
        with unittest.mock.patch.object(talus_map_pictures.style, "save", side_effect=lambda figure, path: figure):
            figure = talus_map_pictures.draw_map(maps, "map.png")
        figure.canvas.draw()
        axes = figure.axes[0]
        low, high = maps.ground.low[:2] + [WEST, SOUTH], maps.ground.high[:2] + [WEST, SOUTH]
        self.assertGreater(axes.get_xlim()[1], high[0] + 10)
        north, = [text for text in axes.texts if text.get_text() == "N"]
        box = north.get_window_extent().transformed(axes.transData.inverted())
        scale, = [line.get_xydata() for line in axes.lines if line.get_linewidth() == 3]
        for place in (box.min, box.max, *scale):
            self.assertTrue((place > low).all() and (place < high).all())

    def test_surfaces_in_a_section_end_on_the_ground(self):
        maps = talus_maps.Maps(talus_maps.checked(FOLDER / "plane1"))
        with unittest.mock.patch.object(talus_map_pictures.style, "save", side_effect=lambda figure, path: figure):
            axes = talus_map_pictures.draw_section(maps, "section.png").axes[0]
        lines = {line.get_label(): line.get_ydata() for line in axes.lines}
        ends = 0
        for name, line in lines.items():
            there = np.isfinite(line)
            last = np.flatnonzero(there[1:-1] & ~(there[:-2] & there[2:])) + 1
            np.testing.assert_allclose(line[last], lines["bottom of the mesh"][last], atol=1e-3 * maps.size, err_msg=name)
            ends += len(last)
        self.assertGreater(ends, 1)

    def test_soil_that_stands_has_not_slid(self):
        velocity = ["--set", 'body.block.velocity=["0.5","0","0"]']  # 0.05 m at the end, a third of the spacing of particles
        talus("run", "block.toml", "-o", "stands", "--no-pictures", *velocity)
        said = mapped("stands", "--spacing", 0.25, status=2)
        self.assertIn("no soil has slid far enough for a map", said)
        self.assertIn("the largest displacement, 50 mm", said)

    def test_particles_that_left_are_said(self):
        (FOLDER / "longer.toml").write_text(BLOCK.replace("duration = 0.1", "duration = 0.23"))
        talus("run", "longer.toml", "-o", "left", "--no-pictures")
        said = mapped("left", "--spacing", 0.25)
        gone = volume_of("left", 0) - volume_of("left")
        self.assertIn(f"with a volume of {gone:.4g} m³ at the start left the mesh", said)
        arrival, _, _ = read(FOLDER / "left/maps/arrival_time.tif")
        self.assertTrue(np.isfinite(arrival[3:12, 1]).all())  # also where soil went that has left

    def test_soil_that_moved_less_than_a_tenth_is_told_and_mapped_on_request(self):
        shutil.copytree(FOLDER / "block1", FOLDER / "torn", dirs_exist_ok=True)
        with h5py.File(sorted((FOLDER / "torn/run").glob("0*.h5"))[-1], "r+") as last:
            moved, volume = last["displacement"][:], last["volume"][:, 0]
            slow = np.arange(len(moved)) % 4 == 0
            moved[~slow] *= 20  # the others move by a twentieth of that
            last["displacement"][...] = moved
        said = mapped("torn", "--spacing", 0.25)
        self.assertIn(f"{volume[slow].sum():.3g} m³ that moved by 1 m are not mapped", said)
        self.assertIn("by more than a tenth of the largest displacement", said)
        self.assertAlmostEqual(read(FOLDER / "torn/maps/thickness.tif")[0].sum() * 0.0625, volume[~slow].sum(), delta=1e-6)
        said = mapped("torn", "--spacing", 0.25, "--moved", 0.9)
        self.assertNotIn("not mapped", said)
        self.assertAlmostEqual(read(FOLDER / "torn/maps/thickness.tif")[0].sum() * 0.0625, volume.sum(), delta=1e-6)
        self.assertIn("is below --moved 50 m", mapped("block1", "--moved", 50, status=2))

    def test_what_cannot_be_mapped_is_refused(self):
        (FOLDER / "empty").mkdir(exist_ok=True)
        self.assertIn("there is no run.h5", talus("maps", "empty", status=2))
        talus("run", "block.toml", "-o", "flat", "--no-pictures", "--set", "dimension=2", "--set", "body.block.velocity=[\"10\",\"0\"]",
              "--set", "mesh.thickness=1", "--set", "output.interval=0.1")
        self.assertIn("is a run in 2D", mapped("flat", status=2))
        self.assertIn("nowhere as thick", mapped("block1", "--limit", 5, status=2))
        self.assertIn("choose a larger spacing", mapped("block1", "--spacing", 1e-5, status=2))
        self.assertIn("single particles show", mapped("block1", "--spacing", 0.06))

    def test_thickness_does_not_depend_on_the_cells(self):
        """The block is 0.5 m thick everywhere. Its particles are as irregular as the tetrahedra they are in: their columns have up to twice that."""
        for spacing in (0.05, 0.1, 0.25):
            mapped("block1", "--spacing", spacing)
            numbers, _, _ = feature("block1", "outline")
            self.assertAlmostEqual(numbers["largest_thickness_m"], 0.5, delta=0.2, msg=f"cells of {spacing} m")

    def test_interrupted_run(self):
        shutil.copytree(FOLDER / "block1", FOLDER / "broken", dirs_exist_ok=True)
        log = FOLDER / "broken/events.jsonl"
        whole = log.read_text()
        log.write_text(whole + '{"kind": "broke_off", "text": "the disk is full"}\n')
        self.assertIn("the run broke off: the disk is full; the maps show it up to 0.1 s", mapped("broken", "--spacing", 0.25))
        log.write_text("".join(line for line in whole.splitlines(keepends=True) if '"end"' not in line))
        said = mapped("broken", "--spacing", 0.25)
        self.assertIn("warning: the run is incomplete: it was killed, or still runs, since run.log has no end; the maps show it up to 0.1 s", said)
        log.write_text(whole)
        self.assertNotIn("incomplete", mapped("broken", "--spacing", 0.25))


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        FOLDER = pathlib.Path(name)
        unittest.main(argv=sys.argv[:1], verbosity=2)
