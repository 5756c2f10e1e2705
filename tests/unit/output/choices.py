"""What the pictures of a run choose to show: argument 1 is the folder of the scripts."""

import functools
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import types
import unittest
import unittest.mock

import matplotlib
import numpy as np

sys.path.insert(0, sys.argv.pop(1))
import talus_factor  # noqa: E402
import talus_lines  # noqa: E402
import talus_map_pictures  # noqa: E402
import talus_outcomes  # noqa: E402
import talus_plot  # noqa: E402
import talus_results  # noqa: E402
import talus_sections  # noqa: E402
import talus_sliding  # noqa: E402
import talus_compare  # noqa: E402
import talus_runs  # noqa: E402
import talus_study  # noqa: E402
import talus_soil  # noqa: E402
from talus_colours import Colours  # noqa: E402
from talus_cores import on_two_cores  # noqa: E402
from talus_histories import base_friction, draw_histories, drawn_energies, potential_that_left  # noqa: E402
from talus_measures import MEASURES, flow  # noqa: E402
from talus_moments import chosen_snapshots, since_reset, telling, with_stress  # noqa: E402
from talus_outcomes import FAILS, STANDS  # noqa: E402
from talus_paths import grouped, label_of, name_envelopes, name_of_mean_stress  # noqa: E402
import talus_style  # noqa: E402
import talus_units  # noqa: E402
from talus_report import bases, key_results, motion_at_end, ways_out  # noqa: E402
from talus_results import MECHANISM, NOT_ENDED, History, Quantity, Results  # noqa: E402
from talus_sliding import still_moving  # noqa: E402
from talus_relief import Eye  # noqa: E402
from talus_sections import Painter  # noqa: E402
from talus_slip import said_of_ends, said_of_line, slip_surface  # noqa: E402
from talus_soils import moved_away, painted, tints  # noqa: E402
from talus_symbols import keep_apart, named_points  # noqa: E402
from talus_tiles import Frame  # noqa: E402
from talus_views import Oblique, View, views_of  # noqa: E402
from talus_way import Way  # noqa: E402


def matplotlib_colour(name):
    return np.array(matplotlib.colors.to_rgb(name))


class Snapshot:
    """Soil that has moved as one; the first particles have left the mesh."""

    def __init__(self, time, way, left=0):
        self.time, self._way, self._left = time, way, left

    def ids(self):
        return np.arange(self._left, 30)

    def position(self):
        return np.full((30 - self._left, 2), self._way)


def chosen(snapshots):
    return [snapshot.time for snapshot in chosen_snapshots(types.SimpleNamespace(snapshots=snapshots))]


class Snapshots(unittest.TestCase):
    def test_a_long_wait_is_one_picture(self):
        times = chosen([Snapshot(n, 5.0 * max(0, n - 80)) for n in range(101)])  # stands for 80 s and slides for 20 s
        self.assertEqual((times[0], times[-1], len(times)), (0, 100, 6))
        self.assertEqual(sum(time <= 80 for time in times), 1)

    def test_particles_that_leave_do_not_hide_the_slide(self):
        times = chosen([Snapshot(n, 5.0 * max(0, n - 80), left=max(0, n - 80)) for n in range(101)])
        self.assertEqual(sum(time <= 80 for time in times), 1)

    def test_soil_that_stays_is_shown_evenly_in_time(self):
        self.assertEqual(chosen([Snapshot(n, 0.0) for n in range(101)]), [0, 20, 40, 60, 80, 100])


class Block(dict):
    """Soil in 3D, without fields, that has moved along y and down; the first particles have left the mesh."""

    def __init__(self, start, left, way):
        self.ids, self.position = lambda: np.arange(left, len(start)), lambda: start[left:] + [0, way, -way]


class Views(unittest.TestCase):
    def test_a_section_lies_along_the_way_though_particles_have_left(self):
        start = np.random.default_rng(1).uniform(0, 10, (40, 3))
        slide = [Block(start, 0, 0), Block(start, 5, 30)]
        _, _, section, above = views_of(types.SimpleNamespace(snapshots=slide, up_axis=lambda: 2, scene={}, folder=pathlib.Path("nowhere")))
        self.assertEqual((section.across, section.up), (1, 2))
        self.assertEqual((above.across, above.up), (0, 1))  # the east to the right

    def test_a_section_follows_an_oblique_slide(self):
        start = np.random.default_rng(1).uniform(0, 10, (400, 3))
        way = [np.array([0.0, 0, 0]), np.array([20.0, 20, -20]), np.array([20.0, 50, -30])]  # to the northeast, then to the north
        slide = [Block(start + by, 0, 0) for by in way]
        _, cut, section, above = views_of(types.SimpleNamespace(snapshots=slide, up_axis=lambda: 2, scene={}, folder=pathlib.Path("nowhere")))
        self.assertEqual((cut.name, section.name), ("cut open along the slide", "section along the slide"))
        middle = np.array([start.mean(axis=0) + by for by in way])
        np.testing.assert_allclose(section.aside(middle), 0, atol=1e-9)
        flat = section.flat(middle)
        np.testing.assert_allclose(np.diff(flat[:, 0]), [20 * np.sqrt(2), 30], rtol=1e-9)
        np.testing.assert_allclose(flat[:, 1], middle[:, 2])
        np.testing.assert_allclose(section.aside(middle[1:2] + [3, -3, 5]), 3 * np.sqrt(2), rtol=1e-6)
        # beyond its corners the way goes on straight
        out = section.plane.corners[0] - section.plane.corners[1]
        first = section.plane.corners[0] + np.sqrt(2) * out / np.linalg.norm(out)
        self.assertAlmostEqual(section.flat(np.array([[*first, 0]]))[0, 0], -np.sqrt(2), places=9)
        normal, place = cut.cut
        self.assertAlmostEqual(normal @ middle[-1], place, places=9)  # through the middle of the deposit
        chord = section.plane.corners[-1] - section.plane.corners[0]
        self.assertAlmostEqual(normal[:2] @ chord, 0, places=9)

    def test_a_way_leads_from_the_crown_to_the_toe_past_the_hook_at_the_end_of_the_path(self):
        """A slide to the west that turns to the south, up the flank and back, and has its front 150 m to the south of its middle."""
        bend = np.array([[400.0, 400], [300, 400], [200, 395], [120, 370], [80, 320], [80, 280], [100, 240], [130, 210], [137, 195], [127, 180]])
        release = np.array([[480.0, 402], [440, 420], [440, 380], [400, 400]])
        north, aside = np.meshgrid(np.arange(30, 330, 5.0), np.arange(-10, 11, 5.0))
        deposit = np.column_stack([120 + aside.ravel() + (north.ravel() - 180) / 10, north.ravel()])
        way = Way.of(bend, release, np.array([1050.0, 1040, 1040, 1020]), deposit, 3.0)
        crown = release[0]
        toe = deposit[np.linalg.norm(deposit - crown, axis=1).argmax()]
        along, off = way.beside(np.array([crown, bend[0], bend[-1], toe]))
        np.testing.assert_allclose(off, [0, 0, 0, 0], atol=3)
        self.assertTrue((np.diff(along) > 0).all())
        self.assertGreater(way.length, along[-1] + 50)
        self.assertGreater(way.beside(bend[-2:-1])[1][0], 5)  # not along the hook
        steps = np.diff(way.corners[-4:], axis=0)
        steps /= np.linalg.norm(steps, axis=1)[:, None]
        self.assertGreater((steps[1:] * steps[:-1]).sum(axis=1).min(), np.cos(np.radians(45)))

    def test_a_way_goes_straight_on_where_soil_is_nearly_as_far_as_the_toe(self):
        east, north = (one.ravel() for one in np.meshgrid(np.arange(-100, 101, 5.0), np.arange(400, 601, 5.0)))
        deposit = np.column_stack([east, north])
        path = np.column_stack([np.zeros(6), np.linspace(0, 500, 6)])
        way = Way.of(path, np.array([[0.0, -50], [30, -20], [-30, -20]]), np.array([50.0, 40, 40]), deposit, 3.0)
        np.testing.assert_allclose(way.corners[:, 0], 0, atol=1e-9)
        self.assertGreater(way.corners[-1][1], 600)

    def test_a_section_that_all_soil_has_left_is_empty(self):
        painter = Painter.__new__(Painter)
        painter.views, painter.spacing, painter._tiles = [View("section", 0, 1, (0, 5.0))], 0.1, {}
        painter._sizes = lambda snapshot: np.full(3, 0.1)
        gone = types.SimpleNamespace(step=1, position=lambda: np.zeros((3, 2)))
        self.assertTrue((painter._tiled(gone, 0, Frame((0, 0), (1, 1), 8)) == -1).all())


class Interrupted(unittest.TestCase):
    """A script that waits for its model, in a pipe that nobody writes into."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        pipe = pathlib.Path(folder.name) / "model.json"
        os.mkfifo(pipe)
        self.command = [sys.executable, "-B", str(pathlib.Path(talus_plot.__file__).with_name("talus_model.py")), str(pipe), f"{folder.name}/model.png"]
        self.pipe = pipe

    def ended(self, command, end):
        """Status and words of a command to which something is done once the script reads."""
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=os.environ | {"TALUS_PROGRAM": "Talus"}) as process:
            with open(self.pipe, "w"):  # waits for the reader; at its end the script has an empty model
                end(process)
                words = process.communicate(timeout=60)[1]
            return process.returncode, words

    def test_scripts_say_one_line(self):
        self.assertEqual(self.ended(self.command, lambda script: script.send_signal(signal.SIGINT)), (130, "talus: interrupted\n"))

    def test_scripts_say_errors_in_one_line(self):
        for damaged, said in (("missing", "no results/history.csv: Is a directory"), ("text", "history.csv is damaged: it is no text"),
                              ("module", "cannot be loaded (No module named 'h5py'); install python3-h5py")):
            folder = self.pipe.parent / damaged
            folder.mkdir()
            (folder / "h5py.py").write_text("raise ModuleNotFoundError(\"No module named 'h5py'\")\n")
            (folder / "history.csv").write_bytes(b"\xff\xfe")
            script = ("import sys, runpy; sys.path.insert(0, sys.argv[1]); import talus_interrupt; sys.excepthook = talus_interrupt.say_error\n"
                      + {"missing": "raise IsADirectoryError(21, 'Is a directory', 'no results/history.csv')",
                         "text": "from talus_results import History; History(sys.argv[2] + '/history.csv')",
                         "module": "sys.path.insert(0, sys.argv[2]); import h5py"}[damaged])
            ended = subprocess.run([sys.executable, "-B", "-c", script, str(pathlib.Path(talus_plot.__file__).parent), str(folder)],
                                   stderr=subprocess.PIPE, text=True)
            self.assertEqual(ended.returncode, 1)
            self.assertIn(said, ended.stderr)
            self.assertRegex(ended.stderr, "^talus: [^\n]*\n$")

    @unittest.skipUnless(sys.platform == "linux", "other systems do not tell a process of its parent's end")
    def test_scripts_end_with_the_program(self):
        program = [sys.executable, "-c", "import subprocess, sys; subprocess.run(sys.argv[1:])", *self.command]
        self.assertEqual(self.ended(program, lambda started: started.kill()), (-signal.SIGKILL, "talus: interrupted\n"))


class Crosses(unittest.TestCase):
    """Of particles that left the mesh."""

    def marked(self, view, time):
        painter = Painter.__new__(Painter)
        painter.results = types.SimpleNamespace(escaped=types.SimpleNamespace(time=np.array([1.0, 2.0, 3.0]), position=np.array([[0.0, 0, 0], [0, 50, 0], [0, -50, 0]])))
        painter.spacing, painter.views, painter.corners = 1.0, [view], [(np.zeros(2), np.full(2, 100.0))]
        painter.marked_escaped, painter.said, painter.since, painter.reset = 83, [], {}, ""  # crosses of an earlier sheet
        painter._title = lambda *_: ["time"]
        painter._panel = lambda axes, snapshot, *_: painter._mark_escaped(axes, view, snapshot.time, 10.0)
        painter._frame_sheet = lambda *_: painter.said.append(painter.marked_escaped)
        figure = painter._sheet("velocity", None, [types.SimpleNamespace(time=time, step=1)], 1, [[0]])
        talus_runs.plt.close(figure)
        self.assertEqual(sum(len(line.get_xdata()) for line in figure.axes[0].lines), painter.said[0])
        return painter.said[0]

    def test_are_those_of_the_time_that_is_shown(self):
        view = View("section", 0, 1)
        self.assertEqual([self.marked(view, time) for time in (0.5, 1.5, 2.5, 9.0)], [0, 1, 2, 3])

    def test_are_not_where_the_body_is_cut_away(self):
        eye = Eye(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
        self.assertEqual(self.marked(Oblique("whole", eye), 9.0), 3)
        self.assertEqual(self.marked(Oblique("cut open", eye, (np.array([0.0, 1.0, 0.0]), 0.0)), 9.0), 2)
        self.assertEqual(self.marked(View("section", 0, 2, (1, 0.0)), 9.0), 1)


class Scales(unittest.TestCase):
    def strain(self, log=False):
        values = types.SimpleNamespace(stage="slide", scalar=lambda field: (np.linspace(0, 1, 1001), "-"))
        return Colours("plastic_strain", [values], log)

    def test_a_twentieth_of_the_largest_strain_is_seen(self):
        self.assertGreater(self.strain().norm(0.05), 0.2)
        self.assertTrue(self.strain().rooted)

    def test_a_logarithmic_scale_has_no_root(self):
        self.assertFalse(self.strain(log=True).rooted)
        self.assertAlmostEqual(float(self.strain(log=True).norm(1e-1)), 2 / 3)

    def of(self, field, values, unit="-", spacing=0.0, stage="slide"):
        snapshots = [types.SimpleNamespace(time=time, stage=stage, scalar=lambda field: (np.asarray(values, float), unit)) for time in (0.0, 2.0)]
        return Colours(field, snapshots, spacing=spacing)

    def test_what_is_next_to_nothing_has_the_colour_of_soil(self):
        for field, ends, unit, said in (("displacement", (0, 1.2e-4), "m", "nothing moved: at most 0.12 mm"), ("displacement_y", (-1.2e-4, 2e-5), "m", "nothing moved: at most 0.12 mm"),
                                        ("velocity", (0, 6e-5), "m/s", "nothing moves: at most 0.06 mm/s"), ("velocity_x", (-6e-5, 0), "m/s", "nothing moves: at most 0.06 mm/s"),
                                        ("plastic_strain", (0, 5e-5), "-", "nothing sheared: at most 5e-05")):
            values = np.linspace(*ends, 1001)
            scale = self.of(field, values, unit, 0.5)  # a thousandth of the spacing is 0.5 mm, and there are 2 s from one picture to the next
            self.assertEqual(scale.nothing, said)
            self.assertTrue(scale.plain(values * scale.factor).all(), field)
            self.assertGreaterEqual(np.ptp(scale.shown) / scale.factor, 2.5e-4 if "velocity" in field else 5e-4)
            larger = self.of(field, 25 * values, unit, 0.5)
            self.assertEqual(larger.nothing, "")
            self.assertFalse(larger.plain(25 * values * larger.factor).all())
            self.assertEqual(self.of(field, values, unit, 0.5, talus_results.MECHANISM).nothing, "")  # its size is free

    def test_mobilised_friction_is_even_and_begins_below_nearly_all_soil(self):
        scale = self.of("mobilised_friction", np.concatenate([np.zeros(500), np.linspace(12, 30, 1001)]), "deg")  # half of it without stress
        self.assertEqual(scale.shown, (10, 30))
        self.assertAlmostEqual(scale.norm(30) - scale.norm(28), 0.1)
        self.assertGreater(np.ptp(scale.map(1.0)[:3]), 0.4)  # no black
        self.assertEqual(list(scale.plain(np.array([0, 12, np.nan]))), [True, False, True])

    def test_a_field_of_both_signs_is_pale_at_nothing(self):
        scale = self.of("displacement_x", np.linspace(-1, 3, 1001), "m")
        self.assertEqual(scale.shown, (-1, 3))
        self.assertAlmostEqual(float(scale.norm(0)), 0.5)
        self.assertAlmostEqual(float(scale.norm(1)) + float(scale.norm(-1)), 1)
        self.assertGreater(min(scale.map(0.5)[:3]), 0.9)
        self.assertGreater(scale.map(1.0)[0], scale.map(1.0)[2])  # red above, blue below
        self.assertGreater(scale.map(0.0)[2], scale.map(0.0)[0])

    def test_soil_has_its_colour_below_the_shares_that_the_guide_states(self):
        for field, values, share in (("displacement", np.linspace(0, 2, 1001), 0.02), ("plastic_strain", np.linspace(0, 2, 1001), 0.0025),
                                     ("displacement_x", np.linspace(-1, 2, 1001), 1e-6), ("stress_xx", np.linspace(-2, 0, 1001), 0.02)):
            scale = self.of(field, values)
            self.assertEqual(list(scale.plain(np.array([0.9, 1.1]) * 2 * share)), [True, False], field)

    def test_say_how_soil_without_a_value_looks(self):
        scale = self.of("displacement", np.linspace(0, 2, 1001), "m")
        self.assertEqual((scale.in_words(), scale.in_words("grey")), ("in the colour of its soil: below 0.04 m", "grey: below 0.04 m"))

    def test_both_signs_are_those_above_two_hundredths_of_the_larger(self):
        ends = [self.of("stress_xx", np.linspace(-100 * low, 100, 10001)).shown for low in (0.018, 0.023)]
        self.assertEqual([low for low, _ in ends], [0, -2.2])  # nearly the least

    def test_a_little_of_the_other_sign_is_beyond_the_end(self):
        scale = self.of("pore_pressure", np.linspace(-0.01, 1, 1001), "-")
        self.assertEqual((scale.shown, scale.above, scale.below), ((0, 1), False, True))


class Labels(unittest.TestCase):
    def test_of_near_lines_are_one(self):
        lines = [("clay", "s = 0 Pa", 10.0, 0.7), ("clay", "s = 500 kPa", 40.0, 0.7), ("clay", "s = 1 MPa", 40.5, 0.7), ("sand", "", 41.0, 0.7)]
        self.assertEqual(grouped(lines, 2.0), [("clay, s = 500 kPa, s = 1 MPa; sand", 3), ("clay, s = 0 Pa", 0)])
        self.assertEqual(len(grouped(lines, 0.1)), 4)
        self.assertEqual(grouped([("", "", 1.0, 0.7)], 2.0), [("strength", 0)])

    def test_of_envelopes_lie_along_them_and_on_no_other(self):
        figure, axes = talus_runs.plt.subplots(figsize=(5, 4))
        axes.set(xlim=(0, 56), ylim=(0, 58))
        lines = [("", "s = 0 Pa", 0.77, 2.0), ("", "s = 200 kPa", 0.78, 18.0), ("", "s = 500 kPa", 0.79, 22.5), ("", "s = 1 MPa", 0.79, 23.2)]
        name_envelopes(axes, lines)
        figure.canvas.draw()
        self.assertEqual([text.get_text() for text in axes.texts], ["s = 500 kPa, s = 1 MPa", "s = 200 kPa", "s = 0 Pa"])
        inside = axes.get_window_extent()
        for text, slope in zip(axes.texts, (0.79, 0.78, 0.77)):
            box = text.get_window_extent()
            self.assertTrue(inside.x0 < box.x0 and box.x1 < inside.x1 + 2 and box.y1 < inside.y1 + 2, (text.get_text(), box, inside))
            (x, y), (ahead, up) = axes.transData.transform([(0, 0), (1, slope)])
            self.assertAlmostEqual(text.get_rotation(), np.degrees(np.arctan2(up - y, ahead - x)), places=3)
        talus_runs.plt.close(figure)

    def with_points(self, places):
        """A section from (0, 0) to (10, 10) with the names of points."""
        painter = Painter.__new__(Painter)
        history = types.SimpleNamespace(points=lambda time: {name: np.array(place) for name, place in places.items()}, way=lambda name: np.array([places[name]] * 3))
        painter.results, painter.low, painter.spacing = types.SimpleNamespace(history=history), np.zeros(2), 0.5
        figure, axes = talus_runs.plt.subplots()
        axes.set(xlim=(0, 10), ylim=(0, 10))
        painter._mark_points(axes, types.SimpleNamespace(aside=lambda place: [0.0], flat=lambda place: place), 0.0, 9.5)
        keep_apart(axes)
        figure.canvas.draw()
        return figure, axes

    def test_of_points_of_a_model_do_not_cover_the_dots_of_others(self):
        figure, axes = talus_runs.plt.subplots()
        axes.set(xlim=(0, 50), ylim=(0, 20))
        name_of_D2 = axes.transData.transform((23.679, 8.944)) + 9 * figure.dpi / 72  # up and to the right of its dot
        points = {"D2": (23.679, 8.944), "S2": axes.transData.inverted().transform(name_of_D2)}
        model = types.SimpleNamespace(data={"lines": [], "points": [{"name": name, "position": place} for name, place in points.items()]})
        named_points(axes, model, np.asarray)
        keep_apart(axes)
        for text in axes.texts:
            for name, place in points.items():
                self.assertFalse(text.get_window_extent().contains(*axes.transData.transform(place)), (text.get_text(), name))
        talus_runs.plt.close(figure)

    def test_of_points_near_the_upper_edge_stand_below_them(self):
        painter = Painter.__new__(Painter)
        figure, axes = self.with_points({"crest": (5.0, 9.9), "toe": (9.0, 2.0)})
        tops = {text.get_text(): text.get_window_extent().y1 for text in axes.texts}
        self.assertLess(tops["crest"], axes.get_window_extent().y1)
        self.assertGreater(tops["toe"], axes.transData.transform((9, 2))[1])
        talus_runs.plt.close(figure)

    def test_of_points_beside_each_other_do_not_cover_each_other_and_one_particle_has_one(self):
        figure, axes = self.with_points({"crest": (5.0, 5.0), "brow": (5.1, 4.9), "shoulder": (5.0, 5.0)})
        self.assertEqual([text.get_text() for text in axes.texts], ["crest, shoulder", "brow"])
        one, other = (text.get_window_extent() for text in axes.texts)
        self.assertFalse(one.overlaps(other))
        talus_runs.plt.close(figure)

    def test_of_lines_have_colours_that_differ(self):
        lines = np.array([matplotlib_colour(line) for line in talus_runs.style.LINES])
        apart = [np.linalg.norm(one - other) for k, one in enumerate(lines) for other in lines[:k]]
        self.assertGreater(min(apart), 0.19)  # it was 0.17 of kinetic and dissipated energy, which looked alike

    def test_and_titles_keep_away_from_the_edge_and_from_the_charts(self):
        for title in ("Slope", "A title of a scene that is so long that it has no room beside the headline of the chart"):
            figure, axes = talus_runs.plt.subplots(figsize=(6, 3), layout="constrained")
            axes.set_title("of the chart", loc="left")
            talus_runs.style.headline(figure, "Factor of safety", title)
            figure.canvas.draw()
            inch, own = figure.dpi, axes.get_tightbbox()
            for box in (text.get_window_extent() for text in (figure._suptitle, *figure.texts) if text.get_text().strip()):
                self.assertGreater(min(box.x0, figure.bbox.x1 - box.x1, figure.bbox.y1 - box.y1), 0.09 * inch, title)
                self.assertGreater(box.y0, own.y1, title)
            talus_runs.plt.close(figure)


class Paths(unittest.TestCase):
    def test_that_end_before_the_run_say_when(self):
        time, known = np.arange(5.0), np.array([1.0, 2, 3, np.nan, np.nan])
        self.assertEqual(label_of("crest", time, known), "crest, no stress after t = 2.00 s")
        self.assertEqual(label_of("left_face", time, np.ones(5)), "left face")

    def test_name_the_mean_stress_that_the_pores_leave(self):
        moist, full = ({name: np.zeros(2) for name in names} for names in (("toe_deviator_Pa", "toe_suction_Pa"), ("toe_deviator_Pa",)))
        for columns, water, net in ((moist, {}, True), (moist, {"stress": "bishop"}, False), (full, {}, False)):
            results = types.SimpleNamespace(history=types.SimpleNamespace(columns=columns), scene={"water": water})
            self.assertEqual("net" in name_of_mean_stress(results), net)


class Energies(unittest.TestCase):
    def test_potential_energy_is_its_change_and_what_stays_is_left_out(self):
        lines = {"kinetic": np.array([0.0, 2.0]), "potential": np.array([6e6, 6e6 - 5]), "escaped_energy": np.zeros(2), "strain": np.full(2, 3.0)}
        drawn = drawn_energies(lines | {"dissipated": np.array([0.0, 1.0])})
        self.assertEqual(list(drawn), ["kinetic", "Δ potential", "dissipated\n(remainder)"])
        self.assertEqual(list(drawn["Δ potential"]), [0, -5])

    def test_potential_energy_counts_particles_that_left(self):
        escaped = types.SimpleNamespace(time=np.array([1.0, 2.0]), position=np.array([[5.0, 100.0], [5.0, 200.0]]),
                                        columns={"mass_kg": np.array([2.0, 1.0]), "water_kg": np.array([0.0, 1.0]), "x_m": np.full(2, 5.0)})
        with unittest.mock.patch("talus_histories.read_model", lambda folder: types.SimpleNamespace(data={"gravity": [0, -10, 0]})):
            left = potential_that_left(types.SimpleNamespace(escaped=escaped, folder=None), np.array([0.0, 1.0, 1.5, 3.0]))
        self.assertEqual(list(left), [0, 2000, 2000, 6000])
        self.assertEqual(list(potential_that_left(types.SimpleNamespace(escaped=None), np.zeros(2))), [0, 0])


    def test_of_a_mechanism_are_not_drawn(self):
        history = History.__new__(History)
        history.time, history.step, history.stage = np.arange(3.0), np.arange(3), ["start", "gravity", "strength reduction"]
        history.columns = {"strain_J": np.array([0.0, 2, 9]), "work_gravity_J": np.array([0.0, 3, 3]), "dissipated_J": np.array([0.0, 1, -6])}
        history.columns |= {"crest_displacement_m": np.array([0.0, 0.07, 0.9])}
        before = history.without(MECHANISM)
        self.assertEqual((list(before.time), list(before.step), before.stage), ([0, 1], [0, 1], ["start", "gravity"]))
        self.assertEqual({name: values[-1] for name, values in before.columns.items()},
                         {"strain_J": 2, "work_gravity_J": 3, "dissipated_J": 1, "crest_displacement_m": 0.07})
        self.assertEqual(history["crest_displacement_m"][-1], 0.9)


class Group(dict):
    """What stands in run.h5 for a snapshot of three particles that have moved by a way."""

    def __init__(self, time, stage, way):
        def field(value, unit):
            return Field(np.asarray(value, float).reshape(3, -1), unit)
        super().__init__(displacement=field([[way, 0]] * 3, "m"), position=field(np.zeros((3, 2)), "m"), volume=field(np.ones(3), "m2"), mass=field(np.ones(3), "kg"),
                         plastic_strain=field(np.zeros(3), "-"), id=field(np.arange(3), "").astype(int))
        self.attrs = {"time": time, "step": int(time), "stage": stage}


class Field:
    def __init__(self, values, unit):
        self._values, self.attrs = values, {"unit": unit}

    def astype(self, kind):
        return Field(self._values.astype(kind), self.attrs["unit"])

    def __getitem__(self, what):
        return self._values[what]


class Reduction(unittest.TestCase):
    """Soil that settles by 0.07 m, whose mechanism moves by 1.3 m."""

    def setUp(self):
        self.results = Results.__new__(Results)
        groups = {"0": Group(0, "", 0), "1": Group(1, "gravity", 0.07), "2": Group(1, MECHANISM, 1.3)}
        self.results._file, self.results.history, self.results.escaped = {"snapshots": groups}, None, None
        self.results.snapshots = [talus_results.Snapshot(group, {}) for group in groups.values()]
        self.results.scene, self.results.bodies, self.results.folder = {}, ["clay"], pathlib.Path("nowhere")
        self.results.mesh = lambda: (np.zeros((0, 2)), np.zeros((0, 3), int))

    def test_leaves_its_mechanism_out_of_the_state_of_the_slope(self):
        self.assertEqual([one.stage for one in self.results.before_reduction().snapshots], ["start", "gravity"])
        self.assertEqual([one.stage for one in self.results.snapshots], ["start", "gravity", MECHANISM])
        self.assertIs(self.results.before_reduction().before_reduction().snapshots[-1].stage, "gravity")
        self.assertEqual([one.stage for one in self.results.of_reduction().snapshots], ["start", MECHANISM])

    def test_is_named_in_the_picture_of_its_strain(self):
        painter = Painter.__new__(Painter)
        painter.results, painter.views, painter.since = self.results, [None], {}
        self.assertEqual([painter._title(one, 0, None)[1] for one in self.results.snapshots], ["start", "gravity", "mechanism, whose size is free"])

    def test_is_what_a_report_begins_with(self):
        bracket = {"decided": False, "equilibrium": 1.083, "mechanism": 1.091}
        came_to = {"state": STANDS, "cell_m": 1.0, "largest_displacement_m": 0.07, "volume_of_slide_m3": None}
        with unittest.mock.patch("talus_report.read_factor", lambda results: {"factor_of_safety": bracket, "by_flow": {}}), unittest.mock.patch("talus_report.outcome", lambda results: came_to):
            found = key_results(self.results.before_reduction())
        self.assertEqual(found[0][:2], ("Factor of safety", "between 1.083 and 1.091"))
        cards = {what: (number, note) for what, number, note in found}
        self.assertEqual(cards["Largest displacement"][0], "70 mm")
        self.assertTrue(cards["Largest displacement"][1].endswith("before the strength is reduced"))
        self.assertEqual(cards["State before the strength is reduced"][0], STANDS)
        self.assertNotIn("State at the end", cards)


class Motion(unittest.TestCase):
    """1000 particles of which the first have slid, and some still do."""

    def moving(self, fast, of=1000):
        speed = np.where(np.arange(1000) < fast, 3.0, 0.05)
        snapshot = Moving(speed)
        return still_moving(snapshot, np.arange(of))

    def test_is_said_from_a_hundredth_of_the_mass_on(self):
        self.assertIsNone(self.moving(10))
        self.assertEqual(self.moving(11), (0.011, 3.0))
        self.assertEqual(self.moving(10, of=100), (0.1, 3.0))  # of what slid
        self.assertIsNone(self.moving(1000, of=0))

    def test_of_a_small_slide_in_a_large_model_is_the_largest(self):
        """A slide of 60 of 100,000 particles on soil that settles; as few as 40 are single particles."""

        def largest(slid, displacement=12.0):
            moved = np.where(np.arange(100_000) < slid, displacement, 0.1)
            columns = {"mass": np.ones((100_000, 1)), "volume": np.full((100_000, 1), 8.0)}
            snapshot = unittest.mock.MagicMock()
            snapshot.scalar, snapshot.position = lambda name: (moved, "m"), lambda: np.zeros((100_000, 3))
            snapshot.column, snapshot.__contains__ = lambda name: unittest.mock.Mock(values=columns[name]), lambda self, name: name in columns
            return talus_sliding.largest_displacement(snapshot)

        self.assertEqual(largest(60), 12.0)
        self.assertEqual(largest(40), 0.1)
        self.assertEqual(largest(60, displacement=1.9), 0.1)  # less than their size
        self.assertEqual(largest(1000), 12.0)

    def test_is_told_from_the_same_limits_by_the_program(self):
        header = (pathlib.Path(talus_plot.__file__).parents[2] / "simulation/still_moving.h").read_text()
        stated = {name: float(number) for name, number in re.findall(r"constexpr double (\w+) = ([\d.]+);", header)}
        self.assertEqual(stated, {"slides_share": talus_sliding.SLIDES, "slides_least": talus_sliding.SMALL, "slow": talus_sliding.SLOW,
                                  "restless": talus_sliding.RESTLESS, "nearly_all": talus_outcomes.SHARE,
                                  "of_moved": talus_sliding.OF_MOVED, "several": talus_sliding.SEVERAL})

    def test_is_told_by_the_report(self):
        last = Moving(np.full(1000, 11.4))
        with unittest.mock.patch("talus_report.sliding", lambda last: np.ones(1000, bool)):
            self.assertEqual(motion_at_end(last), "; still moving: 100 % of what slid is faster than 0.1 m/s, at up to 11.4 m/s")
            self.assertEqual(motion_at_end(Moving(np.full(1000, 0.05))), "")


class Moving(dict):
    def __init__(self, speed):
        super().__init__(velocity=speed)
        self.ids, self.scalar = lambda: np.arange(len(speed)), lambda field: (speed, "m/s")


class Depth(unittest.TestCase):
    """A cube of 10 m whose upper layers, a fifth of it, run out as a sheet half a metre thick, while the rest moves by 3 m."""

    def flow(self):
        start = np.stack(np.meshgrid(*3 * [np.arange(10) + 0.5], indexing="ij"), axis=-1).reshape(-1, 3)
        end = start + [3, 0, 0]
        sheet = start[:, 2] > 8
        x, y = np.meshgrid(np.arange(20, 60, 2) + 0.5, np.arange(10) + 0.5)
        end[sheet] = np.column_stack([x.ravel(), y.ravel(), np.full(200, 0.5)])
        snapshots = []
        for time, place in enumerate((start, end)):
            snapshot = Group(time, "slide", 0)
            snapshot.update(position=Field(place, "m"), displacement=Field(place - start, "m"), volume=Field(np.ones((1000, 1)), "m3"), mass=Field(np.ones((1000, 1)), "kg"),
                            id=Field(np.arange(1000)[:, None], ""))
            snapshots.append(snapshot)
        results = Results.__new__(Results)
        results.scene = {"up": "z"}
        results.snapshots = [talus_results.Snapshot(group, {}) for group in snapshots]
        results._derive(results.snapshots)
        corner = np.stack(np.meshgrid(np.arange(0, 64, 2), np.arange(0, 12, 2), [0], indexing="ij"), axis=-1).reshape(-1, 1, 3)
        node = (corner + 2 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])).reshape(-1, 3).astype(float)
        results.mesh = lambda: (node, np.arange(len(node)).reshape(-1, 4))
        return flow(results)

    def test_of_a_flow_is_that_of_the_soil_that_has_left_its_outline(self):
        depth, _, cell = self.flow()
        self.assertLess(depth, 1)
        self.assertAlmostEqual(cell, (8 * 2**0.5) ** (1 / 3), delta=1e-9)  # regular tetrahedron of the volume of a corner of 2 m


class Resets(unittest.TestCase):
    def results(self, *stages):
        snapshots = [Snapshot(time, 0.1 * time) for time in range(len(stages))]
        for snapshot, stage in zip(snapshots, stages):
            snapshot.stage, snapshot.scalar = stage, lambda _, time=snapshot.time: (np.full(10, 1.0 + time), "m")
        scene = {"stage": [{"name": "gravity", "reset_displacement": True}, {"name": "rain"}]}
        return types.SimpleNamespace(snapshots=snapshots, scene=scene)

    def test_are_what_displacement_is_shown_since(self):
        results = self.results("start", "gravity", "gravity", "gravity", "rain", "rain", "rain")
        shown, stage = since_reset(results, results.snapshots[:5], "displacement")
        self.assertEqual(([one.time for one in shown], stage), ([0, 4, 5, 6], "gravity"))
        for field, other in (("displacement_x", [0, 4, 5, 6]), ("velocity", [0, 1, 2, 3, 4])):
            self.assertEqual([one.time for one in since_reset(results, results.snapshots[:5], field)[0]], other)

    def test_are_followed_by_what_is_not_nothing_again(self):
        results = self.results("start", "gravity", "gravity", *["rain"] * 12)
        for snapshot in results.snapshots:
            snapshot.scalar = lambda _, time=snapshot.time: (np.full(10, max(0.0, time - 3.0)), "m")  # the reset is at 2
        shown, _ = since_reset(results, results.snapshots, "displacement")
        self.assertEqual((len(shown), shown[0].time), (6, 0))
        self.assertGreater(shown[1].time, 3)

    def settled(self):
        """Soil that settles by 0.25 m under gravity, and creeps by 10 mm a second after the reset at t = 2 s."""
        results = self.results("start", "gravity", "gravity", "rain", "rain", "rain")
        for step, snapshot in enumerate(results.snapshots):
            moved = 0.125 * step if step <= 2 else 0.01 * (step - 2)
            snapshot.step, snapshot.scalar = step, lambda _, moved=moved: (np.full(10, moved), "m")
        painter = Painter.__new__(Painter)
        painter.results, painter.spacing = results, 1e-3
        return painter, results.snapshots

    def test_make_the_scale_of_pictures_and_films_that_also_show_what_was_before(self):
        painter, snapshots = self.settled()
        scale = painter.colours("displacement", snapshots)
        self.assertEqual((scale.shown[1], scale.unit, scale.above), (30, "mm", True))  # the settlement lies beyond its end
        self.assertEqual(painter.colours("displacement_x", snapshots).shown[1], 30)
        self.assertEqual(painter.colours("velocity", snapshots).shown[1], 0.25)  # no reset sets it to 0
        self.assertEqual(painter.colours("displacement", snapshots[:3]).shown[1], 0.25)  # nothing else is shown
        painter.spacing = 100.0  # of which 30 mm are next to nothing
        self.assertEqual((painter.colours("displacement", snapshots).shown[1], painter.colours("displacement", snapshots).nothing), (0.25, ""))

    def test_between_the_times_of_a_picture_are_said_in_its_titles(self):
        painter, snapshots = self.settled()
        painter.count_from("displacement", snapshots[1:4])
        self.assertEqual((painter.since, painter.reset), ({1: "since the start", 2: "since the start", 3: "since the end of stage gravity"}, ""))
        painter.results.when, painter.views = lambda snapshot: f"t = {snapshot.time} s", [View("section", 0, 1)]
        self.assertEqual(painter._title(snapshots[3], 0, ""), ["t = 3 s", "rain", "since the end of stage gravity"])
        for shown, reset in ((snapshots[3:], "gravity"), ([snapshots[0], *snapshots[3:]], "gravity"), (snapshots[:3], "")):  # one origin: said once
            painter.count_from("displacement", shown)
            self.assertEqual((painter.since, painter.reset), ({}, reset))
        painter.count_from("velocity", snapshots)
        self.assertEqual((painter.since, painter.reset), ({}, ""))

    def test_at_the_end_of_a_run_show_nothing_else(self):
        results = self.results("start", "gravity", "gravity")
        self.assertEqual(since_reset(results, results.snapshots, "displacement"), (results.snapshots, ""))

    def test_lines_are_shown_after_them_and_their_friction_after_the_first_stage(self):
        line = types.SimpleNamespace(time=np.arange(7.0), stage=["start", "gravity", "gravity", "gravity", "rain", "rain", "rain"])
        line.columns = {"displacement_m": np.arange(7.0)[:, None], "mobilised_friction_deg": np.arange(7.0)[:, None]}
        with unittest.mock.patch("talus_lines.means", lambda line: {"displacement_m": line.columns["displacement_m"][:, 0]}):
            self.assertEqual(talus_lines.chosen(line, reset=(3.0, "gravity")), [4, 5, 6])
            self.assertEqual(talus_lines.chosen(line)[0], 0)
        self.assertEqual(talus_lines.under_stress(line, [0, 2, 3, 6]), [3, 6])
        line.stage = ["start"] + 6 * ["slide"]
        self.assertEqual(talus_lines.under_stress(line, [0, 3, 6]), [3, 6])


    def test_are_where_every_panel_of_a_line_begins(self):
        """Of a line of 12 days that was reset after 5 days, and of one of 10 days and 20 s that was reset after 10 days."""
        for day, label, ticks in ((86400.0, "time [d]", ["6", "7", "8", "9", "10", "11", "12"]), (5.0, "time since t = 10.0 d [s]", ["0", "2", "4", "6", "8", "10", "12", "14"])):
            time = np.concatenate([np.arange(7) * 86400.0, 10 * 86400.0 + np.arange(5) * day]) if day == 5 else np.arange(13) * day
            reset = 5 if day > 5 else 7
            ones = np.ones((len(time), 4))
            columns = {name: ones * np.arange(4) for name in ("x_m", "y_m", "distance_m")} | {name: ones * time[:, None] for name in
                       ("displacement_m", "displacement_x_m", "displacement_y_m", "mobilised_friction_deg")} | {"state": 0 * ones}
            line = types.SimpleNamespace(name="inclinometer", time=time, columns=columns, stage=["gravity"] * (reset + 1) + ["rain"] * (len(time) - reset - 1))
            line.moved, seen = lambda: np.stack([ones, ones], axis=2), []
            type_of = type("Line", (types.SimpleNamespace,), {"__getitem__": lambda self, name: self.columns[name]})
            line = type_of(**vars(line))
            snapshots = [types.SimpleNamespace(time=at, stage=stage) for at, stage in zip(time, line.stage)]
            results = types.SimpleNamespace(snapshots=snapshots, title="", up_axis=lambda: 1, history=None, scene={"stage": [{"name": "gravity", "reset_displacement": True}, {"name": "rain"}]})
            with unittest.mock.patch.object(talus_lines.style, "save", lambda figure, path: seen.append(figure)), \
                    unittest.mock.patch("talus_lines.dimensionless", lambda results, times: None):
                talus_lines.draw_line(results, line, "", None)
            profile, _, mean = seen[0].axes
            self.assertEqual(mean.lines[0].get_xdata()[0], time[reset + 1])
            self.assertEqual(profile.get_title(loc="left"), "since the end of stage gravity")
            self.assertEqual(len(profile.lines), len(talus_lines.chosen(line, reset=(time[reset], "gravity"))))
            with unittest.mock.patch.object(talus_lines.style, "save", lambda figure, path: seen.append(figure)), \
                    unittest.mock.patch("talus_lines.dimensionless", lambda results, times: None):
                talus_lines.draw_line(results, line, "", [time[2], time[-1]])  # times before and after it
            self.assertEqual([curve.get_label().split(", ")[-1] for curve in seen[1].axes[0].lines], ["since the start", "since the end of stage gravity"])
            talus_runs.plt.close(seen[1])
            seen[0].canvas.draw()
            low, high = mean.get_xlim()
            shown = [text.get_text() for at, text in zip(mean.get_xticks(), mean.get_xticklabels()) if low <= at <= high]
            self.assertEqual((mean.get_xlabel(), shown), (label, ticks))


class Factors(unittest.TestCase):
    def test_that_are_brackets_have_a_headline_with_room_and_a_legend_beside_the_lines(self):
        bracket = {"decided": False, "equilibrium": 1.083, "mechanism": 1.0912}
        trials = [{"flow": flow, "search": 1, "factor": factor, "outcome": outcome, "displacement_m": size} for flow, factor, outcome, size in
                  (("own", 1.0, "equilibrium", 0.1), ("own", 1.083, "equilibrium", 0.6), ("own", 1.0912, "mechanism", 9), ("associated", 1.17, "equilibrium", 6),
                   ("associated", 1.18, "mechanism", 9))]
        with unittest.mock.patch.object(talus_factor.style, "save", lambda figure, path: figure):
            figure = talus_factor.draw_displacement({"trials": trials}, f"Factor of safety {talus_factor.in_words(bracket)}", "Cut of 14 m", None)
        figure.canvas.draw()
        whole, axes = figure.bbox, figure.axes[0]
        self.assertLess(figure._suptitle.get_window_extent().x1, whole.x1)
        legend = axes.get_legend().get_window_extent()
        self.assertLess(legend.y1, axes.get_window_extent().y0)
        self.assertGreater(legend.y0, whole.y0)


class Refusals(unittest.TestCase):
    def test_numbers_of_particles_are_no_fields(self):
        first = types.SimpleNamespace(scalar=lambda field: (np.zeros(3), ""), names=lambda: ["velocity"])
        with unittest.mock.patch("talus_plot.Results", lambda folder: types.SimpleNamespace(snapshots=[first], scene={})):
            talus_plot.checked("here", ["velocity"])
            for field in ("body", "id"):
                with self.assertRaisesRegex(talus_plot.NoSuchField, f"{field} is a number of particles"):
                    talus_plot.checked("here", [field])


class Histories(unittest.TestCase):
    def test_a_stage_begins_where_the_one_before_ended(self):
        history = History.__new__(History)
        history.time, history.stage = np.array([0.0, 1.0, 2.0, 2.5, 3.0]), ["start", "rain", "rain", "slide", "slide"]
        self.assertEqual(history.stage_starts(), [(0.0, "start"), (0.0, "rain"), (2.0, "slide")])

    def test_of_friction_on_a_base_have_the_tangent_of_a_constant_angle(self):
        scene = {"boundary": {"bed": {"friction_angle": 20}, "rock": {"friction_angle": "20 deg"}, "clay": {"friction_angle": "20 + x"}, "wall": {}}}
        for name, tan_phi in (("bed", 0.36397), ("rock", 0.36397), ("clay", None), ("wall", None), ("other", None)):
            self.assertEqual(base_friction(scene, f"{name}_friction") and round(base_friction(scene, f"{name}_friction"), 5), tan_phi)
        self.assertIsNone(base_friction(scene, "bed_clearance"))

    def test_the_clock_of_the_loads_has_no_picture(self):
        time = np.arange(3.0)
        history = types.SimpleNamespace(time=time, groups=lambda: {("load_time", "s"): {"": time}}, points=lambda time: {})
        self.assertEqual(draw_histories(types.SimpleNamespace(history=history, scene={}, snapshots=[]), None), [])

    def test_of_water_begin_when_suction_no_longer_grows_with_gravity(self):
        history = History.__new__(History)
        history.time, history.step, history.stage = np.arange(6.0), np.arange(6), ["start", "gravity", "gravity", "rain", "rain", "rain"]
        history.columns = {"water_kg": np.array([90.0, 60, 50, 52, 55, 57]), "water_out_kg": np.array([0.0, 0, 0, -2, -5, -7]),
                           "water_given_kg": np.array([0.0, -30, -40, -40, -40, -40]), "water_error_kg": np.zeros(6)}
        history.quantities = {f"water{'' if part == 'stored' else '_' + part}_kg": Quantity("water_ledger", "kg", "run", part) for part in ("stored", "out", "given", "error")}
        for flows, first in ((False, 2.0), (True, 0.0)):
            scene, seen = {"stage": [{"name": "gravity", "gravity_ramp": 1, "pore_flow": flows}, {"name": "rain"}]}, {}
            results = types.SimpleNamespace(history=history, scene=scene, snapshots=[], title="", per_metre=lambda text: text)
            with unittest.mock.patch.object(talus_runs.style, "save", lambda figure, path: seen.update({path.name: figure})):
                draw_histories(results, pathlib.Path())
            upper = seen["water_ledger.png"].axes[0]
            gained = {line.get_label(): line for line in upper.lines}["gained"]
            self.assertEqual((gained.get_xdata()[0], gained.get_ydata()[0], gained.get_ydata()[-1]), (first, 0, -33 if flows else 7))
            self.assertEqual("since the end of stage gravity" in [text.get_text() for text in seen["water_ledger.png"].texts], not flows)

    def test_of_displacement_begin_at_the_last_reset(self):
        history = History.__new__(History)
        history.time, history.step, history.stage = np.arange(6.0), np.arange(6), ["start", "gravity", "gravity", "rain", "rain", "rain"]
        history.columns = {"crest_displacement_m": np.array([0, 0.2, 0.3, 0, 1e-3, 2e-3]), "crest_velocity_m_s": np.array([0, 0.2, 0.1, 0, 1e-3, 1e-3])}
        history.quantities = {"crest_displacement_m": Quantity("displacement", "m", "point", "crest"), "crest_velocity_m_s": Quantity("velocity", "m/s", "point", "crest")}
        snapshots = [types.SimpleNamespace(time=float(time), stage=stage) for time, stage in zip(history.time, history.stage)]
        for resets, first in ((True, 3.0), (False, 0.0)):
            scene, seen = {"stage": [{"name": "gravity", "reset_displacement": resets}, {"name": "rain"}]}, {}
            results = types.SimpleNamespace(history=history, scene=scene, snapshots=snapshots, title="", per_metre=lambda text: text)
            with unittest.mock.patch.object(talus_runs.style, "save", lambda figure, path: seen.update({path.name: figure})):
                draw_histories(results, pathlib.Path())
            moved, speed = (seen[f"history_{name}.png"] for name in ("displacement", "velocity"))
            self.assertEqual((moved.axes[0].lines[0].get_xdata()[0], speed.axes[0].lines[0].get_xdata()[0]), (first, 0))
            self.assertEqual("since the end of stage gravity" in [text.get_text() for text in moved.texts], resets)
            self.assertEqual(max(moved.axes[0].lines[0].get_ydata()), 2.0 if resets else 0.3)  # mm or m


    def test_of_points_that_are_one_particle_are_one(self):
        history = History.__new__(History)
        history.time, history.step, history.stage = np.arange(3.0), np.arange(3), ["start", "slide", "slide"]
        ways = {"crest": [0.0, 1, 2], "toe": [0.0, 2, 4], "shoulder": [0.0, 1, 2]}
        history.columns = {f"{name}_{what}": np.array(way) for name, way in ways.items() for what in ("x_m", "y_m", "displacement_m")}
        history.quantities = {f"{name}_{what}_m": Quantity(what, "m", "point", name) for name in ways for what in ("x", "y", "displacement")}
        results, seen = types.SimpleNamespace(history=history, scene={}, snapshots=[], title="", per_metre=lambda text: text), []
        with unittest.mock.patch.object(talus_runs.style, "save", lambda figure, path: seen.append(figure)):
            draw_histories(results, pathlib.Path())
        self.assertEqual([text.get_text() for text in seen[0].axes[0].get_legend().get_texts()], ["crest, shoulder", "toe"])


class Values(unittest.TestCase):
    """Soil of which a part has no plastic strain, as its law is elastic."""

    def results(self, *strain):
        last = Moving(np.array(strain))
        last["plastic_strain"], last.position, last.time = last.pop("velocity"), lambda: np.zeros((len(strain), 3)), 1.0
        last.column = lambda name: types.SimpleNamespace(values=last[name][:, None])
        return types.SimpleNamespace(snapshots=[last], history=None, escaped=None, bodies=["rock", "debris"], scene={}, folder=pathlib.Path("nowhere"), events=lambda kind=None: [])

    def test_that_are_none_do_not_count(self):
        results = self.results(np.nan, 0.5, 1.5, np.nan)
        self.assertEqual((MEASURES["largest"](results, "plastic_strain"), MEASURES["mean"](results, "plastic_strain")), (1.5, 1.0))
        with self.assertRaisesRegex(KeyError, "no particle has a value of plastic_strain"):
            MEASURES["mean"](self.results(np.nan, np.nan), "plastic_strain")
        results.history = types.SimpleNamespace(columns={"toe_velocity_m_s": np.array([np.nan, 2.0, 1.0])})
        self.assertEqual((MEASURES["largest_in_history"](results, "toe_velocity_m_s"), MEASURES["largest_speed"](results, "toe")), (2.0, 2.0))

    def test_that_are_none_do_not_stand_in_a_report(self):
        cards = {what: number for what, number, _ in key_results(self.results(np.nan, 0.5, 1.5))}
        self.assertEqual(cards["Largest plastic strain"], "1.5")
        self.assertNotIn("Largest plastic strain", {what for what, _, _ in key_results(self.results(np.nan, np.nan))})

    def test_that_are_doubtful_come_first(self):
        results = self.results(0.5)
        results.events = lambda kind: [{"kind": kind, "stage": "gravity", "values": {"largest_displacement_m": 1.531}}] * (kind == "moved_before_reset")
        results.history = types.SimpleNamespace(columns={"toe_x_m": np.array([4.0, np.nan]), "crest_x_m": np.array([np.nan, 1.0])}, points=lambda time: {"toe": (), "crest": ()},
                                                groups=dict)
        (moved, way, note), (points, names, _) = key_results(results)[:2]
        self.assertEqual((moved, way, points, names), ("Moved before the start", "1.53 m", "Points without soil", "toe"))
        self.assertIn("stage gravity", note)


class Columns(unittest.TestCase):
    """history.csv with a point, a base and energies, and what history_columns.csv says of its columns."""

    ROWS = (("crest_x_m", "x", "m", "point", "crest"), ("crest_velocity_m_s", "velocity", "m/s", "point", "crest"), ("toe_x_m", "x", "m", "point", "toe"),
            ("kinetic_J", "energy", "J", "run", "kinetic"), ("base_force_x_N", "force_x", "N", "boundary", "base"), ("base_inflow_m3_s", "inflow", "m3/s", "boundary", "base"),
            ("mass_kg", "mass", "kg", "run", ""))

    def test_are_what_their_table_says(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "history.csv").write_text("time_s,step,stage," + ",".join(row[0] for row in self.ROWS) + "\n" + "".join(f"{t},{t},fall,{t},2,3,4,5,6,7\n" for t in (0, 1)))
            history = talus_results.History(folder / "history.csv")
            self.assertEqual(history["mass_kg"].tolist(), [7, 7])
            with self.assertRaisesRegex(OSError, "history_columns.csv"):
                history.groups()
            (folder / "history_columns.csv").write_text("column,quantity,unit,of,which\n" + "".join(",".join(row) + "\n" for row in self.ROWS))
            groups = {key: {label: values.tolist() for label, values in lines.items()} for key, lines in history.groups().items()}
            self.assertEqual(groups, {("x", "m"): {"crest": [0, 1], "toe": [3, 3]}, ("velocity", "m/s"): {"crest": [2, 2]}, ("energy", "J"): {"kinetic": [4, 4]},
                                      ("base_force_x", "N"): {"": [5, 5]}, ("base_inflow", "m³/s"): {"": [6, 6]}, ("mass", "kg"): {"": [7, 7]}})
            self.assertEqual({name: place.tolist() for name, place in history.points(0.5).items()}, {"crest": [0.5], "toe": [3]})
            self.assertEqual(history.unit("crest_velocity_m_s"), "m/s")


class CutHistory(unittest.TestCase):
    """A stage by finite elements with steps of any length, then motion with a row every 0.1 s in steps of 0.03 s, then one every 0.5 s after a resume."""

    def rows(self):
        rows = [(0, 0, "start"), (1, 1, "static"), (5, 2, "static"), (5.2, 3, "static")]
        steps = [round(0.1 * k / 0.03 + 0.5) for k in range(1, 21)] + [round((2 + 0.5 * k) / 0.03 + 0.5) for k in range(1, 5)]
        return rows + [(round(5.2 + 0.03 * step, 6), 3 + step, "motion") for step in steps]

    def said(self, rows, end="\n"):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "history.csv"
            path.write_text("time_s,step,stage,kinetic_J\n" + "\n".join(f"{time},{step},{stage},1.5" for time, step, stage in rows) + end)
            results = Results.__new__(Results)
            results.folder, results.history, results.snapshots = pathlib.Path("run"), History(path), [types.SimpleNamespace(time=self.rows()[-1][0])]
            return results.cut_history()

    def test_that_is_whole_says_nothing(self):
        self.assertEqual(self.said(self.rows()), "")

    def test_with_half_a_line_says_so(self):
        for end in ("", "\n9.3,"):
            self.assertEqual(self.said(self.rows(), end), "history.csv in run is cut, as its last line is incomplete: curves show the rest")

    def test_without_rows_says_where(self):
        rows = self.rows()
        self.assertRegex(self.said(rows[:10] + rows[13:]), "rows are missing between 5.83 and 6.22 s: curves")
        self.assertRegex(self.said(rows[:15]), "rows are missing after 6.31 s: curves")


class Scale(unittest.TestCase):
    def test_of_a_map_leaves_the_corner_of_the_arrow_to_the_north(self):
        soil, low = np.zeros((50, 50), bool), np.array([1000.0, 2000.0])
        shown = np.array([low, low + 100])
        corner = lambda: talus_map_pictures.corner_of_arrow(soil, 2.0, low, shown, 15.0)
        place = lambda arrow: tuple(talus_map_pictures.place_of_scale(soil, 2.0, low, shown, 20.0, 15.0, arrow))
        self.assertEqual(corner(), (1, 1))
        soil[:, 46:] = True
        self.assertEqual(corner(), (1, 0))
        self.assertEqual(place((1, 0)), (1004.0, 2004.0))
        soil[40:, :8] = True
        self.assertEqual(corner(), (0, 0))
        self.assertEqual(place((0, 0))[0], 1076.0)

    def test_of_a_map_stands_where_no_soil_is(self):
        soil, low = np.zeros((50, 50), bool), np.array([1000.0, 2000.0])

        def place(beyond=0.0):
            shown = np.array([low + beyond, low + 100 - beyond])
            return tuple(talus_map_pictures.place_of_scale(soil, 2.0, low, shown, 20.0, 15.0))  # a map of 100 m on 6.7 inches

        self.assertEqual(place(beyond=10.0), (1013.2, 2013.2))  # on the ground, where cells reach beyond it

        self.assertEqual(place(), (1004.0, 2004.0))
        soil[5, 2] = True
        self.assertEqual(place(), (1076.0, 2004.0))
        soil[45, 2] = True
        self.assertEqual(place(), (1004.0, 2091.5))
        soil[4:6, 47] = True
        self.assertEqual(place(), (1004.0, 2004.0))  # less soil than there


class Times(unittest.TestCase):
    def said(self, *snapshots):
        results = types.SimpleNamespace(snapshots=[types.SimpleNamespace(time=time, stage=stage) for time, stage in snapshots])
        return [Results.when(results, snapshot) for snapshot in results.snapshots]

    def test_a_run_of_seconds_is_told_in_seconds(self):
        self.assertEqual(self.said((0, "start"), (2.25, "slide"), (12.5, "slide")), ["t = 0.0 s", "t = 2.2 s", "t = 12.5 s"])

    def test_a_run_of_days_is_told_in_days_and_its_slide_in_seconds_after_them(self):
        self.assertEqual(self.said((0, "start"), (30 * 86400, "seepage"), (45 * 86400, "seepage"), (45 * 86400 + 4.25, "slide")),
                         ["t = 0.0 d", "t = 30.0 d", "t = 45.0 d", "t = 45.0 d + 4.2 s"])


class Panels(unittest.TestCase):
    def state(self, way, strain, left=0):
        snapshot = Snapshot(0, way, left)
        snapshot.scalar = lambda field: (np.full(30 - left, strain), "-")
        return snapshot

    def test_are_drawn_where_they_show_something_else(self):
        snapshots = [self.state(0, 0), self.state(0, 0.001), self.state(0, 0.5), self.state(1, 0.5), self.state(1, 0.501), self.state(1, 0.501, left=3)]
        shown = telling(snapshots, "strain", Colours("strain", snapshots), 1.0)
        self.assertEqual([snapshots.index(one) for one in shown], [0, 2, 3, 5])


class Water:
    """A field that is nothing at the start, and something from the end of gravity on."""

    def __init__(self, time, stage, value):
        self.time, self.stage, self._value = time, stage, value

    def ids(self):
        return np.arange(3)

    def scalar(self, field):
        return np.full(3, float(self._value)), "Pa"


class Stress(unittest.TestCase):
    def test_is_shown_from_the_end_of_gravity_on_and_motion_from_the_start_on(self):
        all_of_them = [Water(0, "start", 0), Water(1, "gravity", 5), Water(2, "gravity", 10), Water(3, "rain", 11), Water(4, "rain", 12)]
        results, chosen = types.SimpleNamespace(snapshots=all_of_them), [all_of_them[k] for k in (0, 1, 4)]
        self.assertEqual([one.time for one in with_stress(results, chosen, "pore_pressure")], [2, 4])
        self.assertEqual([one.time for one in with_stress(results, chosen, "velocity_x")], [0, 1, 4])


class Soils(unittest.TestCase):
    """A section of 20 by 10 pixels, the lower half clay (0), the upper half sand (1)."""

    def setUp(self):
        self.owner = np.arange(200).reshape(10, 20)
        self.body = (np.arange(200) >= 100).astype(int)
        self.frame = Frame((0, 0), (2, 1), 20)

    def test_are_seen_where_a_field_has_nothing_to_show(self):
        value = np.where(np.arange(200) % 20 < 10, 0.0, 1.0)
        scale = Colours("displacement", [types.SimpleNamespace(scalar=lambda field: (value, "m"))])
        picture = painted(self.owner, value, self.body, tints(["clay", "sand"]), scale)
        for row, body in ((2, 0), (7, 1)):
            np.testing.assert_allclose(picture[row, 3], [*tints(["clay", "sand"])[body], 1])
            np.testing.assert_allclose(picture[row, 15], scale.map(scale.norm(1.0)))
        self.assertLess(picture[4, 3, :3].sum(), picture[2, 3, :3].sum() - 0.5)  # the line between them

    def test_keep_their_colours_as_others_are_added(self):
        names = ["clay", "sand", "silt", "fill", "rock", "gravel", "crust"]
        whole = dict(zip(names, talus_style.soil_colours(names)))
        for count in range(1, len(names)):
            for some in (names[:count], names[count:]):
                self.assertEqual(talus_style.soil_colours(some), [whole[name] for name in some])
        many = [f"lift{k}" for k in range(60)]
        self.assertEqual(len(set(talus_style.soil_colours(many))), len(many))
        self.assertEqual(len(talus_style.soil_colours([f"lift{k}" for k in range(100)])), 100)

    def test_a_single_cell_of_nothing_is_no_hole(self):
        owner = np.arange(400).reshape(20, 20).repeat(10, axis=0).repeat(10, axis=1)  # particles of 10 pixels
        value = np.ones(400)
        value[:100], value[305] = 0, 0  # a quarter of the soil, and one particle amid the rest
        scale = Colours("displacement", [types.SimpleNamespace(scalar=lambda field: (value, "m"))])
        tint, body = tints(["clay"]), np.zeros(400, int)
        at = {name: painted(owner, value, body, tint, scale, reach)[row, column, :3] for name, reach, row, column in
              (("hole", 0, 155, 55), ("none", 8, 155, 55), ("quarter", 8, 20, 55), ("edge", 8, 0, 0))}
        for where, colour in (("hole", tint[0]), ("quarter", tint[0]), ("edge", tint[0]), ("none", scale.map(0.0)[:3])):
            np.testing.assert_allclose(at[where], colour, rtol=1e-6, err_msg=where)

    def test_an_outline_is_seen_where_the_soil_has_left_it(self):
        soil = np.zeros((10, 20), bool)
        soil[:5, :10] = soil[:9, 10:] = True  # the left half has sunk from 0.9 to 0.5
        line = moved_away(np.array([(0.0, 0.9), (2.0, 0.9)]), soil, self.frame, 0.1)
        seen = line[np.isfinite(line[:, 0]), 0]
        self.assertGreater(len(seen), 5)
        self.assertLess(seen.max(), 1.0)
        self.assertTrue(np.isnan(line[line.shape[0] // 2 + 2:]).all())


class Sheared:
    """Soil of 20 m by 10 m with a particle in each square of 0.25 m, and a plastic strain that is given at each place."""

    def __init__(self, strain):
        x, y = np.meshgrid(np.arange(0.125, 20, 0.25), np.arange(0.125, 10, 0.25))
        self._place = np.column_stack([x.ravel(), y.ravel()])
        self._strain = np.array([strain(*place) for place in self._place])
        self.time, self.folder, self.snapshots, self.scene = 0, "here", [self], {}

    def __contains__(self, name):
        return name == "plastic_strain"

    def ids(self):
        return np.arange(len(self._place))

    def position(self):
        return self._place

    def scalar(self, name):
        return self._strain, "-"

    def up_axis(self):
        return 1


class SlipSurface(unittest.TestCase):
    """A line within 0.5 m, the height of a row, of the middle of its band."""

    def test_stays_in_one_of_two_bands(self):
        # in every fourth metre the upper band, 3 m above the lower one, has more strain; the lower one has more in all
        def strain(x, y):
            return 0.6 if abs(y - 3) < 0.5 else (1.0 if x % 4 < 1 else 0.3) if abs(y - 6) < 0.5 else 0.0

        line = slip_surface(Sheared(strain), 0)[0]
        self.assertLess(np.abs(line[:, 1] - 3).max(), 0.5)
        self.assertGreater(np.ptp(line[:, 0]), 19)

    def test_does_not_leap_over_sound_soil_to_a_band_that_is_near(self):
        # 1 m of soil between the bands, less than a step may rise; the upper one has more strain to the right of the middle, and ends there
        def strain(x, y):
            return 0.6 if abs(y - 3) < 0.5 else 0.7 if abs(y - 5) < 0.5 and 10 < x < 12 else 0.0

        self.assertLess(np.abs(slip_surface(Sheared(strain), 0)[0][:, 1] - 3).max(), 0.5)

    def test_follows_a_band_that_rises_steeply(self):
        def band(x):
            return 2 if x < 12 else 2 + 2.5 * (x - 12)

        line = slip_surface(Sheared(lambda x, y: float(abs(y - band(x)) < (0.5 if x < 12 else 1.2) and x < 15)), 0)[0]
        self.assertGreater(line[:, 1].max(), 8)
        for x, y in line:
            self.assertLess(abs(y - band(x)), 1.3)


    def test_is_that_of_the_first_time_at_which_it_leads_from_ground_to_ground(self):
        # a circle from the ground at x = 4 to the ground at x = 16, of which the part to the right of `front` is sheared
        def circle(front):
            return lambda x, y: float(front < x < 16.4 and abs(np.hypot(x - 10, y - 12) - 6.3) < 0.4)

        moments = [Sheared(circle(front)) for front in (15, 9, 3.6, 3.6)]
        for time, moment in enumerate(moments):
            moment.time = time
        results = moments[0]
        results.snapshots = moments
        with unittest.mock.patch("talus_slip.failure", lambda results: (1.0,)):
            line, snapshot = slip_surface(results)[:2]
        self.assertEqual(snapshot.time, 2)
        self.assertLess(line[0, 0], 6)
        self.assertEqual(slip_surface(results, 1)[1].time, 1)

        def said(time):
            line, snapshot, place, _ = slip_surface(results, time)
            return said_of_ends(results, line, place, snapshot)

        self.assertRegex(said(1), r"ends inside the soil, .* m below the ground on the left: no connected path of .* at t = 1 s; a later time")
        self.assertEqual(said(2), "")

    def test_is_not_that_of_an_earlier_time_which_ends_a_little_below_the_ground(self):
        # the first band ends 1 m below the ground on the right, a tenth of the height of the soil and two rows; the second one at the ground
        circle = [lambda x, y: float(abs(np.hypot(x - 10, y - 12) - 6.3) < 0.4 and (x < 10 or y < 9)),
                  lambda x, y: float(abs(np.hypot(x - 10, y - 12) - 6.3) < 0.4)]
        moments = [Sheared(strain) for strain in circle]
        for time, moment in enumerate(moments):
            moment.time = time
        results = moments[0]
        with unittest.mock.patch("talus_slip.failure", lambda results: (0.0,)):
            results.snapshots = moments
            self.assertEqual(slip_surface(results)[1].time, 1)
            results.snapshots = [moments[0], moments[0]]
            self.assertEqual(slip_surface(results)[1].time, 0)

    def test_says_that_no_path_leads_to_the_ground(self):
        # a band from one end of the soil to the other, 3 m below its ground
        results = Sheared(lambda x, y: float(abs(y - 7) < 0.5))
        line, snapshot, place, _ = slip_surface(results, 0)
        said = said_of_ends(results, line, place, snapshot)
        self.assertIn("2.9 m below the ground on the left and 2.9 m below the ground on the right", said)
        self.assertIn("no connected path", said)
        self.assertIn("the last time of the run", said)

    def test_says_where_it_is_none(self):
        # a band 3 m below the ground that is followed by one along the ground, and one that is interrupted for 3 m
        results = Sheared(lambda x, y: float(abs(y - (7 if x < 10 else 9.7 if x > 11 else 7 + 2.7 * (x - 10))) < 0.5))
        results.scene = {"boundary": {"bed": {"kind": "friction"}, "left": {"kind": "roller"}}}
        line, _, place, strain = slip_surface(results, 0)
        ground, slip = said_of_line(results, line, place, strain)
        self.assertRegex(ground, r"follows the ground from x = 1[01]\.?\d* to (19|20)\.?\d* m")
        self.assertIn("boundary bed is no plastic strain", slip)
        line = np.column_stack([np.arange(0.25, 20, 0.5), np.full(40, 3.0)])
        broken = Sheared(lambda x, y: float(abs(y - 3) < 0.5 and not 8 < x < 12.5))
        [weak] = said_of_line(broken, line, broken.position(), broken.scalar("plastic_strain")[0])
        self.assertRegex(weak, r"from x = 8\.\d* to 1[12]\.\d* m: the band is not continuous")
        whole = Sheared(lambda x, y: float(abs(y - 3) < 0.5))
        self.assertEqual(said_of_line(whole, line, whole.position(), whole.scalar("plastic_strain")[0]), [])

    def test_says_how_far_below_the_ground_a_line_ends(self):
        # up to 1 m below the ground on the right, a tenth of its height
        results = Sheared(lambda x, y: float(abs(np.hypot(x - 10, y - 12) - 6.3) < 0.4 and (x < 10 or y < 9)))
        line, snapshot, place, _ = slip_surface(results, 0)
        self.assertRegex(said_of_ends(results, line, place, snapshot), "m below the ground on the right: soil with more than 0.2 of .* ends there")


    def test_is_in_the_picture_of_a_section_where_it_was_found(self):
        line = np.array([[2.0, 9.0], [10.0, 4.0], [18.0, 2.0]])
        for found, factor in ((True, False), (False, True), (True, True), (False, False)):
            with tempfile.TemporaryDirectory() as place:
                folder = pathlib.Path(place)
                if found:
                    (folder / "slip_surface.csv").write_text("x_m,elevation_m\n" + "".join(f"{x},{y}\n" for x, y in line))
                if factor:
                    (folder / "factor_of_safety.json").write_text(json.dumps({"mechanisms": [{"slip_surface_m": (line + 1).tolist()}],
                                                                              "factor_of_safety": {"decided": True, "value": 1.2345}}))
                soil = Moved()
                results = types.SimpleNamespace(snapshots=[soil], up_axis=lambda: 1, mesh=lambda: (np.zeros((0, 2)), np.zeros((0, 3), int)), scene={}, folder=folder, bodies=["clay"],
                                                escaped=None, history=None, title="slope", when=lambda one: f"t = {one.time} s", rigid_outlines=lambda time: {}, structures=dict)
                sheets = []
                with unittest.mock.patch.object(talus_sections.style, "save", lambda figure, path: sheets.append(figure)):
                    for draw in talus_sections.section_tasks(results, ["displacement"], None, folder):
                        draw()
                drawn = {curve.get_label(): curve.get_xydata() for curve in sheets[0].axes[0].lines}
                legend = [text.get_text() for one in (*sheets[0].legends, *sheets[0].artists) if hasattr(one, "get_texts") for text in one.get_texts()]
                for there, name, points in ((found, "slip surface, where its soil was at the start", line), (factor, "slip surface of the factor of safety, 1.234", line + 1)):
                    self.assertEqual((name in drawn, name in legend), (there, there), (name, list(drawn), legend))
                    if there:
                        np.testing.assert_allclose(drawn[name], points)
                for sheet in sheets:
                    talus_runs.plt.close(sheet)
                if found:
                    (folder / "run.h5").touch()
                    os.utime(folder / "slip_surface.csv", (0, 0))  # the folder has another run since
                    self.assertEqual(len(talus_sections.slip_surfaces(results, folder)), factor)


class Cores(unittest.TestCase):
    def done_by(self, cores, fails=False):
        """The processes that did four tasks, each of which tells its own."""
        here = os.getpid()

        def work(number):
            if fails and os.getpid() != here:
                raise OSError("no space")
            time.sleep(0.05)
            return number, os.getpid()

        with unittest.mock.patch("os.sched_getaffinity", lambda process: set(range(cores))):
            numbers, processes = zip(*on_two_cores([functools.partial(work, number) for number in range(4)]))
        self.assertEqual(numbers, (0, 1, 2, 3))
        return processes

    def test_share_the_work(self):
        here = os.getpid()
        self.assertEqual(self.done_by(1), (here,) * 4)
        shared = self.done_by(2)
        self.assertEqual((shared.count(here), len(set(shared))), (2, 2))
        self.assertEqual(self.done_by(2, fails=True), (here,) * 4)

    def test_hear_what_cannot_be_drawn(self):
        def work():
            raise OSError("no space")
        for cores in (1, 2):
            with unittest.mock.patch("os.sched_getaffinity", lambda process: set(range(cores))), self.assertRaisesRegex(OSError, "no space"):
                on_two_cores([work, work])


class Moved(Sheared):
    """The same soil, of which the upper half has moved by 1 m."""
    step, stage = 1, "slide"

    def __init__(self):
        super().__init__(lambda x, y: float(y > 5))

    def __contains__(self, name):
        return name in ("displacement", "volume")

    def body(self):
        return np.zeros(len(self._place), int)

    def column(self, name):
        return types.SimpleNamespace(values=np.full((len(self._place), 1), 0.25**2))

    def scalar(self, name):
        return (self._strain, "m") if name == "displacement" else None


class ElementTests(unittest.TestCase):
    def test_are_not_crushed_by_an_oedometer(self):
        way = np.linspace(0, 1, 5)
        def test(axial, aside, p, q):
            strain = {f"strain_{c}": np.zeros(5) for c in ("xx", "zz", "xy", "yz", "xz")} | {"strain_yy": -axial * way}
            strain |= {"strain_xx": aside * way, "strain_zz": aside * way}
            return strain | {"mean_pressure_Pa": 1e5 + p * way, "deviator_Pa": q * way, "compression": (axial - 2 * aside) * way, "pore_pressure_Pa": 0 * way, "void_ratio": np.nan * way}
        shear, oedometer = test(0.05, 0.025, 5e4, 1.5e5), test(0.1, 0, 9e6, 8e6)
        for tests, largest in (({"shear": shear, "oedometer": oedometer}, 200), ({"oedometer": oedometer}, 9000)):
            with unittest.mock.patch.object(talus_soil, "save", lambda figure, path: figure):
                paths, _, _, compression = talus_soil.draw(tests, "", None).axes
            factor = 1 if "kPa" in paths.get_xlabel() else 1e3
            self.assertEqual(round(factor * paths.get_xlim()[1] / largest, 0), 1, tests.keys())
            self.assertGreater(factor * compression.get_xlim()[1], 9000)  # whole in its own chart


class Report(unittest.TestCase):
    def test_says_by_which_groups_soil_left(self):
        def said(*groups):
            return ways_out(types.SimpleNamespace(group=groups, columns={"mass_kg": np.array([1.0, 2.0, 1.0])}))
        self.assertEqual(said("north", "east_side", "north"), "; by north 50 %, east side 50 %")
        self.assertEqual(said("north", "", "north"), "; by north 50 %, faces without a name 50 %")
        self.assertEqual(said("north", "north", "north"), "; by north")
        self.assertEqual(said("", "", ""), "")

    def test_has_the_friction_of_bases_and_how_close_the_soil_is(self):
        columns = {"bed_friction": np.array([0.1, 0.355]), "bed_clearance_m": np.array([0.2, 0.0121]), "dry_friction": np.array([0.3, 0.0]), "dry_clearance_m": np.zeros(2)}
        scene = {"boundary": {"bed": {"friction_angle": 20}, "dry": {"friction_angle": 20}, "side": {}}}
        (what, number, note), = bases(types.SimpleNamespace(history=types.SimpleNamespace(columns=columns), scene=scene))
        self.assertEqual((what, number), ("Friction on bed at the end", "0.355"))
        self.assertTrue(note.endswith("tan φ = 0.364; lowest particles 12.1 mm above it"), note)
        scene["boundary"]["bed"]["friction_angle"] = "20 + x"
        (_, _, note), = bases(types.SimpleNamespace(history=types.SimpleNamespace(columns=columns), scene=scene))
        self.assertTrue(note.endswith("last row; lowest particles 12.1 mm above it"), note)


class Events(unittest.TestCase):
    """events.jsonl of a run that came to its end, of one that broke off, and of one that was killed."""

    def read(self, *kinds, last_line="\n"):
        with tempfile.TemporaryDirectory() as folder:
            results = Results.__new__(Results)
            results.folder = pathlib.Path(folder)
            if kinds:
                lines = [json.dumps({"kind": kind, "text": f"the {kind}\u2028"}, ensure_ascii=False) for kind in kinds]
                (results.folder / "events.jsonl").write_text("\n".join(lines) + last_line)
            return results.broke_off(), [event["kind"] for event in results.events()], len(results.events("warning"))

    def test_tell_how_a_run_ended(self):
        self.assertEqual(self.read("body", "warning", "end"), ("", ["body", "warning", "end"], 1))
        self.assertEqual(self.read("body", "end", "factor_of_safety")[0], "")
        self.assertEqual(self.read("body", "broke_off")[0], "the broke_off\u2028")
        self.assertEqual(self.read("end", "strength_trial", "broke_off")[0], "the broke_off\u2028")
        self.assertEqual(self.read("body", "warning")[0], NOT_ENDED)

    def test_are_whole_lines(self):
        self.assertEqual(self.read("body", "warning", "warning", last_line=""), (NOT_ENDED, ["body", "warning"], 1))

    def test_of_a_run_without_them_are_not_known(self):
        self.assertEqual(self.read(), ("", [], 0))


class Charts(unittest.TestCase):
    """One axis, one quantity, with its unit."""

    def labels(self, module, draw):
        """(x label, y label) of each chart of a picture."""
        seen = []
        with unittest.mock.patch.object(module, "save", lambda figure, path: seen.append(figure)):
            draw()
        return [(axes.get_xlabel().replace("\n", " "), axes.get_ylabel().replace("\n", " ")) for axes in seen[0].axes if axes.get_xlabel()]

    def runs(self, rows, measures=()):
        """A sweep of these rows."""
        runs = talus_runs.Runs.__new__(talus_runs.Runs)
        runs.rows, runs.title, runs.in_plane, runs.measures, runs.ended = rows, "", True, measures, [row for row in rows if not row["failure"]]
        return runs

    def drawn(self, picture):
        """The figure of a picture of talus_study."""
        seen = []
        with unittest.mock.patch.object(talus_runs.style, "save", lambda figure, path: seen.append(figure)):
            talus_runs.charts("", picture[0], "", *picture[1:])
        seen[0].canvas.draw()
        self.addCleanup(talus_runs.plt.close, seen[0])
        return seen[0]

    def test_outcomes_stand_against_each_key_of_its_own(self):
        rows = [{"series": key, "overrides": [], "key": key, "value": value, "unit": unit, "failure": "", "state": FAILS, "volume_of_slide_m3": volume}
                for key, unit, values in (("body.clay.cohesion", "kPa", (6.0, 8.0)), ("body.clay.friction_angle", "deg", (20.0, 25.0)))
                for volume, value in zip((3.0, 4.0), values)]
        figure = self.drawn(talus_compare.outcomes(self.runs(rows), {})[2]["outcomes"])
        self.assertEqual([(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes],
                         [("body.clay.cohesion [kPa]", "volume of slide [m³/m]"), ("body.clay.friction_angle [deg]", "volume of slide [m³/m]")])
        self.assertEqual(talus_runs.named("volume_of_slide_m3", False), "volume of slide [m³]")
        self.assertEqual(talus_runs.named("crest_largest_speed_m_s", True), "crest largest speed [m/s]")

    def test_outcomes_have_the_units_of_the_scene(self):
        rows = [{"line": "", "series": "a", "overrides": ["key=1"], "key": "key", "value": value, "unit": "", "failure": "", "state": FAILS, "travel_distance_m": 10.0 * value}
                for value in (1.0, 2.0)]
        talus_units.use({"output": {"units": "US"}})
        self.addCleanup(talus_units.use, {})
        said, _, pictures, _ = talus_compare.outcomes(self.runs(rows), {})
        axes, = self.drawn(pictures["outcomes"]).axes
        self.assertEqual(axes.get_ylabel(), "travel distance [ft]")
        np.testing.assert_allclose(max(np.max(line.get_ydata()) for line in axes.lines if len(line.get_ydata())), 20 / 0.3048)
        self.assertIn("65.62", said[-1])
        curve = self.drawn(("", [[talus_study.exceedance({"": rows}, "travel_distance_m", [{"name": "far", "outcome": "travel_distance_m", "limit": 15.0}], 0.95, True)]])).axes[0]
        self.assertIn(15 / 0.3048, [line.get_xdata()[0] for line in curve.lines])  # the limit is given in m, as the column is

    def test_a_series_over_two_keys_is_a_line_for_each_value_of_the_first(self):
        rows = [{"series": "both", "overrides": [f"body.clay.cohesion={c}", f"body.clay.friction_angle={phi}"]} for c in ("4 kPa", "8 kPa") for phi in ("15", "20")]
        for some, lines in ((rows, ["both, body.clay.cohesion=4 kPa"] * 2 + ["both, body.clay.cohesion=8 kPa"] * 2), (rows[:2], ["both"] * 2)):
            talus_compare.lines_in(some)
            self.assertEqual([row["line"] for row in some], lines)

    def test_energies_of_a_section_are_those_of_a_metre(self):
        history = History.__new__(History)
        history.time, history.step, history.stage = np.array([0.0, 1.0]), np.array([0, 1]), ["slide", "slide"]
        history.columns = {"kinetic_J": np.array([0.0, 2e3]), "crest_displacement_m": np.array([0.0, 1.0])}
        history.quantities = {"kinetic_J": Quantity("energy", "J", "run", "kinetic"), "crest_displacement_m": Quantity("displacement", "m", "point", "crest")}
        for per, unit in (("/m", "kJ/m"), ("", "kJ")):
            results = types.SimpleNamespace(history=history, scene={}, snapshots=[], title="", per_metre=lambda text, per=per: text + per)
            seen = []
            with unittest.mock.patch.object(talus_runs.style, "save", lambda figure, path: seen.append(figure)):
                draw_histories(results, pathlib.Path())
            self.assertEqual(sorted(axes.get_ylabel() for figure in seen for axes in figure.axes), ["displacement [m]", f"energy [{unit}]"])

    def test_errors_stand_against_each_key_of_its_own(self):
        rows = [{"line": series, "key": key, "unit": unit, "value": value, "way": 1 + error, "error": error, "processor_s": 1.0, "pareto": 1, "failure": ""}
                for series, key, unit in (("euler", "integrator.fraction", ""), ("arkode", "integrator.velocity_tolerance", "m/s"))
                for value, error in ((0.1, 0.01), (0.001, 0.001))]
        figure = self.drawn(talus_compare.chart_of_errors(rows, {"uncertainty": 0.0005, "value": 1.0, "measure": "way"}))
        self.assertEqual([axes.get_xlabel().replace("\n", " ") for axes in figure.axes],
                         ["processor time [s]", *2 * ["integrator.fraction"], *2 * ["integrator.velocity_tolerance [m/s]"]])
        self.assertEqual([text.get_text() for text in figure.legends[0].get_texts()], ["euler", "arkode", "Pareto front", "reference uncertain"])
        self.assertEqual(len({axes.lines[1].get_color() for axes in figure.axes[1:3]} | {axes.lines[-2].get_color() for axes in figure.axes[3:4]}), 2)
        low, _ = figure.axes[0].get_ylim()
        self.assertTrue(0.0001 < low < 0.001, low)  # the uncertainty brings no empty decade

    def test_show_no_more_named_points_than_have_room(self):
        rows = [{"series": "soil", "overrides": [], "key": "size", "value": float(size), "unit": "m", "failure": "", "state": FAILS,
                 **{f"m{n}_displacement_m": 1.0 * n * size for n in range(14)}, **{f"m{n}_largest_speed_m_s": 2.0 for n in range(14)}} for size in (1, 2)]
        lines, _, pictures, _ = talus_compare.outcomes(self.runs(rows), {})
        self.assertLess(max(map(len, lines)), 250)
        colours = [{line.get_label(): line.get_color() for line in axes.lines if line.get_label().startswith("m")} for axes in self.drawn(pictures["outcomes"]).axes]
        self.assertEqual(colours[0], colours[1])
        self.assertEqual(len(set(colours[0].values())), 5)

    def test_labels_of_logarithmic_axes_are_few_and_keep_apart(self):
        for low, high in ((0.1, 1.1), (2e-4, 3e-3), (0.021, 0.048), (1, 1e3), (1e-9, 1e4), (7e4, 2e6)):
            rows = [{"line": "euler", "key": "integrator.fraction", "unit": "", "value": float(value), "way": 1 + value, "error": value, "processor_s": value, "pareto": 1, "failure": ""}
                    for value in np.geomspace(low, high, 4)]
            for axes in self.drawn(talus_compare.chart_of_errors(rows, {"uncertainty": 0.0, "value": 1.0, "measure": "way"})).axes:
                for axis, name in ((axes.xaxis, "x"), (axes.yaxis, "y")):
                    if axis.get_scale() != "log":
                        continue
                    low_end, high_end = axis.get_view_interval()
                    labels = [label for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()) for label in (tick.label1,)
                              if label.get_text() and low_end <= tick.get_loc() <= high_end]
                    self.assertTrue(2 <= len(labels) <= 6, (low, high, [label.get_text() for label in labels]))
                    boxes = sorted(((box.x0, box.x1) if name == "x" else (box.y0, box.y1) for box in (label.get_window_extent() for label in labels)))
                    self.assertTrue(all(one[1] < other[0] for one, other in zip(boxes, boxes[1:])), (low, high, name, [label.get_text() for label in labels]))
        self.assertEqual([talus_runs.style.log_number(value) for value in (2e-4, 1e-5, 0.002, 50, 3e5)], ["2×10⁻⁴", "10⁻⁵", "0.002", "50", "3×10⁵"])

    DESIGN = {"planned": 5, "criteria": [], "confidence": 0.95}

    def test_runs_of_a_study_that_broke_off_are_crosses(self):
        rows = [{"run": c, "c": float(c), "way": None if c == 3 else float(c), "failure": "no equilibrium" if c == 3 else ""} for c in range(5)]
        variables = [{"name": "c", "unit": "kPa", "numeric": True, "random": True}]
        for some, places in ((rows, [3]), (rows[:3], [])):
            lines, _, pictures, _ = talus_study.study(self.runs(some, ["way"]), self.DESIGN | {"variables": variables})
            axes = self.drawn(pictures["scatter"]).axes[0]
            self.assertEqual([line.get_xdata()[0] for line in axes.lines if line.get_marker() == "X"], places)
            self.assertEqual(lines[1:], ["  run 3 broke off: no equilibrium"] * len(places))

    def test_bars_of_a_tornado_say_their_values(self):
        fit = {"case": "", "outcome": "travel_distance_m", "runs": 40, "mean": 5.0, "r2": 1.0,
               "bars": [{"variable": "friction", "unit": "deg", "quantiles": [20.5, 27.5], "low": 4.0, "high": 6.0}]}
        figure = self.drawn(("", [talus_study.tornado([fit], True)]))
        self.assertEqual([label.get_text() for label in figure.axes[0].get_yticklabels()], ["friction\n20.5 to 27.5 deg"])
        self.assertEqual([text.get_text() for text in figure.legends[0].get_texts()], ["variable at the 10 % quantile of these runs", "at their 90 % quantile"])
        self.assertIn("fit to 40 runs", figure.axes[0].get_title(loc="right"))

    def test_panels_of_a_key_share_its_range_and_show_standing_runs(self):
        rows = []
        for level in ("0", "3"):
            for c in (4.0, 7.0, 10.0):
                fails = level == "3" and c == 4
                rows.append({"series": "wet", "overrides": [f"water.level={level}", f"c={c}"], "key": "body.clay.cohesion", "value": c, "unit": "kPa", "failure": "",
                             "state": FAILS if fails else STANDS, "load_time_of_failure_s": 1.3 if fails else None, "largest_displacement_m": 7.0 if fails else 1e-4,
                             "travel_distance_m": 43.0 if fails else 0.0})
        figure = self.drawn(talus_compare.outcomes(self.runs(rows), {})[2]["outcomes"])
        ranges = {axes.get_xlim() for axes in figure.axes}
        self.assertEqual(len(ranges), 1)
        self.assertTrue(3 < next(iter(ranges))[0] < 4 and 10 < next(iter(ranges))[1] < 11, ranges)
        said = talus_runs.MARKS["never"][2]
        self.assertEqual([list(line.get_xdata()) for line in figure.axes[0].lines if line.get_label() == said], [[4, 7, 10], [7, 10]])  # without a failure
        self.assertIn(said, [text.get_text() for text in figure.legends[0].get_texts()])

    VARIABLES = [{"name": "c", "unit": "kPa", "numeric": True, "random": True}, {"name": "rise", "unit": "m", "numeric": True, "random": False},
                 {"name": "drain", "unit": "", "numeric": False, "random": False}]

    def paired(self):
        """Eight samples of a strength, each with two levels and two drains: soil slides at the upper level alone, in six of eight samples."""
        rows = []
        for c in range(8):
            for rise in ("0", "3"):
                for drain in ("shut", "open"):
                    way = 10.0 - c if rise == "3" and c < 6 else 0.0
                    rows.append({"c": str(c), "rise": rise, "drain": drain, "failure": "", "state": FAILS if way else STANDS, "fails": bool(way), "way": way})
        return rows

    def test_lists_and_choices_beside_distributions_have_a_probability_each(self):
        cases = talus_study.cases_of(self.paired(), self.VARIABLES)
        self.assertEqual(list(cases), ["rise = 0 m, drain = shut", "rise = 0 m, drain = open", "rise = 3 m, drain = shut", "rise = 3 m, drain = open"])
        found = [talus_study.probability(rows, {"name": "slide", "outcome": "fails", "side": "above", "limit": 0.5}, 0.95) for rows in cases.values()]
        self.assertEqual([(p["met"], p["runs"]) for p in found], [(0, 8), (0, 8), (6, 8), (6, 8)])  # n is the number of samples
        self.assertEqual(list(talus_study.cases_of(self.paired(), self.VARIABLES[:1])), [""])
        # without distributions a list is a variable of the fit, and a choice that is no number has a fit per value
        listed = [v | {"random": False} for v in self.VARIABLES]
        self.assertEqual(list(talus_study.cases_of(self.paired(), listed)), ["drain = shut", "drain = open"])

    def test_pictures_of_a_study_have_a_curve_and_a_panel_per_case(self):
        others = [f"other{k}" for k in range(4)]
        rows = [row | {"run": k} | {other: row["way"] + 1 for other in others} for k, row in enumerate(self.paired())]
        _, page, pictures, _ = talus_study.study(self.runs(rows, ["way", *others]), self.DESIGN | {"variables": self.VARIABLES})
        fits = page["sensitivities"][:4]
        self.assertEqual([bool(fit["bars"]) for fit in fits], [False, False, True, True])
        self.assertEqual({len(fit["bars"]) for fit in fits if fit["bars"]}, {1})  # the strength: the others do not vary in a case
        tornado, exceedance, scatter = (self.drawn(pictures[name]) for name in ("tornado", "exceedance", "scatter"))
        cases = [fit["case"] for fit in fits]
        self.assertEqual([axes.get_title(loc="right").split("\n")[0] for axes in tornado.axes[:4]], cases)
        self.assertEqual(len({axes.get_xlim() for axes in tornado.axes[:4]}), 1)
        for axes in exceedance.axes:
            self.assertEqual([line.get_label() for line in axes.lines], [f"{case}: 8 runs" for case in cases])
        self.assertEqual(len({round(axes.get_position().x0, 2) for axes in exceedance.axes}), 3)  # five panels, three in a row
        self.assertLess(exceedance.get_figwidth(), 14)
        self.assertTrue(set(cases) < {text.get_text() for text in scatter.legends[0].get_texts()})

    def test_quantiles_of_a_tornado_are_of_the_runs_with_the_outcome(self):
        rows = [{"c": str(k), "factor_of_safety": float(k) if k > 10 else None} for k in range(1, 31)]
        variable = {"name": "c", "unit": "Pa", "numeric": True, "random": True}
        fit = talus_study.sensitivities(rows, [variable], "factor_of_safety")
        self.assertEqual(fit["runs"], 20)
        self.assertAlmostEqual(fit["bars"][0]["quantiles"][0], 11 + 0.1 * 19)
        chosen = talus_study.sensitivities(rows, [variable | {"random": False}], "factor_of_safety")["bars"][0]  # who chose the values gets no quantiles of them
        self.assertEqual(chosen["ends"], [11, 30])
        self.assertNotIn("quantiles", chosen)


class Mechanisms(unittest.TestCase):
    def test_are_a_field_on_cells_with_soil_and_arrows_where_it_moves(self):
        nodes = np.array([(0.0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)])
        cells = np.array([(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4)])
        points = np.array([(0.6, 0.3), (0.3, 0.6)])  # of the left half; the right one is air
        triangles, values = talus_factor.field_of_cells(types.SimpleNamespace(mesh=lambda: (nodes, cells)), points, np.array([1.0, 3.0]))
        self.assertEqual(sorted(map(tuple, triangles.triangles)), [(0, 1, 4), (0, 4, 3)])
        self.assertEqual((values[1], values[3], values[4]), (1, 3, 2))
        place, way = talus_factor.arrows_of(np.array([(0.0, 0), (10, 0)]), np.array([(0.0, 0), (0, 5)]))
        self.assertEqual(place.tolist(), [[10, 0]])
        self.assertGreater(way[0, 1], 0)

    def test_leave_the_eye_some_room_between_arrows(self):
        place = np.stack(np.meshgrid(np.linspace(0, 60, 241), np.linspace(0, 20, 81)), axis=-1).reshape(-1, 2)
        arrows, way = talus_factor.arrows_of(place, np.ones_like(place))
        self.assertLess(len(arrows), 300)
        self.assertLess(np.linalg.norm(way, axis=1).max(), 1.5 * np.diff(np.unique(np.round(arrows[:, 0], 6))).max())  # not over its next but one

    def figure(self, draw):
        seen = []
        with unittest.mock.patch.object(talus_factor.style, "save", lambda figure, path: seen.append(figure)):
            draw()
        return seen[0]

    def test_fill_the_width_of_their_picture(self):
        nodes = np.array([(0.0, 0), (60, 0), (60, 20), (0, 20)])
        place = nodes[[0, 2, 3]] * 0.98 + 0.1
        last = types.SimpleNamespace(position=lambda: place, scalar=lambda field: (np.ones(3), "-"), values=lambda field: np.ones((3, 2)))
        results = types.SimpleNamespace(snapshots=[last], mesh=lambda: (nodes, np.array([(0, 1, 2), (0, 2, 3)])), title="")
        factor = {"mechanisms": [{"slip_surface_m": [[0, 20], [60, 0]], "factor_of_safety": {"value": 1.2, "decided": True}}]}
        figure = self.figure(lambda: talus_factor.draw_mechanism(results, factor, "", None))
        figure.canvas.draw()
        section = figure.axes[0].get_window_extent().transformed(figure.transFigure.inverted())
        self.assertLess(section.x0, 0.12)
        self.assertGreater(section.width, 0.7)
        # below the axis a second line of words was cut off in a low section
        self.assertEqual(figure.axes[0].get_xlabel(), "x [m]")
        self.assertIn("whose size is free", figure.axes[0].get_title(loc="left"))


class RigidBodies(unittest.TestCase):
    def test_stand_where_the_history_says(self):
        # a quarter turn about the centre, while it moves to x = 5
        history = {"wall_x_m": np.array([1.0, 5.0]), "wall_y_m": np.array([2.0, 2.0]), "wall_rotation_deg": np.array([0.0, 180.0])}
        body = {"name": "wall", "polygon": [[0, 1], [2, 1], [2, 3], [0, 3]], "centre": [1, 2]}

        class Rows(dict):
            time = np.array([0.0, 2.0])

        results = types.SimpleNamespace(_rigid=[body], history=Rows(history))
        np.testing.assert_allclose(Results.rigid_outlines(results, 1.0)["wall"], [[4, 1], [4, 3], [2, 3], [2, 1]], atol=1e-12)


if __name__ == "__main__":
    unittest.main()
