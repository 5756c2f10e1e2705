"""How the pictures of Talus look: type, colours, units of a size that reads well."""

import os
import pathlib
import re
import struct
import zlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, to_hex, to_rgb
from matplotlib.ticker import FuncFormatter, Locator, MaxNLocator, NullFormatter

from talus_units import length

INK, SOFT, FAINT, ACCENT = "#1f2933", "#616e7c", "#cbd2d9", "#0b7285"
LINES = ("#0b7285", "#d9480f", "#5f3dc4", "#2b8a3e", "#c2255c", "#e67700", "#6f4518", "#868e96")
EDGE = 0.12  # between titles and the edge of a chart [inch]
RESOLUTION = 120  # dots per inch
PACKED = 4  # of 9: how thoroughly pictures are packed

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 9, "axes.titlesize": 9.5, "axes.labelsize": 9,
    "text.color": INK, "axes.labelcolor": INK, "axes.edgecolor": SOFT, "xtick.color": SOFT, "ytick.color": SOFT,
    "xtick.labelcolor": INK, "ytick.labelcolor": INK, "xtick.labelsize": 8, "ytick.labelsize": 8,
    "axes.linewidth": 0.7, "xtick.major.width": 0.7, "ytick.major.width": 0.7,
    "xtick.major.size": 3, "ytick.major.size": 3,
    "axes.spines.top": False, "axes.spines.right": False, "axes.prop_cycle": matplotlib.cycler(color=LINES),
    "figure.facecolor": "white", "legend.frameon": False,
})


def part_of(name, low, high):
    """A piece of a colour map."""
    return LinearSegmentedColormap.from_list(f"{name}_part", plt.get_cmap(name)(np.linspace(low, high, 256)))


GROUND = ("#a9a29a", "#c2a278", "#b9bfa4", "#e8d5b0", "#e0b88a", "#d5cfc9", "#a8895f", "#d8c774")  # of the soils
TINTS, SHADE = 71, 0.05  # of these colours: so many in all, which differ by this share of black or white; no multiple of the colours divides 71


def soil_colours(names):
    """The colour of each soil, which follows from its name alone, so that it stays as soils are added; but two that would have the same one differ by a shade."""
    taken = {}
    for name in sorted(names, key=lambda one: zlib.crc32(one.encode())):
        tint = zlib.crc32(name.encode()) % TINTS
        while tint in taken.values() and len(taken) < TINTS:
            tint = (tint + len(GROUND)) % TINTS
        taken[name] = tint
    return [shaded(GROUND[taken[name] % len(GROUND)], SHADE * (taken[name] // len(GROUND) - 2)) for name in names]


def shaded(colour, share):
    """A colour with a share of white, or of black where it is negative."""
    return to_hex((1 - abs(share)) * np.array(to_rgb(colour)) + max(share, 0.0))


STATES = ("elastic", "peak", "softening", "residual")  # values 0, 1, 2, 3 of the field state
STATE_COLOURS = ("#eef1f4", "#ffd43b", "#f76707", "#c92a2a")
# of even steps in lightness; strain and pressure start pale, so that the eye goes to where there is some
MAPS = {"displacement": plt.get_cmap("viridis"), "thickness": part_of("YlOrRd", 0.05, 1.0), "velocity": plt.get_cmap("plasma"),
        "plastic_strain": part_of("magma_r", 0.03, 0.95), "pore_pressure": part_of("YlGnBu", 0.08, 1.0),
        "suction": part_of("YlOrBr", 0.03, 0.95), "saturation": plt.get_cmap("YlGnBu"), "mobilised_friction": part_of("YlOrRd", 0.02, 0.95),
        "state": ListedColormap(STATE_COLOURS)}
SIGNED = {"pore_pressure": plt.get_cmap("BrBG")}  # of fields that take both signs, pale at 0; others take BOTH
BOTH = plt.get_cmap("RdBu_r")
SYMBOL = {"displacement": "|u|", "velocity": "|v|", "thickness": "h", "plastic_strain": "εₚ", "pore_pressure": "p", "suction": "s", "saturation": "S", "mobilised_friction": "φₘ"}


def colours_of(field, signed=False):
    return SIGNED.get(field, BOTH) if signed else MAPS.get(field, plt.get_cmap("cividis"))


class Places(MaxNLocator):
    """Ticks of places [m] at round numbers of the unit of the run."""

    def tick_values(self, low, high):
        return super().tick_values(low * length()[0], high * length()[0]) / length()[0]


def places(axis, most=None):
    """Lets an axis of places [m] have numbers in the unit of the run, and at most so many intervals."""
    if most or length()[0] != 1:
        axis.set_major_locator(Places(most or 8, steps=[1, 2, 5, 10]))
    number_places(axis)


def number_places(axis):
    """Numbers of places [m] in the unit of the run."""
    if length()[0] != 1:
        axis.set_major_formatter(FuncFormatter(lambda at, _: f"{round(at * length()[0], 6):.12g}"))


class LogTicks(Locator):
    """Few ticks of a logarithmic axis, whose labels keep apart: round numbers as far as `most` of them have room, else whole decades."""

    STEPS = ((1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9), (1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,))

    def __init__(self, most):
        self.most = most

    def __call__(self):
        return self.tick_values(*sorted(self.axis.get_view_interval()))

    def tick_values(self, low, high):
        decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
        for steps in self.STEPS:
            ticks = [float(f"{step}e{int(k)}") for k in decades for step in steps]
            ticks = [tick for tick in ticks if low * (1 - 1e-9) <= tick <= high * (1 + 1e-9)]
            if len(ticks) <= self.most:
                return np.array(ticks)
        return np.array(ticks[:: -(-len(ticks) // self.most)])


def log_number(value, _=None):
    """0.002, 50, 2×10⁻⁴"""
    if 1e-3 <= value < 1e5:
        return f"{value:g}"
    digits, _, power = f"{value:.6e}".partition("e")
    raised = "10" + str(int(power)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return raised if float(digits) == 1 else f"{float(digits):g}×{raised}"


def few_log_ticks(*charts):
    """Labels of the logarithmic axes of these charts that do not overlap."""
    for axis, most in ((axis, most) for axes in charts for axis, most in ((axes.xaxis, 5), (axes.yaxis, 6)) if axis.get_scale() == "log"):
        axis.set_major_locator(LogTicks(most))
        axis.set_major_formatter(FuncFormatter(log_number))
        axis.set_minor_formatter(NullFormatter())


def headline(figure, text, title):
    """What a chart shows, and of which scene, below it where there is no room beside it; `figure` has the layout "constrained"."""
    beside = 0.13 * len(text) + 0.08 * len(title) < figure.get_figwidth()  # [inch]
    width, height = figure.get_size_inches()
    x, y = EDGE / width, EDGE / height
    room = EDGE + (0.24 if beside else 0.42)  # above the charts [inch]
    figure.get_layout_engine().set(rect=(0.5 * x, 0.5 * y, 1 - x, 1 - 0.5 * y - room / height))
    figure.suptitle(text, x=x, y=1 - y, ha="left", fontsize=12, fontweight="bold")
    down = EDGE + (0.02 if beside else 0.24)  # from the top [inch]
    at = {"x": 1 - x, "ha": "right"} if beside else {"x": x, "ha": "left"}
    figure.text(y=1 - down / figure.get_figheight(), s=title, va="top", fontsize=8.5, color=SOFT, **at)


def legend_below(figure, handles, columns=None):
    """One legend of all charts, below them on the left, in so many columns; `figure` has the layout "constrained"."""
    columns = columns or len(handles)
    figure.supxlabel("\n".join([" "] * -(-len(handles) // columns)), fontsize=10)  # keeps the room
    figure.legend(handles=handles, loc="lower left", ncols=columns, fontsize=8)


def program():
    """Name and version of the program that draws, "Talus 0.1.0". The program passes them on when it starts a script; a script that is started alone
    reads them from CMakeLists.txt, which an installed program lacks."""
    if "TALUS_PROGRAM" in os.environ:
        return os.environ["TALUS_PROGRAM"]
    lists = pathlib.Path(__file__).resolve().parents[3] / "CMakeLists.txt"
    return "Talus " + re.search(r"project\(Talus VERSION (\S+)", lists.read_text()).group(1) if lists.exists() else "Talus"


def save(figure, path, dpi=RESOLUTION):
    """Writes a figure as PNG, whose metadata say in "Software" which program drew it, and closes it. Returns the path."""
    path.parent.mkdir(exist_ok=True)
    figure.set_dpi(dpi)
    figure.canvas.draw()
    path.write_bytes(png(np.asarray(figure.canvas.buffer_rgba())[..., :3], dpi))
    plt.close(figure)
    return path


def png(picture, dpi):
    """A file of a picture [rows, columns, 3]. Lines are packed as they are: charts are smaller so, and in a third of the time that a choice among the filters
    of the format takes."""
    lines = np.zeros((len(picture), 1 + picture[0].size), np.uint8)
    lines[:, 1:] = picture.reshape(len(picture), -1)
    metre, about = round(dpi / 0.0254), f"Software\0{program()}, Matplotlib {matplotlib.__version__}".encode("latin-1")
    parts = ((b"IHDR", struct.pack(">IIBBBBB", picture.shape[1], picture.shape[0], 8, 2, 0, 0, 0)), (b"tEXt", about), (b"pHYs", struct.pack(">IIB", metre, metre, 1)),
             (b"IDAT", zlib.compress(lines, PACKED)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts)
