"""Opens the results of a run with the reader that ParaView takes by itself, and compares with run.h5; draws run.py.

    pvpython tests/paraview/check.py DIR PICTURE
"""
import os
import sys

import h5py
import numpy as np
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy

folder, picture = os.path.abspath(sys.argv[1]), sys.argv[2]
failures = []


def expect(true, claim):
    if not true:
        failures.append(claim)


run = h5py.File(os.path.join(folder, "run.h5"), "r")
snapshots = [run["snapshots"][number] for number in sorted(run["snapshots"])]
dimension = int(run["mesh"].attrs["dimension"])
bodies = [name.decode() for name in np.ravel(run["bodies"][()])]

particles = OpenDataFile(os.path.join(folder, "run.xdmf"))
expect(list(particles.TimestepValues) == [float(s.attrs["time"]) for s in snapshots], "the times are those of run.h5")
view = CreateView("RenderView")
view.ViewSize = [1000, 500]
first = Show(particles, view)
strains = {"plastic_strain", "shear_strain"} & set(snapshots[0])
expect(not strains or first.ColorArrayName[1] in strains, f"ParaView colours by a strain at first sight, not by {first.ColorArrayName[1]}")

for snapshot in (snapshots[0], snapshots[len(snapshots) // 2], snapshots[-1]):
    time = float(snapshot.attrs["time"])
    particles.UpdatePipeline(time)
    data = servermanager.Fetch(particles)
    count = len(snapshot["id"])
    expect(data.GetNumberOfPoints() == count, f"{count} points at {time} s, not {data.GetNumberOfPoints()}")
    expect(data.GetNumberOfCells() == count, f"{count} cells of a point each at {time} s, not {data.GetNumberOfCells()}")
    points = vtk_to_numpy(data.GetPoints().GetData())
    expect(np.array_equal(points[:, :dimension], snapshot["position"][()]), f"the points at {time} s are the positions")
    shown = {data.GetPointData().GetArrayName(k): vtk_to_numpy(data.GetPointData().GetArray(k)) for k in range(data.GetPointData().GetNumberOfArrays())}
    for name, values in snapshot.items():
        if name == "position":
            continue
        if name == "body":
            label = "body (" + ", ".join(f"{k} {body}" for k, body in enumerate(bodies)) + ")"
        else:
            unit = "-" if name == "id" else values.attrs["unit"]
            unit = unit.decode() if isinstance(unit, bytes) else unit
            details = ([] if unit == "-" else [unit]) + (["xx yy zz xy"] if values.shape[1] == 4 else [])
            label = f"{name} ({', '.join(details)})" if details else name
        expect(label in shown, f"there is a field {label} at {time} s among {sorted(shown)}")
        if label in shown:
            expect(np.array_equal(shown[label].reshape(count, -1)[:, : values.shape[1]], values[()]), f"the values of {label} at {time} s are those of run.h5")

mesh = OpenDataFile(os.path.join(folder, "mesh.xdmf"))
mesh.UpdatePipeline()
expect(mesh.GetDataInformation().GetNumberOfCells() == len(run["mesh/cell_node"]), "mesh.xdmf has all cells")
Hide(particles, view)

state = os.path.join(folder, "run.py")
with open(state) as script:
    names = {"__file__": state}
    exec(compile(script.read(), state, "exec"), names)
field_of_state = names["field"]
for name, of_all in (("velocity (m/s)", "velocity"), ("displacement (m)", "displacement"), ("plastic_strain", "plastic_strain")):
    if of_all in snapshots[0]:
        largest = max(np.linalg.norm(snapshot[of_all][()], axis=1).max() for snapshot in snapshots)
        shown = GetDisplayProperties(GetActiveSource(), view)
        shown.SetScalarColoring(name, servermanager.GetAssociationFromString("POINTS"))
        shown.RescaleTransferFunctionToDataRange(True, False)  # as ParaView does where somebody chooses it in the list; ColorBy would enforce the present range
        end = GetColorTransferFunction(name).RGBPoints[-4]
        expect(abs(end - (largest or 1)) < 1e-5 * (largest or 1), f"the colours of {name} reach to its largest value over all times, {largest:.4g}, not to {end:.4g}")
GetDisplayProperties(GetActiveSource(), view).SetScalarColoring(field_of_state, servermanager.GetAssociationFromString("POINTS"))
SaveScreenshot(picture, view, ImageResolution=[1000, 500])
from paraview.vtk.vtkIOImage import vtkPNGReader

reader = vtkPNGReader()
reader.SetFileName(picture)
reader.Update()
pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())[:, :3].astype(int)
coloured = np.mean(np.ptp(pixels, axis=1) > 40)
expect(coloured > 0.05, f"run.py fills more than 5 % of the picture with coloured particles, not {100 * coloured:.1f} %")

for failure in failures:
    print("failed:", failure)
print(f"{folder}: {len(snapshots)} snapshots, {len(snapshots[-1]['id'])} particles, {dimension}D, {'failed' if failures else 'as stated'}; {picture}")
sys.stdout.flush()
os._exit(1 if failures else 0)  # sys.exit ends ParaView 5.11 on a virtual screen with GLXBadContext and status 1
