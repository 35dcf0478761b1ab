"""What the printed minimiser does."""

from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.tables import Case
from papers.riccati_lmi.statements import DATA


@task("Xst")
def stabilising(case: Case, results: Results) -> None:
    """The eigenvalues of A + B B' X, enclosed by the checker."""
    results.prove(
        build.certificate(
            "eigenvalues",
            id="stabilising",
            statement="The rightmost eigenvalue of A + B B' X lies in this interval.",
            tables=case,
            definitions={**DATA, "X": "printed('X')"},
            fields={"matrix": "A + B@B.T@X", "measure": "abscissa"},
            quantities={"abscissa": "audit.abscissa"},
        ),
        source="Xst",
    )


TASKS = (stabilising,)
