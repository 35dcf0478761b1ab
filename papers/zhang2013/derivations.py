"""The derivations of zhang2013, step by step, as identities: (2), (5), (7), Lemma 1, (12) to (22)."""

from gainsay.proof import Certificate
from gainsay.results import Results, task
from gainsay.statements import Statement, Step, differing, identical, implication, matrix, scalar
from gainsay.tables import Case
from papers.zhang2013.statements import PARTS, PRINTED_LOOP, equation_9, functional

ETA = ("z", "z'", "z_d", "z_M")
#: a system (7)-(8) without numbers, and the unknowns of Theorem 1
FREE_LOOP = {
    **functional(3),
    "A_bar": matrix(3, 3),
    "A_d": matrix(3, 3),
    "B_bar": matrix(3, 2),
    "C_z": matrix(1, 3),
    "C_d": matrix(1, 2),
    "mu": scalar(),
    "g": scalar(),
}
TIME_UNIT = {"d_M": "eye(1)"}
UNIT_NOTE = "time in units of d_M, in which d_M = 1; any other unit scales rates and R alone"
UNIT_ON_FAITH = ("That the unit of time may be chosen so that d_M = 1.",)
STATES = {name: matrix(3, 1) for name in ("z", "v", "zd", "zM")}
VECTORS = {**STATES, "w": matrix(2, 1)}
W1 = "((z - zd).T @ R @ (z - zd))"
W2 = "((zd - zM).T @ R @ (zd - zM))"
RATE = (
    "2 * z.T @ P1 @ v + 2 * (z.T @ P2.T + v.T @ P3.T) @ (-v + A_bar @ z + A_d @ zd{w}) + z.T @ (Q1 + Q2) @ z"
    " - zM.T @ Q1 @ zM - (1 - mu) * zd.T @ Q2 @ zd + d_M * v.T @ R @ v"
)
"""Right side of (12) without its integral; v stands for z'."""
FUNCTIONAL = "{z}.T @ P1 @ {z} + {G1} - {G1M} + {G2} - {G2d} + d_M * {H} - ({K} - {KM})"
"""(11) in antiderivatives: G1' = z'Q1 z, G2' = z'Q2 z, H' = v'R v, K' = H; at t - d(t) where d, at t - d_M where M."""
LATER = {
    "z": "(z + e * v)",
    "G1": "(G1 + e * z.T @ Q1 @ z)",
    "G1M": "(G1M + e * zM.T @ Q1 @ zM)",
    "G2": "(G2 + e * z.T @ Q2 @ z)",
    "G2d": "(G2d + e * (1 - mu) * zd.T @ Q2 @ zd)",
    "H": "(H + e * v.T @ R @ v)",
    "K": "(K + e * H)",
    "KM": "(KM + e * HM)",
}
"""What (11) consists of at t + e, to first order in e, for a delay of the rate mu."""


#: the quadratic form of (17); with the column of w that of (22)
FORM_17 = {
    ("z", "z"): "sym(P2.T @ A_bar) + Q1 + Q2",
    ("z", "z'"): "P1 - P2.T + A_bar.T @ P3",
    ("z", "z_d"): "P2.T @ A_d",
    ("z'", "z'"): "-sym(P3) + d_M * R",
    ("z'", "z_d"): "P3.T @ A_d",
    ("z_d", "z_d"): "-(1 - mu) * Q2",
    ("z_M", "z_M"): "-Q1",
}
EQUATION_17 = Statement("(17)", "proof of Theorem 1", ETA, FORM_17, FREE_LOOP)
EQUATION_22 = Statement(
    "(22)",
    "proof of Theorem 1",
    (*ETA, "w"),
    {**FORM_17, ("z", "w"): "P2.T @ B_bar", ("z'", "w"): "P3.T @ B_bar"},
    FREE_LOOP,
)


def jensen(label: str, first: str, second: str) -> Statement:
    """(15) or (16): the two intervals of Lemma 1 weighed, as a quadratic form of z, z(t - d), z(t - d_M)."""
    blocks = {
        ("z", "z"): f"-{first} * R",
        ("z", "z_d"): f"{first} * R",
        ("z_d", "z_d"): "-4 * R",
        ("z_d", "z_M"): f"{second} * R",
        ("z_M", "z_M"): f"-{second} * R",
    }
    return Statement(label, "proof of Theorem 1", ("z", "z_d", "z_M"), blocks, {"R": FREE_LOOP["R"]})


@task("(2), (5), (7)")
def model(case: Case, results: Results) -> None:
    """The design model from the equations of motion and of the observer."""
    number, pair = scalar(), matrix(2, 1)
    results.prove(
        identical(
            case,
            "eq2.identity",
            "Eliminating eta'' from (1) gives (2).",
            "J * a + F @ (-q - F.T * a) - u - w",
            "(J - F @ F.T) * a - (F @ q + u + w)",
            {"J": number, "a": number, "u": number, "w": number, "F": matrix(1, 2), "q": pair},
            id="eq2",
        ),
        source="(2)",
    )
    rate = "(A @ x + B * u + B * w1 + B * w2)"
    unknowns = {"A": matrix(2, 2), "B": pair, "x": pair, "L": matrix(1, 2)}
    results.prove(
        identical(
            case,
            "eq5.identity",
            "(3) and (4) give (5), the observer being fed the torque that is applied.",
            f"w2rate + L @ B @ (p + L @ x) + L @ (A @ x + B * u) - L @ {rate}",
            "w2rate - L @ B @ (w2 - p - L @ x) - L @ B * w1",
            unknowns | dict.fromkeys(("u", "w1", "w2", "w2rate", "p"), number),
            id="eq5",
        ),
        source="(5)",
    )
    unknowns = {"A": matrix(2, 2), "B": pair, "x": pair, "xd": pair, "K": matrix(1, 2)}
    unknowns |= dict.fromkeys(("e", "w1", "w2"), number)
    results.prove(
        identical(
            case,
            "eq7.identity",
            "(3) with (6), its estimate not delayed, gives the first rows of (7).",
            "A @ x + B @ (-(w2 - e) + K @ xd) + B * w1 + B * w2",
            "A @ x + B * e + B @ K @ xd + B * w1",
            unknowns,
            id="eq7",
        ),
        source="(7)",
    )
    results.prove(
        differing(
            case,
            "eq7.input_delayed_identity",
            "With the whole input delayed, as the name u(t - d(t)) would have it, (7) does not follow.",
            "A @ x + B @ (-(w2d - ed) + K @ xd) + B * w1 + B * w2",
            "A @ x + B * e + B @ K @ xd + B * w1",
            unknowns | dict.fromkeys(("w2d", "ed"), number),
            id="eq7-input-delay",
        ),
        source="(6), (7)",
    )


@task("Lemma 1, (15), (16)")
def lemma(case: Case, results: Results) -> None:
    """Lemma 1, and the quadratic forms that it turns into."""
    first = "(W1 * r * (r - 2 * s) + W2 * s ** 2)"
    second = "(W1 * r ** 2 + W2 * s * (s - 2 * r))"
    results.prove(
        identical(
            case,
            "lemma1.holds",
            "With s = d - d_m and r = d_M - d, the two differences of Lemma 1 times s r (s + r) are "
            "D1 = W1 r (r - 2 s) + W2 s^2 and D2 = W1 r^2 + W2 s (s - 2 r), and (2 r - s) D1 + s D2 = "
            "2 r (r - s)^2 W1 >= 0. So not both are negative where s < 2 r; and D2 >= 0 where s >= 2 r.",
            f"diag((s + r) * (r * W1 + s * W2) - s * r * (3 * W1 + W2) - {first}, "
            f"(s + r) * (r * W1 + s * W2) - s * r * (W1 + 3 * W2) - {second}, (2 * r - s) * {first} + s * {second})",
            "diag(0, 0, 2 * r * (r - s) ** 2 * W1)",
            dict.fromkeys(("s", "r", "W1", "W2"), scalar()),
            id="lemma1",
            faith=(
                "That s, r, W1 and W2 are not negative and s + r > 0 in Lemma 1.",
                "The step from the identities to Lemma 1: for s < 2 r a sum of D1 and D2 with weights 2 r - s > 0 and "
                "s is not negative, so not both are negative; for s >= 2 r the second is a sum of terms >= 0.",
            ),
        ),
        source="Lemma 1",
    )
    unknowns = {"R": FREE_LOOP["R"], **{name: VECTORS[name] for name in ("z", "zd", "zM")}}
    for part, label in zip(PARTS, ("(15)", "(16)"), strict=True):
        one, other = (str(weight) for weight in PARTS[part])
        results.prove(
            identical(
                case,
                f"eq{label[1:3]}.identity",
                f"{label} holds for every z(t), z(t - d), z(t - d_M) and R (times d_M).",
                f"-({one} * {W1} + {other} * {W2})",
                f"col(z, zd, zM).T @ {jensen(label, one, other).formula} @ col(z, zd, zM)",
                unknowns,
                id=f"eq{label[1:3]}",
            ),
            source=label,
        )


def derivative_of_11(case: Case) -> Certificate:
    """(11) at t + e less (11) at t is e times (12), to first order, where z' is what (10) says it is."""
    unknowns = {name: FREE_LOOP[name] for name in ("P1", "P2", "P3", "Q1", "Q2", "R", "A_bar", "A_d", "mu")}
    unknowns |= {name: STATES[name] for name in ("z", "zd", "zM")}
    unknowns |= dict.fromkeys(("e", "d_M", "G1", "G1M", "G2", "G2d", "H", "HM", "K", "KM"), scalar())
    ones = {name: [["1"] * unknown.columns] * unknown.rows for name, unknown in unknowns.items()}
    return identical(
        case,
        "",
        "(12) is the derivative of (11) along (10), z for its x and d'(t) for its mu, to first order.",
        f"{FUNCTIONAL.format(**LATER)} - ({FUNCTIONAL.format(**{name: name for name in LATER})})",
        f"e * ({RATE.format(w='')} - (H - HM))",
        unknowns,
        id="eq12",
        definitions={"v": "A_bar @ z + A_d @ zd"},
        modulo=["e**2"],
        at={**ones, "e": "0"},
        faith=(
            "That an integral of a continuous function has that function as its derivative: G1' = z'Q1 z and so on.",
            "That the double integral of (11) is d_M H(t) - (K(t) - K(t - d_M)) with H' = z''R z' and K' = H.",
        ),
    )


@task("(12) to (22)")
def derivative(case: Case, results: Results) -> None:
    """The derivative of the functional as a quadratic form, and the norm inequality."""
    results.certificate(derivative_of_11(case))
    for equation, term, vector in (
        (EQUATION_17, "", "col(z, v, zd, zM)"),
        (EQUATION_22, " + B_bar @ w", "col(z, v, zd, zM, w)"),
    ):
        name = f"eq{equation.label[1:3]}"
        results.prove(
            identical(
                case,
                f"{name}.identity",
                f"The derivative (12) without its integral is the quadratic form of {equation.label} ({UNIT_NOTE}).",
                RATE.format(w=term),
                f"{vector}.T @ {equation.formula} @ {vector}",
                FREE_LOOP | (VECTORS if term else STATES),
                id=name,
                definitions=TIME_UNIT,
                faith=UNIT_ON_FAITH,
            ),
            source=equation.label,
        )
    for part, number in (("a", "18"), ("b", "19")):
        first, second = PARTS[part]
        results.prove(
            identical(
                case,
                f"eq{number}.identity",
                f"The leading part of (9{part}) is the left side of ({number}) ({UNIT_NOTE}).",
                f"col(z, v, zd, zM).T @ {equation_9(part, {}).sub(*ETA).formula} @ col(z, v, zd, zM)",
                f"{RATE.format(w='')} - {first} * {W1} - {second} * {W2}",
                FREE_LOOP | STATES,
                id=f"eq{number}",
                definitions=TIME_UNIT,
                faith=UNIT_ON_FAITH,
            ),
            source=f"(9{part}), ({number})",
        )
    results.certificate(
        differing(
            case,
            "",
            "The term of Q2 weighs 1 - d'(t), which is 1 - mu for d'(t) = mu alone: (12) is an inequality.",
            "(1 - rate) * zd.T @ Q2 @ zd",
            "(1 - mu) * zd.T @ Q2 @ zd",
            {"rate": scalar(), "mu": scalar(), "Q2": FREE_LOOP["Q2"], "zd": VECTORS["zd"]},
            id="eq12-equality",
        )
    )
    unknowns = {**{name: FREE_LOOP[name] for name in ("C_z", "C_d", "g")}, **VECTORS}
    phi = "col(z, v, zd, zM, w)"
    output = "row(C_z, zeros(1, 3), zeros(1, 3), zeros(1, 3), C_d)"
    results.prove(
        identical(
            case,
            "eq21.identity",
            "(21) holds with Y = [C 0 0 0 C_d].",
            "(C_z @ z + C_d @ w) ** 2 - g * w.T @ w",
            f"{phi}.T @ (diag(zeros(12, 12), -g * eye(2)) + {output}.T @ {output}) @ {phi}",
            unknowns,
            id="eq21",
        ),
        source="(21)",
    )
    results.certificate(
        differing(
            case,
            "",
            "The printed Y = [C 0 0 C_d] has one block less than phi: its row is 11 long, phi 14.",
            "row(C_z, zeros(1, 3), zeros(1, 3), C_d)",
            output,
            unknowns,
            id="eq21-printed",
        )
    )
    results.certificate(
        differing(
            case,
            "",
            "The printed d_M x' ' R x' weighs 2 entries with a 3 x 3 matrix.",
            "take(R, [0, 1], [0, 1])",
            "R",
            {"R": FREE_LOOP["R"]},
            id="eq12-printed",
        )
    )


@task("after Theorem 1")
def slack(case: Case, results: Results) -> None:
    """P2 and P3 do not reduce conservatism: what holds for any of them holds for P2 = P1, P3 = d_M R."""
    # on this subspace z' is what (7) says it is, and the slack drops out
    subspace = (
        "[[eye(3), 0, 0, 0, 0], [A_bar, A_d, 0, B_bar, 0], [0, eye(3), 0, 0, 0], [0, 0, eye(3), 0, 0], "
        "[0, 0, 0, eye(2), 0], [0, 0, 0, 0, eye(1)]]"
    )
    rest = (
        "[[eye(3), zeros(3,3), 0, 0, 0, 0], [0, 0, eye(3), 0, 0, 0], [0, 0, 0, eye(3), 0, 0], [0, 0, 0, 0, eye(2), 0], "
    )
    rest += "[0, 0, 0, 0, 0, eye(1)]]"
    gap = "row(-A_bar, eye(3), -A_d, zeros(3, 3), -B_bar, zeros(3, 1))"
    for part, quantity in (("a", "theorem1.slack_useless"), ("b", "")):
        given = equation_9(part, PRINTED_LOOP)
        certificate = implication(
            case,
            id=f"eq9-slack-{part}",
            quantity=quantity,
            sentence=f"Where (9{part}) holds for some P2, P3, it holds for P2 = P1, P3 = d_M R.",
            given=[given < 0, "R > 0"],
            then=f"{given.formula.replace('P2', 'P1').replace('P3', '(d_M * R)')} < 0",
            by=[
                Step(given.label, f"({subspace}) @ ({rest})", left_inverse="eye(15)"),
                Step("R > 0", gap, scale="d_M", left_inverse="col(zeros(3, 3), eye(3), zeros(9, 3))"),
            ],
            positive=("d_M",),
            unknowns=functional(3),
        )
        if quantity:
            results.prove(certificate, source="(9)")
        else:
            results.certificate(certificate)
    results.say("Lemma 1, (2) to (22)", "identities and implications proved")


TASKS = (model, lemma, derivative, slack)
