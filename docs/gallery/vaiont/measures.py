"""Measures of this page alone, written like those of src/output/plots/talus_measures.py."""

import numpy as np


def levels(results):
    """Level of the water above the horizontal plane in the rows of the history [m]; below zero before it rises."""
    history = results.history
    of_load = np.interp(history.columns["load_time_s"], *np.array(results.scene["functions"]["hw"], float).T)
    return np.where(np.isin(history.stage, ("water", "slide")), of_load, -1.0)


def displacement_at_level(results, point, level):
    """Displacement of a point when the rising water reached a level [m]."""
    return results.history.columns[f"{point}_displacement_m"][np.flatnonzero(levels(results) >= level - 1e-9)[0]]


def speed_in_stage(results, point, stage):
    """Largest speed of a point in a stage [m/s]."""
    rows = np.array(results.history.stage) == stage
    return results.history.columns[f"{point}_velocity_m_s"][rows].max()


def run_out(results, point):
    """Largest horizontal displacement of a point [m]."""
    return results.history.columns[f"{point}_displacement_x_m"].max()


MEASURES = {"displacement_at_level": displacement_at_level, "speed_in_stage": speed_in_stage, "run_out": run_out}
