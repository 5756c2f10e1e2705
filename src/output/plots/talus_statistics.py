"""The arithmetic of studies: intervals of probabilities, limits of refined values."""

import math

import numpy as np

ORDERS = (0.5, 3.0)  # of convergence: errors of cells and steps have 1 or 2; beyond 3 two values are near by chance
NEAR = 0.1  # of what is allowed: a last change that is smaller is none, whatever the order


def solved(function, target, low=0.0, high=1.0):
    """Where an increasing function has a value, by bisection."""
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < target else (low, middle)
    return 0.5 * (low + high)


def binomial_tail(k, n, p):
    """Probability of k or more successes in n trials of probability 0 < p < 1."""
    terms = [math.lgamma(n + 1) - math.lgamma(i + 1) - math.lgamma(n - i + 1) + i * math.log(p) + (n - i) * math.log1p(-p) for i in range(k, n + 1)]
    return min(1.0, math.fsum(map(math.exp, terms)))


def clopper_pearson(k, n, confidence):
    """Interval of a probability of which k of n independent trials had success (Clopper & Pearson 1934). It covers the probability at least
    with the confidence; for a Latin hypercube, whose estimates scatter less, with more."""
    rest = 0.5 * (1 - confidence)
    low = 0.0 if k == 0 else solved(lambda p: binomial_tail(k, n, p), rest)
    return low, 1.0 if k == n else solved(lambda p: binomial_tail(k + 1, n, p), 1 - rest)


def order_of(sizes, values, bounds):
    """The order p within bounds with which three values, from coarse to fine, go one way to a limit: value = limit + C size**p. None where there is none: their
    changes grow, or shrink too little or too much."""
    before, last = values[1] - values[0], values[2] - values[1]
    def ratio(p):  # of the changes; it grows with p
        return (sizes[0] ** p - sizes[1] ** p) / (sizes[1] ** p - sizes[2] ** p)
    low, high = bounds
    return solved(ratio, before / last, low, high) if last and ratio(low) <= before / last <= ratio(high) else None


def rest_of(sizes, values, order):
    """What is left from the finest value up to the limit (Richardson's extrapolation)."""
    return (values[-1] - values[-2]) / ((sizes[-2] / sizes[-1]) ** order - 1)


def extrapolate(refined):
    """(value, uncertainty, origin) of the limit of values refined by a parameter that goes to zero, from the three finest: Richardson's extrapolation with
    the order that they show, if they converge at one between 0.5 and 8, and if above 2.5 a fourth run, where there is one, lies on the same way (a high order
    is otherwise a coincidence of the last two runs); otherwise the finest value, as uncertain as the last two refinements changed it. A refinement that
    changed nothing, such as a tolerance where stability rules, is none."""
    known = []  # from coarse to fine
    for size, value in sorted(((size, value) for size, value in refined if None not in (size, value)), reverse=True):
        if not known or known[-1][1] != value:
            known.append((size, value))
    sizes, values = ([pair[k] for pair in known[-4:]] for k in (0, 1))
    changes = np.diff(values)
    if not len(changes):
        return math.nan, math.inf, "no two runs differ by their last key: give --exact or --reference"
    order = None
    if len(values) > 2 and 0 < sizes[-1] < sizes[-2] and abs(sizes[-2] / sizes[-1] - sizes[-3] / sizes[-2]) < 0.05 * sizes[-2] / sizes[-1]:
        order = order_of(sizes[-3:], values[-3:], (0.5, 8))
    if order and (order <= 2.5 or len(changes) < 3 or changes[0] / changes[1] >= 1):
        rest = rest_of(sizes, values, order)
        return values[-1] + rest, abs(rest), f"extrapolated at the observed order {order:.2g}"
    return values[-1], float(max(abs(changes[-2:]))), "its finest run"


def settles(sizes, values, within, least=0.0):
    """What refinement does to a quantity, whose `sizes` and `values` go from coarse to fine. Allowed is a share `within` of the finest value, or `least`.
    "missing": only some of the runs have it.
    "equal": all values differ by no more than what is allowed.
    "settles": the values go one way to a limit, and every three of them as if their error was a power of the size between the ORDERS; neither the last change
    nor the rest up to that limit is more than what is allowed.
    "near": the values go one way, the last change is at most NEAR of what is allowed and the one before at most twice it: too fast for an order, and small.
    "swings": the values go to and fro.
    "open": all else."""
    if None in values:
        return "missing"
    allowed, changes = max(within * abs(values[-1]), least), np.diff(values)
    if np.ptp(values) <= allowed:
        return "equal"
    if min(changes) < 0 < max(changes):
        return "swings"
    orders = [order_of(sizes[k:k + 3], values[k:k + 3], ORDERS) for k in range(len(values) - 2)]
    if None not in orders and max(abs(changes[-1]), abs(rest_of(sizes, values, orders[-1]))) <= allowed:
        return "settles"
    return "near" if abs(changes[-1]) <= NEAR * allowed and abs(changes[-2]) <= 2 * allowed else "open"
