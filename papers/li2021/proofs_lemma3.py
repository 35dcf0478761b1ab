"""Lemma 3 says more than (12) gives: gains that satisfy (12), and a pole outside the disk once the inertia is off.

(A.1) treats e as zero. With e = Delta J q'' the loop (10) is (I + E_t Delta W_t) xi' = A_t xi, of which block (2,6) of
(12), which is zero where a disk needs -E_t' P, knows nothing.
"""

import numpy as np

from gainsay.results import Results, task
from gainsay.scans import over_choice
from gainsay.statements import Stated, Step, implication, matrix, prove
from gainsay.systems import loop_proofs
from gainsay.tables import Case
from papers.li2021 import plant
from papers.li2021.statements import EQ12, EQ12_CORRECTED, LOOP, TABLES

#: state feedback u = -(J0 - F'F) (k1 q + k2 q') of an observer with gains l1, l2: poles near -0.9, -0.4, -0.54, -1.9
GAINS = {"k1": "0.36", "k2": "1.3", "l1": "2.44", "l2": "1.026"}
CONTROLLER = {
    "Af": "[[-l1 * eye(3), eye(3)], [-(l2 + k1) * eye(3), -k2 * eye(3)]]",
    "Bf": "col(l1 * eye(3), l2 * eye(3))",
    "Cf": "(J0 - F.T @ F) @ row(-k1 * eye(3), -k2 * eye(3))",
}
#: every moment of inertia 5 % low: delta = (-1, 1, -1), as Delta J2 is printed negative
LIGHT_PLANT = "A0 + L @ diag(1, 1, -1, -1, -1, -1, -1, -1, -1, -1, 1, 1) @ K"
LIGHT = "inverse(eye(12) + E_t @ diag(-1, 1, -1) @ W_t) @ A_t"
#: P = p x (J0 - F'F), a Kronecker product, found by a solver; the three axes are nearly alike and nearly apart
SMALL_P = np.array(
    (
        (313.3948, -162.8287, -311.9225, 167.527),
        (-162.8287, 92.959, 161.7772, -95.3903),
        (-311.9225, 161.7772, 311.327, -164.2522),
        (167.527, -95.3903, -164.2522, 105.28),
    )
)
#: lambda and gamma^2 at which (12) is met, and how far outside the pole is shown to lie, 1/s
LAMBDA, GAMMA_SQUARED, REACH = "7", "10000", "1.003"


def lyapunov(case: Case) -> np.ndarray:
    """P of (12), shape (12, 12)."""
    k = plant.constants(case)
    return np.kron(SMALL_P, np.diag(k.inertia) - k.coupling.T @ k.coupling)


@task("Lemma 3, corrected")
def corrected_disk(case: Case, results: Results) -> None:
    """Prove that the corrected (12) keeps the poles of (10) in the disk whatever the inertia within its envelope.

    The loop with e = Delta W_t xi', Delta'Delta <= I, is xi' = A_e xi with A_t = A_e + E_t Delta W_t A_e.
    """
    bounded = "eye(3) - Delta.T @ Delta >= 0"
    factor = "col(eye(12), Delta @ W_t @ A_e, zeros(3, 12), lam * W_t @ A_e, zeros(3, 12), (A_e + a * eye(12)) / a)"
    results.prove(
        implication(
            case,
            id="lemma3-corrected-disk",
            quantity="lemma3.corrected_disk",
            sentence="Where (12) holds with 0 in block (1,2) and -E'P in block (2,6), the loop (10) with "
            "e = Delta W xi' satisfies (A + aI)'P(A + aI)/a - (b^2/a) P < 0 for every Delta with Delta'Delta <= I.",
            given=[EQ12_CORRECTED < 0, bounded],
            then="(A_e + a * eye(12)).T @ P @ (A_e + a * eye(12)) / a - r * P < 0",
            expand={"A_t": "A_e + E_t @ Delta @ W_t @ A_e"},
            unknowns={"A_e": matrix(12, 12), "Delta": matrix(3, 3)},
            by=[
                Step(
                    EQ12_CORRECTED.label,
                    factor,
                    left_inverse="row(eye(12), zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 3), zeros(12, 12))",
                ),
                Step(bounded, "W_t @ A_e", scale="lam**2"),
            ],
            faith=("That the inequality with P > 0 puts every eigenvalue of the loop into D(a, b).",),
        ),
        source="Lemma 3, (12)",
    )
    results.say("Lemma 3, corrected", "two blocks of (12) put right keep the poles in the disk for every inertia")


@task("Lemma 3")
def disk_of_lemma_3(case: Case, results: Results) -> None:
    """Prove that a loop satisfies (12) and has a pole outside D(a, b) with an inertia that the lemma allows."""
    texts = {
        **TABLES,
        **GAINS,
        **CONTROLLER,
        "A": LIGHT_PLANT,
        "Ad": "Af",
        "Bd": "Bf",
        "Cd": "Cf",
        **LOOP,
        "lam": LAMBDA,
        "g": GAMMA_SQUARED,
    }
    stated = Stated(case, [EQ12.defining(texts) < 0, "P > 0"], label="(12)")
    prove(
        results,
        "lemma3.eq12",
        stated,
        stated.point({"P": lyapunov(case)}),
        id="lemma3-eq12",
        source="Lemma 3",
        sentence=f"P > 0 that satisfies (12) with gains of ours at lambda = {LAMBDA}, gamma = 100",
    )
    results.certificate(
        loop_proofs.pole_outside_disk(
            case,
            LIGHT,
            "a",
            REACH,
            definitions=stated.parts()["definitions"],
            id="lemma3-outside-disk",
            statement=f"The loop of lemma3-eq12 has a pole outside D(1.01, {REACH}) where every inertia is 5 % low.",
            quantities={"radius": "lemma3.disk_reach"},
        )
    )
    centre, floats = case.number("disk_centre"), stated.floats()
    reach = {
        name: float(np.abs(np.linalg.eigvals(floats.constant(formula)) + centre).max())
        for name, formula in (("loop", LIGHT), ("nominal", "A_t"))
    }
    results.quantity("lemma3.disk_reach", reach["loop"], method="eigenvalues", source="Lemma 3")
    method = f"eigenvalues, poles of the {case.choice('disk_poles')}"
    over_choice(case, results, "lemma3.disk_over_readings", "disk_poles", reach, method=method, source="Lemma 3")
    results.say(
        "Lemma 3",
        f"gains with (12) at lambda = {LAMBDA}: poles within {reach['nominal']:.4f} of -a, and "
        f"{reach['loop']:.4f} where the inertia is 5 % low",
    )
