"""The command line that all steps share."""

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from gainsay.errors import LONGEST_FILE, LONGEST_PART, InputError, one_line
from gainsay.steps.holding import hold_as_step
from gainsay.tables import Case, find_root, read_case

#: exit codes of every command
CLEAN, DIFFERENCES, BAD_INPUT = 0, 1, 2


def refuse(error: InputError) -> int:
    """Say in one line on standard error why the input is refused."""
    print(f"bad input: {error}", file=sys.stderr)
    return BAD_INPUT


def broken_off(error: OSError) -> int:
    """Say in one line that a file could not be written or read: a full disk, no permission, no temporary folder."""
    with open(os.devnull, "wb") as nowhere:  # noqa: PTH123  # what is left to say would fail again, and late
        if error.filename is None:
            os.dup2(nowhere.fileno(), sys.stdout.fileno())
    reason = one_line((error.strerror or str(error)).lower(), LONGEST_PART)
    place = "output" if error.filename is None else one_line(str(error.filename), LONGEST_FILE)
    print(f"broken off: {place}: {reason}", file=sys.stderr)
    return BAD_INPUT


def whole_streams() -> None:
    """Put the null device where a standard stream is closed: a file opened later would take its number."""
    while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(handle)
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)


def step_command(work: Callable[[Case], None], about: str, arguments: Sequence[str] | None = None) -> int:
    """Run a step for the paper named on the command line.

    Parameters
    ----------
    work : callable
        Takes the validated tables of the paper.
    about : str
        First line of the help text.
    arguments : sequence of str, optional
        Instead of `sys.argv`.

    Returns
    -------
    int
        0, or 2 where the input is refused before anything was computed, another run has the results, or a file cannot
        be written.
    """
    parser = argparse.ArgumentParser(description=about, epilog="exit codes: 0 done, 2 bad input")
    parser.add_argument("paper", help="folder name below papers/, such as wan2014")
    parser.add_argument("--root", type=Path, help="project root; default: the project around the current folder")
    whole_streams()
    options = parser.parse_args(arguments)
    try:
        root = find_root(options.root)
        case = read_case(root, options.paper)
        hold_as_step(root)
        work(case)
        sys.stdout.flush()
    except InputError as error:
        return refuse(error)
    except OSError as error:
        return broken_off(error)
    return CLEAN
