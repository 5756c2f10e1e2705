"""Styles by which QGIS opens the maps: NAME.qml beside each grid, and the table layer_styles of the GeoPackage."""

import numpy as np
from matplotlib.colors import to_hex
from osgeo import ogr

import talus_style as style
from talus_units import in_use

STEPS = 9
FIELDS = {"thickness": "thickness", "largest_thickness": "thickness", "largest_speed": "velocity"}  # whose colours the pictures have
LINES = {"outline": ("fill", "SimpleFill", {"style": "no", "outline_color": style.INK, "outline_width": "0.5"}),
         "path": ("line", "SimpleLine", {"line_color": style.ACCENT, "line_width": "0.8"})}
TEXTS = ("f_table_catalog", "f_table_schema", "f_table_name", "f_geometry_column", "styleName", "styleQML", "styleSLD", "description", "owner", "ui")


def of_grid(name, values, unit):
    """The style of a grid: its colours over its range; what has both signs is pale at 0. Thickness of nothing is seen through."""
    known = values[np.isfinite(values)]
    high = float(np.percentile(np.abs(known), 99.9)) if known.size else 1.0
    high = high or 1.0
    signed = bool((known < -0.02 * high).any())
    low = -high if signed else 0.0
    colours, (factor, written) = style.colours_of(FIELDS.get(name, name), signed), in_use(unit)
    items = "".join(f'<item value="{low + share * (high - low):.6g}" color="{to_hex(colours(share))}" alpha="{0 if share == 0 and not signed and "thickness" in name else 255}" '
                    f'label="{factor * (low + share * (high - low)):.3g} {written}"/>' for share in np.linspace(0, 1, STEPS))
    return ('<!DOCTYPE qgis>\n<qgis version="3.22"><pipe>'
            f'<rasterrenderer type="singlebandpseudocolor" band="1" opacity="1" classificationMin="{low:.6g}" classificationMax="{high:.6g}">'
            f'<rastershader><colorrampshader colorRampType="INTERPOLATED" classificationMode="2" clip="0" minimumValue="{low:.6g}" maximumValue="{high:.6g}">{items}'
            "</colorrampshader></rastershader></rasterrenderer></pipe></qgis>\n")


def of_layer(name):
    kind, drawn, look = LINES[name]
    looks = "".join(f'<prop k="{key}" v="{value}"/>' for key, value in look.items())
    return ('<!DOCTYPE qgis>\n<qgis version="3.22"><renderer-v2 type="singleSymbol"><symbols>'
            f'<symbol name="0" type="{kind}" alpha="1"><layer class="{drawn}" enabled="1">{looks}</layer></symbol></symbols></renderer-v2></qgis>\n')


def add_styles(package):
    """Gives an open GeoPackage the styles of its layers."""
    table = package.CreateLayer("layer_styles", None, ogr.wkbNone)
    for name in TEXTS:
        table.CreateField(ogr.FieldDefn(name, ogr.OFTString))
    table.CreateField(ogr.FieldDefn("useAsDefault", ogr.OFTInteger))
    for name in LINES:
        feature = ogr.Feature(table.GetLayerDefn())
        given = {"f_table_name": name, "f_geometry_column": "geom", "styleName": "Talus", "styleQML": of_layer(name), "useAsDefault": 1}
        for key in (*TEXTS, "useAsDefault"):
            feature.SetField(key, given.get(key, ""))
        table.CreateFeature(feature)
