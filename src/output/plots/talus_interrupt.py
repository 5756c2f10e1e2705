"""Imported first by the scripts that the program starts: Ctrl-C ends them with one line in place of a traceback, and they end with the program."""

import ctypes
import os
import pathlib
import signal
import sys

PR_SET_PDEATHSIG = 1  # of linux/prctl.h
FIRST = os.getpid()  # the script itself and none of its workers


def ended(number, _):
    """Unwinds, so that files half written are removed, and says so once."""
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, signal.SIG_IGN)
    if os.getpid() == FIRST:
        print("talus: interrupted", file=sys.stderr, flush=True)
    raise SystemExit(128 + number)


def end_with_parent():
    """Lets this process get SIGTERM when the one that started it is gone; Linux alone can."""
    try:
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    except (AttributeError, OSError):
        pass


def is_script():
    """Is the script of this process one of those beside this file, and not a test or a user's own?"""
    script = getattr(sys.modules["__main__"], "__file__", None)
    return script is not None and pathlib.Path(script).resolve().parent == pathlib.Path(__file__).resolve().parent


if is_script():
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:  # as of a job in the background
        signal.signal(signal.SIGINT, ended)
    signal.signal(signal.SIGTERM, ended)
    if "TALUS_PROGRAM" in os.environ:  # which the program sets
        end_with_parent()
