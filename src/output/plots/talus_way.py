"""The way of a slide on the level: the path of its centre of mass, from behind its crown to beyond its toe. Sections of maps and pictures follow it."""

import numpy as np


class Way:
    """A line through `corners` [n, 2] in m, which goes on straight beyond its ends."""

    def __init__(self, corners):
        self.corners = np.asarray(corners, float)
        steps = np.diff(self.corners, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        self._direction = steps / lengths[:, None]
        self._begin = np.concatenate([[0], np.cumsum(lengths)])
        self.length = float(self._begin[-1])

    @classmethod
    def of(cls, path, crown, toe, size):
        """Along the places of the centre of mass [n, 2], one after the other, of particles of this size; `crown` and `toe` are places [2]."""
        path = path[np.isfinite(path[:, 0])]
        kept = [path[0]]
        for place in path[1:]:  # a centre of mass that comes to rest turns in all directions
            if np.linalg.norm(place - kept[-1]) > 2 * size:
                kept.append(place)
        if len(kept) < 2:
            kept = [crown, toe]
        kept = np.array(kept)
        ends = []
        for end, beside, reached in ((kept[0], kept[1], crown), (kept[-1], kept[-2], toe)):
            out = (end - beside) / np.linalg.norm(end - beside)
            ends.append(end + out * (max((reached - end) @ out, 0) + 0.15 * np.linalg.norm(toe - crown)))
        return cls([ends[0], *kept, ends[1]])

    def at(self, distance):
        """Places at distances from the first corner [n, 2]."""
        return np.column_stack([np.interp(distance, self._begin, self.corners[:, k]) for k in (0, 1)])

    def beside(self, place):
        """Of places [n, 2]: the distance along the way, and how far they are from it [m]."""
        along, aside = np.zeros(len(place)), np.full(len(place), np.inf)
        last = len(self._direction) - 1
        for k, direction in enumerate(self._direction):
            way = (place - self.corners[k]) @ direction
            way = np.clip(way, -np.inf if k == 0 else 0, np.inf if k == last else self._begin[k + 1] - self._begin[k])
            away = np.linalg.norm(place - self.corners[k] - way[:, None] * direction, axis=1)
            nearer = away < aside
            along, aside = np.where(nearer, self._begin[k] + way, along), np.where(nearer, away, aside)
        return along, aside

    def chord(self):
        """Direction from the first to the last corner [2]."""
        chord = self.corners[-1] - self.corners[0]
        return chord / np.linalg.norm(chord)
