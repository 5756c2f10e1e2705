"""Imported first by the scripts that the program starts: Ctrl-C and errors end them with one line in place of a traceback, and they end with the
program."""

import ctypes
import os
import pathlib
import signal
import sys

PR_SET_PDEATHSIG = 1  # of linux/prctl.h
PACKAGES = {"numpy": "python3-numpy", "matplotlib": "python3-matplotlib", "h5py": "python3-h5py", "osgeo": "python3-gdal"}  # of Debian
FIRST = os.getpid()  # the script itself and none of its workers


def ended(number, _):
    """Unwinds, so that files half written are removed, and says so once."""
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, signal.SIG_IGN)
    if os.getpid() == FIRST:
        print("talus: interrupted", file=sys.stderr, flush=True)
    raise SystemExit(128 + number)


def in_one_line(error):
    """What an error that no script expects says to a user: a cause outside of the scripts as such, else where it happened."""
    if isinstance(error, ImportError):
        told = [name for name in PACKAGES if name in (error.name or "").split(".") or f"'{name}'" in str(error)]
        return f"pictures and maps need Python modules of which one cannot be loaded ({error}); install " + " ".join(PACKAGES[name] for name in told or PACKAGES)
    if isinstance(error, MemoryError):
        return "the memory of this machine, or a limit of it (ulimit -v), does not suffice"
    if isinstance(error, OSError) and error.filename is not None:
        return f"{error.filename}: {error.strerror}"
    if isinstance(error, OSError):
        return str(error)
    at = error.__traceback__
    own = at
    while at:  # the innermost place in these scripts
        own = at if pathlib.Path(at.tb_frame.f_code.co_filename).parent == pathlib.Path(__file__).parent else own
        at = at.tb_next
    place = f"{pathlib.Path(own.tb_frame.f_code.co_filename).name} line {own.tb_lineno}" if own else "a script"
    return f"a file of the results is damaged, or {place} has a fault: {type(error).__name__}: {error}"


def say_error(kind, error, _):
    if issubclass(kind, BrokenPipeError):  # who reads the output may leave early
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return
    print(f"talus: {' '.join(in_one_line(error).split())}", file=sys.stderr, flush=True)


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
    sys.excepthook = say_error
    if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:  # as of a job in the background
        signal.signal(signal.SIGINT, ended)
    signal.signal(signal.SIGTERM, ended)
    if "TALUS_PROGRAM" in os.environ:  # which the program sets
        end_with_parent()
