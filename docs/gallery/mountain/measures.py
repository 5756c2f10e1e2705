"""How far the debris goes, from the first and the last snapshot of a run. x points east, z up."""

import numpy as np


def centre(snapshot):
    mass = snapshot.values("mass")
    return (snapshot.position() * mass[:, None]).sum(axis=0) / mass.sum()


def centre_way(results):
    """Horizontal way of the centre of mass, as the crow flies [m]."""
    return np.hypot(*(centre(results.snapshots[-1]) - centre(results.snapshots[0]))[:2])


def centre_friction(results):
    """Friction angle of a rigid block that comes to rest as the centre of mass does [rad]: its fall over the horizontal length of its way."""
    places = np.array([centre(snapshot) for snapshot in results.snapshots])
    return np.arctan((places[0, 2] - places[-1, 2]) / np.hypot(*np.diff(places[:, :2], axis=0).T).sum())


def front(results):
    """East of the window's corner, behind which 99 % of the mass lie at the end [m]."""
    return np.quantile(results.snapshots[-1].position()[:, 0], 0.99)


def left(results):
    """Share of the mass that has moved by more than 100 m."""
    last = results.snapshots[-1]
    mass = last.values("mass")
    return mass[np.linalg.norm(last.values("displacement"), axis=1) > 100].sum() / mass.sum()


def volume(results):
    """Of the slide, in the first snapshot [m3]."""
    return results.snapshots[0].values("mass").sum() / 2000


def speed(results):
    """Largest of the centre of mass, between snapshots [m/s]."""
    places = np.array([centre(snapshot) for snapshot in results.snapshots])
    return (np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff([snapshot.time for snapshot in results.snapshots])).max()


MEASURES = {function.__name__: function for function in (centre_way, centre_friction, front, left, volume, speed)}
