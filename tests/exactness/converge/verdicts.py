"""The verdict of `talus converge` on numbers: argument 1 is the folder of the scripts."""

import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))
from talus_statistics import settles  # noqa: E402
from talus_compare import judge  # noqa: E402


def rows(**columns):
    """Runs with cells of 0.4, 0.2 and 0.1 m that fail, with these quantities."""
    runs = [{"value": size, "unit": "m", "failure": "", "state": "fails", "cell_m": size, "largest_displacement_m": 2.0} for size in (0.4, 0.2, 0.1)]
    for key, values in columns.items():
        for run, value in zip(runs, values):
            run[key] = value
    return runs


def halved(values, least=0.0):
    """The verdict on values at sizes that halve from one to the next."""
    return settles([0.5 ** k for k in range(len(values))], values, 0.05, least)


class Verdicts(unittest.TestCase):
    def test_equal_within_the_tolerance_counts_from_largest_to_least(self):
        self.assertEqual(halved([1.02, 0.98, 1.0]), "equal")
        self.assertEqual(halved([0.97, 1.03, 1.0, 1.03, 1.0]), "swings")  # each within 3 % of the finest, but 6 % apart

    def test_a_sequence_settles_only_by_an_order_of_convergence(self):
        self.assertEqual(halved([1.2, 1.04, 1.0]), "settles")  # order 2
        self.assertEqual(halved([1.08, 1.0, 1.049]), "swings")
        self.assertEqual(halved([1.12, 1.0, 1.01]), "swings")  # the last two are near, but not on one way
        self.assertEqual(halved([1.5, 1.2, 1.06, 1.0]), "open")  # order 1, but changes by 6 % at last
        self.assertEqual(halved([1.1, 1.04, 1.0]), "open")  # order 0.6: 4 % at last, and 8 % more up to the limit
        self.assertEqual(halved([1.2, 1.001, 1.0]), "open")  # order 7.6: the last two are near by chance
        self.assertEqual(halved([1.2, 1.0, 1.0]), "open")

    def test_sizes_count(self):
        close = (0.707, 0.4, 0.354)  # the changes of an error of order 2 are as 9.8 to 1
        values = [1 + 0.3 * size**2 for size in close]
        self.assertEqual(settles(close, values, 0.05), "settles")
        self.assertEqual(halved(values), "open")
        self.assertEqual(settles((0.8, 0.4, 0.2), [13.04, 11.60, 11.47], 0.05), "open")

    def test_a_place_is_known_to_a_cell(self):
        self.assertEqual(halved([3.4, 3.0, 3.2], least=0.4), "equal")
        self.assertEqual(halved([3.5, 3.0, 3.45], least=0.4), "swings")

    def test_that_some_fail_and_some_stand_is_the_verdict(self):
        runs = rows(state=["fails", "stands", "fails"], largest_displacement_m=[2.0, 0.01, 2.1])
        sentences, decides, _ = judge(runs, "cells", 0.05)
        self.assertTrue(decides)
        self.assertEqual(sentences, ["The slope fails with 0.4 m, 0.1 m and stands with 0.2 m: the cell size decides whether it fails."])

    def test_a_motion_of_less_than_a_cell_is_said(self):
        runs = rows(state=["moves", "fails", "fails"], largest_displacement_m=[0.3, 0.6, 0.9])
        self.assertEqual(judge(runs, "cells", 0.05)[0][0], "The slope fails with 0.2 m, 0.1 m and moves with 0.4 m: the cell size decides whether it fails.")
        self.assertEqual(judge(rows(state=["moves"] * 3), "cells", 0.05)[0][0], "The slope moves in all 3 runs.")

    def test_equal_displacements_do_not_divide_runs_into_failing_and_standing(self):
        runs = rows(state=["fails", "moves", "fails"], largest_displacement_m=[0.401, 0.399, 0.402])  # about the size of a cell
        self.assertFalse(judge(runs, "cells", 0.05)[1])

    def test_the_load_may_be_settled_while_the_run_out_is_not(self):
        runs = rows(load_time_of_failure_s=[13.2, 13.4, 13.3], crest_displacement_m=[6.0, 4.0, 5.0])
        sentences, decides, judged = judge(runs, "cells", 0.05)
        self.assertTrue(decides)
        self.assertIn("The load time of failure is 13.2 to 13.4 s, 1.5 % apart: the cell size does not decide it within 5 %.", sentences)
        self.assertIn("The crest displacement is 4 to 6 m, 40 % apart: it swings, and the cell size decides it.", sentences)
        self.assertEqual([(one["quantity"], one["state"]) for one in judged],
                         [("load_time_of_failure_s", "equal"), ("largest_displacement_m", "equal"), ("crest_displacement_m", "swings")])
        self.assertFalse(judge(rows(load_time_of_failure_s=[13.2, 13.4, 13.3]), "cells", 0.05)[1])

    def test_a_missing_value_is_said_and_decides(self):
        sentences, decides, judged = judge(rows(load_time_of_failure_s=[13.04, None, 11.47]), "cells", 0.05)
        self.assertTrue(decides)
        self.assertIn("The load time of failure is 11.5 to 13 s, 14 % apart and missing with 0.2 m: the cell size decides it.", sentences)
        self.assertIn(("load_time_of_failure_s", "missing"), [(one["quantity"], one["state"]) for one in judged])
        self.assertFalse(judge(rows(load_time_of_failure_s=[None] * 3), "cells", 0.05)[1])

    def test_a_small_last_change_is_none_whatever_the_order(self):
        self.assertEqual(halved([1.06, 1.001, 1.0]), "near")
        self.assertEqual(halved([1.06, 1.01, 1.0]), "settles")
        sentences, decides, _ = judge(rows(crest_displacement_m=[2.12, 2.002, 2.0]), "cells", 0.05)
        self.assertFalse(decides)
        self.assertTrue(any("changes it by 0.1 %, a tenth or less of 5 %, and the cell size does not decide it" in one for one in sentences), sentences)

    def test_what_settles_has_an_order_and_a_limit(self):
        sentences, _, judged = judge(rows(crest_displacement_m=[2.16, 2.04, 2.01]), "cells", 0.05)
        self.assertIn("The crest displacement is 2.01 to 2.16 m, 7.5 % apart: it settles, to 2 m by extrapolation at the order 2, and the last refinement changes it by 1.5 %, "
                      "within 5 %.", sentences)
        self.assertAlmostEqual(judged[-1]["limit"], 2.0)

    def test_places_are_said_to_a_cell(self):
        sentences, decides, _ = judge(rows(travel_distance_m=[3.4, 3.0, 3.2]), "cells", 0.05)
        self.assertFalse(decides)
        self.assertIn("The travel distance is 3 to 3.4 m, 12 % apart: the cell size does not decide it within one cell of 0.4 m.", sentences)

    def test_a_run_that_broke_off_is_no_agreement(self):
        runs = rows() + [{"value": 0.05, "unit": "m", "failure": "a particle left the mesh"}]
        sentences, decides, _ = judge(runs, "cells", 0.05)
        self.assertTrue(decides)
        self.assertEqual(sentences[0], "The run with 0.05 m broke off: a particle left the mesh.")
        self.assertTrue(judge(rows()[:2], "cells", 0.05)[1])  # two runs show nothing


if __name__ == "__main__":
    unittest.main()
