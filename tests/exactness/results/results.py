"""The module talus_results on a run of the guide's slope, and the examples of docs/reference/python.md on it:
results.py PROGRAM SOURCES"""

import csv
import pathlib
import re
import runpy
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

SOURCES, PROGRAM = pathlib.Path(sys.argv.pop()), sys.argv.pop()
MODULE = subprocess.run([PROGRAM, "--python-path"], check=True, capture_output=True, text=True).stdout.strip()
sys.path.insert(0, MODULE)
loaded = set(sys.modules)
from talus_results import Results, Table  # noqa: E402

LOADED = set(sys.modules) - loaded
SCENE = SOURCES / "docs/guide/slope.toml"
COARSE = ["mesh.size=0.8", "output.line.down.points=[[12, 5], [12, 0.5]]"]


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def runpy_of(script, *words):
    """The names of a script after it has run here."""
    before, sys.argv = sys.argv, [str(script), *map(str, words)]
    try:
        return runpy.run_path(str(script))
    finally:
        sys.argv = before


class Module(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.slope = cls.folder / "slope"
        cls.call(PROGRAM, "run", SCENE, "-o", cls.slope, "--no-pictures", "--set", *COARSE)
        cls.results = Results(cls.slope)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def call(cls, *words):
        alone = {"PYTHONPATH": MODULE, "PATH": "/usr/bin:/bin", "HOME": str(cls.folder)}  # Open MPI 5 does not start without a home
        done = subprocess.run(list(map(str, words)), capture_output=True, text=True, env=alone)
        if done.returncode:
            raise AssertionError(f"{words} ended with {done.returncode}: {done.stdout} {done.stderr}")
        return done.stdout

    def refused(self, error, words, function, *arguments):
        with self.assertRaises(error) as caught:
            function(*arguments)
        self.assertIn(words, str(caught.exception))

    def test_is_no_load_of_a_plotting_library(self):
        self.assertFalse({name for name in LOADED if name.startswith(("matplotlib", "PIL", "talus_style"))})

    def test_history_is_that_of_the_file(self):
        with open(self.slope / "history.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        history = self.results.history
        self.assertEqual(len(history.time), len(rows))
        self.assertEqual(history["crest_displacement_m"][-1], float(rows[-1]["crest_displacement_m"]))
        self.assertEqual((history.unit("crest_displacement_m"), history.unit("face_velocity_m_s")), ("m", "m/s"))
        self.assertEqual(set(history.names()) | {"time_s", "step", "stage"}, set(rows[0]))
        self.refused(KeyError, "did you mean crest_displacement_m", history.__getitem__, "crest_displacment_m")

    def test_snapshots_are_those_of_the_file(self):
        last = self.results.snapshots[-1]
        with h5py.File(self.slope / "run.h5") as file:
            group = list(file["snapshots"].values())[-1]
            np.testing.assert_array_equal(last.position(), group["position"][...])
            np.testing.assert_array_equal(last.values("velocity"), group["velocity"][...])
            np.testing.assert_array_equal(last.values("stress_xy"), group["stress"][:, 3])
            np.testing.assert_array_equal(last.values("volume"), group["volume"][:, 0])
        self.assertEqual((last.unit("velocity"), last.unit("stress_xy"), last.stage), ("m/s", "Pa", "slide"))
        self.assertIs(self.results.snapshot_at(1e9), last)
        self.assertEqual(self.results.bodies, ["clay"])
        self.refused(KeyError, "did you mean displacement", last.values, "displacment")
        self.refused(KeyError, "did you mean displacement", last.unit, "displacment")

    def test_displacement_counts_from_the_start_of_a_stage(self):
        last, since = self.results.snapshots[-1], self.results.since("slide")
        before = next(one for one, after in zip(self.results.snapshots, self.results.snapshots[1:]) if after.stage == "slide")
        self.assertEqual(since.snapshots[0].time, before.time)
        self.assertEqual(np.abs(since.snapshots[0].values("displacement")).max(), 0)
        np.testing.assert_allclose(since.snapshots[-1].values("displacement"), last.values("displacement") - before.values("displacement"), atol=1e-12)
        np.testing.assert_array_equal(last.values("displacement"), Results(self.slope).snapshots[-1].values("displacement"))
        self.assertEqual(since.history["crest_displacement_m"][0], 0)
        self.assertIs(since.before_reduction(), since)  # as the report asks for it
        self.refused(KeyError, "did you mean slide", self.results.since, "slid")

    def test_lines_and_model_are_read(self):
        line = self.results.lines()["down"]
        self.assertEqual(line["displacement_m"].shape, (len(line.time), len(line["x_m"][0])))
        np.testing.assert_allclose(line["x_m"][0], 12, atol=0.8)
        self.assertIn("stages", " ".join(self.results.model()))
        nodes, cells = self.results.mesh()
        self.assertEqual((nodes.shape[1], cells.shape[1], cells.max() + 1), (2, 3, len(nodes)))

    def test_what_is_no_run_is_refused(self):
        self.refused(FileNotFoundError, "contains no run.h5", Results, self.folder)
        broken = self.folder / "broken"
        broken.mkdir(exist_ok=True)
        data = (self.slope / "run.h5").read_bytes()
        (broken / "run.h5").write_bytes(data[: len(data) // 3])
        self.refused(OSError, "damaged or being written", Results, broken)
        shutil.copy(self.slope / "run.h5", broken / "run.h5")
        self.refused(OSError, "to which it refers, is missing", Results, broken)
        shutil.copytree(self.slope / "run", broken / "run")
        (broken / "history.csv").write_text("time_s,step,stage,crest_x_m\n0,0,gravity,1.5x\n")
        self.refused(OSError, "history.csv is damaged", Results, broken)

    def test_examples_of_the_guide_draw(self):
        python, examples = sys.executable, SOURCES / "docs/guide/results"
        front = self.call(python, "-B", examples / "front.py", self.slope, self.folder / "front.png")
        self.assertIn("the front ends at x = ", front)
        self.assertIn("towards larger x", front)
        self.assertAlmostEqual(float(front.split("=")[1].split()[0]), self.results.snapshots[-1].position()[self.moved(), 0].max(), delta=0.01)
        fastest = max(np.linalg.norm(snapshot.values("velocity"), axis=1).max() for snapshot in self.results.snapshots)
        speed = float(re.search(r"speed of the soil there is (\S+) m/s", front)[1])
        self.assertTrue(0 < speed < fastest + 0.005, (speed, fastest))  # two digits; the front jumps where soil further on begins to count
        profile = self.call(python, "-B", examples / "profile.py", self.slope, "displacement", 12, self.folder / "profile.png", 5, 1e9)
        self.assertEqual(len(profile.splitlines()), 2)
        compared = self.folder / "compared"
        self.call(PROGRAM, "compare", SCENE, "--no-plot", "-o", compared, "--set", *COARSE, "--series",
                  "residual: body.clay.residual_friction_angle=8 deg,17 deg")
        table = Table(compared / "study.csv")
        self.assertEqual((list(table["value"]), list(table["series"]), len(table)), ([8, 17], ["residual"] * 2, 2))
        self.refused(KeyError, "did you mean travel_distance_m", table.__getitem__, "travel_distanc_m")
        self.assertIn("2 runs", self.call(python, "-B", examples / "outcomes.py", compared, self.folder / "outcomes.png"))
        # two keys, and a run without a slide's distance: as if the same runs belonged to two levels of water
        table = [row | {"line": f"residual, water.level={level}"} for level in (0, 3) for row in rows_of(compared / "study.csv")]
        table[0]["travel_distance_m"] = ""
        with open(compared / "study.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, table[0])
            writer.writeheader()
            writer.writerows(table)
        said = self.call(python, "-B", examples / "outcomes.py", compared, self.folder / "two.png")
        self.assertIn("4 runs; the slide travels by ", said)
        self.assertNotIn("nan", said)
        drawn = runpy_of(examples / "outcomes.py", compared, self.folder / "two.png")
        self.assertEqual([text.get_text() for text in drawn["right"].get_legend().get_texts()],
                         [f"residual, water.level={level}: {angle}" for level in (0, 3) for angle in (8, 17)])
        for name in ("front", "profile", "outcomes"):
            self.assertGreater((self.folder / f"{name}.png").stat().st_size, 10000)

    def test_pictures_of_the_slip_surface_and_of_the_stress_paths_are_drawn(self):
        said = self.call(sys.executable, "-B", pathlib.Path(MODULE) / "talus_plot.py", self.slope, "--fields", "stress_xy", "--times", 5, "--slip-surface")
        self.assertIn("[output.line.slip_surface]", said)
        for name in ("stress_xy", "stress_paths", "slip_surface"):
            self.assertEqual((self.slope / f"pictures/{name}.png").read_bytes()[:4], b"\x89PNG")

    def moved(self):
        return np.linalg.norm(self.results.snapshots[-1].values("displacement"), axis=1) > 0.05


if __name__ == "__main__":
    unittest.main()
