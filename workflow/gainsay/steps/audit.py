"""Audit the printed gains of a paper: poles, norms, identities, rounding."""

import sys

from gainsay.steps.command import step_command
from gainsay.steps.tasks import run_step
from gainsay.tables import Case


def audit(case: Case) -> None:
    """Run every audit task of a paper."""
    run_step(case, "audit")


if __name__ == "__main__":
    sys.exit(step_command(audit, __doc__))
