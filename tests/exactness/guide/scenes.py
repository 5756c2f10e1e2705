"""The pages of the guide: their scenes are files that the program takes, their commands name keys that exist, and they are short:
scenes.py PROGRAM CXX GUIDE"""

import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

GUIDE = pathlib.Path(sys.argv.pop()).resolve()
CXX = sys.argv.pop()
PROGRAM = str(pathlib.Path(sys.argv.pop()).resolve())
ROOT = GUIDE.parent.parent
SHOWN = re.compile(r"<!-- file: (\S+) -->\n.*?<!-- end -->", flags=re.S)  # `talus verify --gallery guide --pages` compares it with the file
MOST_WORDS = 620, 11000  # of a page, two printed ones; of the guide, each without the files that it shows
COARSE = "mesh.size=2"  # nothing here depends on the cells


def pages():
    return {page.name: page.read_text() for page in sorted(GUIDE.glob("*.md"))}


def scenes():
    return sorted(path for path in GUIDE.glob("*.toml") if path.name != "numbers.toml")


def commands(text):
    """Words of each ./talus command of a page, without the program."""
    text = SHOWN.sub("", text).replace("\\\n", " ")
    for line in re.findall(r"^    \./talus (.*)$", text, flags=re.M):
        yield shlex.split(line.split("   #")[0])


def program(*words, cwd=ROOT):
    return subprocess.run([PROGRAM, *map(str, words)], cwd=cwd, capture_output=True, text=True)


class Scenes(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.copy = pathlib.Path(self.folder.name) / "docs" / "guide"
        shutil.copytree(GUIDE, self.copy)
        (pathlib.Path(self.folder.name) / "tests").symlink_to(ROOT / "tests")
        library = [CXX, "-O2", "-shared", "-fPIC", self.copy / "umat" / "linear_elastic.cpp", "-o", self.copy / "linear_elastic.so"]
        subprocess.run(library, check=True)  # as own_law.md says

    def tearDown(self):
        self.folder.cleanup()

    def taken(self, done):
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_program_takes_each(self):
        for path in scenes():
            with self.subTest(path.name):
                tables = tomllib.loads(path.read_text())
                if "mesh" in tables:
                    self.taken(program("check", path.name, cwd=self.copy))
                elif "material" in tables:
                    self.taken(program("soil", path.name, "-o", "soil", "--no-pictures", cwd=self.copy))
                else:
                    self.taken(program("study", path.name, "--set", "samples=1", "-j", "1", "-o", "study", "--no-plot", cwd=self.copy))

    def test_each_is_shown_on_a_page(self):
        shown = {name for text in pages().values() for name in SHOWN.findall(text)}
        self.assertEqual({path.name for path in scenes()} - shown, {"sand.toml"})

    def test_a_page_shows_no_scene_that_is_no_file(self):
        for name, text in pages().items():
            self.assertNotIn("```toml", SHOWN.sub("", text), name)

    def test_keys_of_the_commands_exist(self):
        tried = 0
        for name, text in pages().items():
            for words in commands(text):
                if words[0] not in ("run", "solve", "check") or not words[1].startswith("docs/guide"):
                    continue
                with self.subTest(page=name, command=" ".join(words)):
                    overrides = words[words.index("--set") + 1:] if "--set" in words else []
                    end = next((k for k, word in enumerate(overrides) if word.startswith("-")), len(overrides))
                    scene = pathlib.Path(words[1]).name
                    coarse = [COARSE] if "size" in tomllib.loads((GUIDE / scene).read_text())["mesh"] and scene != "valley.toml" else []
                    self.taken(program("check", scene, "--set", *coarse, *overrides[:end], *([] if coarse or overrides[:end] else ["title=as it is"]), cwd=self.copy))
                    tried += 1
        self.assertGreater(tried, 15)

    def test_pages_are_short(self):
        words = {name: len(SHOWN.sub("", text).split()) for name, text in pages().items()}
        self.assertLess(sum(words.values()), MOST_WORDS[1])
        for name, count in words.items():
            self.assertLess(count, MOST_WORDS[0], name)

    def test_each_page_is_in_the_index(self):
        index = pages()["README.md"]
        for name in pages():
            self.assertTrue(name == "README.md" or f"]({name})" in index, name)


if __name__ == "__main__":
    unittest.main()
