"""What the printed minimiser does."""

from gainsay.results import Results, task
from gainsay.systems.loop_proofs import abscissa
from gainsay.tables import Case
from papers.riccati_lmi.statements import DATA


@task("Xst")
def stabilising(case: Case, results: Results) -> None:
    """The rightmost eigenvalue of A + B B' X, enclosed by the checker."""
    proof = abscissa(
        case,
        "A + B@B.T@printed('X')",
        definitions=DATA,
        statement="The rightmost eigenvalue of A + B B' X lies in this interval.",
        quantity="audit.abscissa",
    )
    results.prove(proof, source="Xst")


TASKS = (stabilising,)
