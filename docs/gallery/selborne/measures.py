"""What the page on Selborne states besides the measures of all pages."""
import numpy as np

from talus_lines import dimensionless, means


def column(results, name):
    """Times and values of a column of history.csv after gravity."""
    after = [k for k, stage in enumerate(results.history.stage) if stage not in ("start", "gravity")]
    return np.asarray(results.history.time)[after], np.asarray(results.history[name])[after]


def rise_at_failure(results, point):
    """Pore pressure at failure beyond that at the end of gravity [Pa]."""
    time, pressure = column(results, f"{point}_pore_pressure_Pa")
    return pressure[np.argmin(np.abs(dimensionless(results, time) - 1))] - pressure[0]


def acceleration(results, point, over=1.0):
    """Largest mean acceleration over a time [m/s2]."""
    time, speed = column(results, f"{point}_velocity_m_s")
    inside = time + over <= time[-1]
    return float(np.max(np.abs(np.interp(time + over, time, speed) - speed)[inside])) / over


def sliding_time(results, point, speed=0.02):
    """Time between the first and the last moment at which a point is faster than `speed` [s]."""
    time, values = column(results, f"{point}_velocity_m_s")
    fast = time[values > speed]
    return float(fast[-1] - fast[0])


def friction(results, line):
    """Of a line, after gravity and before failure: t*, its mean mobilised friction [deg], whether a place of it has yielded."""
    followed = results.lines()[line]
    relative, mean = dimensionless(results, followed.time), means(followed)
    before = (relative > 0) & (relative <= 1)
    return relative[before], mean["mean_mobilised_friction_deg"][before], mean["share_elastic"][before] < 1


def first_yield(results, line):
    """t* at which the first place of a line yields."""
    relative, _, yielded = friction(results, line)
    return float(relative[np.argmax(yielded)])


def plateau(results, line):
    """Mean mobilised friction of a line between its first yield and failure, from t* = first yield + 0.15 to 0.99 [deg]."""
    relative, angle, _ = friction(results, line)
    return float(angle[(relative > first_yield(results, line) + 0.15) & (relative < 0.99)].mean())


MEASURES = {each.__name__: each for each in (rise_at_failure, acceleration, sliding_time, first_yield, plateau)}
