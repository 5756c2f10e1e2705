"""Which soil of a run slides: how far most of it moved, whether it has come to rest, and how thick it is."""

import numpy as np

SLIDES = 0.1  # share of the largest displacement beyond which soil slides
SMALL = 0.1  # share of the spacing of particles below which the largest displacement is that of soil that stands


def spacing(snapshot):
    """Mean distance of neighbouring particles, by their volume [m]; 0 without particles."""
    volume = snapshot.column("volume").values
    return float(volume.mean()) ** (1 / snapshot.position().shape[1]) if len(volume) else 0.0


OF_MOVED, SEVERAL = 0.05, 50


def largest_displacement(snapshot, share=0.999):
    """The displacement that this share of the mass has at most [m]: the largest, without single particles. Where SEVERAL particles or more moved by more
    than their own size, single ones are no more than OF_MOVED of the mass of these: so that a small slide in a large model is none of them."""
    moved = snapshot.scalar("displacement")[0]
    if not len(moved):
        return 0.0
    try:
        mass = snapshot.column("mass").values[:, 0]
    except KeyError:  # results of other programs
        mass = np.ones(len(moved))
    single = (1 - share) * mass.sum()
    try:
        size = snapshot.column("volume").values[:, 0] ** (1 / snapshot.position().shape[1])
    except KeyError:
        size = np.inf
    slid = moved > size
    if slid.sum() >= SEVERAL:
        single = min(single, OF_MOVED * mass[slid].sum())
    order = np.argsort(moved)
    return float(moved[order][np.searchsorted(np.cumsum(mass[order]), mass.sum() - single)])


def sliding(last):
    """Which particles have slid by the last snapshot: those that have moved by more than SLIDES of the largest displacement; none where this is below
    SMALL of the spacing of particles. Whether soil slid or deformed as a whole is for talus_outcomes to say."""
    return slides(last.scalar("displacement")[0], largest_displacement(last), spacing(last))


def slides(displacement, largest, spacing):
    """The same of displacements [m] of particles with this spacing."""
    return displacement > SLIDES * largest if largest > SMALL * spacing else np.zeros(len(displacement), bool)


# the log decides it likewise: src/simulation/still_moving.h
SLOW = 0.1  # speed that soil at rest does not have [m/s]
RESTLESS = 0.01  # share of the mass that slid: where more of it is faster than SLOW, it has not come to rest


def still_moving(snapshot, numbers):
    """The share of the soil with these numbers that is faster than SLOW, and the speed that 99.9 % of it have at most [m/s]; None where it has come to
    rest, as at most RESTLESS of it is faster."""
    of = np.isin(snapshot.ids(), numbers, assume_unique=True)
    if not of.any() or "velocity" not in snapshot:
        return None
    speed = snapshot.scalar("velocity")[0][of]
    mass = snapshot.column("mass").values[of, 0] if "mass" in snapshot else np.ones(len(speed))
    share = mass[speed > SLOW].sum() / mass.sum()
    return (float(share), float(np.quantile(speed, 0.999))) if share > RESTLESS else None


class Thickness:
    """The thickness of the soil that slides until the end: its volume per area on the level, in m, over a few particles. `sliding` holds the numbers of
    the particles of this soil. Thickness is 0 for other soil."""

    WIDE = 2.5  # side of the squares between which volume is shared, over the spacing of particles

    def __init__(self, last, up):
        self._level = [axis for axis in range(3) if axis != up]
        self.sliding = last.ids()[sliding(last)]
        self._spacing = spacing(last) or 1.0

    def __call__(self, snapshot):
        sliding = np.isin(snapshot.ids(), self.sliding, assume_unique=True)
        thickness = np.zeros(len(sliding))
        if sliding.any():
            place = snapshot.position()[:, self._level]
            low, high = place.min(axis=0) - self._spacing / 2, place.max(axis=0) + self._spacing / 2
            count = np.maximum(2, np.round((high - low) / (self.WIDE * self._spacing)).astype(int))
            side = (high - low) / count
            exact = np.clip((place[sliding] - low) / side - 0.5, 0, count - 1)  # soil at the edges counts for the outermost squares
            first = np.minimum(exact.astype(int), count - 2)
            corners = [(np.prod(np.where(corner, exact - first, 1 - exact + first), axis=1), np.ravel_multi_index((first + corner).T, count))
                       for corner in np.ndindex(2, 2)]
            volume = snapshot.column("volume").values[sliding, 0]
            held = sum(np.bincount(number, share * volume, np.prod(count)) for share, number in corners) / np.prod(side)
            thickness[sliding] = sum(share * held[number] for share, number in corners)
        return thickness, "m"
