"""What `talus verify --gallery` says at its end."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).with_name("page_numbers.py")
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

    def test_each_column_of_a_study_fails_by_itself(self):
        with tempfile.TemporaryDirectory() as name:
            page = pathlib.Path(name) / "docs" / "gallery" / "small"
            page.mkdir(parents=True)
            (page / "numbers.toml").write_text('[study.sizes]\nabout = "four meshes"\ncommand = "sizes.py TALUS"\nfile = "sizes.csv"\n'
                                               'compare = {crest_m = 0.05, toe_m = 0.05}\nbecause = "of the cells"\n')
            (page / "README.md").write_text("<!-- studies -->\n<!-- end -->\n")
            (page / "sizes.csv").write_text("size_m,crest_m,toe_m\n1,2,3\n")
            (page / "sizes.py").write_text("import pathlib\npathlib.Path('sizes.csv').write_text('size_m,crest_m,toe_m\\n1,4,3.03\\n')\n")
            told = subprocess.run([sys.executable, "-B", SCRIPT, page.parent, "/bin/false", "--long"], capture_output=True, text=True)
            self.assertEqual(told.returncode, 1)
            self.assertRegex(told.stdout, r"crest_m +largest difference  1.00e\+00  tolerance 0.05 FAILS\n +toe_m +largest difference  1.00e-02  tolerance 0.05 holds")

    def test_a_study_finds_what_lies_beside_its_page(self):
        for place in ("docs/gallery/small", "docs/guide"):
            with self.subTest(place), tempfile.TemporaryDirectory() as name:
                page, docs = pathlib.Path(name) / place, pathlib.Path(name) / "docs"
                (docs / "gallery").mkdir(parents=True)
                page.mkdir()
                for file in ("meshes/slope.csv", "docs/theory/table.csv", "docs/gallery/other/part.csv"):
                    (pathlib.Path(name) / file).parent.mkdir(exist_ok=True)
                    (pathlib.Path(name) / file).touch()
                up = "../" * (place.count("/") + 1)
                (page / "numbers.toml").write_text('[study.sizes]\nabout = "four meshes"\ncommand = "sizes.py"\nfile = "sizes.csv"\n'
                                                   'compare = {crest_m = 0.05}\nbecause = "of the cells"\n')
                (page / "README.md").write_text("<!-- studies -->\n<!-- end -->\n")
                (page / "sizes.csv").write_text("size_m,crest_m\n1,2\n")
                (page / "sizes.py").write_text("import pathlib\n" + "".join(
                    f"open('{up}{file}')\n" for file in ("meshes/slope.csv", "docs/theory/table.csv", "docs/gallery/other/part.csv"))
                    + "pathlib.Path('sizes.csv').write_text('size_m,crest_m\\n1,2\\n')\n")
                told = subprocess.run([sys.executable, "-B", SCRIPT, docs / "gallery", "/bin/false", "--long"], capture_output=True, text=True)
                self.assertRegex(told.stdout, r"crest_m +largest difference  0.00e\+00  tolerance 0.05 holds", told.stderr)

    def test_what_a_program_printed_is_on_the_page(self):
        with tempfile.TemporaryDirectory() as name:
            page = pathlib.Path(name) / "docs" / "gallery" / "small"
            page.mkdir(parents=True)
            (page / "numbers.toml").write_text('[study.picture]\nabout = "a picture"\ncommand = ["TALUS draw FOLDER", "write.py TALUS"]\n'
                                               'tables = [{name = "printed", text = "said.txt"}]\n')
            (page / "README.md").write_text("<!-- studies -->\n<!-- end -->\n<!-- picture: printed -->\n<!-- end -->\n")
            (page / "said.txt").write_text("old\n")
            (page / "write.py").write_text("import pathlib\npathlib.Path('said.txt').write_text('the slope\\n\\nfails\\n')\n")

            def verify(*words):
                return subprocess.run([sys.executable, "-B", SCRIPT, page.parent, "/bin/true", *words], capture_output=True, text=True)
            self.assertEqual(verify("--long", "--write").returncode, 0)
            text = (page / "README.md").read_text()
            self.assertIn("<!-- picture: printed -->\n\n    the slope\n\n    fails\n\n<!-- end -->", text)
            self.assertIn("| `talus draw FOLDER`, `write.py TALUS` |", text)
            self.assertEqual(verify("--pages").returncode, 0)
            (page / "said.txt").write_text("the slope\n\nstands\n")
            self.assertEqual(verify("--pages").returncode, 1)

    def test_tables_stand_on_pages_beside_the_first(self):
        with tempfile.TemporaryDirectory() as name:
            page = pathlib.Path(name) / "docs" / "gallery" / "small"
            page.mkdir(parents=True)
            (page / "numbers.toml").write_text(NUMBERS + """
[[verdict]]
quantity = "number of steps"
reference = "about 10"
of = ["slow", "steps"]
is = "same"

[[verdict]]
quantity = "crest"
reference = "-"
talus = "2 m"
is = "chosen"
""")
            (page / "sizes.csv").write_text("size_m,crest_m\n1,2\n")
            (page / "README.md").write_text("<!-- verdict -->\n<!-- end -->\n<!-- studies -->\n<!-- end -->\n")

            def verify(*words):
                return subprocess.run([sys.executable, "-B", SCRIPT, page.parent, "/bin/false", "--pages", *words], capture_output=True, text=True)
            told = verify("--write")
            self.assertEqual(told.returncode, 1)
            self.assertIn("no line <!-- numbers -->", told.stdout)
            (page / "runs.md").write_text("<!-- numbers -->\n<!-- end -->\n")
            self.assertEqual(verify().returncode, 1)
            self.assertEqual(verify("--write").returncode, 0)
            self.assertIn("| number of steps | about 10 | 10 | same |\n| crest | - | 2 m | chosen |\n<!-- end -->", (page / "README.md").read_text())
            self.assertIn("| the scene as it is | steps | 10 | none: exact |", (page / "runs.md").read_text())
            (page / "runs.md").write_text((page / "runs.md").read_text().replace("| 10 |", "| 11 |"))
            told = verify()
            self.assertEqual(told.returncode, 1)
            self.assertIn("tables of runs.md are not made from its numbers.toml", told.stdout)

    def test_a_page_may_leave_out_its_studies_unless_one_is_unchecked(self):
        with tempfile.TemporaryDirectory() as name:
            page = pathlib.Path(name) / "docs" / "gallery" / "small"
            page.mkdir(parents=True)
            (page / "sizes.csv").write_text("size_m,crest_m\n1,2\n")
            (page / "README.md").write_text("<!-- numbers -->\n<!-- end -->\n")
            for study, status in ((NUMBERS, 0), (NUMBERS.replace("[study.sizes]", '[study.sizes]\nunchecked = "takes a day"'), 1)):
                (page / "numbers.toml").write_text(study)
                told = subprocess.run([sys.executable, "-B", SCRIPT, page.parent, "/bin/false", "--pages", "--write"], capture_output=True, text=True)
                self.assertEqual(told.returncode, status, told.stdout)
                self.assertEqual("no line <!-- studies -->" in told.stdout, bool(status))

    def test_a_table_leaves_out_what_it_is_told_to(self):
        with tempfile.TemporaryDirectory() as name:
            page = pathlib.Path(name) / "docs" / "gallery" / "small"
            page.mkdir(parents=True)
            (page / "numbers.toml").write_text(NUMBERS + 'tables = [{name = "crest", rows = ["size_m"], values = ["crest_m"], without = {size_m = ["1", "2"]}}]\n'
                                               + NUMBERS.split("\n\n")[0].replace("slow", "other").replace("the scene", "listed = no").replace(
                                                   'cost =', 'listed = false\ncost =') + "\n")
            (page / "sizes.csv").write_text("size_m,crest_m\n1,2\n2,3\n3,4\n")
            (page / "README.md").write_text("".join(f"<!-- {marker} -->\n<!-- end -->\n" for marker in ("numbers", "studies", "sizes: crest")))
            subprocess.run([sys.executable, "-B", SCRIPT, page.parent, "/bin/false", "--pages", "--write"], check=True, stdout=subprocess.DEVNULL)
            text = (page / "README.md").read_text()
            self.assertIn("| 3 | 4 |", text)
            self.assertNotIn("| 1 | 2 |", text)
            self.assertNotIn("| 2 | 3 |", text)
            self.assertNotIn("listed = no", text)
            told = subprocess.run([sys.executable, "-B", SCRIPT, page.parent, "/bin/false", "--list"], capture_output=True, text=True)
            self.assertIn("listed = no", told.stdout)


if __name__ == "__main__":
    unittest.main()
