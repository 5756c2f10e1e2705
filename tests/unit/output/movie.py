"""The clock of a film and its files: argument 1 is the folder of the scripts."""

import contextlib
import io
import pathlib
import shutil
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np
from PIL import Image

sys.path.insert(0, sys.argv.pop(1))
import talus_movie as movie  # noqa: E402


class Particles:
    """A snapshot of two particles, of which one has moved."""

    def __init__(self, time, stage, way):
        self.time, self.stage, self._way = time, stage, way

    def ids(self):
        return np.arange(2)

    def position(self):
        return np.array([[0.0, 0.0], [self._way, 0.0]])


def slope():
    """40 s of rain in which the soil creeps, then 8 s in which it slides by 1 m/s; a snapshot each 0.25 s."""
    rain = [Particles(0.25 * n, "rain", 1e-4 * n) for n in range(161)]
    return rain + [Particles(40 + 0.25 * n, "slide", 0.016 + 0.25 * n) for n in range(1, 33)]


class Clock(unittest.TestCase):
    def test_the_slide_has_one_pace_and_the_rain_is_shortened(self):
        pace = movie.paces(slope())
        self.assertEqual(set(pace[:160]), {(50.0, True)})  # 40 s before the slide in the nearest of 10, 20, 50 to 1 s
        self.assertEqual(set(pace[160:]), {(1.0, False)})

    def test_slow_soil_that_is_fast_later_in_its_stage_is_shortened_up_to_there(self):
        for snapshot in (snapshots := slope()):
            snapshot.stage = "all"
        self.assertEqual(movie.paces(snapshots)[159:161], [(50.0, True), (1.0, False)])

    def test_what_is_slow_after_the_slide_has_the_rest_of_the_time_for_slow_parts(self):
        rest = [Particles(48 + n, "rest", 8.016) for n in range(1, 101)]  # 100 s in the nearest of 10, 20, 50 to 2 s
        self.assertEqual(set(movie.paces(slope() + rest)[-100:]), {(50.0, True)})

    def test_frames_follow_the_clock(self):
        film = movie.timeline(slope())
        frames = sum(count for _, count, _ in film)
        self.assertEqual(frames, movie.FIRST + movie.LAST + 8 + 80 + 1)  # 0.8 s at fifty times the pace, 8 s in real time
        self.assertEqual({count for snapshot, count, _ in film[1:-1] if snapshot.stage == "slide"}, {2, 3})  # 0.25 s each
        self.assertEqual(film[-1][0].time, 48)
        for snapshot, _, pace in film[1:]:
            self.assertEqual(pace, "real time" if snapshot.time > 40 else "shortened: 50 × real time", snapshot.time)

    def test_a_run_without_motion_is_no_division_by_zero(self):
        still = [Particles(time, "hold", 0.0) for time in (0, 1, 1, 2)]  # two at one time, as after a resume
        self.assertEqual({factor for factor, _ in movie.paces(still)}, {2.0})  # four snapshots a second at the least
        self.assertEqual(movie.timeline(still)[-1][0].time, 2)

    def test_a_slide_with_few_snapshots_is_told_with_what_would_be_enough(self):
        self.assertEqual(movie.tell_of_few(slope()), "")
        few = [snapshot for snapshot in slope() if snapshot.time <= 40 or snapshot.time % 2 == 0]
        self.assertIn("moves in 4 of the snapshots only, in the stage slide: a run with output.interval = 0.2 s", movie.tell_of_few(few))  # 8 s in 40 parts

    def test_paces_are_said_in_words(self):
        self.assertEqual([movie.pace_in_words(movie.round_factor(factor), False) for factor in (1.2, 86400, 0.04, 0)],
                         ["real time", "100,000 × real time", "1/20 of real time", "real time"])


class Files(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)
        random = np.random.default_rng(1)
        self.frames = []
        for n in range(3):
            image = np.full((301, 1201, 3), 255, np.uint8)
            image[100:, 400:] = random.integers(0, 255, (201, 801, 3))
            image[:100, 400:] = random.integers(249, 255, (100, 801, 1))  # nearly white, as beside letters
            path = self.folder / f"{n:05}.png"
            Image.fromarray(image).save(path)
            self.frames.append((path, n + 1))

    def test_the_gif_has_the_durations_and_white_paper(self):
        movie.write_gif(self.frames, self.folder / "film.gif")
        with Image.open(self.folder / "film.gif") as film:
            self.assertEqual(film.n_frames, 3)
            self.assertEqual(film.width, movie.GIF_PIXELS)
            self.assertEqual(film.convert("RGB").getpixel((5, 5)), (255, 255, 255))
            durations = []
            for k in range(3):
                film.seek(k)
                durations.append(film.info["duration"])
        self.assertEqual(durations, [100, 200, 300])

    def test_a_gif_that_is_too_large_becomes_narrower(self):
        with mock.patch.object(movie, "GIF_BYTES", 60_000):
            movie.write_gif(self.frames, self.folder / "film.gif")
        self.assertLessEqual((self.folder / "film.gif").stat().st_size, 60_000)

    def test_an_ffmpeg_that_fails_leaves_no_file_and_says_why(self):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            self.assertEqual(movie.write_mp4(shutil.which("false"), self.frames, self.folder / "film.mp4"), "")
        self.assertIn("no MP4 was written", said.getvalue())
        self.assertFalse((self.folder / "film.mp4").exists())

    @unittest.skipUnless(shutil.which("ffmpeg"), "there is no ffmpeg")
    def test_an_odd_size_is_no_obstacle_to_the_mp4(self):
        self.assertIn("film.mp4", movie.write_mp4(shutil.which("ffmpeg"), self.frames, self.folder / "film.mp4"))
        self.assertEqual((self.folder / "film.mp4").read_bytes()[4:8], b"ftyp")


if __name__ == "__main__":
    unittest.main()
