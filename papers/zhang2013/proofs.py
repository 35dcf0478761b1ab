"""Certificates of zhang2013: what a floating-point result becomes once it is proved from the tables."""

from fractions import Fraction

from gainsay.proof import Certificate
from gainsay.proof.build import certificate
from gainsay.statements import Stated, Step, identical, implication, scalar, symmetric
from gainsay.systems import loop_proofs
from gainsay.tables import Case
from papers.zhang2013.statements import (
    MINUS,
    OFFSETS,
    PLANT,
    PRINTED_LOOP,
    ROWS,
    SIZES,
    UNKNOWNS_23,
    corrected_23,
    equation_23,
    flexible_loop,
    theorem_2,
)

THEOREM_1_ON_FAITH = (
    "Theorem 1 itself: that (9a) and (9b) imply stability and the norm bound for every admissible delay."
)
PRINTED_GAINS = "printed('K')", "printed('L')"


def gains_of(design: str) -> tuple[str, str]:
    """Formulas of K and L of a design."""
    return f"design('{design}', 'K')", f"design('{design}', 'L')"


def norm_without_delay(case: Case, value: float) -> Certificate:
    """Bounded real lemma for (7) without delay: the norm is below `value` and the loop stable."""
    return loop_proofs.norm_below(
        case,
        {"A": "A_bar + A_d", "B": "B_bar", "C": "C_z", "D": "C_d"},
        f"{value:.9f}",
        definitions=PRINTED_LOOP,
        id="hinf-delay-0",
        statement="The norm of (7) without delay is below this level, and the loop is stable.",
        quantities={"norm": "audit.hinf.delay_0"},
    )


def negative_form(case: Case) -> Certificate:
    """On (x, x', x_d, x_M) = (l1 v, -v, l1 v, l1 v) both editions give forms that are positive for every l1 <= 0."""
    core = [form("a").sub("x", "x'", "x_d", "x_M") for form in (corrected_23, equation_23)]
    unknowns = {name: UNKNOWNS_23[name] for name in ("P11", "Q11", "Q21", "R1", "X", "M")} | {"l1": scalar()}
    on = "col(l1 * eye(2), -eye(2), l1 * eye(2), l1 * eye(2))"
    base = "l1 ** 2 * mu * Q21 - 2 * l1 * P11 + d_M * R1"
    right = [base, f"{base} + 2 * l1 ** 2 * Q11 - 6 * l1 * R1 / d_M"]
    return identical(
        case,
        "theorem2.negative_lambda1_form",
        "On one subspace the left sides of (23a), corrected and printed, are sums of positive definite "
        "matrices for every lambda1 <= 0: neither can be negative.",
        f"diag({', '.join(f'(T.T @ {s.formula} @ T)' for s in core)})",
        f"diag({', '.join(right)})",
        unknowns,
        id="lambda1-form",
        definitions={**PLANT, "T": on},
        faith=(
            "The step from the identity to the sign: for lambda1 <= 0 and d_M, mu > 0 every term of the right sides is "
            "a non-negative multiple of a positive definite matrix.",
        ),
    )


def printed_sign_infeasible(case: Case, edition: str, quantity: str) -> Certificate:
    """(23) has no solution at the printed lambda1 = -0.12: the form of `negative_form` as Farkas multipliers."""
    l1, d_M, mu = case.exact("lambda1"), case.exact("d_M"), case.exact("mu")
    z = [Fraction(0)] * 15
    for row, value in (("x", Fraction(1)), ("x'", -1 / l1), ("x_d", Fraction(1)), ("x_M", Fraction(1))):
        z[OFFSETS[row]] = value
    first = [[1, 0], [0, 0]]
    weights = {"Q21": mu, "P11": -2 / l1, "R1": d_M / l1**2}
    if edition == "printed":
        weights |= {"Q11": Fraction(2), "R1": weights["R1"] - 6 / (l1 * d_M)}
    witness: dict[str, list] = {theorem_2(case, edition).constraints[0].label: [[x * y for y in z] for x in z]}
    witness |= {f"{name} > 0": [[weight * v for v in line] for line in first] for name, weight in weights.items()}
    return certificate(
        "farkas",
        id=f"lambda1-sign-{edition}",
        statement=f"(23), {edition}, has no solution at the printed lambda1 = -0.12.",
        witness=witness,
        quantities={"feasible": quantity},
        **theorem_2(case, edition, l1=MINUS).parts(),
    )


def gamma_floor(case: Case) -> Certificate:
    """gamma^2 > C2^2 wherever the corrected (23a) holds: a constant w1 that the estimate cancels reaches y undamped."""
    z = [Fraction(0)] * 15
    for row, value in (("e", 1), ("e_d", 1), ("e_M", 1), ("w1", -1), ("y", case.exact("C2"))):
        z[OFFSETS[row]] = Fraction(value)
    stated = theorem_2(case, g="gamma2").changed(minimise="gamma2")
    parts = stated.parts()
    return certificate(
        "dual_bound",
        id="gamma-floor",
        statement="No design that the corrected (23a) accepts has gamma below |C2|.",
        witness={stated.constraints[0].label: [[x * y for y in z] for x in z], "Q22 > 0": [[case.exact("mu")]]},
        quantities={"objective": "theorem2.gamma_squared_floor"},
        **{**parts, "fields": {**parts["fields"], "bound": "C2 ** 2"}},
    )


def block_diagonal_lyapunov(case: Case) -> Stated:
    """A Lyapunov matrix diag(plant, observer), the structure of P1 in (25), for the flexible loop without delay."""
    return Stated(
        case,
        ["sym(diag(P11, P12) @ (A_bar + A_d)) < 0", "P11 > 0", "P12 > 0"],
        unknowns={"P11": symmetric(6), "P12": symmetric(1)},
        where=flexible_loop(*PRINTED_GAINS),
        label="(25) flexible",
    )


def w1_rms(case: Case, size: str, quantity: str) -> Certificate:
    """Root mean square of w1 over long times, from the square of its amplitude (formula): positive."""
    return certificate(
        "enclosed",
        id="w1-persists",
        tables=case,
        statement="The root mean square of w1 over long times is positive, at whatever frequency: its energy grows "
        "linearly with time, so that w1 is not in l2[0, inf) and no bound on its norm holds.",
        fields={"formula": f"sqrt({size} / 2)", "low": "0"},
        quantities={"value": quantity},
    )


def larger_than_max(case: Case) -> Certificate:
    """||w|| may exceed max(delta_1, delta_2) where ||w1|| <= delta_1 and ||w2'|| <= delta_2."""
    return certificate(
        "enclosed",
        id="delta-max",
        tables=case,
        statement="With ||w1|| = delta_1 = 4 and ||w2'|| = delta_2 = 3 the square of ||w|| is above that of "
        "max(delta_1, delta_2) = 4.",
        definitions=[("delta_1", "4"), ("delta_2", "3")],
        fields={"formula": "delta_1 ** 2 + delta_2 ** 2 - delta_1 ** 2", "low": "0"},
    )


def residual_error(case: Case, frequency: str, size: str, quantity: str) -> Certificate:
    """Amplitude of the periodic estimation error that w1 keeps up without delay, w1 of a tabled frequency.

    `size` is the square of the amplitude of w1 as a formula. Real and imaginary part of the state solve
    A r + w i = -B, w r - A i = 0.
    """
    state = "inverse([[-A_0, -w * eye(7)], [w * eye(7), -A_0]]) @ col(B_bar, zeros(7, 1))"
    return certificate(
        "enclosed",
        id=quantity.replace("audit.", "").replace("_", "-"),
        tables=case,
        statement="Without delay the loop of (1), (4), (6) with the printed gains answers w1 of the frequency "
        f"{frequency} with an estimation error w2 - w2hat of this amplitude.",
        definitions={
            **flexible_loop(*PRINTED_GAINS),
            "A_0": "A_bar + A_d",
            "w": f"number('{frequency}')",
            "H": state,
            "e_r": "C_z @ H[0:7, 0:1]",
            "e_i": "C_z @ H[7:14, 0:1]",
        },
        fields={"formula": f"sqrt({size} * (e_r ** 2 + e_i ** 2))", "low": "0"},
        quantities={"value": quantity},
    )


def w2_rate_rms(case: Case, size: str, quantity: str) -> Certificate:
    """Root mean square of the rate of w2 that w1 keeps up without delay: positive, so that it is not in l2 either."""
    definitions = {
        **flexible_loop(*PRINTED_GAINS),
        "A_0": "A_bar + A_d",
        "w": "number('w1_frequency')",
        "H": "inverse([[-A_0, -w * eye(7)], [w * eye(7), -A_0]]) @ col(B_bar, zeros(7, 1))",
        "vibration": "row(zeros(1, 2), V, zeros(1, 1))",
        "v_r": "vibration @ H[0:7, 0:1]",
        "v_i": "vibration @ H[7:14, 0:1]",
    }
    return certificate(
        "enclosed",
        id="w2-rate-persists",
        tables=case,
        statement="Without delay the loop of (1), (4), (6) with the printed gains answers the printed w1 with a rate "
        "of w2 of this root mean square: its energy grows linearly with time, so that it is not in l2[0, inf).",
        definitions=definitions,
        fields={"formula": f"w * sqrt({size} * (v_r ** 2 + v_i ** 2) / 2)", "low": "0"},
        quantities={"value": quantity},
    )


def definite_slack(case: Case) -> list[Certificate]:
    """(23a), printed or corrected, forces P22 > 0 and a positive definite symmetric part of P21-bar (here X)."""
    made = []
    rows = {row: i for i, row in enumerate(ROWS)}
    for edition, form in (("printed", equation_23), ("corrected", corrected_23)):
        given = form("a")
        for row, weight, conclusion, said, name, quantity in (
            ("e'", "R2", "l2 * sym(P22) > 0", "lambda2 (P22 + P22')", "p22-positive", "theorem2.p22_positive"),
            ("x'", "R1", "l1 * sym(X) > 0", "lambda1 (P21-bar + P21-bar')", "x-definite", "theorem2.x_definite"),
        ):
            size = SIZES[row]
            blocks = [f"zeros({n}, {size})" if i != rows[row] else f"eye({size})" for i, n in enumerate(SIZES.values())]
            column = f"col({', '.join(blocks)})"
            sentence = f"Where (23a), {edition}, holds and {weight} > 0, {said} is positive definite."
            made.append(
                implication(
                    case,
                    id=f"{name}-{edition}",
                    quantity=quantity if edition == "printed" else "",
                    sentence=sentence,
                    given=[given < 0, f"{weight} > 0"],
                    then=conclusion,
                    by=[
                        Step(given.label, column, left_inverse=f"({column}).T"),
                        Step(f"{weight} > 0", f"eye({size})", scale="d_M"),
                    ],
                    positive=("d_M",),
                )
            )
    return made
