"""What runs of a slope came to, in the report and in the tables of `talus study` and `talus compare`, and what they warned of: outcomes.py PROGRAM"""

import csv
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

PROGRAM = sys.argv.pop()
sys.path.insert(0, subprocess.run([PROGRAM, "--python-path"], check=True, capture_output=True, text=True).stdout.strip())
from talus_outcomes import FAILS, MOVES, STANDS, state_of, write_json  # noqa: E402
from talus_report import key_results  # noqa: E402
from talus_results import Results  # noqa: E402
from talus_sliding import SLOW, sliding, still_moving  # noqa: E402
from talus_study import UNKNOWN, state  # noqa: E402

SECTION = """part,x,y
outline,0,0
outline,30,0
outline,30,8
outline,0,8
interface0,0,6
interface0,8,6
interface0,14,2
interface0,30,2
region_clay,4,1
region_air,25,6
"""
SCENE = """title = "A small slope"
gravity = 9.81
[mesh]
section = "slope.csv"
size = 0.8
[body.clay]
region = "clay"
density = 2000
law = "mohr_coulomb"
young_modulus = "10 MPa"
poisson_ratio = 0.3
cohesion = "6 kPa"
friction_angle = 10
[boundary.base]
kind = "fixed"
[boundary.left]
kind = "roller"
[boundary.right]
kind = "roller"
[[stage]]
name = "slide"
duration = "15 s"
gravity_ramp = "1 s"
until = "rest"
damping = 0.05
[output]
interval = 0.5
[output.point.crest]
position = [8, 6]
"""
STUDY = """scene = "slope.toml"
measures = ["crest_displacement_m@14"]
[variable.strength]
key = "body.clay.cohesion"
unit = "kPa"
kind = "list"
values = [2, 5, 9]
[criterion.failure]
outcome = "fails"
above = 0.5
"""
FACTORS = """scene = "static.toml"
runs = "factor_of_safety"
[variable.angle]
key = "body.clay.friction_angle"
kind = "list"
values = [6, 8]
"""


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))

SLED_SECTION = """part,x,y
outline,0,0
outline,20,0
outline,20,8
outline,0,8
interface0,0,6
interface0,8,6
interface0,8,0
interface1,10,0
interface1,10,1
interface1,11,1
interface1,11,0
region_clay,4,1
region_sled,10.5,0.5
region_air,15,6
b_base,0,0
b_base,9,0
b_ice,9,0
b_ice,20,0
b_left,0,0
b_left,0,8
"""
SLED = """title = "A sled on ice beside soil that stands"
gravity = 9.81
[mesh]
section = "sled.csv"
size = 0.8
[body.clay]
region = "clay"
density = 2000
law = "linear_elastic"
young_modulus = "100 MPa"
poisson_ratio = 0
stress = ["0", "-19620 * (6 - y)", "0", "0"]
[body.sled]
region = "sled"
density = 2000
law = "linear_elastic"
young_modulus = "10 MPa"
poisson_ratio = 0
velocity = ["0.6 + 0 * x", "0 * x"]
stress = ["0", "-19620 * (1 - y)", "0", "0"]
[boundary.base]
kind = "fixed"
[boundary.ice]
kind = "friction"
friction_angle = 0.5
[boundary.left]
kind = "roller"
[[stage]]
name = "slide"
duration = "15 s"
until = "rest"
rest_speed = 0.1
"""


class Outcomes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        static = SCENE.replace('gravity_ramp = "1 s"\nuntil = "rest"\ndamping = 0.05\n', 'kind = "quasi_static"\n')
        for name, text in (("slope.csv", SECTION), ("slope.toml", SCENE), ("static.toml", static), ("study.toml", STUDY), ("factors.toml", FACTORS)):
            (cls.folder / name).write_text(text)
        cls.printed = cls.call("study", "study.toml", "-o", "out", "-j", "2")
        cls.table = rows(cls.folder / "out/study.csv")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def ended(cls, *words):
        done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, cwd=cls.folder)
        if done.returncode:
            raise AssertionError(f"{words} ended with {done.returncode}: {done.stdout} {done.stderr}")
        return done

    @classmethod
    def call(cls, *words):
        return cls.ended(*words).stdout

    def test_a_slide_of_less_than_a_cell_has_a_state_of_its_own(self):
        self.assertEqual([(row["state"], row["fails"]) for row in self.table], [("fails", "True"), ("moves", ""), ("stands", "False")])
        self.assertEqual([row["meets_failure"] for row in self.table], ["yes", "", "no"])
        self.assertIn("the slope fails in 1 runs, moves by less than a cell in 1, stands in 1", self.printed)
        moved, standing = self.table[1:]
        self.assertGreater(float(moved["volume_of_slide_m3"]), 10)
        self.assertGreater(float(moved["depth_of_slide_m"]), 2)
        self.assertEqual([float(standing[name]) for name in ("travel_distance_m", "volume_of_slide_m3", "depth_of_slide_m")], [0, 0, 0])

    def test_the_report_says_the_same(self):
        for k, row in enumerate(self.table):
            cards = {what: (number, note) for what, number, note in key_results(Results(self.folder / f"out/run{k:05d}"))}
            self.assertEqual(cards["State at the end"][0], row["state"])
            shown = float(cards["Largest displacement"][0].split()[0]) / (1000 if " mm" in cards["Largest displacement"][0] else 1)
            self.assertAlmostEqual(shown / float(row["largest_displacement_m"]), 1, delta=0.005)  # three digits
            self.assertAlmostEqual(float(cards["Volume of slide"][0].split()[0]), float(row["volume_of_slide_m3"]), delta=0.05)  # three digits
        self.assertIn("less than a cell of 0.77 m", cards_note(self.folder / "out/run00001"))

    def test_a_slide_that_has_not_come_to_rest_is_one_for_log_screen_and_report(self):
        ends = ["--set", "stage.slide.until=duration", "--set", "stage.slide.duration=3"]
        for cohesion in ("2 kPa", "9 kPa"):
            done = subprocess.run([PROGRAM, "run", "slope.toml", "-o", "moving", "--no-pictures", "--force", "--set", f"body.clay.cohesion={cohesion}", *ends],
                                  capture_output=True, text=True, cwd=self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            results = Results(self.folder / "moving")
            moving = still_moving(results.snapshots[-1], results.snapshots[-1].ids()[sliding(results.snapshots[-1])])
            said, last = "the slide has not come to rest at t = 3 s: ", results.log_lines()[-2]
            if cohesion == "9 kPa":
                self.assertIsNone(moving)
                self.assertNotIn(said, done.stderr)
                continue
            self.assertGreater(moving[0], 0.1)
            self.assertIn(f"{said}{100 * moving[0]:.3g} % of what slid is faster than {SLOW:g} m/s, at up to {moving[1]:.3g} m/s; ", last)
            self.assertTrue(last.endswith("; a longer duration of the stage slide would show where it stops (--resume goes on with it)"), last)
            self.assertIn(last.partition("  ")[2], done.stderr.splitlines()[-3:])
        # soil that stands lowers the speed below which a stage counts as at rest, while a sled slides on ice beside it
        (self.folder / "sled.csv").write_text(SLED_SECTION)
        (self.folder / "sled.toml").write_text(SLED)
        done = self.ended("run", "sled.toml", "-o", "moving", "--no-pictures", "--force").stderr
        self.assertIn("stage slide ended: the rms speed of all soil is below rest_speed = 0.1 m/s, but ", done)
        self.assertNotIn("came to rest", done)
        self.assertIn("the rms speed of all soil is below rest_speed, and a smaller rest_speed of the stage slide would show where it stops", done)

        # damped soil that sets out is slower than a large limit for longer than 200 steps, 0.7 s; it slows down after 2 s
        self.ended("run", "slope.toml", "-o", "damped", "--no-pictures", "--force", "--set", "body.clay.cohesion=4 kPa", "--set", "stage.slide.damping=0.8",
                   "--set", "stage.slide.gravity_ramp=0", "--set", "stage.slide.rest_speed=0.1", "--set", "stage.slide.duration=6")
        self.assertGreater(float(rows(self.folder / "damped/history.csv")[-1]["time_s"]), 2)

        # the run goes on with a smaller one
        done = self.ended("run", "sled.toml", "-o", "moving", "--no-pictures", "--resume", "--set", "stage.slide.rest_speed=0.01").stderr
        self.assertIn("since then the scene has another stage.0.rest_speed", done)
        self.assertIn("stage slide came to rest", done)
        self.assertNotIn("nothing was left to do", done)

    def test_a_slide_that_the_end_of_the_mesh_cuts_off_is_warned_of(self):
        said = " cuts the slide off: soil that lay there has moved by "
        for crest, cut in ((2, True), (20, False)):  # m behind it
            (self.folder / "near.csv").write_text(SECTION.replace("outline,0,0", f"outline,{8 - crest},0").replace("outline,0,8", f"outline,{8 - crest},8").replace(
                "interface0,0,6", f"interface0,{8 - crest},6").replace("region_clay,4,1", "region_clay,7.5,1"))
            (self.folder / "near.toml").write_text(SCENE.replace("slope.csv", "near.csv"))
            done = self.ended("run", "near.toml", "-o", "near", "--no-pictures", "--force", "--set", "body.clay.cohesion=1 kPa", "--set", "stage.slide.duration=4").stderr
            self.assertEqual(f"the end of the mesh at x = {8 - crest} m{said}" in done, cut, done)
        self.ended("run", "slope.toml", "-o", "near", "--no-pictures", "--force", "--set", "body.clay.cohesion=9 kPa")
        self.assertNotIn("cuts the slide off", (self.folder / "near/run.log").read_text())  # soil that stands is not cut off

    def test_a_bottom_of_the_mesh_that_a_slide_reaches_is_warned_of_whatever_the_cells(self):
        said = "the slide reaches the fixed bottom of the mesh at y = "
        wide = SECTION.replace("outline,0,", "outline,-20,").replace("interface0,0,", "interface0,-20,")
        deep = wide.replace("outline,-20,0\noutline,30,0", "outline,-20,-10\noutline,30,-10")
        bare = SECTION.replace("interface0,14,2\ninterface0,30,2", "interface0,20,0")  # a floor without soil in front of the toe
        for section, size, reached in ((wide, 0.8, True), (wide, 0.5, True), (deep, 0.8, False), (bare, 0.8, False)):
            (self.folder / "ends.csv").write_text(section)
            (self.folder / "ends.toml").write_text(SCENE.replace("slope.csv", "ends.csv"))
            done = self.ended("run", "ends.toml", "-o", "ends", "--no-pictures", "--force", "--set", "body.clay.cohesion=2 kPa", "--set", f"mesh.size={size}",
                              "--set", "stage.slide.duration=4").stderr
            self.assertEqual(said in done, reached, f"{size} m: {section} {done}")

    def test_a_rear_that_a_slide_reaches_is_warned_of_though_its_soil_hardly_moves(self):
        root = pathlib.Path(__file__).resolve().parents[3]
        text, said = (root / "meshes/selborne.csv").read_text(), "the slide reaches the end of the mesh at x = "
        for rear, reached in ((-2, True), (-20, False)):  # m; the base of both is 5 m deeper than that of the gallery's scene, whose rear, at 0, is nearly cut off
            section = re.sub(r"^(outline|b_recharge_base|b_recharge_side),(\d+),0$", r"\1,\2,-5", text, flags=re.M)
            (self.folder / "ends.csv").write_text(re.sub(r"^(outline|interface\d|b_recharge_base|b_recharge_side),0,", rf"\1,{rear},", section, flags=re.M))
            (self.folder / "ends.toml").write_text((root / "docs/gallery/selborne_absolute/scene.toml").read_text().replace("../../../meshes/selborne.csv", "ends.csv"))
            done = self.ended("run", "ends.toml", "-o", "ends", "--no-pictures", "--force", "--set", "mesh.size=2", "--set", "output.interval=0").stderr
            self.assertEqual(said in done, reached, done)
            self.assertNotIn("cuts the slide off", done)  # less than 2 % of the largest displacement

    def test_a_point_above_the_ground_names_the_particle_that_is_followed(self):
        for height, far in ((6.0, False), (6.6, True)):
            log = self.ended("run", "slope.toml", "-o", "point", "--no-pictures", "--force", "--set", "stage.slide.duration=0.01", "--set", f"output.point.crest.position=[4, {height}]").stderr
            self.assertEqual("output.point.crest: its position (4, 6.6) m has no particle within half a cell: the one that is followed, the nearest, lies at (" in log, far, log)

    def test_compare_says_the_same(self):
        printed = self.call("compare", "slope.toml", "-o", "compared", "-j", "2", "--no-plot", "--series", "strength: body.clay.cohesion=5 kPa,9 kPa")
        table = rows(self.folder / "compared/study.csv")
        for one, other in zip(table, self.table[1:]):
            for name in ("state", "fails", "largest_displacement_m"):
                self.assertEqual(one[name], other[name])
            self.assertEqual(one["volume_of_slide_m3"], other["volume_of_slide_m3"])  # 0 of a slope that stands
        self.assertRegex(printed, r"\[kPa\] +state")
        self.assertRegex(printed, r"strength +5 +moves")

    def test_a_run_at_rest_has_its_last_row_at_later_times(self):
        for row in self.table:  # all come to rest before 14 s
            self.assertAlmostEqual(float(row["crest_displacement_m@14"]) / float(row["crest_displacement_m"]), 1, delta=1e-5)  # six digits

    def test_values_that_are_none_are_null(self):
        (self.folder / "none.toml").write_text(STUDY.replace("crest_displacement_m@14", "crest_displacement_m@9"))
        late = ["--set", 'set=["stage.slide.until=duration","stage.slide.duration=0.5"]']
        refused = subprocess.run([PROGRAM, "study", "none.toml", "-o", "late", "--no-plot", *late], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("the measure crest_displacement_m@9 asks for t = 9 s, and the stages of the scene end at t = 0.5 s", refused.stderr)
        known = {"failure": "", "strength": "1", "state": "stands", "fails": False, "x": None}
        self.assertEqual(state(known, {"outcome": "x", "side": "below", "limit": 1}), UNKNOWN)
        path = self.folder / "page.json"
        write_json(path, {"a": [math.nan, 1.5], "b": {"c": math.inf, "d": True, "e": 3}})
        self.assertEqual(json.loads(path.read_text(), parse_constant=self.fail), {"a": [None, 1.5], "b": {"c": None, "d": True, "e": 3}})

    def test_warnings_of_the_runs_reach_the_summary(self):
        printed = self.call("study", "factors.toml", "-o", "factors", "-j", "2", "--no-plot")
        said = "the factor of a mechanism of fewer than 10 cells is some per cent too large"
        lines = [line for line in printed.splitlines() if said in line]
        self.assertEqual(len(lines), 1, printed)
        self.assertTrue(lines[0].startswith("warning in 2 of 2 runs, first in run00000: the mechanism from x = "), lines[0])
        self.assertTrue(all(said in row["warnings"] for row in rows(self.folder / "factors/study.csv")))
        warnings = json.loads((self.folder / "factors/study.json").read_text())["warnings"]
        self.assertEqual([(one["runs"], one["first_run"]) for one in warnings if said in one["warning"]], [(2, "run00000")])


def cards_note(folder):
    return next(note for what, _, note in key_results(Results(folder)) if what == "State at the end")


class Soil:
    """Particles of equal mass that moved by `way` and have this plastic strain."""

    def __init__(self, way, strain=None):
        self.snapshots = [self]
        self.fields = {"displacement": np.full(50, way)} | ({} if strain is None else {"plastic_strain": np.full(50, strain)})

    def __contains__(self, name):
        return name in self.fields

    def scalar(self, name):
        return self.fields[name], ""


class States(unittest.TestCase):
    def test_limits(self):
        for way, strain, failed, state in ((1.1, 0.0, False, FAILS), (0.0, 0.0, True, FAILS), (0.5, 0.3, False, MOVES), (0.5, 0.05, False, STANDS),
                                           (0.05, 0.3, False, STANDS), (0.5, None, False, MOVES)):
            self.assertEqual(state_of(Soil(way, strain), 1.0, failed, way), state, (way, strain, failed))


if __name__ == "__main__":
    unittest.main()
