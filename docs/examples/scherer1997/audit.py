"""What the controller of the mixed problem does, each norm with a Lyapunov matrix of its own."""

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.systems.norms import bounded_real_certificate_matrix, h2_norm, hinf_norm
from gainsay.systems.synthesis import h2_output_feedback
from gainsay.tables import Case
from papers.scherer1997.plant import MIXED_LOOP, loop
from papers.scherer1997.synthesis import h2_plant


@task("mixed")
def mixed_controller(case: Case, results: Results) -> None:
    """Both norms of one loop: the bounded real lemma, and an observability Gramian."""
    A, B, Cinf, C2 = loop(case, *(case.designs["mixed"][name] for name in ("Ak", "Bk", "Ck")))
    gramian = solve_continuous_lyapunov(A.T, -C2.T @ C2 - 1e-3 * np.eye(6))
    for kind, quantity, fields, P, value in (
        ("bounded_real", "audit.hinf", {"C": "Linf", "gamma": "number('gamma')"},
         bounded_real_certificate_matrix(A, B, Cinf, None, case.number("gamma")), hinf_norm(A, B, Cinf)[0]),
        ("h2", "audit.h2", {"C": "L2", "bound": "number('h2_level')"}, gramian, h2_norm(A, B, C2)),
    ):  # fmt: skip
        certificate = build.certificate(
            kind,
            id=quantity.replace(".", "-"),
            statement="The controller of the mixed problem keeps this norm below the level.",
            tables=case,
            definitions=MIXED_LOOP,
            fields={"A": "Al", "B": "Bl", **fields},
            witness={"P": P},
            quantities={"norm": quantity},
        )
        results.prove(certificate, source="mixed problem", values={quantity: value})


@task("H2")
def h2_controller(case: Case, results: Results) -> None:
    """Its H-infinity norm: below gamma, so that gamma alone would cost no H2 norm at all."""
    K = h2_output_feedback(h2_plant(case)).controller
    A, B, Cinf, _ = loop(case, K.A, K.B, K.C)
    results.quantity("audit.h2_optimal_hinf", hinf_norm(A, B, Cinf)[0], method="level set of the Hamiltonian matrix")


TASKS = (mixed_controller, h2_controller)
