"""Solve the LMIs of a paper, certify what they say, and write the designs and their gains."""

import sys

from gainsay.steps.command import step_command
from gainsay.steps.tasks import run_step
from gainsay.tables import Case


def synthesis(case: Case) -> None:
    """Run every synthesis task of a paper."""
    run_step(case, "synthesis")


if __name__ == "__main__":
    sys.exit(step_command(synthesis, __doc__))
