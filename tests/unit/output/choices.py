"""What the pictures of a run choose to show: argument 1 is the folder of the scripts."""

import sys
import types
import unittest

import numpy as np

sys.path.insert(0, sys.argv.pop(1))
from talus_histories import draw_histories, drawn_energies  # noqa: E402
from talus_results import Results  # noqa: E402
from talus_sections import Colours, chosen_snapshots  # noqa: E402


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


class Scales(unittest.TestCase):
    def strain(self, log=False):
        values = types.SimpleNamespace(scalar=lambda field: (np.linspace(0, 1, 1001), "-"))
        return Colours("plastic_strain", [values], log)

    def test_a_twentieth_of_the_largest_strain_is_seen(self):
        self.assertGreater(self.strain().norm(0.05), 0.2)
        self.assertTrue(self.strain().rooted)

    def test_a_logarithmic_scale_has_no_root(self):
        self.assertFalse(self.strain(log=True).rooted)
        self.assertAlmostEqual(float(self.strain(log=True).norm(1e-1)), 2 / 3)


class Energies(unittest.TestCase):
    def test_potential_energy_is_its_change_and_what_stays_is_left_out(self):
        lines = {"kinetic": np.array([0.0, 2.0]), "potential": np.array([6e6, 6e6 - 5]), "escaped_energy": np.zeros(2), "strain": np.full(2, 3.0)}
        drawn = drawn_energies(lines)
        self.assertEqual(list(drawn), ["kinetic", "Δ potential"])
        self.assertEqual(list(drawn["Δ potential"]), [0, -5])


class Histories(unittest.TestCase):
    def test_the_clock_of_the_loads_has_no_picture(self):
        time = np.arange(3.0)
        history = types.SimpleNamespace(time=time, groups=lambda: {("load_time", "s"): {"": time}})
        self.assertEqual(draw_histories(types.SimpleNamespace(history=history), None), [])


class Times(unittest.TestCase):
    def said(self, *snapshots):
        results = types.SimpleNamespace(snapshots=[types.SimpleNamespace(time=time, stage=stage) for time, stage in snapshots])
        return [Results.when(results, snapshot) for snapshot in results.snapshots]

    def test_a_run_of_seconds_is_told_in_seconds(self):
        self.assertEqual(self.said((0, "start"), (2.25, "slide"), (12.5, "slide")), ["t = 0.0 s", "t = 2.2 s", "t = 12.5 s"])

    def test_a_run_of_days_is_told_in_days_and_its_slide_in_seconds_after_them(self):
        self.assertEqual(self.said((0, "start"), (30 * 86400, "seepage"), (45 * 86400, "seepage"), (45 * 86400 + 4.25, "slide")),
                         ["t = 0.0 d", "t = 30.0 d", "t = 45.0 d", "t = 45.0 d + 4.2 s"])


if __name__ == "__main__":
    unittest.main()
