"""What a scene models, from the document that the program makes of it (src/simulation/model.h): in numbers, and in words."""

import functools
import json
import pathlib
import tomllib

import numpy as np

import talus_style as style
from talus_units import Keys, duration, quantity, span, words

EARTH, WATER, LOAD, BASE, PLATE, GAS = style.INK, "#1971c2", "#c92a2a", "#a0410d", "#5f3dc4", "#862e9c"
UNBROKEN = "\u00a0"  # a blank at which no line ends
# symbols of the parameters of soils; a parameter without one has its key in words
PARAMETERS = {"unit_weight": "γ", "saturated_unit_weight": "γₛₐₜ", "density": "ρ", "porosity": "n", "grain_density": "ρₛ", "young_modulus": "E",
              "shear_modulus": "G", "bulk_modulus": "K", "poisson_ratio": "ν", "cohesion": "c", "friction_angle": "φ", "dilation_angle": "ψ",
              "residual_cohesion": "cᵣ", "residual_friction_angle": "φᵣ", "residual_dilation_angle": "ψᵣ", "tension_cutoff": "σₜ",
              "k0": "K₀", "hydraulic_conductivity": "k", "permeability": "k"}
# keys of soils that are no parameters: what they fill, their law, their particles, their state at the start
NO_PARAMETERS = {"region", "law", "material", "particles_per_cell", "dense", "velocity", "displacement", "stress", "body_acceleration", "water_table"}
# what a boundary does to the soil: words, colour, symbol in perspective
ON_SOIL = {"fixed": ("fixed", EARTH, "s"), "roller": ("roller", EARTH, "o"), "base": ("base with friction", BASE, "X"),
           "load": ("load", LOAD, "v"), "velocity": ("moving plate", PLATE, "D"), "dashpot": ("non-reflecting", GAS, "P"),
           "tied": ("tied", EARTH, "o")}
ON_WATER = {"wall": "no flow", "pressure": "pore pressure", "seepage": "water level, above it a seepage face", "flux": "inflow", "outflow": "outflow"}


class Model:
    """The document of the program: see src/simulation/model.h."""

    def __init__(self, text):
        self.data = json.loads(text)
        self.title = self.data["title"]
        self.dimension = self.data["dimension"]
        self.scene = tomllib.loads(self.data["scene"])
        self.terrain = pathlib.PurePath(self.scene.get("mesh", {}).get("terrain", {}).get("file", "")).name  # the file; empty where there is none
        self.keys = Keys(self.data["keys"])
        self.bodies = [body["name"] for body in self.data["bodies"]]
        self.colours = style.soil_colours(self.bodies)
        self.there = [body["there"] for body in self.data["bodies"]]
        self.corners = np.array([cell["corners"] for cell in self.data["cells"]]).reshape(-1, 3, self.dimension)
        self.normal = np.array([cell["normal"] for cell in self.data["cells"]]).reshape(-1, self.dimension)  # of the faces in 3D
        self.body = np.array([cell["body"] for cell in self.data["cells"]], int)
        self.boundaries = [Boundary(one, self.dimension) for one in self.data["boundaries"]]
        if self.dimension == 3:  # symbols alone do not tell boundaries apart
            for k, boundary in enumerate(self.boundaries):
                boundary.colour = style.LINES[k % len(style.LINES)]
        self.stages = self.data["stages"]

    def soil_line(self, name):
        """Law (or material of the library) and parameters of a soil: first those with symbols, then the others."""
        given = self.scene.get("body", {}).get(name, {})
        others = [key for key, value in given.items() if key not in NO_PARAMETERS and key not in PARAMETERS and not isinstance(value, dict)]
        said = [f"{symbol} = {self._value(given, key)}" for key, symbol in PARAMETERS.items() if key in given]
        said += [f"{words(key)} {self._value(given, key)}" for key in others]
        return f"{words(given.get('law') or given.get('material', ''))}: {', '.join(one.replace(' ', UNBROKEN) for one in said)}"

    def _value(self, given, key):
        return self.keys.text("body.NAME", given.get("law", ""), key, given[key])

    def water_lines(self):
        """Polylines of the water tables at the start, level beyond their ends, over the width of the model: [(body, points)]."""
        left, right = self.corners[..., 0].min(), self.corners[..., 0].max()
        lines = []
        for table in self.data["water"]["tables"]:
            points = np.array(table["points"])
            x = np.unique(np.concatenate([[left, right], points[(points[:, 0] > left) & (points[:, 0] < right), 0]]))
            lines.append((table["body"], np.column_stack([x, np.interp(x, points[:, 0], points[:, 1])])))
        return lines


def outline(cells):
    """Edges [n, 2, dim] that only one of some triangles [m, 3, dim] has."""
    if not len(cells):
        return []
    edges = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    size = np.ptp(edges.reshape(-1, cells.shape[-1]), axis=0).max()
    _, node = np.unique(np.round(edges.reshape(-1, cells.shape[-1]) / (1e-7 * size)).astype(np.int64), axis=0, return_inverse=True)
    _, first, count = np.unique(np.sort(node.reshape(-1, 2), axis=1), axis=0, return_index=True, return_counts=True)
    return edges[first[count == 1]]


def common_edges(first, second):
    """Edges [n, 2, 3] that some triangles [m, 3, 3] share with others."""
    found = [np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]) for cells in (first, second)]
    edges = np.concatenate(found)
    if not len(edges):
        return edges
    size = np.ptp(edges.reshape(-1, 3), axis=0).max()
    _, node = np.unique(np.round(edges.reshape(-1, 3) / (1e-7 * size)).astype(np.int64), axis=0, return_inverse=True)
    _, one, number = np.unique(np.sort(node.reshape(-1, 2), axis=1), axis=0, return_index=True, return_inverse=True)
    of_first, of_second = (np.isin(np.arange(len(one)), part) for part in np.split(number, [len(found[0])]))
    return edges[one[of_first & of_second]]


def read_model(folder):
    """The model of a run, or None where the run has left no document of it."""
    path = folder / "run" / "model.json"
    return model_of(path, path.stat().st_mtime_ns) if path.exists() else None


@functools.lru_cache(maxsize=1)
def model_of(path, _):
    return Model(path.read_text())


class Boundary:
    """A boundary with its faces: corners [faces, dim, dim], normals and vectors (load or velocity) [faces, dim]."""

    def __init__(self, data, dimension):
        self.name, self.soil, self.water, self.gas = data["name"], data["soil"], data["water"], data["gas"]
        self.groups, self.values, self.changes, self.level = data["groups"], data["values"], data["changes"], data["level"]
        faces = data["faces"]
        self.has_soil = np.array([face["soil"] for face in faces], bool)
        self.partly = not self.has_soil.all()  # values are known where there is soil
        self.corners = np.array([face["corners"] for face in faces]).reshape(-1, dimension, dimension)
        self.normal = np.array([face["normal"] for face in faces]).reshape(-1, dimension)
        self.vector = np.array([face["vector"] for face in faces]).reshape(-1, dimension)
        self.colour = ON_SOIL[self.soil][1] if self.soil in ON_SOIL else GAS if self.gas == "pressure" else WATER
        if self.soil in ("load", "none"):  # act on soil only
            keep = self.has_soil
            self.corners, self.normal, self.vector, self.has_soil = self.corners[keep], self.normal[keep], self.vector[keep], self.has_soil[keep]

    def marker(self):
        return ON_SOIL[self.soil][2] if self.soil in ON_SOIL else "."

    def what(self):
        """What it does, in words."""
        if self.soil in ON_SOIL:
            return ON_SOIL[self.soil][0]
        return "gas pressure" if self.gas == "pressure" else ON_WATER.get(self.water, "no effect")

    def at_start(self):
        """Its values at the start, in words; empty if it has none."""
        said = [f"{one['name']} {span(one['low'], one['high'], one['unit'])}" + " at the soil" * (self.partly and one["low"] < one["high"]) for one in self.values if one["name"] != "adhesion" or one["high"]]
        if self.level is not None:
            said = [f"water level {quantity(self.level, 'm')}"]
        if not self.changes:
            return ", ".join(said)
        return ", ".join(said) + " at the start, changes with time" if said else "changes with time"

    def place(self):
        """In 3D the plane of its faces where they lie in one across an axis: " (z = 0 m)"."""
        if self.corners.shape[-1] < 3 or not len(self.corners):
            return ""
        corners = self.corners.reshape(-1, 3)
        flat = np.flatnonzero(np.ptp(corners, axis=0) < 1e-6 * np.ptp(corners, axis=0).max())
        return f" ({'xyz'[flat[0]]} = {quantity(corners[0, flat[0]], 'm', '.4g')})" if len(flat) == 1 else ""

    def line(self):
        values = self.at_start()
        told = values.startswith(self.what()) or (self.values and self.soil == "load")
        return f"{self.name}{self.place()}: {values if told else ', '.join(filter(None, (self.what(), values)))}"


SEEPING = {"seepage": "water seeps, soil at rest", "consolidation": "water seeps, soil consolidates"}  # kinds of stages


def stage_rows(model):
    """What a table of the stages says: the names of its columns, then a row for each stage."""
    rows = [("stage", "kind", "at most", "ends with", "what acts")]
    for number, stage in enumerate(model.stages):
        kind = words(stage["kind"]) + (f", {stage['integrator']}" if stage["kind"] == "dynamic" else ", steady" if stage.get("steady") else "")
        lasts = duration(stage["duration"]) if "duration" in stage else "-"
        rows.append((stage["name"], kind, lasts, ending(stage), "; ".join(actions(model, number))))
    return rows


def ending(stage):
    if stage["kind"] == "factor_of_safety":
        return "a bracket of the factor"
    until = stage.get("until", "duration")
    if stage.get("when_lost") == "next_stage":
        return "duration, or loss of equilibrium"
    if until == "failure":
        return f"failure of {stage['failure_point']}, from {quantity(stage['failure_speed'], 'm/s')}"
    if until == "rest":
        return f"rest, below {quantity(stage['rest_speed'], 'm/s')}"
    return until


def actions(model, number):
    """What acts in a stage, in words."""
    said, stage = [], model.stages[number]
    size = float(np.linalg.norm(model.data["gravity"]))
    if size:
        said.append(f"gravity {quantity(size, 'm/s2')}" + (f", growing from 0 in {duration(stage['gravity_ramp'])}" if stage.get("gravity_ramp") else ""))
    if stage.get("seismic_coefficient"):
        said.append(f"pseudo-static inertia of ({', '.join(f'{k:g}' for k in stage['seismic_coefficient'])}) times the weight")
    if stage.get("earthquake"):
        said.append("the earthquake")
    phases = model.data["phases"]
    if phases == "drained":
        seeped = any(before["kind"] in SEEPING for before in model.stages[:number])
        said.append(SEEPING.get(stage["kind"], "pore pressure of the seepage before" if seeped else "prescribed pore pressure"))
    elif phases != "dry":
        said.append("pore fluids move" if stage.get("pore_flow", True) else "pore pressure of the start")
    standing = [one.name for one in model.boundaries if one.soil in ("load", "velocity")]
    if standing:
        said.append("on the soil: " + ", ".join(standing))
    if stage["changes"]:
        said.append("changing with time: " + ", ".join(words(one.replace(".", " ")) for one in stage["changes"]))
    elif stage.get("hold_loads"):
        said.append("functions of time stand still")
    if stage["kind"] == "factor_of_safety":
        said.append("strength divided by trial factors")
    if stage.get("initial_stress") == "k0":
        said.append("stress at the start by k0")
    for key, verb in (("add", "adds"), ("remove", "removes")):
        if stage.get(key):
            said.append(f"{verb} {', '.join(stage[key])}")
    if stage["kind"] == "dynamic":
        said.append(f"damping {stage['damping']:g}" if stage["damping"] else "no damping")
    if not stage.get("softening", True):
        said.append("soil keeps its strength")
    if stage.get("reset_displacement"):
        said.append("displacement set to 0 at its end")
    return said


def notes(model):
    """Sentences on the water."""
    water = model.scene.get("water", {})
    said = []
    if model.data["water"]["tables"]:
        level = ", raised by level = " + model.keys.text("water", "", "level", water["level"]) if "level" in water else ""
        said.append("blue line: water table at the start" + level)
    elif "table" in water:
        said.append(f"water table: {water['table']}")
    if model.data["water"].get("surface"):  # no older model has one
        said.append("blue faces: water table at the start, seen through the ground")
    if model.data["water"]["line"]:
        said.append("dashed blue line: where the pore pressure at the start ends in the soil")
    for key in ("suction", "excess"):
        if key in water:
            said.append(f"{key}: {model.keys.text('water', '', key, water[key])}")
    return said
