"""The arithmetic of a sweep on numbers: measures, references, warnings. Argument 1 is the folder of the scripts."""

import json
import math
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, sys.argv.pop(1))
from talus_results import History  # noqa: E402
from talus_statistics import extrapolate  # noqa: E402
from talus_runs import Runs, measured  # noqa: E402


class References(unittest.TestCase):
    def test_richardson_finds_the_limit_of_a_power(self):
        value, uncertainty, origin = extrapolate([(h, 7 + 3 * h * h) for h in (0.1, 0.2, 0.4)])
        self.assertAlmostEqual(value, 7, delta=1e-12)
        self.assertAlmostEqual(uncertainty, 3 * 0.01, delta=1e-12)
        self.assertEqual(origin, "extrapolated at the observed order 2")

    def test_without_convergence_the_finest_run_is_as_uncertain_as_its_last_changes(self):
        self.assertEqual(extrapolate([(0.1, 5), (0.2, 6), (0.4, 5.5), (None, 1)])[:2], (5, 1))
        self.assertTrue(math.isinf(extrapolate([(0.1, 5)])[1]))
        self.assertAlmostEqual(extrapolate([(0.1, 5), (0.2, 5.1), (0.4, 4)])[1], 1.1, delta=1e-12)  # the last change may be small by chance
        value, uncertainty, _ = extrapolate([(1e-4, 5), (1e-3, 5), (1e-2, 5), (1e-1, 5.2)])  # a tolerance that stability overrules
        self.assertEqual(value, 5)
        self.assertAlmostEqual(uncertainty, 0.2, delta=1e-12)
        self.assertTrue(math.isinf(extrapolate([(0.1, 5), (0.2, 5)])[1]))
        # order 5 in the last three runs, but the fourth turns back
        value, uncertainty, _ = extrapolate([(0.05, 12.0638), (0.1, 12.0541), (0.2, 11.7065), (0.4, 11.7174)])
        self.assertEqual(value, 12.0638)
        self.assertAlmostEqual(uncertainty, 0.3476, delta=1e-12)

    def test_sizes_of_zero_and_sizes_that_repeat_are_no_order(self):
        for sizes in ((0.0, 0.1, 0.2), (0.1, 0.1, 0.1)):
            self.assertEqual(extrapolate(zip(sizes, (1.0, 1.1, 1.3)))[2], "its finest run")


class Histories(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def history(self, stage="fall"):
        (self.folder / "history.csv").write_text(f"time_s,step,stage,x_m\n0,0,start,0\n1,5,fall,4\n2,9,{stage},2\n")

    def test_have_measures(self):
        self.history()
        for measure, value in (("x_m", 2), ("x_m@0.5", 2), ("x_m@2", 2), ("x_m@1.5", 3), ("max:x_m", 4), ("time_s", 2), ("step", 9)):
            self.assertEqual(measured(History(self.folder / "history.csv"), self.folder, measure), value, measure)
        self.assertIsNone(measured(History(self.folder / "history.csv"), self.folder, "y_m"))

    def test_end_with_their_last_row_where_a_run_came_to_rest(self):
        for stage, kind, value in (("slide", "rest", 2), ("slide", "slow", 2), ("slide", "equilibrium", 2), ("fall", "rest", None), ("slide", "duration_over", None),
                                   ("slide", "equilibrium_lost", None), ("slide", "remark", None)):
            self.history("slide")
            events = [{"kind": "remark", "stage": "slide"}, {"kind": kind, "stage": stage}]
            (self.folder / "events.jsonl").write_text("".join(json.dumps(event) + "\n" for event in events))
            self.assertEqual(measured(History(self.folder / "history.csv"), self.folder, "x_m@30"), value, (stage, kind))


class Warnings(unittest.TestCase):
    def test_that_differ_in_numbers_and_their_signs_are_one(self):
        runs = Runs.__new__(Runs)
        runs.rows = [{"folder": "run00000", "warnings": ["moves by -1.5e-3 m at (4, -2)", "moves by 20 m at (-4, 0.5)", "moves by 20 s"]}, {"folder": "run00001", "warnings": []},
                     {"folder": "run00002", "warnings": ["moves by 3 s"]}]
        self.assertEqual(runs.warnings(), [{"warning": "moves by -1.5e-3 m at (4, -2)", "runs": 1, "first_run": "run00000"},
                                           {"warning": "moves by 20 s", "runs": 2, "first_run": "run00000"}])


if __name__ == "__main__":
    unittest.main()
