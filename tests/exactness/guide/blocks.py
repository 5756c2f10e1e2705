"""Each block of section 12 of the guide changes a scene by the rules at the head of that section, and `check` takes the scene:  blocks.py PROGRAM GUIDE"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

GUIDE = pathlib.Path(sys.argv.pop())
PROGRAM = sys.argv.pop()
SECTION = "## 12."
COARSE = "mesh.size=1"  # nothing here depends on the cells


def blocks():
    """The blocks of the section, in order."""
    page = (GUIDE / "README.md").read_text()
    section = page[page.index(SECTION):]
    return re.findall(r"^```toml\n(.*?)^```", section[: section.index("\n## ")], flags=re.M | re.S)


def scene_of(block):
    named = re.match(r"# in (\S+\.toml)", block)
    return named[1] if named else "slope.toml"


def tables_of(text):
    """[[header line, lines below]] of a scene, the first without a header."""
    tables = [["", []]]
    for line in text.splitlines():
        if line.startswith("["):
            tables.append([line, []])
        else:
            tables[-1][1].append(line)
    return tables


def key_of(line):
    return line.split("=")[0].strip() if "=" in line and not line.startswith("#") else None


def changed(scene, block):
    """The scene with the block in it."""
    tables = tables_of(scene)
    if "[[stage]]" in block:
        tables = [table for table in tables if not table[0].startswith("[[stage]]")]
    for header, lines in tables_of(block)[1:]:
        name, _, without = header.partition("# without ")
        name = name.split("#")[0].strip()
        own = next((table for table in tables if table[0].split("#")[0].strip() == name and name != "[[stage]]"), None)
        if own is None:
            tables.append([name, lines])
            continue
        left_out = {word.strip() for word in without.split(",") if word.strip()}
        if missing := left_out - {key_of(line) for line in own[1]}:
            raise ValueError(f"{name} has no {', '.join(missing)} that could be left out")
        left_out |= {key_of(line) for line in lines} - {None}
        own[1] = [line for line in own[1] if key_of(line) not in left_out] + lines
    return "\n".join(line for header, lines in tables for line in [header, *lines]) + "\n"


class Blocks(unittest.TestCase):
    def check(self, text, scene):
        with tempfile.TemporaryDirectory() as folder:
            for path in (*GUIDE.glob("*.csv"),):
                shutil.copy(path, folder)
            (pathlib.Path(folder) / scene).write_text(text)
            return subprocess.run([PROGRAM, "check", scene, "--set", COARSE], cwd=folder, capture_output=True, text=True)

    def test_there_are_all(self):
        self.assertGreaterEqual(len(blocks()), 8)

    def test_each_is_taken(self):
        for block in blocks():
            with self.subTest(block=block):
                scene = scene_of(block)
                before = (GUIDE / scene).read_text()
                text = changed(before, block)
                if scene == "slope.toml":
                    self.assertNotEqual(tomllib.loads(text), tomllib.loads(before), "the block changes nothing")
                done = self.check(text, scene)
                self.assertEqual(done.returncode, 0, text + done.stdout + done.stderr)

    def test_a_block_that_does_not_fit_is_found(self):
        scene = (GUIDE / "slope.toml").read_text()
        self.assertNotEqual(self.check(changed(scene, '[body.clay]\nunit_weight = "18 kN/m3"\n'), "slope.toml").returncode, 0)
        with self.assertRaises(ValueError):
            changed(scene, "[body.clay]    # without unit_weight\nporosity = 0.3\n")


if __name__ == "__main__":
    unittest.main()
