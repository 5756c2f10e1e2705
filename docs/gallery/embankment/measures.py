"""How quiet the slide of the embankment is: measures of numbers.toml beside those of src/output/plots/talus_measures.py."""

import numpy as np

WET, DRY = 0.97, 0.95  # degrees of saturation: the front has passed; water is missing again
STRIP = 0.5  # width of the columns in which the surface of the soil is found [m]
WEIGHT_OF_WATER = 9810.0  # [N/m3]


def while_it_slides(results, by=0.5):
    """Snapshots of the last stage after some soil has moved by more than `by`, and which particles the front had passed before each."""
    passed = np.zeros(len(results.snapshots[0].ids()), bool)
    for snapshot in results.snapshots:
        if snapshot.stage != results.snapshots[-1].stage:
            continue
        wet = snapshot.scalar("saturation")[0] > WET
        passed = passed | wet
        if snapshot.scalar("displacement")[0].max() > by:
            yield snapshot, passed


def depth(snapshot):
    """Depth of the particles below the highest one in their column [m]."""
    x, y = snapshot.position()[:, 0], snapshot.position()[:, 1]
    column = np.floor(x / STRIP).astype(int)
    column -= column.min()
    top = np.full(column.max() + 1, -np.inf)
    np.maximum.at(top, column, y)
    return top[column] - y


def share_behind_the_front_that_is_dry(results):
    """Mean over the slide of the share of the particles passed by the wetting front whose saturation is below 0.95 again."""
    return float(np.mean([(snapshot.scalar("saturation")[0][passed] < DRY).mean() for snapshot, passed in while_it_slides(results)]))


def share_behind_the_front_that_is_dry_at_the_end(results):
    """The same share at the end."""
    *_, (snapshot, passed) = while_it_slides(results)
    return float((snapshot.scalar("saturation")[0][passed] < DRY).mean())


def largest_pressure_while_it_slides(results):
    """Largest pore pressure of a particle in the snapshots of the slide [Pa]."""
    return float(max(snapshot.scalar("pore_pressure")[0].max() for snapshot, _ in while_it_slides(results)))


def hydrostatic_pressure_behind_the_front(results):
    """Largest depth of saturated particles in the snapshots of the slide, as pressure of still water [Pa]."""
    return float(max(WEIGHT_OF_WATER * depth(snapshot)[snapshot.scalar("saturation")[0] > 0.99].max() for snapshot, _ in while_it_slides(results)))


MEASURES = {function.__name__: function for function in (share_behind_the_front_that_is_dry, share_behind_the_front_that_is_dry_at_the_end,
                                                         largest_pressure_while_it_slides, hydrostatic_pressure_behind_the_front)}
