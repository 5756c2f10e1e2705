"""The scale of colours of a field."""

import numpy as np
from matplotlib.colors import LogNorm, Normalize, PowerNorm

import talus_style as style
from talus_units import readable_unit


class Colours:
    """The scale that all pictures of a field share: from 0, or the least value if negative, to nearly the largest. That of plastic strain is even
    in its square root, so that the thin band at failure is seen beside the large strain of the slide; that of mobilised friction in its fourth power,
    since soil near failure, where the last degrees count, would be of one colour otherwise."""

    def __init__(self, field, snapshots, log=False):
        self.map = style.colours_of(field)
        values = np.concatenate([snapshot.scalar(field)[0] for snapshot in snapshots])
        values = values[np.isfinite(values)]
        low, high = np.percentile(values, [0.1, 99.9]) if len(values) else (0.0, 0.0)
        self.factor, self.unit = readable_unit(max(abs(low), abs(high)), snapshots[0].scalar(field)[1])
        low, high = -rounded_up(-min(low, 0.0) * self.factor), rounded_up(max(high, 0.0) * self.factor)
        if low == high:
            high = 1.0
        if field == "state":
            low, high = -0.5, len(style.STATES) - 0.5
        self.names = style.STATES if field == "state" else ()
        self.beyond = len(values) > 0 and values.max() * self.factor > high
        self.from_nothing = low == 0 and not self.names
        self.rooted = field == "plastic_strain" and low == 0 and not log
        power = 0.5 if self.rooted else 4 if field == "mobilised_friction" and low == 0 else 1
        self.uneven = {0.5: "colours even in the square root", 4: "colours even in the fourth power"}.get(power, "")
        self.ticks = [float(f"{high * share:.2g}") for share in (0, 0.7, 0.85, 0.93, 1)] if power == 4 else None
        self.norm = LogNorm(1e-3 * high, high, clip=True) if log and low == 0 else PowerNorm(power, low, high) if power != 1 else Normalize(low, high)


def rounded_up(value):
    """The next number of two digits: 1.834 -> 1.9."""
    if value <= 0:
        return 0.0
    step = 10.0 ** (np.floor(np.log10(value)) - 1)
    return float(np.ceil(round(value / step, 6)) * step)
