"""Opens the results in the folder of this file in ParaView (5.11 or newer): File > Load State, or paraview --state=run.py

The last snapshot, coloured by plastic strain where the soil yields and else by displacement, in front of the background mesh. The colours of velocity,
displacement and plastic strain reach to their largest values over all times.
"""
import json
import os

from paraview.simple import *

folder = os.path.dirname(os.path.abspath(__file__))
view = GetActiveViewOrCreate("RenderView")

particles = OpenDataFile(os.path.join(folder, "run.xdmf"))
RenameSource("particles", particles)
times = list(particles.TimestepValues)
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.AnimationTime = view.ViewTime = times[-1]
particles.UpdatePipeline(times[-1])
arrays = particles.PointData
bounds = particles.GetDataInformation().GetBounds()
flat = bounds[4] == bounds[5]

# Points as large as the particles: those of a section have their volume per metre of thickness.
low, high = arrays["volume (m3)"].GetRange()
shown = Show(particles, view)
shown.Representation = "Point Gaussian"
shown.GaussianRadius = 0.5 * (0.5 * (low + high)) ** (1 / 2 if flat else 1 / 3)
shown.ShaderPreset = "Plain circle" if flat else "Sphere"

yields = "plastic_strain" in arrays.keys() and arrays["plastic_strain"].GetRange()[1] > 1e-3
field = "plastic_strain" if yields else "displacement (m)"
ColorBy(shown, ("POINTS", field))
# The scales, of a hundred times at most; ParaView by itself would take those of the time at which a field is chosen.
component = {name: component for name, component in (("plastic_strain", 0), ("displacement (m)", -1), ("velocity (m/s)", -1)) if name in arrays.keys()}
largest = dict.fromkeys(component, 0.0)
for time in sorted({*times[:: -(-len(times) // 100)], times[-1]}):
    particles.UpdatePipeline(time)
    for name in component:
        largest[name] = max(largest[name], arrays[name].GetRange(component[name])[1])
for name, value in largest.items():
    scale = GetColorTransferFunction(name)
    scale.ApplyPreset("Viridis (matplotlib)", True)
    scale.RescaleTransferFunction(0, value or 1)
    scale.AutomaticRescaleRangeMode = "Never"
colours = GetColorTransferFunction(field)
shown.SetScalarBarVisibility(view, True)
bar = GetScalarBar(colours, view)
bar.TitleColor = bar.LabelColor = [0, 0, 0]
bar.Orientation = "Horizontal"
bar.WindowLocation = "Lower Center"

mesh = OpenDataFile(os.path.join(folder, "mesh.xdmf"))
RenameSource("background mesh", mesh)
edges = Show(mesh, view)
edges.Representation = "Wireframe"
edges.ColorArrayName = [None, ""]
edges.AmbientColor = edges.DiffuseColor = [0.5, 0.5, 0.5]
edges.Opacity = 0.2 if flat else 0.1

view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
view.OrientationAxesLabelColor = [0, 0, 0]
view.InteractionMode = "2D" if flat else "3D"
# A section is seen from the front, a body obliquely from above; up is against gravity.
with open(os.path.join(folder, "run", "model.json")) as model:
    gravity = json.load(model)["gravity"]
steepest = max(range(len(gravity)), key=lambda k: abs(gravity[k]))
up = [0, 1, 0] if flat or gravity[steepest] == 0 else [-gravity[steepest] * (k == steepest) for k in range(3)]
towards = [0, 0, 1] if flat else [0.5, 0.5, 1] if steepest == 1 else [0.5, -1, 0.5]
centre = [(bounds[2 * k] + bounds[2 * k + 1]) / 2 for k in range(3)]
view.CameraFocalPoint = centre
view.CameraPosition = [c + d for c, d in zip(centre, towards)]
view.CameraViewUp = up
SetActiveSource(particles)
view.ResetCamera(False)
Render(view)
