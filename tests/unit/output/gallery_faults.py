"""What `talus verify --gallery` says at its end: argument 1 is the folder of the scripts."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(sys.argv.pop(1)) / "talus_numbers.py"
NUMBERS = """[run.slow]
about = "the scene as it is"
scene = "scene.toml"
cost = "quick"
numbers = [{quantity = "steps", measure = "steps", value = 10, tolerance = 0, because = "exact"}]

[study.sizes]
about = "four meshes"
command = "sizes.py TALUS"
file = "sizes.csv"
compare = {crest_m = 0.05}
because = "of the cells"
"""


class Faults(unittest.TestCase):
    def test_what_broke_off_is_named_at_the_end(self):
        with tempfile.TemporaryDirectory() as name:
            page = pathlib.Path(name) / "docs" / "gallery" / "small"
            page.mkdir(parents=True)
            (page / "numbers.toml").write_text(NUMBERS)
            (page / "README.md").write_text("<!-- numbers -->\n<!-- end -->\n<!-- studies -->\n<!-- end -->\n")
            (page / "sizes.csv").write_text("size_m,crest_m\n1,2\n")
            (page / "sizes.py").write_text("raise SystemExit(1)\n")

            def verify(*words):
                return subprocess.run([sys.executable, "-B", SCRIPT, page.parent, "/bin/false", *words], capture_output=True, text=True)
            self.assertEqual(verify("--pages", "--write").returncode, 0)
            told = verify("--long")
            self.assertEqual(told.returncode, 1)
            self.assertTrue(told.stdout.splitlines()[-3].startswith("not all numbers hold that the pages"), told.stdout)
            self.assertEqual(told.stdout.splitlines()[-2:], ["  small: run slow (the scene as it is)", "  small: study sizes (four meshes)"])


if __name__ == "__main__":
    unittest.main()
