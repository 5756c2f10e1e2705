"""Numbers of the pages: reruns the scenes behind them, compares, and writes the tables of the pages.

    page_numbers.py GALLERY TALUS [PAGE ...] [--long] [--only NAME] [--write] [--pages] [--list]

GALLERY is docs/gallery, TALUS the program; `./talus verify --gallery` starts this script with both. A page states its numbers once, in a file
numbers.toml beside its README.md:

    [run.scene]                      # one run; the name is free
    about = "the scene as it is"     # first column of the page's table
    scene = "scene.toml"
    set = ["mesh.size=1"]            # overrides, as of `talus run --set`; may be left out, as all below
    ranks = 2
    command = "solve"                # run (the default), solve, or factor_of_safety
    cost = "quick"                   # quick: in ./talus test; long: only with --long
    unchecked = "why"                # not rerun with the present program
    listed = false                   # checked, but not in the page's table
    table = "crack"                  # the table <!-- numbers: crack --> shows this run, in place of <!-- numbers -->
    numbers = [
      {quantity = "crest displacement", measure = "displacement", point = "crest", unit = "m", value = 12.4, tolerance = 0.5, because = "..."},
    ]

A measure is a function of talus_measures.py, or of a file measures.py beside the page; it gives SI units, and `times` (1 if left out) makes the
stated unit of it. Tolerances are absolute, in the stated unit. A study is a command of the page or a list of them, all of which are long; with a `file`
it writes a CSV, without one it draws pictures and runs only with --write. Where it names a `scene`, that is run into FOLDER first, and `copy` takes
pictures from there:

    [study.sizes]
    about = "four meshes"
    command = "sizes.py TALUS run"   # a script beside the page, or "TALUS maps FOLDER"; TALUS becomes the program, FOLDER an empty folder
    scene = "scene.toml"
    copy = {"slope.png" = "pictures/displacement.png"}
    file = "sizes.csv"               # compared row by row in the columns below, by relative tolerances
    compare = {crest_m = 0.05}
    because = "..."
    tables = [{name = "crest", rows = ["eta"], column = "size_m", value = "crest_m", digits = 1}]   # tables of the page, made from the file;
                                     # digits may be "as written" there; without = {column = ["value"]} leaves rows out; {name = "printed", text = "sizes.txt"} shows a file that the study
                                     # writes beside the page as it is

A page with `model = "scene.toml"` at the head of its file shows what that scene models in a picture model.png, which --write draws again; it carries the
digest of the scene, by which --pages finds that it is of another one.

The table at the head of a page compares with a reference. A row names a number of a run, or gives text:

    [[verdict]]
    quantity = "crest displacement"
    reference = "about 4 m"
    of = ["scene", "displacement of the crest"]   # run and quantity; or talus = "4 m" where a study or another command gives the value
    is = "same within 1 %"                        # same, chosen, fitted, differs: why

The tables stand in README.md or in another page (.md) of the folder between the lines `<!-- verdict -->`, `<!-- numbers -->`, `<!-- studies -->` (a list
of them, which a page may leave to --list unless one is unchecked) or `<!-- sizes: crest -->` (a table of a study), and `<!-- end -->`. Between
`<!-- file: crack.toml -->` and `<!-- end -->` a page shows that file of its folder.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "src/output/plots"))
import talus_interrupt  # noqa: E402, F401  before all that takes time

import argparse
import csv
import difflib
import hashlib
import importlib.util
import math
import os
import re
import shutil
import subprocess
import tempfile
import time
import tomllib

from PIL import Image
from PIL.PngImagePlugin import PngInfo

import talus_measures
from talus_results import Results

KNOWN = {"quantity", "measure", "unit", "value", "tolerance", "because", "times", "beside"}  # other keys of a number go to its measure


class Page:
    """A folder with README.md and numbers.toml."""

    def __init__(self, folder):
        self.folder, self.file, self.readme = folder, folder / "numbers.toml", folder / "README.md"
        self.name = folder.name
        stated = tomllib.loads(self.file.read_text())
        self.runs, self.studies, self.model = stated.get("run", {}), stated.get("study", {}), stated.get("model")
        own = folder / "measures.py"
        self.measures = dict(talus_measures.MEASURES)
        if own.exists():
            spec = importlib.util.spec_from_file_location(f"measures_of_{self.name}", own)
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
            self.measures.update(getattr(module, "MEASURES", {}))

    # ---- the file ----

    def state(self, run, quantity, value):
        """Puts a value into numbers.toml, with the digits of its tolerance."""
        self._change(f"run.{run}", rf'(quantity = "{re.escape(quantity)}".*?value = )[^,}}]+', lambda found: found[1] + value)

    def mark_checked(self, section):
        self._change(section, r"unchecked = .*\n", lambda _: "")

    def _change(self, section, pattern, replacement):
        text = self.file.read_text()
        start = re.search(rf"^\[{re.escape(section)}\]$", text, flags=re.M).end()
        later = re.search(r"^\[", text[start:], flags=re.M)
        end = start + later.start() if later else len(text)
        self.file.write_text(text[:start] + re.sub(pattern, replacement, text[start:end], count=1) + text[end:])

    # ---- tables ----

    def tables(self):
        """{marker: lines of the table} of the page."""
        stated = tomllib.loads(self.file.read_text())
        tables = {}
        if stated.get("verdict"):
            tables["verdict"] = table_of_verdict(stated["verdict"], stated.get("run", {}))
        groups = {}
        for name, run in stated.get("run", {}).items():
            if run.get("listed", True):
                groups.setdefault(run.get("table"), {})[name] = run
        for group, runs in groups.items():
            tables[f"numbers: {group}" if group else "numbers"] = table_of_runs(runs, None if group else self.name)
        if stated.get("study"):
            tables["studies"] = table_of_studies(stated["study"])
        for name, study in stated.get("study", {}).items():
            for wanted in study.get("tables", []):
                tables[f"{name}: {wanted['name']}"] = (printed(self.folder / wanted["text"]) if "text" in wanted
                                                       else table_of_study(self.folder / study["file"], wanted, study))
        return tables

    def texts(self):
        """{file: text} of README.md and of the pages beside it."""
        return {file: file.read_text() for file in [self.readme, *sorted(set(self.folder.glob("*.md")) - {self.readme})]}

    def texts_in_step(self):
        """The pages with the tables that their files give. Raises ValueError where a table has no place."""
        texts = self.texts()
        for marker, lines in self.tables().items():
            pattern = rf"<!-- {re.escape(marker)} -->\n.*?<!-- end -->"
            places = [file for file, text in texts.items() if re.search(pattern, text, flags=re.S)]
            if not places:
                if marker == "studies" and not any("unchecked" in study for study in self.studies.values()):
                    continue
                raise ValueError(f"{self.readme} and the pages beside it have no line <!-- {marker} --> with <!-- end --> after its table")
            block = "\n".join([f"<!-- {marker} -->", *lines, "<!-- end -->"])
            for file in places:
                texts[file] = re.sub(pattern, lambda _: block, texts[file], flags=re.S)
        return {file: re.sub(r"<!-- file: (\S+) -->\n.*?<!-- end -->", self._shown, text, flags=re.S) for file, text in texts.items()}

    def _shown(self, found):
        """A file of the folder as a block of a page."""
        language = {".toml": "toml", ".py": "python"}.get(pathlib.Path(found[1]).suffix, "")
        return f"<!-- file: {found[1]} -->\n```{language}\n{(self.folder / found[1]).read_text().rstrip()}\n```\n<!-- end -->"


def decimals(tolerance):
    """Decimal places that show a tenth of a tolerance; none for a tolerance of 0 or above 10."""
    return max(0, 1 - math.floor(math.log10(tolerance) + 1e-9)) if tolerance > 0 else 0


def shown(value, number):
    """A value with the digits that its tolerance is worth."""
    if not math.isfinite(value):
        return "nan"
    if abs(value) >= 1e7:
        return f"{value:.3e}"
    places = decimals(number["tolerance"])
    return f"{value:.{places}f}" if places < 6 else f"{value:.1e}"


def grouped(value, places):
    """A stated value as tables show it: groups of three digits from 10,000 on."""
    if abs(value) >= 1e7 or places >= 6:
        return f"{value:.2g}" if places >= 6 else f"{value:.3e}"
    return f"{value:,.{places}f}" if abs(value) >= 1e4 else f"{value:.{places}f}"


def stated(number):
    return grouped(number["value"], decimals(number["tolerance"]))


def tolerated(number):
    return f"{number['tolerance']:,g}" if number["tolerance"] < 1e6 else f"{number['tolerance']:.2g}"


def unit_of(number):
    return f" {number['unit']}" if number.get("unit") else ""


def title_of(run):
    return run["about"] + (" *(not checked with the present program)*" if "unchecked" in run else "")


def table_of_verdict(rows, runs):
    """A reference, the value of Talus and how they agree, row by row."""
    lines = ["| | reference | Talus | |", "|---|---|---|---|"]
    for row in rows:
        value = row.get("talus")
        if "of" in row:
            run, quantity = row["of"]
            number = {number["quantity"]: number for number in runs[run]["numbers"]}[quantity]
            value = stated(number) + unit_of(number)
        lines.append(f"| {row['quantity']} | {row['reference']} | {value} | {row['is']} |")
    return lines


def table_of_runs(runs, page):
    """One or two runs: a line for each number. More: one line for each run, or for each quantity, whichever gives the longer table. `page` is named below it."""
    quantities = {}
    for run in runs.values():
        for number in run["numbers"]:
            quantities.setdefault(number["quantity"], number)
    beside = any("beside" in number for number in quantities.values())

    def cell(run, quantity, unit):
        number = next((number for number in run["numbers"] if number["quantity"] == quantity), None)
        if not number:
            return ""
        return stated(number) + (f" ± {tolerated(number)}" if number["tolerance"] else "") + (unit_of(number) if unit else "")

    if len(runs) < 3:
        rows = [["run", "quantity", "value", "tolerance"] + ["for comparison"] * beside]
        for run in runs.values():
            for k, number in enumerate(run["numbers"]):
                within = tolerated(number) + unit_of(number) if number["tolerance"] else "none: exact"
                rows.append(["" if k else title_of(run), number["quantity"], stated(number) + unit_of(number), within] + [number.get("beside", "")] * beside)
    elif len(quantities) >= len(runs):
        rows = [["quantity", *(title_of(run) for run in runs.values())] + ["for comparison"] * beside]
        for quantity, number in quantities.items():
            rows.append([quantity, *(cell(run, quantity, True) for run in runs.values())] + [number.get("beside", "")] * beside)
    else:
        rows = [["run", *(quantity + (f" [{number['unit']}]" if number.get("unit") else "") for quantity, number in quantities.items())]]
        rows += [[title_of(run), *(cell(run, quantity, False) for quantity in quantities)] for run in runs.values()]
        if beside:
            rows.append(["for comparison", *(number.get("beside", "") for number in quantities.values())])
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    lines.insert(1, "|" + "---|" * len(rows[0]))
    return lines if page is None else lines + ["", "This table is made from [numbers.toml](numbers.toml), which gives the reasons of the tolerances.",
                    f"`./talus verify --gallery {page}{' --long' if any(run['cost'] == 'long' for run in runs.values()) else ''}` runs the scenes again and compares."]


def commands_of(study):
    given = study.get("command", [])
    return [given] if isinstance(given, str) else given


def printed(path):
    """What a program printed, as a block of a page."""
    return ["", *(f"    {line}".rstrip() for line in path.read_text().splitlines()), ""]


def table_of_studies(studies):
    lines = ["| study | command | gives | repeated with the present program |", "|---|---|---|---|"]
    for study in studies.values():
        command = ", ".join(f"`{re.sub('^TALUS', 'talus', one)}`" for one in commands_of(study) or ["talus run"])
        gives = f"[{study['file']}]({study['file']})" if "file" in study else "pictures"
        lines.append(f"| {study['about']} | {command} | {gives} | {'no: ' + study['unchecked'] if 'unchecked' in study else 'yes'} |")
    return lines


def table_of_study(path, wanted, study):
    """A CSV as a table: one line for each combination of the columns `rows`, one column for each value of `column`."""
    with open(path, newline="") as file:
        rows = [row for row in csv.DictReader(file) if not any(row[column] in values for column, values in wanted.get("without", {}).items())]
    heads, across = wanted["rows"], wanted.get("column")
    columns = list(dict.fromkeys(row[across] for row in rows)) if across else wanted["values"]
    lines = {}
    for row in rows:
        line = lines.setdefault(tuple(row[head] for head in heads), {})
        if across:
            line[row[across]] = row[wanted["value"]]
        else:
            line.update({name: row[name] for name in columns})

    def cell(text):
        try:
            number = float(text)
        except (TypeError, ValueError):
            return text or wanted.get("missing", "-")
        digits = wanted.get("digits", 3)
        if digits == "as written":
            return text
        return f"{number:.{digits}f}" if "." in text or "e" in text else f"{int(number):,}"

    titles = [wanted.get("titles", {}).get(head, head) for head in heads]
    titles += [wanted.get("titles", {}).get(name, f"{across} = {name}" if across else name) for name in columns]
    result = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    result += ["| " + " | ".join([*key, *[cell(line.get(name)) for name in columns]]) + " |" for key, line in lines.items()]
    if "unchecked" in study:
        result += ["", "*Not checked with the present program.*"]
    return result


# ---- runs ----

def launch(talus, run, page, folder):
    """Runs the scene of a run into `folder`; returns its results."""
    command = run.get("command", "run")
    words = [talus, "run" if command == "run" else "solve", str(page.folder / run["scene"]), "-o", str(folder / "run"), "--no-pictures", "--force"]
    words += ["--factor-of-safety"] if command == "factor_of_safety" else []
    for override in run.get("set", []):
        words += ["--set", override]
    if run.get("ranks", 1) > 1:
        words = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(run["ranks"]), *words]
    done = subprocess.run(words, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or ["no message"])[-1])
    (folder / "run" / "printed.txt").write_text(done.stdout + done.stderr)
    return Results(folder / "run")


def check_run(page, name, run, talus, write):
    """Runs, compares and prints; True if every number holds."""
    print(f"{page.name}: {run['about']}", flush=True)
    start, holds, found = time.time(), True, {}
    with tempfile.TemporaryDirectory() as folder:
        try:
            results = launch(talus, run, page, pathlib.Path(folder))
        except (RuntimeError, OSError) as error:
            print(f"  FAIL: {error}")
            return False
        for number in run["numbers"]:
            try:
                arguments = {key: value for key, value in number.items() if key not in KNOWN}
                computed = float(page.measures[number["measure"]](results, **arguments)) * number.get("times", 1)
            except Exception as error:  # a number that cannot be measured does not hold, whatever the cause
                print(f"  {number['quantity']:44s} FAIL: {type(error).__name__}: {error}")
                holds = False
                continue
            found[number["quantity"]] = shown(computed, number)
            difference = float(found[number["quantity"]]) - number["value"]
            good = abs(difference) <= number["tolerance"] * (1 + 1e-9) or (abs(computed) >= 1e7 and abs(computed - number["value"]) <= number["tolerance"])
            holds = holds and good
            print(f"  {number['quantity']:44s} computed {found[number['quantity']]:>12s}  stated {number['value']:>12g}  "
                  f"difference {difference:>10.3g}  tolerance {number['tolerance']:>8g} {number.get('unit', ''):6s} {'holds' if good else 'FAILS'}")
        work = talus_measures.particle_updates(results) if results.history is not None and results.history.step is not None else 0
        print(f"  {run['cost']}: {results.history.step[-1] if work else 0:.0f} steps, {work:.2e} particle-updates, {time.time() - start:.0f} s"
              + (f"; unchecked before: {run['unchecked']}" if "unchecked" in run else ""), flush=True)
    if write and len(found) == len(run["numbers"]):
        for quantity, value in found.items():
            page.state(name, quantity, value)
        page.mark_checked(f"run.{name}")
        return True
    return holds


# ---- studies ----

def copy_beside_the_rest(page, root):
    """A copy of a page's folder in a tree whose other folders lead to the project's own, since scenes and scripts name meshes, programs and other pages."""
    project = next(folder for folder in page.parents if folder.name == "docs").parent
    here = root / page.relative_to(project)
    shutil.copytree(page, here)
    for folder in here.parents:
        for other in (project / folder.relative_to(root)).iterdir():
            if not other.name.startswith(".") and not (folder / other.name).exists():
                (folder / other.name).symlink_to(other)
        if folder == root:
            return here


def check_study(page, name, study, talus, write):
    """Repeats a study: in place if its file is to be written, else in a copy of the page, whose file is then compared row by row."""
    if "file" not in study and not write:
        return True
    print(f"{page.name}: {study['about']}: {', '.join(commands_of(study))}", flush=True)
    start = time.time()
    with tempfile.TemporaryDirectory() as folder:
        here, runs = page.folder, f"{folder}/runs"
        if not write:
            here = copy_beside_the_rest(page.folder, pathlib.Path(folder) / "tree")
        before = (here / study["file"]).read_bytes() if "file" in study and (here / study["file"]).exists() else None
        if before is not None:  # a script that goes on where it was stopped would keep every row
            (here / study["file"]).unlink()
        commands = [[talus, "run", here / study["scene"], "-o", runs, "--force"]] if "scene" in study else []
        for given in commands_of(study):
            first, *words = [{"TALUS": talus, "FOLDER": runs}.get(word, word) for word in given.split()]
            commands.append([*([talus] if first == talus else [sys.executable, "-B", here / first]), *words])
        for command in commands:
            done = subprocess.run(command, cwd=here, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE if command[0] == talus else None, text=True)
            if done.returncode:
                print(f"  FAIL: a command failed: {((done.stderr or '').strip().splitlines() or ['its message is above'])[-1]}")
                if before is not None:
                    (here / study["file"]).write_bytes(before)
                return False
        for picture, source in study.get("copy", {}).items():
            shutil.copy(f"{runs}/{source}", here / picture)
        if write:
            page.mark_checked(f"study.{name}")
            print(f"  written in {time.time() - start:.0f} s")
            return True
        stated, computed = (list(csv.DictReader(open(place / study["file"], newline=""))) for place in (page.folder, here))
    holds = as_many = len(stated) == len(computed)
    for column, tolerance in study["compare"].items():
        worst = 0.0 if as_many else math.inf
        for one, other in zip(stated, computed):
            if one[column] != other[column]:
                try:
                    worst = max(worst, abs(float(other[column]) - float(one[column])) / abs(float(one[column])))
                except (ValueError, ZeroDivisionError):
                    worst = math.inf
        holds = holds and worst <= tolerance
        print(f"  {column:44s} largest difference {worst:9.2e}  tolerance {tolerance:g} {'holds' if worst <= tolerance else 'FAILS'}")
    print(f"  long: {time.time() - start:.0f} s", flush=True)
    return holds


# ---- the picture of the model ----

COLOURS = 64  # of the palette of a picture of lines and flat areas, which takes a quarter of the place so; also colours of few pixels are in it


def digest_of(page):
    return hashlib.sha256((page.folder / page.model).read_bytes()).hexdigest()


def draw_model(page, talus):
    """Draws model.png of the page's scene."""
    with tempfile.TemporaryDirectory() as folder:
        drawn = pathlib.Path(folder) / "model.png"
        subprocess.run([talus, "check", page.folder / page.model, "--picture", drawn], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        mark = PngInfo()
        mark.add_text("scene", digest_of(page))
        Image.open(drawn).convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE).save(page.folder / "model.png", optimize=True, pnginfo=mark)
    print(f"{page.name}: model.png drawn")


def model_in_step(page):
    """Whether the page shows the model of its scene as it is."""
    picture = page.folder / "model.png"
    fault = ("has no picture model.png" if not picture.exists() else "does not show model.png" if not any("](model.png)" in text for text in page.texts().values())
             else "shows the model of another scene" if Image.open(picture).info.get("scene") != digest_of(page) else "")
    if fault:
        print(f"{page.name}: FAIL: {page.readme.name} {fault}: ./talus verify --gallery {page.name} --pages --write")
    return not fault


# ---- commands ----

def pages_of(gallery, names):
    """The pages of these names, or all: folders of the gallery, and the guide beside it."""
    folders = {folder.name: folder for folder in [*sorted(gallery.iterdir()), gallery.parent / "guide"] if (folder / "numbers.toml").exists()}
    unknown = [name for name in names if name not in folders]
    if unknown:
        print(f"talus: no page {', '.join(unknown)} states numbers; there are {', '.join(folders)}", file=sys.stderr)
        sys.exit(2)
    return [Page(folders[name]) for name in names or folders]


def put_in_step(page, write):
    """Writes the page's tables, or says whether they are what its files give."""
    try:
        wanted = page.texts_in_step()
    except KeyError as error:
        print(f"{page.name}: FAIL: numbers.toml or a table of it has no {error}")
        return False
    except (ValueError, OSError) as error:
        print(f"{page.name}: FAIL: {error}")
        return False
    changed = {file: wanted[file] for file, text in page.texts().items() if text != wanted[file]}
    for file, text in changed.items():
        if write:
            file.write_text(text)
            print(f"{page.name}: tables of {file.name} written")
        else:
            print(f"{page.name}: FAIL: tables of {file.name} are not made from its numbers.toml: ./talus verify --gallery {page.name} --pages --write")
    return write or not changed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gallery", metavar="GALLERY", type=pathlib.Path)
    parser.add_argument("talus", metavar="TALUS")
    parser.add_argument("names", metavar="PAGE", nargs="*")
    parser.add_argument("--long", action="store_true", help="the long runs and the studies too")
    parser.add_argument("--write", action="store_true", help="write what is computed into numbers.toml and the pages")
    parser.add_argument("--pages", action="store_true", help="run nothing: are the tables of the pages in step?")
    parser.add_argument("--only", metavar="NAME", action="append", help="of all the page states only this run or study")
    parser.add_argument("--list", action="store_true", help="name the runs and what they cost")
    given = parser.parse_args()
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    faults, start = [], time.time()
    pages = list(pages_of(given.gallery, given.names))
    known = [name for page in pages for name in (*page.runs, *page.studies)]
    for name in given.only or ():
        if name not in known:
            near = difflib.get_close_matches(name, known, 1)
            sys.exit(f"--only {name}: no page has a run or study of this name; " + (f"did you mean {near[0]}?" if near else f"there are {', '.join(known)}"))
    for page in pages:
        if given.list:
            for run in page.runs.values():
                print(f"{page.name:18s} {run['cost']:6s} {run['about']}")
            for study in page.studies.values():
                print(f"{page.name:18s} {'long':6s} {study['about']}: {', '.join(commands_of(study))}")
            continue
        if not given.pages:
            for name, run in page.runs.items():
                if name in given.only if given.only else given.long or run["cost"] == "quick":
                    if not check_run(page, name, run, given.talus, given.write):
                        faults.append(f"{page.name}: run {name} ({run['about']})")
            for name, study in page.studies.items():
                if name in given.only if given.only else given.long:
                    if not check_study(page, name, study, given.talus, given.write):
                        faults.append(f"{page.name}: study {name} ({study['about']})")
        if not put_in_step(page, given.write):
            faults.append(f"{page.name}: tables of its pages")
        if page.model:
            if given.write:
                draw_model(page, given.talus)
            if not model_in_step(page):
                faults.append(f"{page.name}: picture of the model")
    if given.pages and not faults:
        print(f"the tables of the pages in {given.gallery} are in step")
    elif not given.pages and not given.list:
        print(f"{'not all numbers hold' if faults else 'all numbers hold'} that the pages in {given.gallery} state; {time.time() - start:.0f} s")
    for fault in faults:  # each with its cause further up
        print(f"  {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
