"""Certificates of zhang2013: what a floating-point result becomes once it is proved from the tables."""

from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np
from scipy.linalg import solve_continuous_are, solve_continuous_lyapunov

from gainsay.proof import Certificate
from gainsay.proof.build import certificate, farkas, feasible_point
from papers.zhang2013.formulas import (
    FLEXIBLE,
    NINE,
    PLANT,
    ROWS,
    SIGNED,
    UNKNOWNS9,
    UNKNOWNS23,
    corrected23,
    flexible_loop,
    gains,
    joined,
    nine,
    printed23,
    size_of,
)

PAPER = "zhang2013"
GAMMA = "number('gamma') ** 2"
THEOREM1_ON_FAITH = (
    "Theorem 1 itself: that (9a) and (9b) imply stability and the norm bound for every admissible delay."
)
FORMS = {"printed": printed23, "corrected": corrected23}
OFFSETS = {row: sum(size_of(r) for r in ROWS[:i]) for i, row in enumerate(ROWS)}
CORE = ("x", "x'", "x_d", "x_M")


def enclosure(proved: Certificate) -> dict[str, float]:
    """Value, lower and upper of the quantity that a certificate encloses; `results.quantity` takes them.

    The ends are the doubles next to the value, where the enclosure is narrower than those.
    """
    low, high = next(
        map(Fraction, found.value.split("..")) for found in proved.conclusions if found.relation == "inside"
    )
    value = float((low + high) / 2)
    lower, upper = (np.nextafter(value, end) for end in (-np.inf, np.inf))
    return {"value": value, "lower": float(min(lower, float(low))), "upper": float(max(upper, float(high)))}


def scalars(lambda1: str) -> tuple[tuple[str, str], ...]:
    """Definitions of l1 and l2; lambda1 as a formula."""
    return (("l1", lambda1), ("l2", "number('lambda2')"))


def lmis(edition: str, gamma_squared: str = GAMMA) -> list[list[str]]:
    """(23a) < 0, (23b) < 0 and the sign conditions, as constraints of a certificate."""
    form = FORMS[edition]
    held = [[f"(23{part})", joined(form(part, gamma_squared), ROWS) + " < 0"] for part in "ab"]
    return held + [[name, f"{name} > 0"] for name in SIGNED]


def point_for(names: Mapping[str, Mapping], seed: int = 1) -> dict[str, list]:
    """Small rational values of unknowns, for showing that two formulas differ."""
    rng = np.random.default_rng(seed)
    point = {}
    for name, raw in names.items():
        rows, columns = raw["shape"]
        value = rng.integers(1, 9, size=(rows, columns))
        if raw.get("structure") == "symmetric":
            value = value + value.T
        if rows == columns:
            value = value + 10 * np.eye(rows, dtype=int)  # invertible
        point[name] = [[Fraction(int(v)) for v in line] for line in value]
    return point


def norm_without_delay(case, value: float) -> Certificate:
    """Bounded real lemma for (7) without delay: the norm is below `value` and the loop stable."""
    definitions = [*PLANT, *gains("printed('K')", "printed('L')")]
    from papers.zhang2013.plant import Spacecraft

    loop = Spacecraft.of(case).design_loop(case.printed("K").exact, case.printed("L").exact)
    A, B, C = loop.A + loop.A1, loop.B, loop.C
    P = solve_continuous_are(A, B, C.T @ C + 1e-7 * np.eye(3), -(value**2) * np.eye(2))
    return certificate(
        "bounded_real",
        id="hinf-delay-0",
        paper=PAPER,
        tables=case,
        statement="The norm of (7) without delay is below this level, and the loop is stable.",
        definitions=definitions,
        witness={"P": P},
        fields={"A": "A_bar + A_d", "B": "B_bar", "C": "C_z", "D": "C_d", "gamma": f"{value:.9f}"},
        quantities={"norm": "audit.hinf.delay_0"},
    )


def negative_form(case) -> Certificate:
    """On (x, x', x_d, x_M) = (l1 v, -v, l1 v, l1 v) both editions give forms that are positive for every l1 <= 0."""
    core = {
        edition: {k: t for k, t in form("a", GAMMA).items() if k[0] in CORE and k[1] in CORE}
        for edition, form in FORMS.items()
    }
    unknowns = {name: UNKNOWNS23[name] for name in ("P11", "Q11", "Q21", "R1", "X", "M")}
    on = "col(l1 * eye(2), -eye(2), l1 * eye(2), l1 * eye(2))"
    left = [f"(T.T @ {joined(core[edition], CORE)} @ T)" for edition in ("corrected", "printed")]
    base = "l1 ** 2 * mu * Q21 - 2 * l1 * P11 + d_M * R1"
    right = [base, f"{base} + 2 * l1 ** 2 * Q11 - 6 * l1 * R1 / d_M"]
    return certificate(
        "identity",
        id="lambda1-form",
        paper=PAPER,
        tables=case,
        statement="On one subspace the left sides of (23a), corrected and printed, are sums of positive definite "
        "matrices for every lambda1 <= 0: neither can be negative.",
        definitions=[*PLANT, ("T", on)],
        unknowns=unknowns | {"l1": {"shape": [1, 1]}},
        fields={"left": f"diag({', '.join(left)})", "right": f"diag({', '.join(right)})"},
        quantities={"identity": "theorem2.negative_lambda1_form"},
        faith=(
            "The step from the identity to the sign: for lambda1 <= 0 and d_M, mu > 0 every term of the right sides is "
            "a non-negative multiple of a positive definite matrix.",
        ),
    )


def printed_sign_infeasible(case, edition: str, quantity: str) -> Certificate:
    """(23) has no solution at the printed lambda1 = -0.12: the form of `negative_form` as Farkas multipliers."""
    l1, d_M, mu = case.exact("lambda1"), case.exact("d_M"), case.exact("mu")
    z = [Fraction(0)] * 15
    for row, value in (("x", Fraction(1)), ("x'", -1 / l1), ("x_d", Fraction(1)), ("x_M", Fraction(1))):
        z[OFFSETS[row]] = value
    first = [[1, 0], [0, 0]]
    weights = {"Q21": mu, "P11": -2 / l1, "R1": d_M / l1**2}
    if edition == "printed":
        weights |= {"Q11": Fraction(2), "R1": weights["R1"] - 6 / (l1 * d_M)}
    witness: dict[str, list] = {"(23a)": [[x * y for y in z] for x in z]}
    witness |= {name: [[weight * v for v in line] for line in first] for name, weight in weights.items()}
    return certificate(
        "farkas",
        id=f"lambda1-sign-{edition}",
        paper=PAPER,
        tables=case,
        statement=f"(23), {edition}, has no solution at the printed lambda1 = -0.12.",
        definitions=[*PLANT, *scalars("number('lambda1')")],
        unknowns=UNKNOWNS23,
        witness=witness,
        fields={"constraints": lmis(edition)},
        quantities={"feasible": quantity},
    )


def infeasible(case, name: str, edition: str, lambda1: str, multipliers: Mapping, quantity: str) -> Certificate:
    """(23) has no solution, by multipliers from a solver."""
    named = {label.split(" printed")[0].replace(" > 0", ""): value for label, value in multipliers.items()}
    return farkas(
        id=name,
        paper=PAPER,
        tables=case,
        multipliers=named,
        definitions=[*PLANT, *scalars(lambda1)],
        statement=f"(23), {edition}, has no solution at lambda1 = {lambda1}.",
        unknowns=UNKNOWNS23,
        fields={"constraints": lmis(edition)},
        quantities={"feasible": quantity},
    )


def feasible(case, name: str, edition: str, lambda1: str, point: Mapping, quantity: str) -> Certificate:
    """(23) has a solution."""
    return feasible_point(
        id=name,
        paper=PAPER,
        tables=case,
        definitions=[*PLANT, *scalars(lambda1)],
        statement=f"(23), {edition}, is feasible at lambda1 = {lambda1}.",
        unknowns=UNKNOWNS23,
        point={key: np.atleast_2d(point[key]) for key in UNKNOWNS23},
        fields={"constraints": lmis(edition)},
        quantities={"feasible": quantity},
    )


def accepted(case, name: str, edition: str, lambda1: str, K: str, L: str, point: Mapping, quantity: str) -> Certificate:
    """(23) holds with M = K X and N = P22' L for given gains (formulas)."""
    unknowns = {key: raw for key, raw in UNKNOWNS23.items() if key not in ("M", "N")}
    derived = (("M", f"{K} @ X"), ("N", f"P22.T @ {L}"))
    return feasible_point(
        id=name,
        paper=PAPER,
        tables=case,
        definitions=[*PLANT, *scalars(lambda1), *derived],
        statement=f"(23), {edition}, accepts K = {K}, L = {L} at lambda1 = {lambda1}.",
        unknowns=unknowns,
        point={key: np.atleast_2d(point[key]) for key in unknowns},
        fields={"constraints": lmis(edition)},
        quantities={"feasible": quantity},
    )


def gamma_floor(case) -> Certificate:
    """gamma^2 > C2^2 wherever the corrected (23a) holds: a constant w1 that the estimate cancels reaches y undamped."""
    z = [Fraction(0)] * 15
    for row, value in (("e", 1), ("e_d", 1), ("e_M", 1), ("w1", -1), ("y", case.exact("C2"))):
        z[OFFSETS[row]] = Fraction(value)
    free = UNKNOWNS23 | {"g": {"shape": [1, 1]}}
    return certificate(
        "dual_bound",
        id="gamma-floor",
        paper=PAPER,
        tables=case,
        statement="No design that the corrected (23a) accepts has gamma below |C2|.",
        definitions=[*PLANT, *scalars("number('lambda1_corrected')")],
        unknowns=free,
        witness={"(23a)": [[x * y for y in z] for x in z], "Q22": [[case.exact("mu")]]},
        fields={"constraints": lmis("corrected", "g"), "minimise": "g", "bound": "C2 ** 2"},
        quantities={"objective": "theorem2.gamma_squared_floor"},
    )


def theorem1(
    case,
    name: str,
    K: str,
    L: str,
    point: Mapping,
    quantity: str,
    *,
    mode: str = "",
    gamma_squared: str = GAMMA,
) -> Certificate:
    """(9a), (9b) hold for given gains on the design model, or with a mode on the flexible plant (input w1 alone)."""
    size, inputs = (7, 1) if mode else (3, 2)
    definitions = [*FLEXIBLE, *flexible_loop(K, L, mode)] if mode else [*PLANT, *gains(K, L)]
    where = f"flexible plant, {'K x' if mode == 'paper' else 'whole input'} delayed" if mode else "design model"
    sizes = {"z": size, "w": inputs, "y": 1}
    unknowns = {key: {**raw, "shape": [size, size]} for key, raw in UNKNOWNS9.items()}
    held = [[f"(9{part})", joined(nine(part, gamma_squared, size, inputs), NINE, sizes) + " < 0"] for part in "ab"] + [
        [key, f"{key} > 0"] for key in ("P1", "Q1", "Q2", "R")
    ]
    return feasible_point(
        id=name,
        paper=PAPER,
        tables=case,
        definitions=definitions,
        unknowns=unknowns,
        statement=f"(9a) and (9b) hold for K = {K}, L = {L} on the {where}.",
        point={key: np.atleast_2d(point[key]) for key in unknowns},
        fields={"constraints": held},
        quantities={"feasible": quantity},
        faith=(THEOREM1_ON_FAITH,),
    )


def no_block_diagonal_lyapunov(case, K: str, L: str, multipliers: Mapping, quantity: str) -> Certificate:
    """Without delay the flexible loop has no Lyapunov matrix diag(plant, observer), the structure of P1 in (25)."""
    return farkas(
        id="flexible-block-diagonal",
        paper=PAPER,
        tables=case,
        statement="No block-diagonal Lyapunov matrix diag(P11, P12) proves the flexible loop stable without delay.",
        definitions=[*FLEXIBLE, *flexible_loop(K, L)],
        unknowns={
            "P11": {"shape": [6, 6], "structure": "symmetric"},
            "P12": {"shape": [1, 1], "structure": "symmetric"},
        },
        multipliers=multipliers,
        fields={
            "constraints": [
                ["decrease", "sym(diag(P11, P12) @ (A_bar + A_d)) < 0"],
                ["P11", "P11 > 0"],
                ["P12", "P12 > 0"],
            ]
        },
        quantities={"feasible": quantity},
    )


def abscissa(case, name: str, matrix: str, definitions: Sequence, quantity: str, statement: str) -> Certificate:
    """Enclosure of a spectral abscissa."""
    return certificate(
        "eigenvalues",
        id=name,
        paper=PAPER,
        tables=case,
        statement=statement,
        definitions=definitions,
        fields={"matrix": matrix, "measure": "abscissa"},
        quantities={"abscissa": quantity},
    )


def unstable(
    case, name: str, matrix: str, definitions: Sequence, value: np.ndarray, quantity: str, statement: str
) -> Certificate:
    """A matrix (formula; `value` its floats) has an eigenvalue in the right half plane."""
    P = solve_continuous_lyapunov(value.T, -np.eye(len(value)))
    P = (P + P.T) / 2
    z = np.linalg.eigh(P)[1][:, :1]
    return certificate(
        "unstable",
        id=name,
        paper=PAPER,
        tables=case,
        statement=statement,
        definitions=definitions,
        fields={"matrix": matrix, "alpha": "0"},
        witness={"P": P / np.abs(P).max(), "z": z},
        quantities={"stable": quantity},
    )


def w1_rms(case, size: str, quantity: str) -> Certificate:
    """Root mean square of w1 over long times, from the square of its amplitude (formula): positive."""
    return certificate(
        "enclosed",
        id="w1-persists",
        paper=PAPER,
        tables=case,
        statement="The root mean square of w1 over long times is positive, at whatever frequency: its energy grows "
        "linearly with time, so that w1 is not in l2[0, inf) and no bound on its norm holds.",
        fields={"formula": f"sqrt({size} / 2)", "low": "0"},
        quantities={"value": quantity},
    )


def larger_than_max(case) -> Certificate:
    """||w|| may exceed max(delta_1, delta_2) where ||w1|| <= delta_1 and ||w2'|| <= delta_2."""
    return certificate(
        "enclosed",
        id="delta-max",
        paper=PAPER,
        tables=case,
        statement="With ||w1|| = delta_1 = 4 and ||w2'|| = delta_2 = 3 the square of ||w|| is above that of "
        "max(delta_1, delta_2) = 4.",
        definitions=[("delta_1", "4"), ("delta_2", "3")],
        fields={"formula": "delta_1 ** 2 + delta_2 ** 2 - delta_1 ** 2", "low": "0"},
    )


def residual_error(case, frequency: str, size: str, quantity: str) -> Certificate:
    """Amplitude of the periodic estimation error that w1 keeps up without delay, w1 of a tabled frequency.

    `size` is the square of the amplitude of w1 as a formula. Real and imaginary part of the state solve
    A r + w i = -B, w r - A i = 0.
    """
    state = "inverse([[-A_0, -w * eye(7)], [w * eye(7), -A_0]]) @ col(B_bar, zeros(7, 1))"
    return certificate(
        "enclosed",
        id=quantity.replace("audit.", "").replace("_", "-"),
        paper=PAPER,
        tables=case,
        statement="Without delay the loop of (1), (4), (6) with the printed gains answers w1 of the frequency "
        f"{frequency} with an estimation error w2 - w2hat of this amplitude.",
        definitions=[
            *FLEXIBLE,
            *flexible_loop("printed('K')", "printed('L')"),
            ("A_0", "A_bar + A_d"),
            ("w", f"number('{frequency}')"),
            ("H", state),
            ("e_r", "C_z @ H[0:7, 0:1]"),
            ("e_i", "C_z @ H[7:14, 0:1]"),
        ],
        fields={"formula": f"sqrt({size} * (e_r ** 2 + e_i ** 2))", "low": "0"},
        quantities={"value": quantity},
    )
