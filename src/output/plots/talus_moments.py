"""The times of a run that pictures show."""

import types

import numpy as np

TIME = 0.2  # share of time, against motion, in the choice of snapshots
MOTION = ("displacement", "velocity", "plastic_strain", "thickness")  # fields that are nothing as long as soil has not moved
RESET = ("displacement", "plastic_strain")  # of these, what counts is since the last reset
PART = 0.25  # of the spacing of particles: soil that has moved by less is where it was
SHADE = 0.02  # of the scale of colours: less is not seen


def chosen_snapshots(results, times=None, count=6):
    """Snapshots nearest to `times`; else first, last and some between: evenly by how far things moved, and by a share of TIME also by time, so
    that a long wait before a failure is one picture and not three. Of those that have soil: all of it may have left the mesh."""
    snapshots = [snapshot for snapshot in results.snapshots if len(snapshot.ids())]
    at = np.array([snapshot.time for snapshot in snapshots])
    if times:
        return [snapshots[k] for k in sorted({int(np.abs(at - time).argmin()) for time in times})]
    if len(snapshots) <= count:
        return snapshots
    travel = np.concatenate([[0], np.cumsum([advance(a, b) for a, b in zip(snapshots, snapshots[1:])])])
    pace = sum((share * part / part[-1] for share, part in ((TIME, at - at[0]), (1 - TIME, travel)) if part[-1] > 0), np.zeros(len(at)))
    wanted = np.linspace(0, pace[-1], count)
    return [snapshots[k] for k in sorted({int(np.abs(pace - share).argmin()) for share in wanted})]


def advance(before, after):
    """How far the fastest hundredth of the particles that are in both snapshots moved between them [m]."""
    start, end = in_both(before, after)
    return float(np.percentile(np.linalg.norm(end - start, axis=1), 99)) if len(start) else 0.0


def in_both(before, after):
    """Places in two snapshots of the particles that are in both [m]."""
    _, a, b = np.intersect1d(before.ids(), after.ids(), assume_unique=True, return_indices=True)
    return before.position()[a], after.position()[b]


def with_stress(results, snapshots, field):
    """The snapshots, but in place of the first one, where the field is nothing in it and no measure of motion, that of the end of the stage that follows:
    gravity and pore pressure grow from 0 in a first stage, so that the start would show soil without stress and without water."""
    first = snapshots[0]
    nothing = field not in MOTION and not field.rpartition("_")[0] in MOTION and not np.any(np.nan_to_num(first.scalar(field)[0]))
    if not nothing or len(results.snapshots) < 3:
        return snapshots
    stage = results.snapshots[1].stage
    ready = [snapshot for snapshot in results.snapshots if snapshot.stage == stage and len(snapshot.ids())][-1:]
    return [*ready, *(snapshot for snapshot in snapshots[1:] if snapshot.time > ready[0].time)] if ready and np.any(np.nan_to_num(ready[0].scalar(field)[0])) \
        else snapshots


def of_reset(field):
    """Is this a field, or a component of one, that a reset sets to 0?"""
    return field in RESET or field.rpartition("_")[0] in RESET


def resets(results):
    """Time and stage of the last snapshot before each reset of displacement that the run went on after. A reset is at the end of a stage, whose last
    snapshot still has what is then set to 0."""
    if getattr(results, "counts_since", ""):
        return [(results.snapshots[0].time, results.snapshots[0].stage)]
    names = {stage.get("name") for stage in results.scene.get("stage", []) if stage.get("reset_displacement")}
    return [(one.time, one.stage) for one, after in zip(results.snapshots, results.snapshots[1:]) if one.stage in names and one.stage != after.stage]


def moved_before(results):
    """The displacement [m], and the stage at whose end it was set to zero, by which soil slid before the run begins, if it is more than elastic soil
    settles; None otherwise."""
    found = [(event["values"]["largest_displacement_m"], event["stage"]) for event in results.events("moved_before_reset")]
    return max(found, default=None)


def last_reset(results):
    """The last one of them; None without a reset."""
    return (resets(results) or [None])[-1]


def origin(results, snapshot):
    """The stage from whose end a field that resets set to 0 counts in a snapshot; empty where it counts from the start of the run."""
    return ([stage for time, stage in resets(results) if time < snapshot.time] or [""])[-1]


def since(stage):
    """What a picture says of this origin."""
    return f"since the end of stage {stage}" if stage else "since the start"


def scaled_by(results, snapshots, field):
    """Those of the snapshots that make the scale of a field: of one that a reset sets to 0 those after the last reset, so that the settlement under gravity
    does not hide what the slope does then; all where there are none."""
    reset = last_reset(results) if of_reset(field) else None
    return [snapshot for snapshot in snapshots if reset and snapshot.time > reset[0]] or snapshots


def origins(results, snapshots, field):
    """What each of the snapshots counts a field from, in words: a list of these, empty where all count from the same, which is second. The start, at which
    nothing has moved yet, counts from anything."""
    if not of_reset(field) or not resets(results):
        return [], ""
    stages = [origin(results, snapshot) for snapshot in snapshots]
    of_moved = {stage for stage, snapshot in zip(stages, snapshots) if snapshot is not results.snapshots[0]}
    return ([since(stage) for stage in stages], "") if len(of_moved) > 1 else ([], "".join(of_moved))


def after(reset, times):
    """Numbers of those of the times that come after the reset that last_reset has found; of all of them without a reset, or where fewer than two do."""
    later = np.flatnonzero(times > reset[0] * (1 + 1e-9)) if reset else []
    return later if len(later) > 1 else np.arange(len(times))


def since_reset(results, snapshots, field):
    """The snapshots; of a field that is set to 0 at the end of a stage the start and some after the last reset, so that the settlement under gravity does
    not hide what the slope does then. With the name of this stage, empty without a reset."""
    reset = last_reset(results) if of_reset(field) else None
    later = [snapshot for snapshot in results.snapshots if reset and snapshot.time > reset[0] and len(snapshot.ids())]
    if not later:
        return snapshots, ""
    chosen = lambda count: chosen_snapshots(types.SimpleNamespace(snapshots=later), count=count)
    size = lambda snapshot: np.nanpercentile(np.abs(snapshot.scalar(field)[0]), 99)
    first, *others = chosen(6)
    nothing_yet = others and size(first) < SHADE * size(others[-1])  # as the start, which is shown
    return [snapshots[0], *(others if nothing_yet else chosen(5))], reset[1]


def telling(snapshots, field, colours, spacing):
    """Of the snapshots those that show something else than the one before: soil that moved by a part of the spacing, or another colour in more than a
    hundredth of it."""
    kept = snapshots[:1]
    for snapshot in snapshots[1:]:
        _, a, b = np.intersect1d(kept[-1].ids(), snapshot.ids(), assume_unique=True, return_indices=True)
        same = len(a) == len(kept[-1].ids()) == len(snapshot.ids())
        if same and len(a):
            moved = np.linalg.norm(snapshot.position()[b] - kept[-1].position()[a], axis=1)
            before, after = (np.nan_to_num(np.ma.filled(colours.norm(colours.factor * one.scalar(field)[0][rows]), 0.0)) for one, rows in ((kept[-1], a), (snapshot, b)))
            same = np.percentile(moved, 99) < PART * spacing and (bool(colours.nothing) or np.percentile(np.abs(after - before), 99) < SHADE)
        if not same:
            kept.append(snapshot)
    return kept
