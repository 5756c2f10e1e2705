"""The model of a scene as the program hands it over, its picture, and the tables of the report. Arguments: the program, mpirun, the folder of the
scripts."""

import os
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest

import numpy as np

TALUS, MPIRUN, PLOTS = sys.argv.pop(1), sys.argv.pop(1), sys.argv.pop(1)
sys.path.insert(0, PLOTS)
from talus_model import dimensions, plt  # noqa: E402
from talus_modelled import Model, notes, outline, stage_rows  # noqa: E402
from talus_perspective import Views, hidden  # noqa: E402
from talus_symbols import chains, keep_apart, movable, named_points  # noqa: E402
from talus_units import duration, span, text_of  # noqa: E402

SECTION = """part,x,y
outline,0,0
outline,2,0
outline,2,1
outline,0,1
interface0,0,0.5
interface0,1,0.5
interface0,1,0
region_sand,0.5,0.25
region_air,1.5,0.5
b_top,0,0.5
b_top,1,0.5
"""
# a block of 1 m by 0.5 m; the friction of its base is no number where there is no soil
SCENE = """title = "a block"
phases = "drained"
gravity = 9.81
[mesh]
section = "section.csv"
size = 0.25
[body.sand]
region = "sand"
porosity = 0.4
grain_density = 2650
hydraulic_conductivity = "1e-5 m/s"
law = "mohr_coulomb"
young_modulus = 1e6
poisson_ratio = 0.3
cohesion = "1 kPa"
friction_angle = 30
residual_friction_angle = 25
shape_factor = 50
reference_size = "0.25 m"
[body.sand.retention]
curve = "van_genuchten"
reference_suction = 2e4
shape = 0.5
[boundary.base]
kind = "friction"
friction_angle = "20 + 10 * x + 0 * sqrt(1.1 - x)"
[boundary.left]
kind = "roller"
[boundary.top]
kind = "traction"
pressure = [[0, 1000], [1, 2000]]
[water]
table = [[0, 0.3], [2, 0.1]]
level = "0.05 + rise(t)"
[functions]
rise = [[0, 0], [10, "10 cm"]]
[[stage]]
name = "rest"
duration = 0.005
gravity_ramp = 0.002
damping = 0.7
hold_loads = true
softening = false
[[stage]]
name = "slide"
duration = 0.005
until = "rest"
[output]
[output.point.corner]
position = [1, 0.5]
[output.line.pile]
points = [[0.5, 0.5], [0.5, 0]]
spacing = 0.25
"""
RELATIVE = "body.sand.relative_permeability={curve='van_genuchten_mualem', shape=0.5}"
FILL = ("stage=[{name='fill', kind='quasi_static', add=['sand'], duration=1}]", "boundary.base={kind='fixed'}", "body.sand.cohesion=1 MPa")
SOLID = ("dimension=3", "mesh.thickness=0.5", "mesh.layers=0", "output.point.corner.position=[1, 0.5, 0.2]",
         "output.line.pile.points=[[0.5, 0.5, 0.2], [0.5, 0, 0.2]]",
         "boundary.sides={kind='roller', group=['front', 'back']}")


class Folder(tempfile.TemporaryDirectory):
    """A folder with the scene; `talus` runs the program in it."""

    def __init__(self):
        super().__init__(prefix="model-")
        self.path = pathlib.Path(self.name)
        (self.path / "section.csv").write_text(SECTION)
        (self.path / "block.toml").write_text(SCENE)

    def talus(self, *words, ranks=1, overrides=(), environment=None):
        command = [MPIRUN, "--allow-run-as-root", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
        command += [TALUS, *words]
        for one in overrides:
            command += ["--set", one]
        ended = subprocess.run(command, cwd=self.path, env={**os.environ, **(environment or {})}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        return ended.returncode, ended.stdout

    def model(self, *overrides, ranks=1):
        status, said = self.talus("run", "block.toml", "-o", "out", "--force", "--no-pictures", ranks=ranks, overrides=overrides)
        assert status == 0, said
        return (self.path / "out/run/model.json").read_text()


def area(corners):
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) if corners.shape[2] == 2 else 0.5 * np.linalg.norm(np.cross(a, b), axis=1)


def length(faces):
    return np.linalg.norm(faces[:, 1] - faces[:, 0], axis=1).sum()


class InPlaneStrain(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = Folder()
        cls.addClassCleanup(folder.cleanup)
        cls.text = folder.model()
        cls.on_two_ranks = folder.model(ranks=2)
        cls.model = Model(cls.text)
        cls.boundary = {one.name: one for one in cls.model.boundaries}

    def test_does_not_depend_on_ranks(self):
        self.assertEqual(self.text, self.on_two_ranks)

    def test_cells_fill_soil_and_free_space(self):
        self.assertAlmostEqual(area(self.model.corners[self.model.body == 0]).sum(), 0.5)
        self.assertAlmostEqual(area(self.model.corners[self.model.body == -1]).sum(), 1.5)

    def test_boundaries_have_their_faces(self):
        self.assertAlmostEqual(length(self.boundary["base"].corners), 2)
        self.assertAlmostEqual(length(self.boundary["base"].corners[self.boundary["base"].has_soil]), 1)
        self.assertAlmostEqual(length(self.boundary["left"].corners), 1)
        self.assertAlmostEqual(length(self.boundary["top"].corners), 1)
        np.testing.assert_allclose(self.boundary["base"].normal[self.boundary["base"].has_soil], np.tile([0, -1], (4, 1)), atol=1e-12)
        np.testing.assert_allclose(self.boundary["top"].normal, np.tile([0, 1], (4, 1)), atol=1e-12)  # out of the soil

    def test_boundaries_say_what_they_do(self):
        self.assertEqual({name: one.soil for name, one in self.boundary.items()}, {"base": "base", "left": "roller", "top": "load"})
        values = {one["name"]: one for one in self.boundary["base"].values}
        self.assertAlmostEqual(values["friction angle"]["low"], 20)  # at the corners of the faces with soil
        self.assertAlmostEqual(values["friction angle"]["high"], 30)
        np.testing.assert_allclose(self.boundary["top"].vector, np.tile([0, -1000], (4, 1)), atol=1e-9)
        self.assertEqual(self.boundary["top"].at_start(), "pressure 1 kPa at the start, changes with time")
        self.assertEqual(self.boundary["base"].line(), "base: base with friction, friction angle 20 to 30° at the soil")

    def test_water_table_is_that_of_the_start(self):
        (body, line), = self.model.water_lines()
        self.assertEqual(body, "")
        np.testing.assert_allclose(line, [[0, 0.35], [2, 0.15]])
        self.assertEqual(self.model.data["water"]["line"], [])  # nothing but the table

    def test_stages_say_what_acts(self):
        rows = stage_rows(self.model)
        self.assertEqual(rows[1], ("rest", "dynamic, euler", "0.005 s", "duration", "gravity 9.81 m/s², growing from 0 in 0.002 s; prescribed pore pressure; "
                                   "on the soil: top; functions of time stand still; damping 0.7; soil keeps its strength"))
        self.assertEqual(rows[2], ("slide", "dynamic, euler", "0.005 s", "rest, below 1 mm/s", "gravity 9.81 m/s²; prescribed pore pressure; on the soil: top; "
                                   "changing with time: boundary top, water level; no damping"))

    def test_points_and_lines_are_named(self):
        self.assertEqual(self.model.data["points"], [{"name": "corner", "position": [1, 0.5]}])
        self.assertEqual(self.model.data["lines"], [{"name": "pile", "points": [[0.5, 0.5], [0.5, 0]]}])

    def test_soils_have_their_parameters_with_units(self):
        line = self.model.soil_line("sand").replace("\u00a0", " ")
        self.assertEqual(line, "mohr coulomb: n = 0.4, ρₛ = 2650 kg/m³, E = 1 MPa, ν = 0.3, c = 1 kPa, φ = 30°, φᵣ = 25°, k = 1e-5 m/s, "
                               "reference size 0.25 m, shape factor 50")


class Variants(unittest.TestCase):
    def setUp(self):
        self.folder = Folder()
        self.addCleanup(self.folder.cleanup)

    def test_pressure_of_a_function_ends_at_a_line(self):
        model = Model(self.folder.model("water={excess='9810 * max(0, 0.31 - 0.2 * x - y)'}"))
        pieces = np.array(model.data["water"]["line"])
        self.assertAlmostEqual(np.ptp(pieces[..., 0]), 1)
        np.testing.assert_allclose(pieces[..., 1], 0.31 - 0.2 * pieces[..., 0], atol=1e-8)

    def test_free_surface_is_what_no_other_boundary_has(self):
        model = Model(self.folder.model("phases='saturated'", "water={}", "boundary.base={kind='fixed'}",
                                        "boundary.rain={kind='pore_pressure', group='free_surface', pressure=0}"))
        rain, = [one for one in model.boundaries if one.name == "rain"]
        self.assertAlmostEqual(length(rain.corners), 1.5)  # top and right side

    def test_faces_in_3d_enclose_the_soil(self):
        text = self.folder.model(*SOLID)
        self.assertEqual(text, self.folder.model(*SOLID, ranks=2))
        model = Model(text)
        self.assertAlmostEqual(area(model.corners).sum(), 2.5)
        self.assertTrue(((model.corners.mean(axis=1) - [0.5, 0.25, 0.25]) * model.normal > -1e-12).all())
        base, = [one for one in model.boundaries if one.name == "base"]
        self.assertAlmostEqual(area(base.corners[base.has_soil]).sum(), 0.5)

    def test_views_in_3d_say_from_where_they_see_front_and_back(self):
        model = Model(self.folder.model(*SOLID[:-1], "boundary.front={kind='roller'}", "boundary.back={kind='roller'}"))
        front, back = ([one for one in model.boundaries if one.name == name][0] for name in ("front", "back"))
        self.assertEqual([front.line(), back.line()], ["front (z = 0 m): roller", "back (z = 0.5 m): roller"])
        views = Views(model)
        for number, (end, seen, hidden) in enumerate((("largest x and z", back, front), ("smallest x and z", front, back))):
            self.assertIn(end, views.title(number))
            for boundary, is_seen in ((seen, True), (hidden, False)):
                self.assertTrue((views.cameras[number].sees(boundary.corners.mean(axis=1), boundary.normal) == is_seen).all(), boundary.name)

    def test_water_table_of_a_function_lies_over_the_ground_in_3d(self):
        model = Model(self.folder.model(*SOLID, "water.table=0.2 + 0.1 * x"))
        surface = np.array(model.data["water"]["surface"])
        np.testing.assert_allclose(surface[..., 1], 0.2 + 0.1 * surface[..., 0] + 0.05, atol=1e-12)  # raised by level
        self.assertTrue((surface[..., [0, 2]] >= 0).all() and (surface[..., 0] <= 1).all() and (surface[..., 2] <= 0.5).all())
        level = surface[:, :, [0, 2]]
        self.assertAlmostEqual(area(level).sum(), 0.7**2 * 0.5)
        self.assertIn("blue faces: water table at the start, seen through the ground", notes(model))
        self.assertEqual(Model(self.folder.model(*SOLID)).data["water"]["surface"], [])  # a polyline is a line

    def test_soil_that_a_stage_adds_is_not_there(self):
        model = Model(self.folder.model(*FILL))
        self.assertEqual(model.there, [False])
        self.assertIn("adds sand", stage_rows(model)[1][-1])
        self.assertEqual([one.line() for one in model.boundaries if one.name == "top"], ["top: load, changes with time"])

    def test_a_factor_of_safety_is_a_stage_without_a_duration(self):
        stages = "stage=[{name='rests', kind='quasi_static', duration=1}, {name='factor', kind='factor_of_safety'}]"
        rows = stage_rows(Model(self.folder.model(stages, "boundary.base={kind='fixed'}", "body.sand.residual_friction_angle=30",
                                            "body.sand.cohesion=5 kPa")))
        self.assertEqual(rows[2][1:4], ("factor of safety", "-", "a bracket of the factor"))
        self.assertIn("strength divided by trial factors", rows[2][-1])

    def test_water_that_has_seeped_stays(self):
        stages = "stage=[{name='seeps', kind='seepage', duration=1, steady=true}, {name='moves', duration=0.001}]"
        rows = stage_rows(Model(self.folder.model(stages, "boundary.behind={kind='head', group='left', level=0.4}", RELATIVE)))
        self.assertEqual(rows[1][1:], ("seepage, steady", "1 s", "duration", "gravity 9.81 m/s²; water seeps, soil at rest; on the soil: top; "
                                       "changing with time: boundary top, water level"))
        self.assertIn("pore pressure of the seepage before", rows[2][-1])


class Pictures(unittest.TestCase):
    def setUp(self):
        self.folder = Folder()
        self.addCleanup(self.folder.cleanup)

    def check(self, *words, **options):
        return self.folder.talus("check", "block.toml", *words, **options)

    def test_are_drawn(self):
        for ranks, words, name, overrides in ((1, ["--picture"], "block_model.png", ()), (2, ["--picture", "two.png"], "two.png", ()),
                                              (1, ["--picture", "solid.png"], "solid.png", SOLID), (1, ["--picture", "fill.png"], "fill.png", SOLID + FILL)):
            status, said = self.check(*words, ranks=ranks, overrides=overrides)
            self.assertEqual(status, 0, said)
            self.assertIn(f"the picture of the model is {name}", said)
            self.assertEqual((self.folder.path / name).read_bytes()[:4], b"\x89PNG")

    def test_are_refused_by_another_ending(self):
        status, said = self.check("--picture", "block.jpg")
        self.assertEqual(status, 2, said)
        self.assertIn("--picture block.jpg must be the name of a PNG file", said)

    def test_are_refused_without_their_folder(self):
        for ranks in (1, 2):
            status, said = self.check("--picture", "no/such/folder/block.png", ranks=ranks)
            self.assertEqual(status, 2, said)
            self.assertIn("--picture no/such/folder/block.png cannot be written: there is no folder", said)

    def test_are_refused_in_the_place_of_a_folder(self):
        (self.folder.path / "taken.png").mkdir(exist_ok=True)
        for ranks, name in ((1, "taken.png"), (2, "taken.png"), (1, ".")):
            status, said = self.check("--picture", name, ranks=ranks)
            self.assertEqual(status, 2, said)
            self.assertIn(f"--picture {name} is a folder: name a PNG file in it, such as {name}/block_model.png", said)
            self.assertNotIn("particles", said)  # before the work

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_are_refused_where_nothing_may_be_written(self):
        locked = self.folder.path / "locked"
        locked.mkdir(mode=0o500, exist_ok=True)
        status, said = self.check("--picture", "locked/block.png")
        self.assertEqual(status, 2, said)
        self.assertIn("--picture locked/block.png cannot be written: nothing may be written into ", said)

    def test_without_matplotlib_fail(self):
        (self.folder.path / "matplotlib.py").write_text("raise ImportError('there is none')\n")
        status, said = self.check("--picture", environment={"PYTHONPATH": str(self.folder.path)})
        self.assertEqual(status, 1, said)
        self.assertIn("talus: pictures and maps need Python modules of which one cannot be loaded (there is none); install python3-numpy", said)
        self.assertNotIn("Traceback", said)

    def test_and_tables_are_in_the_report(self):
        status, said = self.folder.talus("run", "block.toml", "-o", "out", "--set", "output.picture=['displacement']")
        self.assertEqual(status, 0, said)
        report = (self.folder.path / "out/report.html").read_text()
        self.assertLess(report.index('alt="Displacement"'), report.index('alt="Model at the start"'))  # the answer comes first
        for cells in ("<th>young modulus</th><td>1 MPa</td>", "<th>pressure</th><td>–</td><td>–</td><td>1 kPa at 0 s, 2 kPa at 1 s</td>",
                      "<th>at the start</th><td>friction angle 20 to 30° at the soil</td><td>–</td><td>pressure 1 kPa at the start, changes with time</td>",
                      "<th>mode</th><td>drained: pore pressure is prescribed</td>", "<th>table</th><td>(0, 0.3), (2, 0.1) m</td>",
                      "<th>level</th><td>0.05 + rise(t) [m]</td>",
                      "<td>rise</td><td>0 at 0 s, 10 cm at 10 s</td>",
                      "<th>retention</th><td>–</td><td>van_genuchten, reference suction 20 kPa, shape 0.5</td>", "<td>rest</td><td>dynamic, euler</td>"):
            self.assertIn(cells, report)


class Words(unittest.TestCase):
    def test_numbers_get_the_unit_of_their_key(self):
        for said, value, unit in (("13 kPa", 13000, "Pa"), ("30°", 30, "deg"), ("9.81 m/s²", "9.81", "m/s2"), ("20 MPa", "20 MPa", "Pa"),
                                  ("18 kN/m³", "18 kN/m3", "N/m3"), ("0.3", 0.3, ""), ("phi(t) [°]", "phi(t)", "deg"), ("2 * t [Pa]", "2 * t", "Pa"),
                                  ("5e-06 °/Pa", 5e-6, "deg/Pa"),
                                  ("true", True, ""),
                                  ("(0, 9.81) m/s²", [0, 9.81], "m/s2"), ("a, b", ["a", "b"], "")):
            self.assertEqual(text_of(value, unit), said)

    def test_lists_are_points_or_values_over_time(self):
        self.assertEqual(text_of([[0, 12], [150, 0]], "deg", over_time=True), "12° at 0 s, 0° at 150 s")
        self.assertEqual(text_of([[0, "7 m"], ["30 days", "9 m"]], "m", over_time=True), "7 m at 0 s, 9 m at 30 days")
        self.assertEqual(text_of([[k, k] for k in range(9)], "m"), "(0, 0) to (8, 8) in 9 points m")
        self.assertEqual(text_of([[0, "4 ft"], ["30 ft", "4 ft"]], "m"), "(0 m, 4 ft), (30 ft, 4 ft)")  # no unit behind values that carry their own
        self.assertEqual(text_of(["0", "t"], "m/s", over_time=True), "0 m/s, t [m/s]")

    def test_spans_and_durations(self):
        self.assertEqual(span(1000, 1000, "Pa"), "1 kPa")
        self.assertEqual(span(0, 12.5, "deg"), "0 to 12.5°")
        self.assertEqual([duration(one) for one in (0.5, 60, 150, 7200, 86400)], ["0.5 s", "60 s", "2.5 min", "2 h", "1 d"])


class Names(unittest.TestCase):
    def test_keep_apart(self):
        figure, axes = plt.subplots()
        self.addCleanup(plt.close, figure)
        axes.set(xlim=(0, 10), ylim=(0, 10))
        axes.text(5.3, 5.3, "a dimension", ha="left")
        soil = axes.text(5, 2, "soil", ha="center")
        movable(soil, [(5, 2), (5, 3), (7, 2)], of_soil=True)
        points = [{"name": name, "position": place} for name, place in (("crest", [5, 5]), ("upper", [5, 5.1]), ("lower", [5.1, 4.9]))]
        model = types.SimpleNamespace(data={"points": points, "lines": [{"name": "pile", "points": [[5, 5], [5, 0]]}]})
        named_points(axes, model, np.asarray)
        keep_apart(axes, [axes.lines[0].get_xydata()])
        boxes = [text.get_window_extent() for text in axes.texts]
        for k, one in enumerate(boxes):
            self.assertFalse(any(one.overlaps(other) for other in boxes[:k]), axes.texts[k].get_text())
        self.assertEqual(soil.get_position(), (7, 2))  # off the dotted line


class Terrain(unittest.TestCase):
    """A plane that falls by 0.5 to the south, whose middle third is soil."""

    def setUp(self):
        node = np.array([[[x, y, 0.5 * y] for y in range(4)] for x in range(4)], float)
        faces = [(i, j, [node[i, j], node[i + 1, j], node[i, j + 1]]) for i in range(3) for j in range(3)]
        faces += [(i, j, [node[i + 1, j + 1], node[i + 1, j], node[i, j + 1]]) for i in range(3) for j in range(3)]
        corners, soil = np.array([face[2] for face in faces]), np.array([face[:2] == (1, 1) for face in faces])
        normal = np.tile(np.array([0, -0.5, 1]) / np.sqrt(1.25), (len(faces), 1))
        bed = types.SimpleNamespace(corners=corners, normal=-normal, has_soil=soil)
        self.model = types.SimpleNamespace(corners=corners[soil] + [0, 0, 0.1], normal=normal[soil], body=np.zeros(2, int), terrain="dem.asc", boundaries=[bed],
                                           data={"up": "z", "points": [], "lines": [], "water": {"tables": []}}, colour=lambda body: "#e8d5b0")

    def test_is_seen_from_downhill_around_its_soil(self):
        views = Views(self.model)
        self.assertEqual(len(views.ground), 16)
        self.assertAlmostEqual(np.linalg.norm(views.rim[:, 1] - views.rim[:, 0], axis=1).sum(), 2 + 2 * np.sqrt(1.25))
        self.assertEqual([views.title(number) for number in (0, 1)], ["terrain (grey) and soil from above, from the south", "from below, from the north"])
        self.assertLess(views.towards[1], 0)
        np.testing.assert_allclose([views.lows[0], views.highs[0]], [[0, 0, 0], [3, 3, 1.6]], atol=0.11)

    def test_has_a_rim_where_soil_ends_upon_it_and_not_at_the_edge_of_the_mesh(self):
        bed, = self.model.boundaries
        bed.has_soil = bed.corners[..., 0].max(axis=1) <= 1  # along the west
        rim = Views(self.model).rim
        self.assertAlmostEqual(np.linalg.norm(rim[:, 1] - rim[:, 0], axis=1).sum(), 3 * np.sqrt(1.25))
        np.testing.assert_allclose(rim[..., 0], 1)
        bed.has_soil[:] = True
        views = Views(self.model)
        self.assertEqual((len(views.ground), len(views.rim)), (0, 0))

    def test_hides_the_rim_behind_its_soil(self):
        views = Views(self.model)
        camera = views.cameras[0]  # in the south
        self.assertFalse(hidden(views.rim, np.concatenate([self.model.corners, views.ground]), camera).any())
        face = np.array([[1, 1, 0.5], [2, 1, 0.5], [2, 1, 4.5], [1, 1, 4.5]])  # of soil of 4 m
        behind = hidden(views.rim, np.stack([face[[0, 1, 2]], face[[0, 2, 3]]]), camera)
        north = (views.rim[..., 1] == 2).all(axis=1)
        self.assertEqual(north.sum(), 1)
        self.assertTrue(behind[north].all())
        self.assertFalse(behind[(views.rim[..., 1] == 1).all(axis=1)].any())

    def test_that_faces_nowhere_is_seen_from_the_largest_coordinates(self):
        self.model.normal = np.tile([0.0, 0, 1], (2, 1))
        self.assertEqual(Views(self.model).title(0), "terrain (grey) and soil from above, from the northeast")


class Dimensions(unittest.TestCase):
    def test_keep_off_names(self):
        for sides, at in (([], 11.3), ([11], -1.3), ([-1.5], 11.3), ([11, -1.5], 11.3)):
            figure, axes = plt.subplots(figsize=(8, 6))
            self.addCleanup(plt.close, figure)
            axes.set(xlim=(-3, 16), ylim=(-3, 13))
            names = [axes.text(x, 5, "name") for x in sides]
            model = types.SimpleNamespace(corners=np.array([[[0, 0], [10, 0], [10, 10]], [[0, 0], [10, 10], [0, 10]]], float), body=np.zeros(2, int), there=[True])
            dimensions(axes, model, np.zeros(2), np.full(2, 10.0), 2.7)
            upright, = (line for line in axes.texts if getattr(line, "of_line", False) and line.xy[0] == line.xyann[0])
            self.assertAlmostEqual(upright.xy[0], at, delta=0.01)
            self.assertEqual([name.get_bbox_patch() is not None for name in names], [len(sides) == 2 and name.get_position()[0] > 0 for name in names])


class Lines(unittest.TestCase):
    def test_facets_join_to_lines_and_rings(self):
        facets = np.array([[[1, 0], [2, 0]], [[1, 0], [0, 0]], [[5, 0], [6, 0]], [[6, 0], [6, 1]], [[6, 1], [5, 0]]], float)
        found = chains(facets, np.zeros((5, 2)))
        self.assertEqual(sorted(len(points) for points, _ in found), [3, 4])
        self.assertEqual(abs(np.diff(found[0][0][:, 0])).tolist(), [1, 1])

    def test_the_outline_has_no_inner_edges(self):
        square = np.array([[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 1], [0, 1]]], float)
        self.assertAlmostEqual(length(np.array(outline(square))), 4)


if __name__ == "__main__":
    unittest.main()
