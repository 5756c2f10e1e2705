"""Tables of outcomes fit into the terminal: argument 1 is the folder of the scripts."""

import sys
import unittest

sys.path.insert(0, sys.argv.pop(1))
import talus_runs  # noqa: E402
from talus_table import folded, lines_of  # noqa: E402

ENDED = {"failure": "", "state": "fails", "load_time_of_failure_s": 13.48, "largest_displacement_m": 3.956, "travel_distance_m": 11.65,
         "volume_of_slide_m3": 21.36, "depth_of_slide_m": 3.905, "deepest_at_x_m": 12.3, "steps": 16425, "wall_s": 12.34}
CAUSE = "particle 12 left the mesh at x = 12 m and y = 3 m; make the mesh larger, so that there is room for the soil to move in"


class Tables(unittest.TestCase):
    def test_that_fit_are_one_block(self):
        self.assertEqual(lines_of(["a", "long heading"], [["x", "1"], ["xyz", "22"]], width=20), ["        long", "  a  heading", "  x        1", "xyz       22"])

    def test_columns_without_room_are_another_table_with_the_same_first_column(self):
        lines = lines_of(["run", "one", "two", "three"], [["a", "1.0000", "2.0000", "3.0000"], ["b", "failed"]], width=20)
        self.assertEqual(lines, ["run     one     two", "  a  1.0000  2.0000", "  b  failed", "", "run   three", "  a  3.0000"])

    COLUMNS = {"state": "", **dict.fromkeys(("load_time_of_failure_s", "largest_displacement_m", "travel_distance_m", "volume_of_slide_m3", "depth_of_slide_m"), ".4g"), "steps": ""}

    def test_of_converge_and_compare_fit_into_80_characters(self):
        of = {"line": "cells", "key": "mesh.size", "unit": "m"}
        rows = [ENDED | of | {"value": 0.5657}, of | {"value": 0.4, "failure": CAUSE}, ENDED | of | {"value": 0.2828}]
        lines = talus_runs.table(rows, self.COLUMNS, True, 80)
        self.assertLessEqual(max(map(len, lines)), 80)
        self.assertIn("room for the soil to move in", " ".join(" ".join(lines).split()))
        self.assertIn("[m³/m]", " ".join(lines))

    def test_have_columns_for_lost_soil_and_warnings_where_runs_have_some(self):
        told = {"line": "cells", "key": "mesh.size", "unit": "m", "value": 0.4, "escaped_share": 0.104, "warning_count": 2}
        rows = [ENDED | told, ENDED | told | {"escaped_share": None, "warning_count": 0, "load_time_of_failure_s": None}]
        lines = talus_runs.table(rows, self.COLUMNS, True)
        self.assertEqual([line.split()[-3:] for line in lines[-2:]], [["10.4", "%", "2"], ["0", "%", "0"]])
        self.assertEqual(lines[-1].split()[3], "-")  # a time of failure
        self.assertEqual(talus_runs.losses([ENDED | {"escaped_share": 0.0, "warning_count": 0}]), {})

    def test_measures_are_said_in_words(self):
        self.assertEqual([talus_runs.named(measure) for measure in ("max:crest_displacement_m", "toe_x_m@30", "kinetic_J")],
                         ["largest crest displacement [m]", "toe x [m] at 30 s", "kinetic [J]"])

    def test_sentences_are_folded(self):
        self.assertEqual(folded("one two three", 8), "one two\nthree")


if __name__ == "__main__":
    unittest.main()
