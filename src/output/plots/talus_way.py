"""The way of a slide on the level: from behind its crown along the path of its centre of mass to beyond its toe. Sections of maps and pictures follow it."""

import numpy as np

BEYOND = 0.15  # of the distance from crown to toe: how far the way goes on behind the one and beyond the other
NEARLY = 0.95  # of the distance from crown to toe: soil straight on that is as far is as good as the toe
SHARP = 0.5  # cosine of the largest turn at the ends of the path


class Way:
    """A line through `corners` [n, 2] in m, which goes on straight beyond its ends. `ahead` are corners of the line that follows the path alone and goes on in
    its directions, as far as crown and toe are; `end` [2] is the end of the path."""

    def __init__(self, corners, ahead):
        self.corners, self.ahead = np.asarray(corners, float), np.asarray(ahead, float)
        self.end = self.ahead[-2]
        steps = np.diff(self.corners, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        self._direction = steps / lengths[:, None]
        self._begin = np.concatenate([[0], np.cumsum(lengths)])
        self.length = float(self._begin[-1])

    @classmethod
    def of(cls, path, release, height, deposit, size):
        """Along the places of the centre of mass [n, 2], one after the other, of particles of this size: from the highest of the places `release` [n, 2], whose
        heights are given, to the place of the deposit [n, 2] that is furthest from it. Of several that are so to within `size` the way leads to that which lies
        straightest on. It goes straight on beyond the path where soil lies there that is nearly as far, or where it would have to turn sharply, as in a slide
        that moved by less than its own width."""
        path = path[np.isfinite(path[:, 0])]
        crown, crowns = release[height.argmax()], release[height >= height.max() - size]
        distance = np.linalg.norm(deposit - crown, axis=1)
        toes = deposit[distance >= distance.max() - size]
        kept = without_hook(path, size, spread_of(deposit))
        if np.linalg.norm(kept[-1] - kept[-2]) <= 2 * size:
            kept = [crowns.mean(axis=0), toes.mean(axis=0)]
        beyond = BEYOND * distance.max()
        ends, straight = [], []
        for end, beside, reached in ((kept[0], kept[1], crowns), (kept[-1], kept[-2], toes)):
            out = (end - beside) / np.linalg.norm(end - beside)
            across = np.array([-out[1], out[0]])
            through = reached[np.abs((reached - end) @ across).argmin()]
            straight.append(end + out * (max((through - end) @ out, 0) + beyond))
            bend = through - end
            met = (distance >= NEARLY * distance.max()) & (np.abs((deposit - end) @ across) <= size) & ((deposit - end) @ out > 0)
            sharp = bend @ out <= SHARP * np.linalg.norm(bend)
            if sharp or np.linalg.norm(bend) <= 2 * size or (reached is toes and met.any()):  # too near for a direction, or not needed
                ends.append([straight[-1]])
            else:
                ends.append([through, through + beyond * bend / np.linalg.norm(bend)])
        return cls([*ends[0][::-1], *kept, *ends[1]], [straight[0], *kept, straight[1]])

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


def without_hook(path, size, spread):
    """The places of a path that are more than two sizes of a particle apart, and its end. Soil that comes to rest in a bend turns back from its flank, and its
    centre of mass in all directions: the last piece of the path, as long as the spread of the deposit, is straight."""
    kept = [path[0]]
    for place in path[1:]:
        if np.linalg.norm(place - kept[-1]) > 2 * size:
            kept.append(place)
    far = np.flatnonzero(np.linalg.norm(kept - path[-1], axis=1) > max(spread, 2 * size))
    return kept[:far[-1] + 1 if len(far) else 1] + [path[-1]]


def spread_of(position):
    """Root mean square of the distances of places [n, 2] from their middle [m]."""
    return float(np.sqrt(((position - position.mean(axis=0)) ** 2).sum(axis=1).mean()))
