#!/usr/bin/python3
"""Maps of a run in 3D, for geographic information systems and as pictures: DIR/maps/*.tif, deposit.gpkg, map.png and section.png."""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import pathlib
import sys

import numpy as np
from osgeo import gdal, ogr, osr

import talus_style as style
from talus_deposit import LEFT_OUT, Deposit, left_mesh, metres, warn
from talus_ground import Ground
from talus_map_pictures import draw_map, draw_section
from talus_qgis import add_styles, of_grid
from talus_results import NOT_ENDED, Results
from talus_sliding import SLOW
from talus_units import brief, in_use, of_column, quantity, use
from talus_way import Way

NO_DATA = -9999.0
THIN = 0.1  # share of the deposit: less that the outline leaves out is not told
TAKEN_IN = 0.95  # share of the deposit that the outline holds with the limit that is proposed

gdal.UseExceptions()
ogr.UseExceptions()
osr.UseExceptions()


class Maps(Deposit):
    """Everything that is mapped, on one grid: thickness and speed are of the soil that slides, the change of thickness is of all soil."""

    def __init__(self, results, spacing=None, limit=None, beyond=None):
        super().__init__(results, spacing, limit, beyond)
        first, last = results.snapshots[0], results.snapshots[-1]
        self.change = self._column(last) - self._column(first)
        self.ground = Ground(self.node.min(axis=0), self.node.max(axis=0), self.size, (0, 1), 2, (self.node, self.cells))
        self.before = self.surface(first)
        east, north = (at[self.covered[-1]] for at in np.meshgrid(*self.grid.centres(), indexing="ij"))
        self.way = Way.of(self.path[:, :2], self.start[:, :2], self.start[:, 2], np.column_stack([east, north]), self.size)  # of the section

    def mapped(self):
        return self.results.snapshots

    def _column(self, snapshot):
        """Thickness of all soil."""
        volume = snapshot.column("volume").values[:, 0]
        return self._even(self.grid.spread(self.axes.level(snapshot.position()), np.cbrt(volume), [volume])[0])

    def surface(self, snapshot):
        """Elevations of the surface on the grid of self.ground."""
        position, volume = self.axes.level(snapshot.position()), snapshot.column("volume").values[:, 0]
        top, soil = self.ground.surface(position, np.cbrt(volume), volume)
        return np.where(soil, top, self.ground.base)

    def moment(self, snapshot=-1):
        """The time of a snapshot in words, as the pictures of a run have it."""
        return self.results.when(self.results.snapshots[snapshot]).removeprefix("t = ")

    def headline(self):
        return f"Soil at {self.moment()}, {100 * self.moving[0]:.3g} % of it still moving, at up to {brief(self.moving[1], 'm/s')}" if self.moving else f"Deposit at {self.moment()}"

    def reference(self):
        """Name of the projection; empty without one."""
        return reference_of(self.axes.projection).GetName() if self.axes.projection else ""

    def polygons(self, mask):
        """Outline of the cells of a mask along their edges, with holes, as one OGR multipolygon in the coordinates of the map."""
        cells, found = raster(self, [(mask, "", "")]), ogr.GetDriverByName("Memory").CreateDataSource("")  # they own band and layer
        layer = found.CreateLayer("outline", reference_of(self.axes.projection), ogr.wkbPolygon)
        gdal.Polygonize(cells.GetRasterBand(1), cells.GetRasterBand(1), layer, -1, [])
        several = ogr.Geometry(ogr.wkbMultiPolygon)
        for feature in layer:
            several.AddGeometry(feature.GetGeometryRef())
        return several

    def rings(self, mask):
        """The same as arrays of places [n, 2]."""
        return [np.array(ring.GetPoints())[:, :2] for polygon in self.polygons(mask) for ring in polygon]

    def layers(self):
        """Of each grid: name, values, unit and meaning."""
        steps = np.diff(self.times)
        interval = f"the states in run.h5, {steps.max():g} s apart or less: what happens between them is missed"
        return (("thickness", self.thickness[-1], "m", f"thickness of the soil that slid, at {self.times[-1]:g} s"),
                ("largest_thickness", self.thickness.max(axis=0), "m", f"largest thickness of the soil that slides, of {interval}"),
                ("largest_speed", self.largest_speed, "m/s", f"largest size of the depth-averaged velocity where soil is at least {self.limit:.3g} m thick, of {interval}"),
                ("arrival_time", self.arrival, "s", f"first time at which sliding soil is at least {self.limit:.3g} m thick, of {interval}"),
                ("change", self.change, "m", f"thickness of all soil at {self.times[-1]:g} s minus that at {self.times[0]:g} s"))


def reference_of(projection):
    """The projection as GDAL takes it; None without one."""
    if not projection:
        return None
    reference = osr.SpatialReference()
    reference.SetFromUserInput(projection)
    reference.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return reference


def undefined():
    """Level coordinates in metres somewhere: a GeoPackage has this name, number -1, for them; without one GDAL calls them degrees, number 0."""
    reference = osr.SpatialReference()
    reference.SetFromUserInput('LOCAL_CS["Undefined Cartesian SRS",UNIT["metre",1]]')
    return reference


def raster(maps, bands, path="", driver="MEM", options=()):
    """A raster file of arrays on the grid, north up. `bands` are (values, meaning, unit)."""
    grid, reference = maps.grid, reference_of(maps.axes.projection)
    kind = gdal.GDT_Byte if bands[0][0].dtype == bool else gdal.GDT_Float32
    made = gdal.GetDriverByName(driver).Create(str(path), *grid.shape, len(bands), kind, list(options))
    low = grid.low + maps.axes.origin[:2]
    made.SetGeoTransform((low[0], grid.spacing, 0, low[1] + grid.shape[1] * grid.spacing, 0, -grid.spacing))
    if reference:
        made.SetSpatialRef(reference)
    made.SetMetadata({"SOFTWARE": style.program(), "TITLE": maps.results.title})
    for k, (values, meaning, unit) in enumerate(bands, start=1):
        band = made.GetRasterBand(k)
        if kind == gdal.GDT_Float32:
            band.SetNoDataValue(NO_DATA)
        band.SetDescription(meaning)
        band.SetUnitType(unit)
        band.WriteArray(np.where(np.isfinite(values), values, NO_DATA).T[::-1] if kind == gdal.GDT_Float32 else values.astype(np.uint8).T[::-1])
    return made


def write_rasters(maps, folder, ascii_grids):
    """The GeoTIFF files; with `ascii_grids` the same as ESRI ASCII, with their projections beside them."""
    options = ("COMPRESS=DEFLATE",)
    for name, values, unit, meaning in maps.layers():
        made = raster(maps, [(values, meaning, unit)], folder / f"{name}.tif", "GTiff", options)
        (folder / f"{name}.qml").write_text(of_grid(name, values, unit))
        if ascii_grids:
            gdal.GetDriverByName("AAIGrid").CreateCopy(str(folder / f"{name}.asc"), made, options=["SIGNIFICANT_DIGITS=8"])
        made.FlushCache()
    bands = [(values, f"thickness at {time:g} s", "m") for time, values in zip(maps.times, maps.thickness)]
    raster(maps, bands, folder / "thickness_over_time.tif", "GTiff", options).FlushCache()


def write_vectors(maps, path):
    """The GeoPackage: layer `outline` of the deposit, layer `path` of the centre of mass of the soil that slides."""
    path.unlink(missing_ok=True)
    reference = reference_of(maps.axes.projection) or undefined()
    made = ogr.GetDriverByName("GPKG").CreateDataSource(str(path))
    line = ogr.Geometry(ogr.wkbLineString25D)
    places = maps.path[np.isfinite(maps.path[:, 0])]
    for place in places + maps.axes.origin:
        line.AddPoint(*map(float, place))
    length = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
    layers = (("outline", ogr.wkbMultiPolygon, maps.polygons(maps.covered[-1]),
               maps.numbers() | {"still_moving": bool(maps.moving), "speed_m_s": maps.moving[1] if maps.moving else 0.0}),
              ("path", ogr.wkbLineString25D, line, {"length_m": length, "start_s": maps.times[0], "end_s": maps.times[-1]}))
    for name, kind, geometry, numbers in layers:
        layer = made.CreateLayer(name, reference, kind)
        for key in numbers:
            layer.CreateField(ogr.FieldDefn(key, ogr.OFTInteger if isinstance(numbers[key], bool) else ogr.OFTReal))
        feature = ogr.Feature(layer.GetLayerDefn())
        for key, value in numbers.items():
            feature.SetField(key, int(value) if isinstance(value, bool) else float(value))
        feature.SetGeometry(geometry)
        layer.CreateFeature(feature)
    add_styles(made)
    made.FlushCache()


def checked(folder):
    """The results of a run in 3D that can be mapped."""
    results = Results(folder)
    use(results.scene)
    if not results.snapshots:
        raise ValueError(f"{folder} contains no snapshots")
    first = results.snapshots[0]
    if first.position().shape[1] != 3:
        raise ValueError(f"{folder} is a run in 2D: maps need one in 3D (dimension = 3)")
    for field in ("displacement", "velocity", "volume"):
        if field not in results.snapshots[-1]:
            raise ValueError(f"{folder} has no field {field}, which maps need")
    return results


def say_what_is_missing(results):
    if cause := results.broke_off():
        warn(f"the run {'is incomplete' if cause == NOT_ENDED else 'broke off'}: {cause}; the maps show it up to {results.snapshots[-1].time:g} s")
    gone = left_mesh(results)
    if len(gone):
        volume = results.snapshots[0].column("volume").values[np.isin(results.snapshots[0].ids(), gone, assume_unique=True)].sum()
        warn(f"{len(gone)} particles with a volume of {quantity(volume, 'm³', '.4g')} at the start left the mesh: the deposit is without them")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="DIR", help="folder of the run")
    parser.add_argument("--spacing", type=float, help="of the grids [m]")
    parser.add_argument("--limit", type=float, help="least thickness [m] of soil that counts for outline, arrival and speed")
    parser.add_argument("--moved", type=float, help="displacement [m] beyond which soil counts as sliding")
    parser.add_argument("--ascii", action="store_true", help="write the grids as ESRI ASCII too")
    given = parser.parse_args()
    try:
        maps = Maps(checked(given.folder), given.spacing, given.limit, given.moved)
        say_what_is_missing(maps.results)
        folder = pathlib.Path(given.folder) / "maps"
        folder.mkdir(exist_ok=True)
        write_rasters(maps, folder, given.ascii)
        write_vectors(maps, folder / "deposit.gpkg")
        draw_map(maps, folder / "map.png")
        draw_section(maps, folder / "section.png")
    except ValueError as error:  # of what these results or this choice cannot give
        print(f"talus: {error}", file=sys.stderr)
        sys.exit(2)
    except RuntimeError as error:  # of GDAL
        sys.exit(f"talus: {error}")
    if maps.moving:
        warn(f"the soil has not come to rest: {100 * maps.moving[0]:.3g} % of what slid is faster than {brief(SLOW, 'm/s')}, at up to {brief(maps.moving[1], 'm/s')}; outline, "
             f"run-out and angle of reach are those at {maps.moment()} and not of a final deposit, for which its last stage "
             "takes a longer duration or, where it ended by rest, a smaller rest_speed")
    if maps.left_out()[0] > LEFT_OUT * maps.volume[-1]:
        warn(maps.beside(given.moved))
    inside, deposit = maps.numbers()["volume_in_outline_m3"], maps.thickness[-1].sum() * maps.grid.spacing**2
    if inside < (1 - THIN) * deposit:
        warn(f"the outline holds {quantity(inside, 'm³')} of the deposit of {quantity(deposit, 'm³')}: the other {100 * (1 - inside / deposit):.2g} % are thinner than the limit "
             f"of {metres(maps.limit)}; --limit {maps.limit_of(TAKEN_IN):.2g} takes in {100 * TAKEN_IN:.3g} % of it. A flow that is thinner than one or two "
             f"particles, {metres(maps.size)} each, is not resolved: smaller cells of the mesh have smaller particles")
    print(f"maps of {maps.results.title}: {maps.headline()[0].lower() + maps.headline()[1:]}, cells of {quantity(maps.grid.spacing, 'm')}, {maps.grid.shape[0]} x {maps.grid.shape[1]}")
    print(f"projection: {'that of the terrain file' if maps.axes.projection else 'none, coordinates are ' + ('those of the terrain file' if maps.axes.spacing else 'local')}")
    for name, value in maps.numbers().items():
        said, unit = of_column(name)
        factor, unit = in_use(unit)
        print(f"  {said:20} {factor * value:12.6g} {unit}")
    released, gone = maps.released()
    factor, unit = in_use("m³")
    print(f"  {'released':20} {factor * released:12.6g} {unit}, the volume of this soil at the start{f', of which {factor * gone:.4g} {unit} left the mesh' if gone else ''}")
    print(f"  {'volume of slide':20} {factor * maps.volume[-1]:12.6g} {unit}, in the grid {factor * deposit:.6g} {unit}")
    print(f"maps are in {folder}: grids as .tif{', .asc' if given.ascii else ''}, deposit.gpkg, map.png, section.png")


if __name__ == "__main__":
    main()
