"""What pictures and report show of a search for a factor of safety that is doubtful: reduced.py FOLDER_OF_THE_SCRIPTS"""

import pathlib
import sys
import tempfile
import types
import unittest
import unittest.mock

import numpy as np

sys.path.insert(0, sys.argv.pop())
import talus_factor  # noqa: E402
from talus_report import bounds, key_results  # noqa: E402
from talus_results import MECHANISM, Results  # noqa: E402

BRACKET = {"decided": True, "value": 1.074, "equilibrium": 1.072, "mechanism": 1.076}


class Snapshot(dict):
    """Three particles that have moved by 0.01 m."""
    time, step, stage = 0.3, 2, "gravity"

    def position(self):
        return np.array([[0.0, 0.0], [1.0, 2.0], [2.0, 5.0]])

    def column(self, name):
        return types.SimpleNamespace(values=np.full((3, 2), 0.01) if name == "displacement" else np.ones(3))

    def scalar(self, name):
        return self.column(name).values, "m"

    def ids(self):
        return np.arange(3)


class Doubts(unittest.TestCase):
    def test_lines_of_a_run_before_the_reduction_are_without_the_mechanism(self):
        folder = pathlib.Path(tempfile.mkdtemp())
        head = "time_s,step,stage,distance_m,displacement_m,displacement_x_m\n"
        (folder / "line_inclinometer.csv").write_text(
            head + "".join(f"{time},{step},{stage},{k},{way},{way}\n" for time, step, stage, way in
                           ((0, 0, "start", 0), (1, 5, "gravity", 0.1), (1.5, 6, MECHANISM, 1.2)) for k in range(3)))
        results = Results.__new__(Results)
        results.folder, results.history = folder, None
        results.snapshots = [types.SimpleNamespace(stage=name) for name in ("start", "gravity", MECHANISM)]
        results._derive = lambda snapshots: None
        self.assertEqual(results.lines()["inclinometer"].moved().max(), 1.2)
        line = results.before_reduction().lines()["inclinometer"]
        self.assertEqual((line.stage, line.moved().max(), line.moved().shape), (["start", "gravity"], 0.1, (2, 3, 1)))
        results.snapshots = results.snapshots[1:]  # as of results since a stage
        self.assertEqual([snapshot.stage for snapshot in results.before_reduction().snapshots], ["gravity"])

    def test_a_stage_without_equilibrium_is_no_state_that_stands(self):
        results = types.SimpleNamespace(snapshots=[Snapshot(displacement=0, volume=0)], bodies=["clay"], history=None, escaped=None, scene={}, up_axis=lambda: 1,
                                        per_metre=lambda unit: unit, events=lambda kind=None: [])
        came_to = {"state": "stands", "cell_m": 1.0, "largest_displacement_m": 0.01, "volume_of_slide_m3": None}
        for lost in ((), ("gravity",)):
            factor = {"factor_of_safety": BRACKET, "flow": "associated", "by_flow": {}, "stages_without_equilibrium": lost}
            with unittest.mock.patch("talus_report.read_factor", lambda results: factor), unittest.mock.patch("talus_report.outcome", lambda results: came_to), \
                    unittest.mock.patch("talus_report.motion_at_end", lambda last: ""), unittest.mock.patch("talus_report.largest_displacement", lambda last: 0.01), \
                    unittest.mock.patch("talus_report.flow", lambda results: None), unittest.mock.patch("talus_report.top_speed", lambda results: None):
                cards = {what: (number, note) for what, number, note in key_results(results)}
            self.assertEqual(cards["State before the strength is reduced"][0], "no equilibrium" if lost else "stands")
            self.assertEqual("stage gravity found no equilibrium" in cards["State before the strength is reduced"][1], bool(lost))

    def test_bounds_stand_beside_the_factor_that_they_bound(self):
        bracket = {flow: BRACKET | {"value": value} for flow, value in (("own", 1.472), ("davis", 1.436), ("associated", 1.491), ("undrained", 1.292))}
        drained = {flow: found for flow, found in bracket.items() if flow != "undrained"}
        for critical, by_flow, said, of in (("undrained", bracket, False, True), ("own", bracket, True, True), ("own", drained, True, False)):
            factor = {"factor_of_safety": bracket[critical], "flow": critical, "by_flow": by_flow, "mechanisms": [{}], "stages_without_equilibrium": ()}
            self.assertEqual(bounds(factor) != "", said)
            lines = talus_factor.factor_lines(factor)
            self.assertEqual("psi = phi as limit equilibrium assumes: 1.491" in lines[-1], True)
            self.assertEqual("bound of the factor with the pore pressure of the stage held, psi = phi" in lines[-1], of)

    def test_an_equilibrium_that_moved_further_than_the_soil_is_high_is_doubted(self):
        for way, doubted in ((3.5, False), (23.65, True)):
            trials = [{"flow": "associated", "search": 1, "factor": 1.142, "outcome": "equilibrium", "displacement_m": way}]
            with unittest.mock.patch.object(talus_factor.style, "save", lambda figure, path: figure):
                figure = talus_factor.draw_displacement({"trials": trials}, "", "", None, 18.0)
            self.assertEqual("displacement has no meaning: the balance of forces alone counts" in figure.axes[0].get_title(loc="left"), doubted)


if __name__ == "__main__":
    unittest.main()
