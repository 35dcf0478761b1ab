"""What the LMIs of the paper say."""

from gainsay.results import Results, task
from gainsay.statements import Stated, prove
from gainsay.tables import Case
from papers.example.statements import INEQUALITY_3


@task("(3)")
def feasibility(case: Case, results: Results) -> None:
    """Whether (3) has a solution: a point or multipliers, whichever there is, becomes the certificate."""
    stated = Stated(case, [INEQUALITY_3 < 0, "X > 0"], label="(3)")
    prove(
        results, "lmi.feasible", stated, stated.solve(), sentence="X > 0 and a matrix Y that satisfy (3)", source="(3)"
    )
    results.say("(3)", "feasible or not, with its certificate")


TASKS = (feasibility,)
