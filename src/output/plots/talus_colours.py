"""The scale of colours of a field."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm, Normalize, PowerNorm

import talus_style as style
from talus_results import MECHANISM
from talus_units import readable_unit

FAINT = 0.02  # values below this share of a scale that begins with nothing have the colour of soil, so that its shape and its layers are seen
ZERO = 1e-6  # the same of a field that takes both signs: its scale is pale at 0, and where it passes through 0 is no place without it
FAINT_ROOT = 0.05  # the same of a scale that is even in the square root, on which more is seen
# What is less in all pictures is nothing: the mesh cannot tell a motion by a thousandth of the spacing of particles, which is less than a pixel, from the
# rest of a stress wave; and a cell sheared by 0.001 has slipped by a thousandth of its size.
STILL = 1e-3  # displacement over the spacing of particles; of a velocity, that from one picture to the next
INTACT = 1e-3  # plastic strain
NOTHING = {"displacement": ("nothing moved", "m"), "velocity": ("nothing moves", "m/s"), "plastic_strain": ("nothing sheared", "")}  # fields with such a floor
EVEN = 5.0  # the scale of mobilised friction begins at a multiple of this [deg]


class Colours:
    """The scale that all pictures of a field share: from 0, or the least value if negative, to nearly the largest. A field that takes both signs has a
    scale with two colours that is pale at 0. That of plastic strain is even in its square root, so that the thin band at failure is seen beside the large
    strain of the slide; that of mobilised friction begins below nearly all soil under stress, since most of it differs by a few degrees. Displacement,
    velocity and plastic strain that are next to nothing in all pictures have the colour of soil, and `nothing` says how large they are; `spacing` is that of
    particles [m]. The scale is that of `snapshots`; where a picture also shows others, `shown` are all of them."""

    def __init__(self, field, snapshots, log=False, spacing=0.0, shown=()):
        values = np.concatenate([snapshot.scalar(field)[0] for snapshot in snapshots])
        self.gaps = not np.isfinite(values).all()
        values = values[np.isfinite(values)]
        low, high = np.percentile(values, [0.1, 99.9]) if len(values) else (0.0, 0.0)
        floor = floor_of(field, snapshots, spacing)
        self.nothing = said_of_nothing(field, np.abs(values).max(initial=0.0)) if floor and max(-low, high) < floor else ""
        if self.nothing:
            low, high = min(np.sign(low), 0.0) * floor, floor
        self.factor, self.unit = readable_unit(max(abs(low), abs(high)), snapshots[0].scalar(field)[1])
        low, high = -rounded_up(-min(low, 0.0) * self.factor), rounded_up(max(high, 0.0) * self.factor)
        signed = min(-low, high) > FAINT * max(-low, high)
        if low == high:
            high = 1.0
        elif not signed:  # a little of the other sign is beyond the end
            low, high = (0.0, high) if high > -low else (low, 0.0)
        if field == "state":
            low, high = -0.5, len(style.STATES) - 0.5
            signed = False
        if field == "mobilised_friction" and np.any(values > 0):
            low = EVEN * np.floor(np.percentile(values[values > 0], 5) * self.factor / EVEN)
        self.map, self.signed = style.colours_of(field, signed), signed
        self.names = style.STATES if field == "state" else ()
        self.shown = (0.5, high) if self.names else (low, high)  # of the scale, in the bar; soil without a state of its strength has its own colour
        ends = [end(known) * self.factor for one in shown or snapshots if len(known := (all_of := one.scalar(field)[0])[np.isfinite(all_of)]) for end in (np.min, np.max)]
        self.above, self.below = max(ends, default=high) > high, min(ends, default=low) < low
        self.rooted = field == "plastic_strain" and low == 0 and not log
        self.uneven = "colours even in the square root" if self.rooted else ""
        largest = max(-low, high)
        self.norm = LogNorm(1e-3 * high, high, clip=True) if log and low == 0 else PowerNorm(0.5, 0, high) if self.rooted else \
            Normalize(-largest, largest) if signed else Normalize(low, high)
        self.faint = 0.5 if self.names else float(self.norm.inverse(FAINT_ROOT if self.rooted else FAINT)) if low == 0 else (ZERO if signed else FAINT) * largest  # the least size that has a colour
        if self.nothing:
            self.faint, self.above, self.below = np.inf, False, False

    def plain(self, values):
        """Which values have the colour of soil."""
        return ~np.isfinite(values) | (np.abs(values) < self.faint)

    def in_words(self, soil="in the colour of its soil"):
        """What has the colour of soil, which `soil` names."""
        if self.nothing:
            return f"{soil}: all of it"
        if self.names or self.signed:
            return f"{soil}: {self.names[0] if self.names else 0}"
        return f"{soil}: below {self.faint:.2g} {self.unit}".rstrip() + ", or without a value" * self.gaps

    def bar(self, figure, place):
        """The bar of the scale in new axes at `place`, with its unit above it. Returns its axes."""
        axes = figure.add_axes(place)
        extend = {(False, False): "neither", (True, False): "max", (False, True): "min", (True, True): "both"}[(self.above, self.below)]
        figure.colorbar(plt.cm.ScalarMappable(self.norm, self.map), cax=axes, extend=extend)
        axes.tick_params(length=2)
        if self.names:
            axes.set_yticks(range(1, len(self.names)), self.names[1:], rotation=90, va="center")
        if not isinstance(self.norm, LogNorm):
            axes.set_ylim(*self.shown)
        axes.set_title(self.unit, fontsize=9, pad=6)
        return axes


def floor_of(field, snapshots, spacing):
    """The size below which a field is nothing; 0 without such a size, as of a mechanism, whose size is free. A speed is nothing at which soil would have
    moved by nothing from one picture to the next."""
    kind = next((kind for kind in NOTHING if field in (kind, f"{kind}_{field[-1]}")), "")  # also of displacement_x
    if kind == "velocity":
        times = sorted(snapshot.time for snapshot in snapshots)
        between = (times[-1] - times[0]) / (len(times) - 1) if len(times) > 1 else times[0]
        floor = STILL * spacing / between if between > 0 else 0.0
    else:
        floor = {"displacement": STILL * spacing, "plastic_strain": INTACT}.get(kind, 0.0)
    return 0.0 if floor and any(snapshot.stage == MECHANISM for snapshot in snapshots) else floor


def said_of_nothing(field, largest):
    """"nothing moved: at most 0.12 mm"."""
    what, unit = next(said for kind, said in NOTHING.items() if field.startswith(kind))
    factor, unit = readable_unit(largest, unit) if unit else (1.0, "")
    return f"{what}: at most {factor * largest:.2g} {unit}".rstrip()


def rounded_up(value):
    """The next number of two digits: 1.834 -> 1.9."""
    if value <= 0:
        return 0.0
    step = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(np.ceil(round(value / step, 6)) * step)
