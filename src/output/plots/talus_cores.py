"""Work that two processes share: drawing takes most of the time of a report, and each picture stands alone."""

import os
import pickle
import signal

from talus_interrupt import end_with_parent


def on_two_cores(tasks):
    """What the functions `tasks` return, in their order; the longest should come first. Where there is a second core a process of its own does some of them,
    whichever is free the next one. What that one fails to do is done here, where errors are heard."""
    if len(tasks) < 2 or len(os.sched_getaffinity(0)) < 2:
        return [task() for task in tasks]
    (queue, waiting), (answer, said) = os.pipe(), os.pipe()
    os.write(waiting, bytes(range(len(tasks))))  # a task a byte, of which no two processes read the same
    os.close(waiting)
    other = os.fork()
    if other == 0:
        try:
            if "TALUS_PROGRAM" in os.environ:
                end_with_parent()
            done = [(number, tasks[number]()) for number in taken(queue)]
            with os.fdopen(said, "wb") as file:
                pickle.dump(done, file)
        finally:
            os._exit(0)
    os.close(said)
    try:
        found = {number: tasks[number]() for number in taken(queue)}
    except BaseException:
        os.kill(other, signal.SIGTERM)
        raise
    finally:
        os.close(queue)
        with os.fdopen(answer, "rb") as file:
            text = file.read()
        os.waitpid(other, 0)
    found.update(pickle.loads(text) if text else ())
    return [found[number] if number in found else task() for number, task in enumerate(tasks)]


def taken(queue):
    while number := os.read(queue, 1):
        yield number[0]
