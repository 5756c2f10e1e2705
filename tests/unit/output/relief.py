"""Pictures of runs in 3D: argument 1 is the folder of the scripts."""

import pathlib
import sys
import tempfile
import types
import unittest
import unittest.mock

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

sys.path.insert(0, sys.argv.pop(1))
import talus_relief as relief  # noqa: E402
import talus_sections  # noqa: E402
from talus_ground import Filling, Ground  # noqa: E402
from talus_report import level_and_upright  # noqa: E402
from talus_sliding import Thickness  # noqa: E402
from talus_colours import Colours  # noqa: E402
from talus_sections import Painter  # noqa: E402
from talus_views import Oblique  # noqa: E402
from talus_tiles import Frame, nearest, tiles  # noqa: E402

SPACING = 0.1
RANDOM = np.random.default_rng(7)
BOTTOM, LOW, HIGH = 0.2, np.zeros(3), np.array([2.0, 1.2, 1.0])  # slope of the mesh's bottom, and the mesh's corners


def turned(points, up):
    """Points with the axes x, y, z turned so that z is the axis `up`."""
    return np.roll(points, up + 1, axis=-1)


def level_of(up):
    return [(up + 1) % 3, (up + 2) % 3]


def mesh(up=2):
    """A box of 2 x 1.2 m and 1 m high whose bottom rises along its first axis, of six tetrahedra for each of its bricks."""
    count = (8, 6, 2)
    grid = np.stack(np.meshgrid(*(np.linspace(0, 1, n + 1) for n in count), indexing="ij"), axis=-1).reshape(-1, 3) * HIGH
    grid[:, 2] = BOTTOM * grid[:, 0] + grid[:, 2] * (1 - BOTTOM * grid[:, 0] / HIGH[2])
    corner = np.arange(len(grid)).reshape([n + 1 for n in count])
    brick = np.stack([corner[i:n0, j:n1, k:n2] for i, n0 in ((0, -1), (1, None)) for j, n1 in ((0, -1), (1, None)) for k, n2 in ((0, -1), (1, None))], axis=-1)
    paths = [(0, 4, 6, 7), (0, 4, 5, 7), (0, 2, 6, 7), (0, 2, 3, 7), (0, 1, 5, 7), (0, 1, 3, 7)]
    return turned(grid, up), np.concatenate([brick.reshape(-1, 8)[:, path] for path in paths])


def layer(low, high, thickness=0.3, up=2):
    """Particles at random between two corners of the level [2], from the bottom of the mesh up to so much above it."""
    count = int(np.prod(np.subtract(high, low)) * thickness / SPACING**3)
    at = RANDOM.random((count, 3)) * [*np.subtract(high, low), thickness] + [*low, 0]
    at[:, 2] += BOTTOM * at[:, 0]
    return turned(at, up)


def lattice(low, high, apart):
    """Particles so far apart, in rows along the axes between two corners."""
    return np.stack(np.meshgrid(*(np.arange(a + apart / 2, b, apart) for a, b in zip(low, high)), indexing="ij"), axis=-1).reshape(-1, 3)


def ground(up=2):
    return Ground(turned(LOW, up), turned(HIGH, up), SPACING, level_of(up), up, mesh(up))


def surface(of, position):
    return of.surface(position, np.full(len(position), SPACING), np.full(len(position), SPACING**3))


def centres(of):
    return np.stack(np.meshgrid(*((np.arange(n) + 0.5) * of.cell for n in of.shape), indexing="ij"), axis=-1)


class Heights(unittest.TestCase):
    def test_the_bottom_is_that_of_the_mesh_up_to_its_edge(self):
        for up in range(3):
            of = ground(up)
            self.assertTrue(of.inside.all())
            self.assertLess(np.abs(of.base - BOTTOM * centres(of)[..., 0]).max(), BOTTOM * of.cell)

    def test_the_surface_is_that_of_the_soil_up_to_its_edge(self):
        of = ground()
        top, soil = surface(of, layer((0, 0), (2, 1.2)))
        self.assertTrue(soil.all())
        self.assertLess(np.abs(top - BOTTOM * centres(of)[..., 0] - 0.3)[2:-2, 2:-2].max(), 0.6 * SPACING)

    def test_the_surface_of_large_particles_beside_small_ones_has_no_pits(self):
        of, small, large = ground(), layer((0, 0), (1, 1.2)), layer((1, 0), (2, 1.2))[::20]  # of 2.7 times the width
        at = np.concatenate([small, large])
        size = np.repeat([SPACING, 20 ** (1 / 3) * SPACING], [len(small), len(large)])
        top, soil = of.surface(at, size, size**3)
        self.assertTrue(soil.all())
        off = top - BOTTOM * centres(of)[..., 0] - 0.3
        self.assertLess(np.abs(off[2:-2, 2:-2]).max(), 2 * SPACING)

    def test_the_surface_has_no_dent_where_particles_are_larger_than_their_widths_tell(self):
        of, apart = ground(), 4 ** (1 / 3) * SPACING  # still below the next step of widths
        at = lattice((0, 0, 0), (2, 1.2, 4 * apart), apart)
        at[:, 2] += BOTTOM * at[:, 0]
        size = np.full(len(at), SPACING)
        off = [of.surface(at, size, share * size**3)[0] - BOTTOM * centres(of)[..., 0] - 4 * apart for share in (4, 1)]
        self.assertLess(np.abs(off[0][2:-2, 2:-2]).max(), 1.5 * SPACING)
        self.assertLess(off[1][2:-2, 2:-2].max(), -1.5 * SPACING)  # as if it were loose

    def test_bodies_apart_have_a_gap_between_them(self):
        of = ground()
        _, soil = surface(of, np.concatenate([layer((0, 0), (0.8, 1.2)), layer((1.3, 0), (2, 1.2))]))
        x = centres(of)[..., 0]
        self.assertTrue(soil[(x < 0.7) | (x > 1.4)].all())
        self.assertFalse(soil[(x > 0.95) & (x < 1.15)].any())

    def test_a_particle_that_flies_is_no_pillar(self):
        of, at = ground(), np.concatenate([layer((0, 0), (1, 1.2)), [[1.6, 0.6, 0.9]]])
        top, soil = surface(of, at)
        self.assertTrue(soil[32, 12])
        self.assertLess(top[32, 12] - BOTTOM * 1.6, 2.5 * SPACING)
        laid = of.below(at, top)
        self.assertLess(laid[-1, 2], top[32, 12])
        self.assertGreater((laid[:-1] == at[:-1]).all(axis=1).mean(), 0.8)

    def test_soil_outside_the_mesh_is_not_shown(self):
        node, cell = mesh()
        kept = cell[node[cell].mean(axis=1)[:, 0] < 1]
        of = Ground(LOW, np.array([2, 1.2, 1]), SPACING, [0, 1], 2, (node, kept))
        self.assertLess(of.high[0], 2.001)
        _, soil = surface(of, layer((0, 0), (2, 1.2)))
        self.assertFalse(soil[centres(of)[..., 0] > 1.05].any())


class Fields(unittest.TestCase):
    def test_a_linear_field_is_found_inside_the_soil_and_nothing_far_away(self):
        at = layer((0, 0), (2, 1.2))
        filling = Filling(at, 3 * at[:, 0] - at[:, 1], SPACING)
        inside = at[(np.abs(at[:, 0] - 1) < 0.8) & (np.abs(at[:, 1] - 0.6) < 0.4)]
        self.assertLess(np.abs(filling.at(inside) - 3 * inside[:, 0] + inside[:, 1]).mean(), SPACING)
        self.assertTrue(np.isnan(Filling(np.concatenate([at, at + [0, 0, 5]]), np.ones(2 * len(at)), SPACING).at(np.array([[1, 0.6, 3.0]]))).all())

    def test_particles_without_a_value_do_not_count(self):
        at = layer((0, 0), (2, 1.2))
        value = np.where(RANDOM.random(len(at)) < 0.3, np.nan, 4.0)
        self.assertTrue(np.allclose(Filling(at, value, SPACING).at(at), 4.0))

    def test_soil_of_which_no_particle_has_a_value_has_none(self):
        """Half of a layer has values, between x = 0.6 and 1.4 m; the rest, out to the edges of the model, is that of a law without the field."""
        of, at = ground(), lattice((0, 0, 0), (2, 1.2, 0.3), SPACING)
        at[:, 2] += BOTTOM * at[:, 0]
        middle = np.abs(at[:, 0] - 1) < 0.4
        value = np.where(middle, 4.0, np.nan)
        filling = Filling(at, value, SPACING)
        self.assertTrue(np.allclose(filling.at(at[np.abs(at[:, 0] - 1) < 0.3]), 4.0))
        self.assertTrue(np.isnan(filling.at(at[np.abs(at[:, 0] - 1) > 0.5])).all())
        self.assertTrue(np.isnan(filling.at(np.array([[0.0, 0.6, 0.3], [2.0, 0, 0.7]]))).all())
        colours = Colours("plastic_strain", [types.SimpleNamespace(scalar=lambda field: (value, ""), stage="slide")])
        self.assertTrue(colours.in_words("grey").endswith(", or without a value"))
        sight = relief.seen_from_above(of, *surface(of, at), relief.Eye.in_front(1, 0, 2), LOW[:2], HIGH[:2], 100)
        sight.light = np.ones_like(sight.light)
        coloured = (np.abs(sight.painted(at, value, colours, SPACING) - relief.SOIL) > 0.02).any(axis=2)
        self.assertTrue(coloured[:, 35:65].all())
        self.assertFalse(coloured[3:-3, 3:25].any() or coloured[3:-3, 75:-3].any())

    def test_thickness_is_the_volume_over_the_area(self):
        at = np.stack(np.meshgrid(*(np.arange(0.5, n) * SPACING for n in (10, 10, 3)), indexing="ij"), axis=-1).reshape(-1, 3)  # 1 x 1 x 0.3 m
        volume = np.full((len(at), 1), SPACING**3)

        def snapshot(moved):
            columns = {"volume": volume, "mass": 2000 * volume}
            return types.SimpleNamespace(ids=lambda: np.arange(len(at)), position=lambda: at, column=lambda name: types.SimpleNamespace(values=columns[name]),
                                         scalar=lambda name: (moved, "m"))
        values, unit = Thickness(snapshot(np.where(at[:, 0] < 0.5, 2.0, 0.01)), 2)(snapshot(None))
        self.assertEqual(unit, "m")
        inner = at[:, 0] < 0.2  # up to the edges
        self.assertLess(np.abs(values[inner] - 0.3).max(), 0.02)
        self.assertEqual(np.abs(values[at[:, 0] >= 0.5]).max(), 0)


class Contours(unittest.TestCase):
    def drawn(self, height):
        """Contours at 0, 10, 20 ... m of heights over a level grid."""
        levels = np.arange(0, 50, 10.0)
        figure, axes = plt.subplots()
        lines = axes.contour(np.ma.filled(relief.without_flats(height, levels, 3), np.nan).T, levels)
        plt.close(figure)
        return {level: sum(map(len, segments)) for level, segments in zip(lines.levels, lines.allsegs)}

    def test_do_not_follow_round_off_on_level_ground(self):
        """A slope comes down to a plain at exactly 10 m, and goes on below it beyond that."""
        x = np.meshgrid(np.arange(120.0), np.arange(40.0), indexing="ij")[0]
        noise = 1e-5 * np.random.default_rng(1).standard_normal(x.shape)
        drawn = self.drawn(np.where(x < 80, np.maximum(10, 45 - x), 10 - 0.4 * np.maximum(0, x - 110)) + noise)
        self.assertEqual(drawn[10], 0)
        self.assertGreater(drawn[20], 30)
        self.assertGreater(self.drawn(45 - x + noise)[10], 0)  # a slope alone has them all

    def test_are_not_drawn_where_the_relief_is_that_of_particles(self):
        of = ground()
        painter = Painter.__new__(Painter)
        painter.ground, painter.spacing = of, SPACING
        for relief_of_soil, count in ((1.5 * SPACING, 0), (8 * SPACING, 1)):
            top = relief_of_soil * np.random.default_rng(1).random(of.shape)
            painter._surface = lambda snapshot: (top, np.ones(of.shape, bool))
            axes = unittest.mock.Mock()
            painter._contours(axes, None)
            self.assertEqual(axes.contour.call_count, count)


class Sections(unittest.TestCase):
    def test_few_large_particles_own_the_pixels_that_are_nearest_to_them(self):
        random = np.random.default_rng(1)
        at, size = 100 * random.random((9, 2)), np.array([10, 20, 5] * 3, np.float32)
        owner, distance = nearest(at, (100, 100), 1.4, size)
        row, column = np.mgrid[:100, :100] + 0.5
        all_of = np.hypot(column[..., None] - at[:, 0], row[..., None] - at[:, 1]) / size
        within = all_of.min(axis=-1) < 1.4
        np.testing.assert_array_equal(owner, np.where(within, all_of.argmin(axis=-1), -1))
        np.testing.assert_allclose(distance[within], all_of.min(axis=-1)[within], atol=1e-5)

    def test_a_section_has_no_holes_and_shows_the_nearest_particles(self):
        at = RANDOM.random((12000, 3)) * [2, 1, 1]
        spacing = (2 / len(at)) ** (1 / 3)
        frame = Frame((0, 0), (2, 1), 300)
        near = np.flatnonzero(np.abs(at[:, 2] - 0.5) < 2.2 * spacing)
        owner = tiles(at[near][:, :2], np.full(len(near), spacing), frame, np.abs(at[near, 2] - 0.5))
        self.assertTrue((owner[10:-10, 10:-10] >= 0).all())
        rows, columns = RANDOM.integers(10, 140, 300), RANDOM.integers(10, 290, 300)
        places = np.column_stack([(columns + 0.5) * frame.pixel, (rows + 0.5) * frame.pixel, np.full(300, 0.5)])
        distance = np.linalg.norm(places[:, None] - at[near][None], axis=2)
        shown = distance[np.arange(300), owner[rows, columns]]
        self.assertLess((shown - distance.min(axis=1)).max(), 1.5 * frame.pixel)


    def test_large_particles_close_larger_gaps(self):
        small, large = (np.stack(np.meshgrid(np.arange(0.5, 10 / width) * width, np.arange(0.5, 10 / width) * width), axis=-1).reshape(-1, 2) for width in (0.2, 1.0))
        at, size = np.concatenate([small, large + [10, 0]]), np.repeat([0.2, 1.0], [len(small), len(large)])
        soil = tiles(at, size, Frame((-2, -2), (22, 12), 240)) >= 0
        self.assertTrue(soil[22:118, 22:218].all())
        self.assertFalse(soil[:, :17].any() or soil[:, 223:].any())
        self.assertLess(abs(soil.sum() - 100 * 200), 0.03 * 100 * 200)


class Sights(unittest.TestCase):
    def sight(self, up=2, at=None, motion=1, cut=None):
        of = ground(up)
        top, soil = surface(of, layer((0, 0), (1, 1.2), up=up) if at is None else at)
        eye = relief.Eye.in_front(motion, of.level[0], up)
        corners = eye.flat(np.array(np.meshgrid(*zip(of.low, of.high))).reshape(3, -1).T)
        low, high = corners.min(axis=0) - 0.1, corners.max(axis=0) + 0.1
        plane = (np.eye(3)[of.level[1]], cut) if cut else None
        return of, eye, (low, high), relief.seen(of, top, soil, eye, low, high, 150, plane)

    def test_a_place_is_where_the_projection_puts_it_whichever_axis_is_up(self):
        for up in range(3):
            for motion in (1, -1):
                of, eye, (low, high), sight = self.sight(up, motion=motion)
                pixel = (high[0] - low[0]) / sight.what.shape[1]
                rows, columns = np.nonzero(sight.what == relief.GROUND)
                flat = eye.flat(sight.place[rows, columns])
                self.assertLess(np.abs(flat[:, 0] - low[0] - (columns + 0.5) * pixel).max(), 1e-6)
                lower = low[1] + (rows + 0.5) * pixel - flat[:, 1]  # a level place is that of the field, half a spacing down
                on_wall, on_level = np.abs(lower) < 1e-6, np.abs(lower - 0.5 * SPACING * np.cos(relief.RAISED)) < 1e-6
                self.assertTrue((on_wall | on_level).all())
                self.assertGreater(on_level.mean(), 0.3)
                self.assertGreater(np.linalg.det([eye.right, eye.top, -np.cross(eye.top, eye.right)]), 0.99)  # not mirrored
                self.assertGreater(motion * eye.right[of.level[0]], 0)  # the slide goes to the right
                self.assertLess(motion * eye.level[of.level[0]], 0)  # and towards the eye

    def test_soil_hides_what_is_behind_it(self):
        of, eye, _, sight = self.sight(at=layer((0.9, 0.5), (1.1, 0.7), 0.6))
        ground_seen = sight.place[sight.what == relief.GROUND]
        behind = np.array([1.0, 0.6, 0]) + 0.35 * eye.level  # on the bottom, hidden by a pillar of 0.6 m
        self.assertGreater(np.linalg.norm((ground_seen - behind)[:, :2], axis=1).min(), 0.05)
        before = np.array([1.0, 0.6, 0]) - 0.35 * eye.level
        self.assertLess(np.linalg.norm((ground_seen - before)[:, :2], axis=1).min(), 0.05)

    def test_of_a_cut_body_the_half_before_the_cut_is_gone_and_its_face_is_seen(self):
        for up in range(3):
            of, eye, _, sight = self.sight(up, cut=0.6, at=layer((0, 0), (2, 1.2), up=up))
            aside = sight.place[sight.what == relief.BODY][:, of.level[1]]
            beyond = (aside - 0.6) * np.sign(eye.level[of.level[1]])
            self.assertGreater(beyond.min(), -1e-9)
            self.assertGreater((np.abs(beyond) < 1e-9).mean(), 0.1)

    def test_a_cut_may_be_oblique(self):
        of = ground()
        at = layer((0, 0), (2, 1.2))
        ahead = np.array([np.cos(0.5), np.sin(0.5), 0])
        normal, eye = np.array([-ahead[1], ahead[0], 0]), relief.Eye.before(ahead, 2)
        place = normal @ [1, 0.6, 0]
        corners = eye.flat(np.array(np.meshgrid(*zip(of.low, of.high))).reshape(3, -1).T)
        sight = relief.seen(of, *surface(of, at), eye, corners.min(axis=0) - 0.1, corners.max(axis=0) + 0.1, 150, (normal, place))
        beyond = (sight.place[sight.what == relief.BODY] @ normal - place) * np.sign(eye.level @ normal)
        self.assertGreater(beyond.min(), -1e-9)
        self.assertGreater((np.abs(beyond) < 1e-9).mean(), 0.1)

    def test_from_above_the_uppermost_soil_is_seen_without_speckles(self):
        of = ground()
        at = layer((0, 0), (2, 1.2), 0.6)
        value = np.where(at[:, 2] - BOTTOM * at[:, 0] > 0.3, 1.0, 0.0)
        top, soil = surface(of, at)
        sight = relief.seen_from_above(of, top, soil, relief.Eye.in_front(1, 0, 2), LOW[:2], HIGH[:2], 100)
        self.assertTrue((sight.what == relief.BODY).all())
        self.assertGreater(Filling(at, value, SPACING).at(sight.place.reshape(-1, 3)).min(), 0.7)

    def test_no_state_appears_between_two_others(self):
        of = ground()
        at = layer((0, 0), (2, 1.2))
        states = np.where(at[:, 0] < 1, 0.0, 3.0)
        colours = Colours("state", [types.SimpleNamespace(scalar=lambda field: (states, "-"))])
        sight = relief.seen_from_above(of, *surface(of, at), relief.Eye.in_front(1, 0, 2), LOW[:2], HIGH[:2], 100)
        sight.light = np.ones_like(sight.light)
        shown = sight.painted(at, states, colours, SPACING)[:, [10, 90]].reshape(-1, 3)
        whole = sight.painted(at, states, colours, SPACING)
        # a pixel at the border is a mean of the two colours, on the line between them
        a, b = shown[0], shown[1]
        share = ((whole - a) @ (b - a)) / ((b - a) @ (b - a))
        self.assertLess(np.abs(whole - a - share[..., None] * (b - a)).max(), 0.02)


class Numbers(unittest.TestCase):
    def test_a_level_displacement_is_the_length_of_both_level_components(self):
        vectors = np.array([[3.0, 4, -1], [-4.5, 0, 2]])
        self.assertEqual(level_and_upright(vectors, 2), (5, 2))
        self.assertEqual(level_and_upright(vectors[:, [1, 2, 0]], 1), (5, 2))  # up is y
        self.assertEqual(level_and_upright(vectors[:, :2], 1), (4.5, 4))


class Pictures(unittest.TestCase):
    def test_a_run_in_3d_has_four_views_and_a_sheet(self):
        start = layer((0, 0), (1, 1.2))

        class Snapshot:
            stage = "slide"

            def __init__(self, step):
                self.step, self.time, self._way = step, float(step), 0.2 * step * np.array([1, 0, BOTTOM])

            def __contains__(self, name):
                return name == "volume"

            def ids(self):
                return np.arange(len(start))

            def position(self):
                return start + self._way

            def body(self):
                return np.zeros(len(start), int)

            def column(self, name):
                return types.SimpleNamespace(values=np.full((len(start), 1), SPACING**3))

            def scalar(self, field):
                return None if field == "plastic_strain" else (np.full(len(start), np.linalg.norm(self._way)), "m")

        snapshots = [Snapshot(step) for step in range(3)]
        results = types.SimpleNamespace(snapshots=snapshots, up_axis=lambda: 2, mesh=mesh, scene={}, folder=pathlib.Path("nowhere"), bodies=["soil"], escaped=None, history=None, title="slope", when=lambda one: f"t = {one.time} s")
        painter = Painter(results, snapshots, 40)
        self.assertEqual(painter.views[painter.section].name.partition(" ")[0], "section")
        self.assertEqual([view.name.partition(" at y = ")[0] for view in painter.views], ["from above in front", "cut open", "section", "from above"])
        colours = Colours("displacement", snapshots)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "picture.png"
            for draw in (lambda: painter.large("displacement", colours, snapshots, path), lambda: painter.over_time("displacement", colours, snapshots, path),
                         lambda: painter.frame("displacement", colours, snapshots[1], "real time", path)):
                with Image.open(draw()) as picture:
                    seen = np.asarray(picture.convert("RGB"), float)
                    self.assertGreater((np.ptp(seen, axis=2) > 60).mean(), 0.01)  # there is colour in it
        self.assertEqual(painter.views[-1].labels, ["x [m]", "y [m]"])
        self.titles_keep_apart(painter, colours, snapshots)
        results.scene = {"mesh": {"terrain": {}}}  # the north is on top and marked
        painter = Painter(results, snapshots, 40)
        self.assertEqual(painter.views[-1].labels, ["x, east [m]", "y, north [m]"])
        with unittest.mock.patch.object(talus_sections.style, "save", lambda figure, path: figure):
            drawn = painter.large("displacement", colours, snapshots, None)
        (axes, north), = [(axes, text) for axes in drawn.axes for text in axes.texts if text.get_text() == "N"]
        drawn.canvas.draw()
        box = north.get_window_extent().transformed(axes.transData.inverted())
        self.assertTrue((painter.ground.low[:2] < box.min).all() and (box.max < painter.ground.high[:2]).all())  # not on the edge of the ground
        self.assertFalse(any(axes.yaxis_inverted() or axes.xaxis_inverted() for axes in drawn.axes))

    def test_a_section_shows_the_ground_whole(self):
        """A thin slide on a steep slope, downhill and aside: behind its crown the ground is higher than all soil, and its way begins before the ground."""
        node, cell = mesh()
        node = node * [1, 1, 6]
        start = lattice((1.2, 0.1, 0), (1.6, 0.5, 0.06), 0.03)
        start[:, 2] += 6 * BOTTOM * start[:, 0]
        away = [step * np.array([-0.25, 0.15, -0.25 * 6 * BOTTOM]) for step in range(4)]
        snapshots = [types.SimpleNamespace(step=step, time=float(step), position=lambda step=step: start + away[step], ids=lambda: np.arange(len(start)))
                     for step in range(4)]
        for shown in snapshots:
            shown.column = lambda name: types.SimpleNamespace(values=np.full((len(start), 1), 0.03**3))
        with_volume = type("Snapshot", (types.SimpleNamespace,), {"__contains__": lambda self, name: name == "volume"})
        snapshots = [with_volume(**vars(shown)) for shown in snapshots]
        results = types.SimpleNamespace(snapshots=snapshots, up_axis=lambda: 2, mesh=lambda: (node, cell), scene={}, folder=pathlib.Path("nowhere"),
                                        bodies=["soil"], escaped=None)
        painter = Painter(results, snapshots, 40)
        view, (low, high) = painter.views[painter.section], painter.corners[painter.section]
        self.assertEqual(view.name, "section along the slide")
        along, base = painter._line_of_bottom(view)
        there = np.isfinite(base)
        self.assertGreater(np.ptp(along), 1.05 * np.ptp(along[there]))
        self.assertGreater(base[there].max(), painter.ground.high[2])
        self.assertLess(base[there].max(), high[1])
        np.testing.assert_allclose([low[0], high[0]], [along[there][0], along[there][-1]], atol=0.1 * np.ptp(along[there]))
        self.assertLessEqual(low[0], along[there][0])
        self.assertGreaterEqual(high[0], along[there][-1])

    def titles_keep_apart(self, painter, colours, snapshots):
        """What all panels count from is said once, and what differs in titles that do not cover each other; the slip surface has its time in its title."""
        late = "since the end of stage excavation"
        with unittest.mock.patch.object(talus_sections.style, "save", lambda figure, path, **_: figure):
            for since in ({0: "since the start", 1: late, 2: late}, {0: late, 1: late, 2: late}):
                painter.since, painter.as_asked = since, True
                figures = [painter.over_time("displacement", colours, snapshots, None), painter.frame("displacement", colours, snapshots[1], "shortened: 1/20 of real time", None)]
                for figure in figures:
                    figure.draw_without_rendering()
                    titles = [axes.title if axes.title.get_text() else axes._left_title for axes in figure.axes]
                    boxes = [title.get_window_extent() for title in titles if title.get_text()]
                    self.assertFalse(any(one.overlaps(other) for k, one in enumerate(boxes) for other in boxes[:k]))
                    told = [text.get_text() for text in (*titles, *figure.texts) if late in text.get_text()]
                    self.assertEqual(len(told), 1 if figure is figures[1] or len(set(since.values())) == 1 else 2)
            painter.since = {}
            line = np.array([[0.2, 0.1], [0.5, 0.1], [0.8, 0.1]])
            title = painter.picture_of_line(snapshots[1], "displacement", line, "slip surface", None).axes[0].get_title(loc="left")
        for said in ("t = 1.0 s", "line: slip surface", "section at y"):
            self.assertIn(said, title)
        model = types.SimpleNamespace(corners=np.array([[[0, 0, 0.0], [1, 0, 0], [0, 1, 0.02]]]) + painter.low)
        with unittest.mock.patch.object(talus_sections, "read_model", lambda folder: model):
            low, high = painter._box()
        self.assertEqual((low[2], high[2]), (painter.low[2], painter.high[2]))  # without half a particle


if __name__ == "__main__":
    unittest.main()
