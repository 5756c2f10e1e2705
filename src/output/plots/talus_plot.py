#!/usr/bin/python3
"""Draws the pictures and the report of a run: DIR/pictures/*.png and DIR/report.html; or a film of it: DIR/pictures/movie_FIELD.gif and .mp4."""

import talus_interrupt  # noqa: F401  before all that takes time

import argparse
import difflib
import sys

import numpy as np

from talus_cores import on_two_cores
from talus_factor import draw_factor
from talus_histories import draw_histories
from talus_lines import draw_lines
from talus_model import draw_model
from talus_modelled import read_model
from talus_movie import draw_movies
from talus_paths import draw_stress_paths
from talus_pdf import print_report
from talus_play import scripts
from talus_report import Drawn, key_results, write_report
from talus_results import NOT_ENDED, Results
from talus_sections import section_tasks
from talus_slip import draw_slip_surface
from talus_units import use

FIELDS = ("displacement", "thickness", "plastic_strain", "velocity", "pore_pressure", "suction", "saturation", "surface", "mobilised_friction", "state")
OVER_TIME = ("displacement", "thickness")  # which have a sheet of several times unasked: the report plays the others
OF_PARTICLES = ("id", "body")  # numbers that are no quantities
OF_MECHANISM = "shear_strain"  # field that says nothing but of the mechanism of a factor of safety
OF_PORES = ("pore_pressure", "gas_pressure", "suction", "saturation")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", metavar="DIR", help="folder of the run")
    parser.add_argument("--fields", nargs="+", metavar="FIELD",
                        help="columns to draw; a vector by its size, a tensor by its mean, or one component: stress_xy")
    parser.add_argument("--times", nargs="+", type=float, metavar="T", help="times to draw [s], the nearest snapshots")
    parser.add_argument("--log", action="store_true", help="plastic strain on a logarithmic scale")
    parser.add_argument("--slip-surface", action="store_true", help="find the slip surface, at the first of the times or at failure")
    parser.add_argument("--movie", action="store_true", help="a film of the fields instead: of plastic strain or, without any, of displacement")
    parser.add_argument("--since", metavar="STAGE", help="displacement since the start of this stage, without what soil moved under its own weight before")
    parser.add_argument("--pdf", action="store_true", help="print the report as DIR/report.pdf too")
    return parser.parse_args()


class NoSuchField(ValueError):
    """An error of who asked for the pictures."""


def checked(folder, fields=None):
    """The results in a folder, which have snapshots and the fields. Raises NoSuchField with the nearest one."""
    results = Results(folder)
    use(results.scene)
    if not results.snapshots:
        raise ValueError(f"{folder} contains no snapshots")
    first = results.snapshots[0]
    for field in fields or ():
        if field in OF_PARTICLES:
            raise NoSuchField(f"{field} is a number of particles and no quantity with a scale: pictures/model.png has the bodies with their names; fields are {', '.join(first.names())}")
        if first.scalar(field) is None:
            if field in OF_PORES and results.scene.get("phases", "dry") == "dry":
                raise NoSuchField(f"{folder} has no field {field}: its run is dry (phases); it has {', '.join(first.names())}")
            nearest = difflib.get_close_matches(field, first.names(), 1)
            raise NoSuchField(f"{folder} has no field {field}{f'; did you mean {nearest[0]}?' if nearest else ''}; it has {', '.join(first.names())}")
    return results


def tell_of_times(results, times):
    """Says which of the times lie outside of the run: the nearest snapshots are shown then."""
    first, last = results.snapshots[0].time, results.snapshots[-1].time
    for time in times or ():
        if not first <= time <= last * (1 + 1e-9):
            shown = first if time < first else last
            print(f"talus: --times {time:g}: the run has snapshots from {first:g} to {last:.6g} s; that at {shown:.6g} s is shown", file=sys.stderr)


def draw(folder, fields=None, times=None, log=False, slip_surface=False, since=None):
    """Draws everything; without `fields`, those of FIELDS that the run has, of which the state of strength only where strength was lost. Returns
    the report's path."""
    results = checked(folder, fields)
    if since:
        try:
            results = results.since(since)
        except KeyError as error:
            raise NoSuchField(f"--since: {error.args[0]}") from error
    tell_of_times(results, times)
    if results.broke_off() == NOT_ENDED:  # a run that broke off has said why
        print(f"talus: the run in {folder} is incomplete: {NOT_ENDED}; the pictures show it up to {results.snapshots[-1].time:.6g} s", file=sys.stderr)
    if cut := results.cut_history():
        print(f"talus: {cut}", file=sys.stderr)
    pictures = results.folder / "pictures"
    slip, without = [], None
    if slip_surface:  # before the sections, which show it
        try:
            slip = draw_slip_surface(results.before_reduction(), pictures, times[0] if times else None)
        except ValueError as error:
            without = error  # everything else is drawn
    usual = [field for field in FIELDS if field != "state" or lost_strength(results)]
    whole, results = results, results.before_reduction()
    of_mechanism = [field for field in fields or () if field == OF_MECHANISM and whole is not results]
    sections = section_tasks(results, [field for field in fields or usual if field not in of_mechanism], times, pictures, log, None if fields or times else OVER_TIME)
    if of_mechanism:
        sections += section_tasks(whole.of_reduction(), of_mechanism, times, pictures)
    model = read_model(results.folder)
    others = [lambda: draw_histories(results, pictures), lambda: model and draw_model(model, pictures / "model.png"), lambda: scripts(results), lambda: key_results(results, model),
              lambda: draw_stress_paths(results, pictures), lambda: draw_lines(results, pictures, times), lambda: draw_factor(whole, pictures)]
    *sections, histories, modelled, played, numbers, paths, lines, factor = on_two_cores([*sections, *others])
    report = write_report(results, model, Drawn(numbers, sections, histories + paths + lines + slip, factor, modelled, played))
    if without:
        raise without
    return report


def film(folder, fields=None, log=False):
    """Draws a film of each field; without `fields` of plastic strain or, where there is none, of displacement."""
    results = checked(folder, fields).before_reduction()
    if not fields:
        strain = results.snapshots[-1].scalar("plastic_strain")
        fields = ["plastic_strain" if strain is not None and np.any(strain[0] > 0) else "displacement"]
    draw_movies(results, fields, results.folder / "pictures", log)


def lost_strength(results):
    """Has any soil softened? The state is then 2 or 3 somewhere."""
    last = results.snapshots[-1].scalar("state")
    return last is not None and bool((last[0] > 1).any())


def main():
    given = arguments()
    try:
        if given.movie:
            film(given.folder, given.fields, given.log)
        else:
            report = draw(given.folder, given.fields, given.times, given.log, given.slip_surface, given.since)
            if given.pdf:
                print_report(report)
    except NoSuchField as error:
        print(f"talus: {error}", file=sys.stderr)
        return 2
    except ValueError as error:
        sys.exit(f"talus: {error}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
