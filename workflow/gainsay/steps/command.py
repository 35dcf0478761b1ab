"""The command line that all steps share."""

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from gainsay.errors import InputError
from gainsay.steps.holding import hold_as_step
from gainsay.tables import Case, find_root, read_case

#: exit codes of every command
CLEAN, DIFFERENCES, BAD_INPUT, NOT_CHECKED = 0, 1, 2, 3


def refuse(error: InputError) -> int:
    """Say in one line on standard error why the input is refused."""
    print(f"bad input: {error}", file=sys.stderr)
    return BAD_INPUT


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
        0, or 2 where the input is refused before anything was computed, or another run has the results.
    """
    parser = argparse.ArgumentParser(description=about, epilog="exit codes: 0 done, 2 bad input")
    parser.add_argument("paper", help="folder name below papers/, such as wan2014")
    parser.add_argument("--root", type=Path, help="project root; default: the project around the current folder")
    options = parser.parse_args(arguments)
    try:
        root = find_root(options.root)
        case = read_case(root, options.paper)
        hold_as_step(root)
        work(case)
    except InputError as error:
        return refuse(error)
    return CLEAN
