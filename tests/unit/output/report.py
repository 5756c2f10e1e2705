"""A report in a browser without a display, as far as there is one: it loads without an error, plays, and stays small with a million particles.
report.py PLOTS"""

import base64
import html
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import types
import unittest
import zipfile

import numpy as np

sys.path.insert(0, sys.argv.pop())
import talus_play  # noqa: E402
import talus_report  # noqa: E402
from talus_units import in_use, of_column, quantity, text_of, use  # noqa: E402
from talus_loads import value_at  # noqa: E402
from talus_workbook import write_workbook  # noqa: E402
from talus_pdf import MISSING, browser, headless, print_report  # noqa: E402

MOST = 20_000_000  # of a page [bytes]
# what a reader does, and what came of it
DRIVE = """<script>
addEventListener("error", (event) => (document.title = "error: " + event.message));
addEventListener("unhandledrejection", (event) => (document.title = "error: " + event.reason));
const wait = setInterval(() => {
  if (document.title.startsWith("error") || document.documentElement.dataset.ready !== "yes") return;
  clearInterval(wait);
  const slider = document.querySelector("#slide input"), said = document.querySelector("#slide output"), [slide, curve] = document.querySelectorAll("canvas");
  const colours = () => {
    const gl = slide.getContext("webgl"), pixels = new Uint8Array(4 * slide.width * slide.height);
    gl.readPixels(0, 0, slide.width, slide.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels.reduce((sum, value, k) => (sum * 31 + value * (k % 97)) % 1000003, 0);
  };
  const at = [said.textContent, colours()];
  slider.value = 0;
  slider.oninput();
  const first = [said.textContent, colours()];
  curve.onpointermove({ offsetX: 58 + (curve.clientWidth - 70) / 2 });
  document.title = JSON.stringify([at, first, curve.nextSibling.textContent]);
}, 50);
</script>"""


class Frame:
    """A snapshot of particles that go down along x."""

    def __init__(self, k, place):
        self.time, self.step, self.stage, self._k, self._place = float(k), k, "slide", k, place

    def ids(self):
        return np.arange(len(self._place))

    def body(self):
        return np.zeros(len(self._place), int)

    def position(self):
        place = self._place.copy()
        place[:, 0] += 0.1 * self._k * (self._place[:, 1] > 5)
        return place

    def names(self):
        return ["displacement"]

    def __contains__(self, name):
        return name in ("displacement", "volume")

    def scalar(self, name):
        return (0.1 * self._k * (self._place[:, 1] > 5), "m") if name == "displacement" else None

    def column(self, name):
        if name != "volume":
            raise KeyError(name)
        return types.SimpleNamespace(values=np.full((len(self._place), 1), 1000 / len(self._place)))


class History:
    def __init__(self):
        self.time = np.linspace(0, 4, 50)

    def groups(self):
        return {("displacement", "m"): {"crest": 0.1 * self.time}}


def results(count, dimension, states=5):
    place = np.random.default_rng(1).random((count, dimension)) * 10
    frames = [Frame(k, place) for k in range(states)]
    node = np.array(list(np.ndindex(*(2,) * dimension)), float) * 10
    cell = np.array([[0, 1, 2], [1, 2, 3]] if dimension == 2 else [[0, 1, 2, 4], [1, 2, 3, 7], [1, 4, 5, 7], [2, 4, 6, 7]])
    return types.SimpleNamespace(snapshots=frames, history=History(), bodies=["clay"], scene={}, mesh=lambda: (node, cell), up_axis=lambda: dimension - 1,
                                 when=lambda frame: f"t = {frame.time:.1f} s")


class Report(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def page(self, of, extra=""):
        path = self.folder / "report.html"
        body = '<div class="field" id="slide"><figure></figure></div><section id="curves"></section>' + extra + talus_play.scripts(of)
        path.write_text(talus_report.PAGE.format(title="report", css="", body=body, foot=""))
        return path

    @unittest.skipUnless(browser(), "there is no Chromium")
    def test_the_slide_plays_in_plane_strain_and_in_space(self):
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                path = self.page(results(2000, dimension), DRIVE)
                done = subprocess.run(headless(f"--user-data-dir={self.folder / 'profile'}", "--enable-logging=stderr", "--virtual-time-budget=8000", "--dump-dom", path.as_uri()),
                                      capture_output=True, text=True, timeout=120, check=True)
                self.assertEqual([line for line in done.stderr.splitlines() if "CONSOLE" in line and "GPU stall" not in line], [])
                title = html.unescape(re.search("<title>(.*?)</title>", done.stdout)[1])
                (last, of_last), (first, of_first), value = json.loads(title)
                self.assertEqual((last, first), ("t = 4.0 s  ·  slide", "t = 0.0 s  ·  slide"))
                self.assertNotEqual(of_last, of_first)
                self.assertRegex(value, r"t = (1\.9|2\.0)\d* s:  crest 0\.(19|20)")

    def test_a_page_of_a_million_particles_is_small(self):
        self.assertLess(self.page(results(1_000_000, 3, 2)).stat().st_size, MOST // 2)  # the other half is for pictures

    def test_a_report_is_printed_or_the_package_is_named(self):
        path = self.page(results(200, 2))
        if browser():
            self.assertEqual(print_report(path).read_bytes()[:4], b"%PDF")
        elif not shutil.which("weasyprint"):
            self.assertRaisesRegex(ValueError, MISSING, print_report, path)

    def test_begins_with_the_mechanism_of_a_factor_or_with_the_slide(self):
        paths = {name: self.folder / f"{name}.png" for name in ("slide", "mechanism")}
        for name, path in paths.items():
            path.write_bytes(name.encode())
        sections = [("displacement", paths["slide"], None)]
        drawn = talus_report.Drawn([], sections, [], [("mechanism and slip surface", paths["mechanism"])], None, "")
        for one, first in ((drawn, "mechanism"), (drawn._replace(factor=[]), "slide")):
            self.assertIn(base64.b64encode(first.encode()).decode(), talus_report.first_picture(one))
        self.assertNotIn('id="slide"', talus_report.first_picture(drawn))
        self.assertIn('id="slide"', talus_report.slide_of(drawn))  # which plays below

    def test_units_are_those_that_the_scene_asks_for(self):
        self.assertEqual(quantity(20e3, "Pa"), "20 kPa")
        use({"output": {"units": "US"}})
        try:
            self.assertEqual([quantity(of, unit, ".3g") for of, unit in ((20e3, "Pa"), (1e6, "Pa"), (0.03, "m"), (2000, "kg/m3"), (19.62e3, "N/m3"))],
                             ["418 psf", "20.9 ksf", "0.0984 ft", "125 pcf", "125 pcf"])
            self.assertEqual([quantity(of, unit) for of, unit in ((2e3, "J/m"), (2e4, "N/m"), (15, "m³/m"))], ["449.6 ft·lbf/ft", "1.37 kip/ft", "161.5 ft³/ft"])
            self.assertEqual(([round(in_use("m3")[0], 4), in_use("m3")[1]], of_column("crest_largest_speed_m_s")), ([35.3147, "ft³"], ("crest largest speed", "m/s")))
            self.assertEqual((text_of("7 kPa", "Pa"), text_of("1 m", "m"), text_of([[0, 1], [10, 2]], "m")), ("146.2 psf", "3.281 ft", "(0, 3.2808), (32.808, 6.5617) ft"))
        finally:
            use({})
        self.assertEqual((text_of("7 kPa", "Pa"), text_of([[0, 1], [10, 2]], "m")), ("7 kPa", "(0, 1), (10, 2) m"))

    def test_tables_are_a_workbook(self):
        write_workbook(self.folder / "t.xlsx", {"Numbers": [("what", "value"), ("a < b", 1.5), ("none", float("nan"))]})
        with zipfile.ZipFile(self.folder / "t.xlsx") as book:
            sheet = book.read("xl/worksheets/sheet1.xml").decode()
            self.assertIn('name="Numbers"', book.read("xl/workbook.xml").decode())
        self.assertEqual(sheet.count("<row"), 3)
        self.assertIn("<t xml:space=\"preserve\">a &lt; b</t></is></c><c><v>1.5</v></c>", sheet)
        self.assertNotIn("nan", sheet)

    def test_loads_have_values_at_failure(self):
        functions = {"fill": [[0, 0], ["10 s", "20 kPa"]]}
        self.assertEqual(value_at([[0, 0], [20, "2 m"]], 5, {}), 0.5)
        self.assertEqual(value_at("-1000 * t^2", 3, {}), -9000)
        self.assertEqual(value_at(["0", "-fill / 2"], 5, functions), [0, -5000])
        self.assertRaises(ValueError, value_at, "x * t", 1, {})


if __name__ == "__main__":
    unittest.main()
