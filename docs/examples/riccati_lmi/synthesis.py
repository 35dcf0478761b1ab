"""The minimum enclosed from both sides, the Riccati equation, and why the one inequality follows from the other."""

import numpy as np
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov

from gainsay.results import Results, task
from gainsay.statements import Stated, Step, enclose, implication
from gainsay.tables import Case
from papers.riccati_lmi.statements import RICCATI, SCHUR


@task("(2)")
def least_trace(case: Case, results: Results) -> None:
    """The infimum by a point and by multipliers, each with its certificate."""
    stated = Stated(case, [SCHUR < 0], minimise="trace(X)", label="(2)")
    enclose(results, "lmi.trace", stated, stated.infimum(), sentence="X that satisfies (2)", source="mincx")


@task("(1)")
def schur(case: Case, results: Results) -> None:
    """(1) is the congruence of (2) with [I; B' X], whatever A, B and Q are."""
    results.prove(
        implication(
            case,
            id="schur",
            quantity="lmi.equivalent",
            sentence="Every X that satisfies (2) satisfies (1).",
            given=[SCHUR < 0],
            then=RICCATI < 0,
            by=[Step("(2)", "col(eye(3), B.T@X)", left_inverse="row(eye(3), zeros(3, 1))")],
            symmetric=["Q"],
        )
    )


@task("Xopt")
def stabilising_solution(case: Case, results: Results) -> None:
    """The stabilising solution by Schur vectors; a step of Newton's method from there gives the band."""
    A, B, Q = (case.matrix(name) for name in "ABQ")
    X = -solve_continuous_are(A, B, -Q, np.eye(1))  # of A'P + P A - P B B' P - Q = 0, P = -X
    loop = A + B @ B.T @ X
    second = solve_continuous_lyapunov(loop.T, X @ B @ B.T @ X - Q)
    for i in range(3):
        for j in range(i, 3):
            band = 10 * abs(second[i, j] - X[i, j]) + 1e-9
            results.quantity(
                f"riccati.x{i + 1}{j + 1}",
                X[i, j],
                method="Riccati equation by Schur vectors; band: a step of Newton's method",
                lower=X[i, j] - band,
                upper=X[i, j] + band,
            )


TASKS = (least_trace, schur, stabilising_solution)
