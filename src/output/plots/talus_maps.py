#!/usr/bin/python3
"""Maps of a run in 3D, for geographic information systems and as pictures: DIR/maps/*.tif, deposit.gpkg, map.png and section.png."""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import json
import pathlib
import sys

import numpy as np
from osgeo import gdal, ogr, osr

import talus_style as style
from talus_ground import Ground
from talus_map_pictures import draw_map, draw_section
from talus_qgis import add_styles, of_grid
from talus_results import NOT_ENDED, SLOW, Results, Thickness, largest_displacement, still_moving
from talus_units import words
from talus_way import Way

NO_DATA = -9999.0
LIMIT = 0.5  # least thickness of soil that counts, over the size of particles: thinner soil is single particles
LEFT_OUT = 0.02  # share of the volume that slid: less that moved and is not mapped is not told
THIN = 0.1  # share of the deposit: less that the outline leaves out is not told
TAKEN_IN = 0.95  # share of the deposit that the outline holds with the limit that is proposed
SPACING = 2.0  # of the grids where there is no terrain file, over the size of particles
EVEN = 3.0  # length over which thickness is evened out, over the size of particles: about the edge of a cell of the mesh with a few particles
MOST_CELLS = 50_000_000  # of one grid

gdal.UseExceptions()
ogr.UseExceptions()
osr.UseExceptions()


def warn(text):
    print(f"warning: {text}", file=sys.stderr)


def left_mesh(results):
    """Numbers of the particles that are in the first snapshot and no longer in the last."""
    return np.setdiff1d(results.snapshots[0].ids(), results.snapshots[-1].ids(), assume_unique=True)


class Axes:
    """From the coordinates of the mesh to those of a map: east, north, elevation. With y up the map looks from above too: its north is -z."""

    def __init__(self, results):
        self.up = results.up_axis()
        path = results.folder / "origin.json"
        found = json.loads(path.read_text()) if path.exists() else {}
        self.origin = np.array([*found.get("origin_m", (0.0, 0.0)), 0.0])
        self.projection = found.get("projection", "")
        self.name = reference_of(self.projection).GetName() if self.projection else ""  # of the projection
        self.spacing = found.get("spacing_m")  # of the terrain file; None without one

    def level(self, vectors):
        """Vectors [n, 3] in the order east, north, up, without the origin."""
        return vectors if self.up == 2 else vectors[:, [0, 2, 1]] * [1, -1, 1]


class Grid:
    """Square cells over the extent of the mesh. Arrays on the grid are [cells to the east, cells to the north]; coordinates are without the origin of the
    map. The southwest corner of the mesh is the centre of a cell of the terrain file, whose spacing is `terrain` [m]: the grid begins at the edge of that
    cell, so that its cells hold whole cells of the terrain where its spacing is a multiple of theirs. Without a terrain its own first cell has its centre
    there."""

    def __init__(self, low, high, spacing, terrain=None):
        beyond = terrain or spacing  # by half of this the outermost cells reach beyond the mesh
        self.spacing, self.low = spacing, low[:2] - beyond / 2
        count = np.ceil(((high - low)[:2] + (beyond if terrain else spacing / 2)) / spacing - 1e-6)
        if count.prod() > MOST_CELLS:
            raise ValueError(f"--spacing {spacing:g} m makes {count.prod():.3g} cells, more than {MOST_CELLS:.3g}: choose a larger spacing")
        self.shape = tuple(count.astype(int).tolist())

    def centres(self):
        return [low + (np.arange(count) + 0.5) * self.spacing for low, count in zip(self.low, self.shape)]

    def number(self, position):
        """The cell of each place as one number; places beyond the edge count for the outermost cells."""
        index = np.clip(np.floor((position[:, :2] - self.low) / self.spacing).astype(int), 0, np.array(self.shape) - 1)
        return np.ravel_multi_index(index.T, self.shape)

    def spread(self, position, size, values):
        """Sums over cells [n, cells, cells] of values [n, particles], each spread evenly over the level square of width `size` [m] of its particle.
        Nothing is lost: what is beyond the edge counts for the outermost cells."""
        least = (position[:, :2] - size[:, None] / 2 - self.low) / self.spacing
        most = least + size[:, None] / self.spacing
        first = np.floor(least).astype(int)
        result = np.zeros((len(values), np.prod(self.shape)))
        reach = int(np.ceil((size / self.spacing).max(initial=0))) + 1
        share = [[np.clip(np.minimum(most[:, axis], first[:, axis] + k + 1) - np.maximum(least[:, axis], first[:, axis] + k), 0, None)
                  / (most - least)[:, axis] for k in range(reach)] for axis in (0, 1)]
        for corner in np.ndindex(reach, reach):
            index = np.clip(first + corner, 0, np.array(self.shape) - 1)
            number, weight = np.ravel_multi_index(index.T, self.shape), share[0][corner[0]] * share[1][corner[1]]
            for sums, value in zip(result, values):
                sums += np.bincount(number, weight * value, len(sums))
        return result.reshape(-1, *self.shape)

    def evened_out(self, values, where, length):
        """Values [cells, cells] whose differences between neighbouring cells of the mask `where` have evened out by diffusion, as far as a cell of the mesh
        with linear shape functions of this length [m] would spread them. The sum stays, the mask's edge stays sharp, and so do uniform values."""
        result = values.copy()
        if not where.any():
            return result
        part = tuple(slice(at.min(), at.max() + 1) for at in np.nonzero(where))
        turns = length**2 / 6 / (2 * self.spacing**2)  # a hat function that ends at +-length has the variance length^2 / 6
        count = int(np.ceil(turns / 0.2))
        ways = [(some, both[1:] & both[:-1]) for some, both in ((result[part], where[part]), (result[part].T, where[part].T))]
        for _ in range(count):
            for some, both in ways:
                flow = turns / count * np.where(both, np.diff(some, axis=0), 0)
                some[:-1] += flow
                some[1:] -= flow
        return result


class Deposit:
    """The soil that slid at the end, on a grid: its outline and the numbers that report, study and maps give of it."""

    def __init__(self, results, spacing=None, limit=None, beyond=None):
        self.results, self.axes = results, Axes(results)
        first, last = results.snapshots[0], results.snapshots[-1]
        node, self.cells = results.mesh()
        self.node = self.axes.level(node)
        sliding = Thickness(last, self.axes.up).sliding if beyond is None else last.ids()[last.scalar("displacement")[0] > beyond]
        self.sliding = np.union1d(sliding, left_mesh(results))
        self.size = self._size_of(first)
        moved = largest_displacement(last)
        if not len(self.sliding) or (moved < self.size and not len(left_mesh(results))):
            least = f"the spacing of particles, {self.size:.3g} m" if beyond is None or moved < self.size else f"--moved {beyond:g} m"
            raise ValueError(f"{results.folder}: no soil has slid far enough for a map: the largest displacement, {moved:.3g} m, is below {least}")
        self.limit = LIMIT * self.size if limit is None else limit
        terrain = self.axes.spacing
        self.grid = Grid(self.node.min(axis=0), self.node.max(axis=0), spacing or terrain or SPACING * self.size, terrain)
        if self.grid.spacing < 1.5 * self.size:
            wider = SPACING * self.size if not terrain else terrain * np.ceil(SPACING * self.size / terrain)
            warn(f"cells of {self.grid.spacing:g} m are not much wider than the particles ({self.size:.3g} m): single particles show in the outline and "
                 f"where the soil is thin; less so with --spacing {wider:.4g}{f', a multiple of the spacing of the terrain file,' if terrain else ''} or more")
        self.moving = still_moving(last, self.sliding)
        self.last = last
        self._accumulate(self.mapped())
        if not self.covered[-1].any():
            raise ValueError(f"the deposit is nowhere as thick as --limit {self.limit:g} m; its largest thickness is {self.thickness[-1].max():.3g} m"
                             + (f". {self.beside(beyond)}" if self.left_out()[0] > LEFT_OUT * self.volume[-1] else ""))
        self._ends(first, last)

    def mapped(self):
        """The snapshots that are put on the grid."""
        return self.results.snapshots[-1:]

    def _size_of(self, first):
        """Mean size of the particles that slide, or of all where none does [m]: those of a slide may be much smaller than those of the ground below it."""
        volume = first.column("volume").values[:, 0]
        slides = np.isin(first.ids(), self.sliding, assume_unique=True)
        return float((volume[slides] if slides.any() else volume).mean()) ** (1 / 3)

    def released(self):
        """Volumes at the start of the soil that is mapped, with what has left the mesh, and of the latter alone [m3]. The deposit has less: it is without what
        left and it is denser, and its outline encloses less still, as soil that is thinner than the limit does not count."""
        first = self.results.snapshots[0]
        volume = first.column("volume").values[:, 0]
        return tuple(float(volume[np.isin(first.ids(), of, assume_unique=True)].sum()) for of in (self.sliding, left_mesh(self.results)))

    def left_out(self):
        """Volume that moved by more than the size of particles and is not mapped [m3], and its least and largest displacement [m]."""
        moved = self.last.scalar("displacement")[0]
        some = (moved > self.size) & ~np.isin(self.last.ids(), self.sliding, assume_unique=True)
        if not some.any():
            return 0.0, (0.0, 0.0)
        return float(self.last.column("volume").values[some, 0].sum()), (float(moved[some].min()), float(moved[some].max()))

    def beside(self, beyond):
        """What is not mapped though it moved, in words; `beyond` is the displacement that was asked for [m], or None."""
        left_out, moved = self.left_out()
        return (f"{left_out:.3g} m3 that moved by {moved[0]:.3g} to {moved[1]:.3g} m are not mapped, and are {100 * left_out / (left_out + self.volume[-1]):.3g} % of "
                "what moved by more than a particle: soil slides in these maps where it moved by more than "
                + (f"--moved {beyond:g} m" if beyond else "a tenth of the largest displacement, which 99.9 % of the mass have at most")
                + f"; --moved {self.size:.2g} maps all of it")

    def limit_of(self, share):
        """The limit of thickness [m], of two digits, with which the outline holds this share of the deposit."""
        thickness = np.sort(self.thickness[-1], axis=None)[::-1]
        limit = thickness[np.searchsorted(np.cumsum(thickness), share * thickness.sum())]
        step = 10.0 ** (np.floor(np.log10(limit)) - 1)
        return float(np.floor(limit / step) * step)

    def _even(self, held):
        """Thickness [m] from the volumes above cells. Particles lie where the mesh put them and where the motion took them, so that a column holds one more
        or one less: this evens out within soil that is thick enough to count, so that neither outline nor volume change."""
        thickness = held / self.grid.spacing**2
        return self.grid.evened_out(thickness, thickness >= self.limit, EVEN * self.size)

    def _accumulate(self, snapshots):
        self.times, self.thickness, self.covered, self.path, self.volume = [], [], [], [], []
        nothing = np.full(self.grid.shape, np.nan)
        self.largest_speed, self.arrival = nothing.copy(), nothing.copy()
        for snapshot in snapshots:
            moves = np.isin(snapshot.ids(), self.sliding, assume_unique=True)
            place, volume = self.axes.level(snapshot.position())[moves], snapshot.column("volume").values[moves, 0]
            velocity = self.axes.level(snapshot.column("velocity").values)[moves]
            held, *flow = self.grid.spread(place, np.cbrt(volume), [volume, *(volume * velocity.T)])
            there = held >= self.limit * self.grid.spacing**2
            speed = np.linalg.norm(np.divide(flow, held, out=np.zeros_like(flow), where=there), axis=0)
            self.largest_speed = np.where(there, np.fmax(self.largest_speed, speed), self.largest_speed)
            self.arrival = np.where(there & ~np.isfinite(self.arrival), snapshot.time, self.arrival)
            self.times.append(snapshot.time)
            self.thickness.append(self._even(held))
            self.covered.append(there)
            self.volume.append(volume.sum())
            self.path.append(np.average(place, axis=0, weights=volume) if len(place) else np.full(3, np.nan))
        self.thickness, self.path = np.array(self.thickness), np.array(self.path)

    def _ends(self, first, last):
        """The crown at the start and the toe of the deposit."""
        start = self.axes.level(first.position())[np.isin(first.ids(), self.sliding, assume_unique=True)]
        self.crown = start[start[:, 2].argmax()]
        # the toe is the cell of the deposit that is furthest from the crown; its elevation is that of the lowest particle there
        east, north = (at[self.covered[-1]] for at in np.meshgrid(*self.grid.centres(), indexing="ij"))
        far = np.hypot(east - self.crown[0], north - self.crown[1]).argmax()
        toe = np.array([east[far], north[far], 0.0])
        slid = np.isin(last.ids(), self.sliding, assume_unique=True)
        end, size = self.axes.level(last.position())[slid], np.cbrt(last.column("volume").values[slid, 0])
        near = np.abs(end[:, :2] - toe[:2]).max(axis=1) <= 1.000001 * (self.grid.spacing + size) / 2
        self.toe = np.array([*toe[:2], end[near, 2].min()])

    def numbers(self):
        """Measures of the deposit, by their names with units, as attributes of its outline."""
        deposit, area = self.thickness[-1], self.covered[-1].sum() * self.grid.spacing**2
        travel, fall = np.linalg.norm((self.toe - self.crown)[:2]), self.crown[2] - self.toe[2]
        inside = deposit[self.covered[-1]].sum() * self.grid.spacing**2
        return {"area_m2": area, "volume_m3": inside, "travel_distance_m": travel, "fall_height_m": fall,
                "angle_of_reach_deg": np.degrees(np.arctan2(fall, travel)), "mean_thickness_m": inside / area,
                "largest_thickness_m": deposit.max(), "least_thickness_m": self.limit, "time_s": self.times[-1]}


class Maps(Deposit):
    """Everything that is mapped, on one grid: thickness and speed are of the soil that slides, the change of thickness is of all soil."""

    def __init__(self, results, spacing=None, limit=None, beyond=None):
        super().__init__(results, spacing, limit, beyond)
        first, last = results.snapshots[0], results.snapshots[-1]
        self.change = self._column(last) - self._column(first)
        self.ground = Ground(self.node.min(axis=0), self.node.max(axis=0), self.size, (0, 1), 2, (self.node, self.cells))
        self.before = self.surface(first)
        start = self.axes.level(first.position())[np.isin(first.ids(), self.sliding, assume_unique=True)]
        east, north = (at[self.covered[-1]] for at in np.meshgrid(*self.grid.centres(), indexing="ij"))
        self.way = Way.of(self.path[:, :2], start[:, :2], start[:, 2], np.column_stack([east, north]), self.size)  # of the section

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
        return f"Soil at {self.moment()}, {100 * self.moving[0]:.3g} % of it still moving, at up to {self.moving[1]:.3g} m/s" if self.moving else f"Deposit at {self.moment()}"

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
        warn(f"{len(gone)} particles with a volume of {volume:.4g} m3 at the start left the mesh: the deposit is without them")


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
        warn(f"the soil has not come to rest: {100 * maps.moving[0]:.3g} % of what slid is faster than {SLOW:g} m/s, at up to {maps.moving[1]:.3g} m/s; outline, "
             f"run-out and angle of reach are those at {maps.moment()} and not of a final deposit, for which its last stage "
             "takes a longer duration or, where it ended by rest, a smaller rest_speed")
    if maps.left_out()[0] > LEFT_OUT * maps.volume[-1]:
        warn(maps.beside(given.moved))
    inside, deposit = maps.numbers()["volume_m3"], maps.thickness[-1].sum() * maps.grid.spacing**2
    if inside < (1 - THIN) * deposit:
        warn(f"the outline holds {inside:.6g} m3 of the deposit of {deposit:.6g} m3: the other {100 * (1 - inside / deposit):.2g} % are thinner than the limit "
             f"of {maps.limit:.3g} m; --limit {maps.limit_of(TAKEN_IN):.2g} takes in {100 * TAKEN_IN:.3g} % of it. A flow that is thinner than one or two "
             f"particles, {maps.size:.3g} m each, is not resolved: smaller cells of the mesh have smaller particles")
    print(f"maps of {maps.results.title}: {maps.headline()[0].lower() + maps.headline()[1:]}, cells of {maps.grid.spacing:g} m, {maps.grid.shape[0]} x {maps.grid.shape[1]}")
    print(f"projection: {'that of the terrain file' if maps.axes.projection else 'none, coordinates are ' + ('those of the terrain file' if maps.axes.spacing else 'local')}")
    for name, value in maps.numbers().items():
        quantity, _, unit = name.rpartition("_")
        print(f"  {words(quantity):20} {value:12.6g} {unit}")
    released, gone = maps.released()
    print(f"  {'released':20} {released:12.6g} m3, the volume of this soil at the start{f', of which {gone:.4g} m3 left the mesh' if gone else ''}")
    print(f"  {'volume that slid':20} {maps.volume[-1]:12.6g} m3, in the grid {maps.thickness[-1].sum() * maps.grid.spacing**2:.6g} m3")
    print(f"maps are in {folder}: grids as .tif{', .asc' if given.ascii else ''}, deposit.gpkg, map.png, section.png")


if __name__ == "__main__":
    main()
