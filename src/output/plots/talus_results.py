"""Reads what a run of Talus left in its folder. It stands on NumPy and h5py alone; docs/reference/python.md has examples.

    from talus_results import Results
    results = Results("results/slope")
    results.history["crest_displacement_m"]               # over results.history.time, in s
    last = results.snapshots[-1]                          # or results.snapshot_at(12.5)
    last.position(), last.values("velocity")              # [particles, axes], in m and m/s
    results.lines()["inclinometer"].columns               # [times, places]

Units are SI, as in the files. Stress is positive in tension, pore pressure in compression.
"""

import copy
import csv
import functools
import difflib
import json
import pathlib
import tomllib
import typing

import h5py
import numpy as np

from talus_sliding import Thickness
from talus_units import DAY, at_time

NOT_ENDED = "it was killed, or still runs, since run.log has no end"
MECHANISM = "strength reduction"  # stage of the last state after a factor of safety: a mechanism, whose size is free


def unknown(kind, name, names):
    """The error for a name that is not there, with the nearest ones that are."""
    names = sorted(names)
    near = difflib.get_close_matches(name, names, 3) or [each for each in names if name in each][:3]
    return KeyError(f"no {kind} {name!r}; " + (f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(names) or 'none'}"))


class Column:
    """One field of a snapshot: values [particles, components]."""

    def __init__(self, dataset):
        self.values = dataset[...]
        self.unit = dataset.attrs.get("unit", "")
        self.meaning = dataset.attrs.get("meaning", "")
        self.components = dataset.attrs.get("components", "").split()


class Snapshot:
    """One state of the run; columns are read when asked for. `derived` holds functions of the snapshot by the names of the fields that they compute:
    (values, unit)."""

    _room = 64_000_000  # bytes of columns that are kept once they are read, of all snapshots

    def __init__(self, group, derived):
        self._group, self._derived, self._kept = group, derived, {}
        self._before = None  # (numbers of particles, their displacement) at the state from which displacement counts
        self.time = float(group.attrs["time"])
        self.step = int(group.attrs["step"])
        self.stage = group.attrs["stage"] or "start"

    def __contains__(self, name):
        return name in self._group

    def names(self):
        """Names of the fields."""
        return [name for name in self._group if name not in ("id", "body")] + list(self._derived)

    def _read(self, name):
        """A Column of the file, which whoever asks for it may change."""
        if name not in self._kept:
            column = Column(self._group[name])
            if column.values.nbytes > Snapshot._room:
                return column
            Snapshot._room -= column.values.nbytes
            self._kept[name] = column
        column = copy.copy(self._kept[name])
        column.values = column.values.copy()
        return column

    def column(self, name):
        """A field as the file has it. Raises KeyError with the nearest names if there is none of this name."""
        if name not in self._group:
            raise unknown("field", name, self.names())
        column = self._read(name)
        if name == "displacement" and self._before:
            have, moved = self._before
            row = np.minimum(np.searchsorted(have, self.ids()), len(have) - 1)
            column.values = column.values - np.where((have[row] == self.ids())[:, None], moved[row], 0.0)
        return column

    def counted_from(self, before):
        """The same, with the displacement since another snapshot."""
        other = copy.copy(self)
        other._before = before.ids(), before.column("displacement").values
        return other

    def values(self, name):
        """Values of a field: [particles] of a number, [particles, components] of a vector or tensor, of which `stress_xy` is one component
        [particles]. Raises KeyError."""
        if name in self._group:
            values = self.column(name).values
            return values[:, 0] if values.shape[1] == 1 else values
        found = self.scalar(name)
        if found is None:
            raise unknown("field", name, self.names())
        return found[0]

    def unit(self, name):
        """Unit of a field, empty if it has none. Raises KeyError."""
        found = self.scalar(name)
        if found is None:
            raise unknown("field", name, self.names())
        return found[1]

    def position(self):
        """Where the particles are: [particles, axes] in m."""
        return self._read("position").values

    def body(self):
        """Number of each particle's body in Results.bodies: [particles]."""
        return self._read("body").values[:, 0]

    def ids(self):
        """Numbers of the particles, increasing: [particles]. A particle keeps its number over the run."""
        return self._read("id").values[:, 0]

    def scalar(self, name):
        """A field as one number a particle, with its unit; None if there is no such field. Of a vector it is the
        magnitude, of a tensor the mean of the diagonal, or one component: `stress_xy`."""
        if name in self._derived:
            return self._derived[name](self)
        if name in self._group:
            column = self.column(name)
            count = column.values.shape[1]
            if count == 1:
                return column.values[:, 0], column.unit
            if count <= 3:
                return np.linalg.norm(column.values, axis=1), column.unit
            return column.values[:, :3].mean(axis=1), column.unit
        whole, _, component = name.rpartition("_")
        if whole in self._group:
            column = self.column(whole)
            if component in column.components:
                return column.values[:, column.components.index(component)], column.unit
        return None


def of_file(read):
    """A constructor that reads a file of results: whatever is wrong in the file is an OSError that names it."""
    @functools.wraps(read)
    def reads(self, path):
        try:
            read(self, path)
        except UnicodeDecodeError as error:
            raise OSError(f"{path} is damaged: it is no text") from error
        except (ValueError, LookupError, TypeError) as error:
            raise OSError(f"{path} is damaged: {error}") from error
    return reads


class Quantity(typing.NamedTuple):
    """What a column of history.csv is: a quantity of a "point", a "boundary", a "rigid" body, a "contact" or the "run"; `which` names it or the part, such as
    `kinetic` of the energy."""

    quantity: str
    unit: str
    of: str
    which: str


class Columns:
    """`columns` of a table by their names."""

    def __contains__(self, name):
        return name in self.columns

    def __getitem__(self, name):
        """A column [rows, ...], `history["crest_displacement_m"]`. Raises KeyError with the nearest names if there is none of this name."""
        if name not in self.columns:
            raise unknown("column", name, self.columns)
        return self.columns[name]

    def names(self):
        """Names of the columns beside time, stage and step; they end with their unit."""
        return list(self.columns)


class OverTime(Columns):
    """The same with the `time` [s], the `stage` and, where it is known, the `step` of each row."""

    step = None

    def without(self, stage):
        """The same without the rows of a stage."""
        return self.rows(np.flatnonzero([name != stage for name in self.stage]))

    def rows(self, kept):
        """The same with these rows alone, by their numbers."""
        other = copy.copy(self)
        other.time, other.step = self.time[kept], None if self.step is None else self.step[kept]
        other.stage = [self.stage[k] for k in kept]
        other.columns = {name: values[kept] for name, values in self.columns.items()}
        return other


class History(OverTime):
    """history.csv: `time` [rows] in s, `stage` and `step` of each row, and columns of numbers by their names. A line that is not whole is left out,
    and `cut` says so in words. Raises OSError where the file has no rows or is damaged."""

    @of_file
    def __init__(self, path):
        self._path = pathlib.Path(path)
        text = self._path.read_text()
        lines = list(csv.reader(text.splitlines()))
        header = lines[0] if lines else []
        last = len(lines) - (not text.endswith("\n"))  # a line without its end may lack digits
        whole = [k for k in range(1, last) if len(lines[k]) == len(header)]
        rows = [lines[k] for k in whole]
        broken = len(lines) - 1 - len(rows)
        self.cut = "" if broken <= 0 else "its last line is incomplete" if broken == 1 and whole == [*range(1, len(lines) - 1)] else f"{broken} lines are incomplete"
        self.columns = {}
        for k, name in enumerate(header):
            if name != "stage":
                self.columns[name] = np.array([float(row[k]) for row in rows])
        if "time_s" not in self.columns:
            raise OSError(f"{path} is damaged: it has no column time_s")
        self.time = self.columns.pop("time_s")
        self.step = self.columns.pop("step", None)
        self.stage = [row[header.index("stage")] for row in rows] if "stage" in header else [""] * len(rows)

    def missing_rows(self, until):
        """Where rows are missing, in words; empty where none are. A row follows on the one before after an interval that changes at most once in a stage of
        motion, give or take a step; `until` [s] is the time of the last snapshot, which a row is near to."""
        gaps, found = np.diff(self.time), []
        if not len(gaps) or self.step is None:
            return ""
        steps = np.diff(self.step)
        for k, gap in enumerate(gaps):
            beside = [gaps[j] for j in (k - 1, k + 1) if 0 <= j < len(gaps) and self.stage[j + 1] == self.stage[k + 1]]
            if beside and steps[k] > 1 and gap > 1.5 * max(beside) + 2 * gap / steps[k]:
                found.append(f"between {self.time[k]:.6g} and {self.time[k + 1]:.6g} s")
        step = gaps[-1] / max(steps[-1], 1)
        if until > self.time[-1] + 1.5 * max(gaps[-2:]) + 2 * step:
            found.append(f"after {self.time[-1]:.6g} s")
        return "rows are missing " + ", ".join(found[:3]) + " and elsewhere" * (len(found) > 3) if found else ""

    def unit(self, name):
        """Unit of a column, empty if it has none. Raises KeyError."""
        self[name]
        return self.quantities[name].unit

    @functools.cached_property
    def quantities(self):
        """What the columns are, as history_columns.csv beside the file says: {column: Quantity}. Raises OSError without it."""
        with open(self._path.with_name("history_columns.csv"), newline="") as file:
            return {row["column"]: Quantity(row["quantity"], row["unit"].translate(str.maketrans("23", "²³")), row["of"], row["which"]) for row in csv.DictReader(file)}

    def groups(self):
        """{(quantity, unit): {label: values}}; energies are one group, and so is each measure of the named points. A quantity of a boundary is one alone,
        one of a rigid body has its components."""
        groups = {}
        for name, values in self.columns.items():
            quantity, unit, of, which = self.quantities[name]
            if of == "rigid" and quantity[-2:-1] == "_":
                key, label = (f"{which}_{quantity[:-2]}", unit), quantity[-1]
            else:
                key, label = ((f"{which}_{quantity}", unit), "") if of in ("boundary", "rigid", "contact") else ((quantity, unit), which)
            groups.setdefault(key, {})[label] = values
        return groups

    def points(self, time):
        """Where the named points are at a time [s]: {name: coordinates}."""
        names = [one.which for one in self.quantities.values() if (one.of, one.quantity) == ("point", "x")] if len(self.time) else []
        return {name: np.array([np.interp(time, self.time, axis) for axis in self.way(name).T]) for name in names}

    def way(self, point):
        """The coordinates of a named point over time [rows, axes]."""
        return np.column_stack([self.columns[f"{point}_{axis}_m"] for axis in "xyz" if f"{point}_{axis}_m" in self.columns])

    def stage_starts(self):
        """[(time, name)] of the stages. A stage begins at the last row of the one before; its own first row comes an interval later."""
        return [(self.time[max(0, k - 1)], name) for k, name in enumerate(self.stage) if k == 0 or name != self.stage[k - 1]]


def read_factor(results):
    """factor_of_safety.json of the run; None where none was asked for."""
    path = results.folder / "factor_of_safety.json"
    return json.loads(path.read_text()) if path.exists() else None


def together(values):
    """The names [[name, ...], ...] of a dictionary, those with the same values together, in its order: points that are the same particle."""
    groups = {}
    for name, numbers in values.items():
        groups.setdefault(np.asarray(numbers).tobytes(), []).append(name)
    return list(groups.values())


class Escaped(Columns):
    """escaped.csv: the particles that left the mesh, in the order of time."""

    @of_file
    def __init__(self, path):
        with open(path, newline="") as file:
            table = csv.DictReader(file)
            names, rows = table.fieldnames or (), list(table)
        if "time_s" not in names:
            raise ValueError("it has no column time_s")
        self.body = [row["body"] for row in rows]
        self.group = [row.get("group", "") for row in rows]  # of faces by which it left; empty where these have no name
        self.columns = {name: np.array([float(row[name]) for row in rows]) for name in names if name not in ("body", "group")}
        self.time = self.columns["time_s"]
        self.position = np.column_stack([self.columns[f"{axis}_m"] for axis in "xyz" if f"{axis}_m" in self.columns] or [self.time])


class Line(OverTime):
    """A line that was followed with the soil, line_NAME.csv: columns [times, places] by their names, `time` in s and `stage` of each time."""

    @of_file
    def __init__(self, path):
        self.name = path.stem.split("_", 1)[1]
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        self.stage = [row["stage"] for row in rows]
        times = np.array([float(row["time_s"]) for row in rows])
        starts = np.flatnonzero(np.diff(times, prepend=-np.inf))
        places = int(np.diff(np.append(starts, len(times))).min()) if len(times) else 0
        self.columns = {}
        for name in rows[0] if rows else ():
            if name not in ("time_s", "step", "stage"):
                values = np.array([float(row[name]) for row in rows])
                self.columns[name] = np.array([values[start:start + places] for start in starts])
        self.time, self.stage = times[starts], [self.stage[start] for start in starts]

    def moved(self):
        """Displacement of each place since the start or the last reset [m], by axis: [times, places, axes]."""
        return np.stack([self.columns[f"displacement_{axis}_m"] for axis in "xyz" if f"displacement_{axis}_m" in self.columns], axis=2)


class Table(Columns):
    """A table of outcomes that `talus study`, `compare` or `converge` wrote (study.csv): columns by their names, as numbers
    [rows] where all of its entries are numbers or empty (then NaN), otherwise as text [rows]."""

    @of_file
    def __init__(self, path):
        with open(path, newline="") as file:
            lines = [row for row in csv.reader(file) if row]
        if not lines:
            raise OSError(f"{path} is empty")
        self.columns = {name: column([row[k] if k < len(row) else "" for row in lines[1:]]) for k, name in enumerate(lines[0])}

    def __len__(self):
        return len(next(iter(self.columns.values())))


def column(words):
    """Numbers where all words are numbers or empty, and some are; otherwise the words."""
    try:
        numbers = np.array([float(word) if word else np.nan for word in words])
    except ValueError:
        return np.array(words)
    return numbers if np.isfinite(numbers).any() else np.array(words)


class Results:
    """The results in a folder: `title`, `bodies` (names), `scene` (a dictionary, with the overrides of the run), `snapshots` over time, `history`
    (None where none was written), `escaped` (likewise). A run that goes on or broke off has what it wrote until now. Raises FileNotFoundError where the
    folder holds no results, OSError where they cannot be read."""

    counts_since = ""  # stage from whose start displacement counts, where one was asked for

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        if not (self.folder / "run.h5").exists():
            raise FileNotFoundError(f"{self.folder} contains no run.h5")
        self._file = None
        try:
            self._read()
        except (OSError, KeyError, AttributeError, RuntimeError) as error:  # what h5py raises where parts are missing
            if self._file:
                self._file.close()
            raise OSError(f"{self.folder / 'run.h5'} cannot be read, as it is damaged or being written: {error}") from error
        path = self.folder / "history.csv"
        self.history = History(path) if path.exists() else None
        path = self.folder / "escaped.csv"
        self.escaped = Escaped(path) if path.exists() else None

    def _read(self):
        self._file = h5py.File(self.folder / "run.h5", "r")
        self.title = self._file.attrs["title"] or self.folder.resolve().name
        self.program = self._file.attrs["program"]
        self.scene_text = self._file["scene"].asstr()[0]
        self.bodies = list(self._file["bodies"].asstr()[...])
        self.scene = parsed(self._file["values"].asstr()[0] if "values" in self._file else self.scene_text)  # with its overrides
        for name, group in self._file["snapshots"].items():
            if group is None:
                raise OSError(f"{self._file['snapshots'].get(name, getlink=True).filename}, to which it refers, is missing or damaged")
        self.snapshots = [Snapshot(group, {}) for group in self._file["snapshots"].values()]
        self._derive(self.snapshots)

    def _derive(self, snapshots):
        """Gives snapshots the fields that follow from the last of them."""
        derived = {}
        for snapshot in snapshots:
            snapshot._derived = derived
        if snapshots and snapshots[0].position().shape[1] == 3 and all(name in snapshots[-1] for name in ("displacement", "volume")):
            derived["thickness"] = Thickness(snapshots[-1], self.up_axis())

    def of_reduction(self):
        """The same with the start and the mechanism alone."""
        other = copy.copy(self)
        other.snapshots = [self.snapshots[0], *(snapshot for snapshot in self.snapshots if snapshot.stage == MECHANISM)]
        return other

    def before_reduction(self):
        """The same without the mechanism that the search for a factor of safety leaves as the last state: its displacement has any size, and it is no
        state of the slope. Results without one are returned as they are."""
        kept = [copy.copy(snapshot) for snapshot in self.snapshots if snapshot.stage != MECHANISM]
        if len(kept) in (0, len(self.snapshots)):
            return self
        other = copy.copy(self)
        other.snapshots = kept
        other._derive(kept)
        other.history = self.history.without(MECHANISM) if self.history else None
        other._without = MECHANISM
        return other

    def since(self, stage):
        """The same from the start of a stage on, with displacement since then: without what soil moved under its own weight before. Raises KeyError for a
        stage that the run has not."""
        number = next((k for k, snapshot in enumerate(self.snapshots) if snapshot.stage == stage), None)
        if number is None:
            raise unknown("stage", stage, dict.fromkeys(snapshot.stage for snapshot in self.snapshots[1:]))
        other, first = copy.copy(self), self.snapshots[max(0, number - 1)]
        other.snapshots = [snapshot.counted_from(first) for snapshot in self.snapshots[max(0, number - 1):]]
        other._derive(other.snapshots)
        if self.history:
            other.history = self.history.rows(np.flatnonzero(self.history.time >= first.time * (1 - 1e-9)))
            for point in other.history.points(first.time):
                way = other.history.way(point)
                other.history.columns[f"{point}_displacement_m"] = np.linalg.norm(way - way[0], axis=1)
        other.counts_since = stage
        return other

    def snapshot_at(self, time):
        """The snapshot nearest to a time [s]."""
        if not self.snapshots:
            raise LookupError(f"{self.folder} has no snapshots")
        return min(self.snapshots, key=lambda snapshot: abs(snapshot.time - time))

    def lines(self):
        """The lines that were followed with the soil: {name: Line}."""
        lines = map(Line, sorted(self.folder.glob("line_*.csv")))
        left_out = getattr(self, "_without", None)
        return {line.name: line.without(left_out) for line in lines}

    @functools.cache
    def structures(self):
        """Structures in the soil, structure_NAME.csv: {name: Line}, whose places are the middles of its elements."""
        return {line.name: line for line in map(Line, sorted(self.folder.glob("structure_*.csv"))) if len(line.time)}

    def model(self):
        """What was modelled, as run/model.json has it: soils, mesh, boundaries, water, points, stages. Raises FileNotFoundError."""
        return json.loads((self.folder / "run" / "model.json").read_text())

    @functools.cached_property
    def _rigid(self):
        """The rigid bodies of the model as they were at the start; none where nothing says what was modelled, or where they went."""
        known = (self.folder / "run" / "model.json").exists() and self.history and len(self.history.time)
        return self.model().get("rigid", []) if known else []

    def rigid_outlines(self, time):
        """The rigid bodies at a time [s]: {name: corners [n, 2]}."""
        history = self.history
        found = {}
        for body in self._rigid:
            x, y, turned = (np.interp(time, history.time, history[f"{body['name']}_{quantity}"]) for quantity in ("x_m", "y_m", "rotation_deg"))
            cos, sin = np.cos(np.radians(turned)), np.sin(np.radians(turned))
            found[body["name"]] = (np.array(body["polygon"]) - body["centre"]) @ np.array([[cos, sin], [-sin, cos]]) + [x, y]
        return found

    def mesh(self):
        """Nodes [n, dim] and cells [m, dim + 1] of the background mesh; nodes that ranks shared are one again."""
        position, cells = self._file["mesh/node_position"][...], self._file["mesh/cell_node"][...]
        if not len(cells):
            return position, cells
        size = np.ptp(position, axis=0).max() or 1.0
        _, first, number = np.unique(np.round(position / (1e-9 * size)), axis=0, return_index=True, return_inverse=True)
        return position[first], number.reshape(-1)[cells]

    def log_lines(self):
        """The lines of run.log."""
        path = self.folder / "run.log"
        return path.read_text(errors="replace").splitlines() if path.exists() else []

    def events(self, kind=None):
        """What happened in the run, see read_events."""
        return read_events(self.folder, kind)

    def broke_off(self):
        """Why and where the run ended early; empty if it came to its end. A run that was killed or still runs has no end among its events."""
        last = {event["kind"]: event for event in self.events()}
        return last["broke_off"]["text"] if "broke_off" in last else "" if "end" in last or not last else NOT_ENDED

    def cut_history(self):
        """What history.csv lacks of the run, as a sentence; empty if it is whole."""
        faults = [] if self.history is None else [self.history.cut, self.history.missing_rows(self.snapshots[-1].time)]
        faults = [fault for fault in faults if fault]
        return f"history.csv in {self.folder} is cut, as {' and '.join(faults)}: curves show the rest" if faults else ""

    def when(self, snapshot):
        """The time of a snapshot in words. In a run of days the time in a stage of less than a day is counted from the snapshot before it."""
        of_stage = [k for k, one in enumerate(self.snapshots) if one.stage == snapshot.stage]
        since = self.snapshots[max(0, of_stage[0] - 1)].time
        short = self.snapshots[of_stage[-1]].time - since < DAY
        return at_time(snapshot.time, self.snapshots[-1].time, since if short else 0.0)

    def per_metre(self, unit):
        """The unit of a mass or a volume: in plane strain it is that of a metre of the slope."""
        return unit + "/m" if self.snapshots[0].position().shape[1] == 2 else unit

    def up_axis(self):
        """Number of the axis along which elevations are counted."""
        return "xyz".index(self.scene.get("up", "y"))


def read_events(folder, kind=None):
    """What happened in the run with the results in a folder, in order, or what of it is of one kind: dictionaries with kind, stage, time_s, load_time_s, values
    (numbers by names with units), warning (is it one?) and text. A last line that is not whole is left out."""
    path = pathlib.Path(folder) / "events.jsonl"
    lines = path.read_text().split("\n")[:-1] if path.exists() else []
    return [event for event in map(json.loads, lines) if kind in (None, event["kind"])]


def parsed(text):
    """The scene as a dictionary; empty if it cannot be read."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return {}
