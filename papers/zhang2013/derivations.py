"""The derivations of zhang2013, step by step, as identities: (2), (5), (7), Lemma 1, (12) to (22)."""

from collections.abc import Mapping, Sequence

from gainsay.proof import Certificate
from gainsay.proof.build import certificate
from gainsay.tables import Case
from gainsay.tables.results import Results, task
from papers.zhang2013.certificates import PAPER, point_for
from papers.zhang2013.formulas import NINE, UNKNOWNS9, joined, nine

SIZES = {"z": 3, "w": 2, "y": 1}
ETA = ("z", "z'", "z_d", "z_M")
FREE_LOOP = {
    "A_bar": {"shape": [3, 3]},
    "A_d": {"shape": [3, 3]},
    "B_bar": {"shape": [3, 2]},
    "C_z": {"shape": [1, 3]},
    "C_d": {"shape": [1, 2]},
    "mu": {"shape": [1, 1]},
    "g": {"shape": [1, 1]},
}
"""A system (7)-(8) without numbers. d_M is set to 1 by the choice of the unit of time."""
TIME_UNIT = (("d_M", "eye(1)"),)
UNIT_NOTE = "time in units of d_M, in which d_M = 1; any other unit scales rates and R alone"
UNIT_ON_FAITH = ("That the unit of time may be chosen so that d_M = 1.",)
VECTORS = {name: {"shape": [3, 1]} for name in ("z", "v", "zd", "zM")} | {"w": {"shape": [2, 1]}}
W1 = "((z - zd).T @ R @ (z - zd))"
W2 = "((zd - zM).T @ R @ (zd - zM))"
RATE = (
    "2 * z.T @ P1 @ v + 2 * (z.T @ P2.T + v.T @ P3.T) @ (-v + A_bar @ z + A_d @ zd{w}) + z.T @ (Q1 + Q2) @ z"
    " - zM.T @ Q1 @ zM - (1 - mu) * zd.T @ Q2 @ zd + d_M * v.T @ R @ v"
)
"""Right side of (12) without its integral; v stands for z'."""


def _matrix(rows: Sequence[str], keep: Sequence[str]) -> str:
    """Weighted by R: the 3 x 3 pattern of (15) or (16) on z, z_d, z_M."""
    blocks = {(a, b): text for (a, b), text in zip(keep, rows, strict=True)}
    return joined(blocks, ("z", "z_d", "z_M"), SIZES)


def identity(
    name: str,
    statement: str,
    left: str,
    right: str,
    unknowns: Mapping,
    quantity: str,
    case: Case,
    definitions: Sequence = (),
    faith: Sequence[str] = (),
) -> Certificate:
    """Certificate that two formulas agree for every value of their unknowns; `faith` names what it leaves to prose."""
    return certificate(
        "identity",
        id=name,
        paper=PAPER,
        tables=case,
        statement=statement,
        unknowns=unknowns,
        definitions=definitions,
        fields={"left": left, "right": right},
        quantities={"identity": quantity},
        faith=faith,
    )


def different(
    name: str,
    statement: str,
    left: str,
    right: str,
    unknowns: Mapping,
    case: Case,
    quantity: str = "",
    definitions: Sequence = (),
) -> Certificate:
    """Certificate that two formulas are not the same."""
    return certificate(
        "different",
        id=name,
        paper=PAPER,
        tables=case,
        statement=statement,
        unknowns=unknowns,
        witness=point_for(unknowns),
        definitions=definitions,
        fields={"left": left, "right": right},
        quantities={"identity": quantity} if quantity else {},
    )


@task("(2), (5), (7)")
def model(case: Case, results: Results) -> None:
    """The design model from the equations of motion and of the observer."""
    scalar, pair = {"shape": [1, 1]}, {"shape": [2, 1]}
    results.certificate(
        identity(
            "eq2",
            "Eliminating eta'' from (1) gives (2).",
            "J * a + F @ (-q - F.T * a) - u - w",
            "(J - F @ F.T) * a - (F @ q + u + w)",
            {"J": scalar, "a": scalar, "u": scalar, "w": scalar, "F": {"shape": [1, 2]}, "q": pair},
            "eq2.identity",
            case,
        )
    )
    rate = "(A @ x + B * u + B * w1 + B * w2)"
    unknowns = {"A": {"shape": [2, 2]}, "B": pair, "x": pair, "L": {"shape": [1, 2]}}
    unknowns |= dict.fromkeys(("u", "w1", "w2", "w2rate", "p"), scalar)
    results.certificate(
        identity(
            "eq5",
            "(3) and (4) give (5), the observer being fed the torque that is applied.",
            f"w2rate + L @ B @ (p + L @ x) + L @ (A @ x + B * u) - L @ {rate}",
            "w2rate - L @ B @ (w2 - p - L @ x) - L @ B * w1",
            unknowns,
            "eq5.identity",
            case,
        )
    )
    unknowns = {"A": {"shape": [2, 2]}, "B": pair, "x": pair, "xd": pair, "K": {"shape": [1, 2]}}
    unknowns |= dict.fromkeys(("e", "w1", "w2"), scalar)
    results.certificate(
        identity(
            "eq7",
            "(3) with (6), its estimate not delayed, gives the first rows of (7).",
            "A @ x + B @ (-(w2 - e) + K @ xd) + B * w1 + B * w2",
            "A @ x + B * e + B @ K @ xd + B * w1",
            unknowns,
            "eq7.identity",
            case,
        )
    )
    results.certificate(
        different(
            "eq7-input-delay",
            "With the whole input delayed, as the name u(t - d(t)) would have it, (7) does not follow.",
            "A @ x + B @ (-(w2d - ed) + K @ xd) + B * w1 + B * w2",
            "A @ x + B * e + B @ K @ xd + B * w1",
            unknowns | dict.fromkeys(("w2d", "ed"), scalar),
            case,
            "eq7.input_delayed_identity",
        )
    )
    for name, value in (("eq2", 1), ("eq5", 1), ("eq7", 1)):
        results.quantity(f"{name}.identity", value, method="polynomial identity", source=f"({name[2:]})")
    results.quantity("eq7.input_delayed_identity", 0, method="exact counterexample", source="(6), (7)")


@task("Lemma 1, (15), (16)")
def lemma(case: Case, results: Results) -> None:
    """Lemma 1, and the quadratic forms that it turns into."""
    scalar = {"shape": [1, 1]}
    first = "(W1 * r * (r - 2 * s) + W2 * s ** 2)"
    second = "(W1 * r ** 2 + W2 * s * (s - 2 * r))"
    results.certificate(
        identity(
            "lemma1",
            "With s = d - d_m and r = d_M - d, the two differences of Lemma 1 times s r (s + r) are "
            "D1 = W1 r (r - 2 s) + W2 s^2 and D2 = W1 r^2 + W2 s (s - 2 r), and (2 r - s) D1 + s D2 = "
            "2 r (r - s)^2 W1 >= 0. So not both are negative where s < 2 r; and D2 >= 0 where s >= 2 r.",
            f"diag((s + r) * (r * W1 + s * W2) - s * r * (3 * W1 + W2) - {first}, "
            f"(s + r) * (r * W1 + s * W2) - s * r * (W1 + 3 * W2) - {second}, (2 * r - s) * {first} + s * {second})",
            "diag(0, 0, 2 * r * (r - s) ** 2 * W1)",
            dict.fromkeys(("s", "r", "W1", "W2"), scalar),
            "lemma1.holds",
            case,
            faith=(
                "That s, r, W1 and W2 are not negative and s + r > 0 in Lemma 1.",
                "The step from the identities to Lemma 1: for s < 2 r a sum of D1 and D2 with weights 2 r - s > 0 and "
                "s is not negative, so not both are negative; for s >= 2 r the second is a sum of terms >= 0.",
            ),
        )
    )
    results.quantity("lemma1.holds", 1, method="polynomial identity", source="Lemma 1")
    weights = {"R": UNKNOWNS9["R"], **{name: VECTORS[name] for name in ("z", "zd", "zM")}}
    keep = (("z", "z"), ("z", "z_d"), ("z_d", "z_d"), ("z_d", "z_M"), ("z_M", "z_M"))
    for number, rows, form in (
        ("15", ("-3 * R", "3 * R", "-4 * R", "R", "-R"), f"-(3 * {W1} + {W2})"),
        ("16", ("-R", "R", "-4 * R", "3 * R", "-3 * R"), f"-({W1} + 3 * {W2})"),
    ):
        results.certificate(
            identity(
                f"eq{number}",
                f"({number}) holds for every z(t), z(t - d), z(t - d_M) and R (times d_M).",
                form,
                f"col(z, zd, zM).T @ {_matrix(rows, keep)} @ col(z, zd, zM)",
                weights,
                f"eq{number}.identity",
                case,
            )
        )
        results.quantity(f"eq{number}.identity", 1, method="polynomial identity", source=f"({number})")


@task("(12) to (22)")
def functional(case: Case, results: Results) -> None:
    """The derivative of the functional as a quadratic form, and the norm inequality."""
    loop = {**UNKNOWNS9, **FREE_LOOP}
    for name, unknowns, term, rows, vector in (
        ("eq17", {k: v for k, v in VECTORS.items() if k != "w"}, "", ETA, "col(z, v, zd, zM)"),
        ("eq22", VECTORS, " + B_bar @ w", (*ETA, "w"), "col(z, v, zd, zM, w)"),
    ):
        # R enters (17) and (22) through d_M R in Omega_22 alone: the rest of (9a) is (15)
        blocks = {k: t for k, t in nine("a", "g").items() if k[0] in rows and k[1] in rows}
        blocks = {
            k: t.split(" - 3 * R")[0].split(" + 3 * R")[0].split(" - 4 * R")[0].split(" - 1 * R")[0]
            for k, t in blocks.items()
            if k != ("z_d", "z_M")
        }
        blocks.pop(("w", "w"), None)
        quadratic = f"{vector}.T @ {joined(blocks, rows, SIZES)} @ {vector}"
        results.certificate(
            identity(
                name,
                f"The derivative (12) without its integral is the quadratic form of ({name[2:]}) ({UNIT_NOTE}).",
                RATE.format(w=term),
                quadratic,
                loop | unknowns,
                f"{name}.identity",
                case,
                TIME_UNIT,
                UNIT_ON_FAITH,
            )
        )
        results.quantity(f"{name}.identity", 1, method="polynomial identity", source=f"({name[2:]})")
    for part, number in (("a", "18"), ("b", "19")):
        weights = ("3", "1") if part == "a" else ("1", "3")
        blocks = {k: t for k, t in nine(part, "g").items() if k[0] in ETA and k[1] in ETA}
        left = f"col(z, v, zd, zM).T @ {joined(blocks, ETA, SIZES)} @ col(z, v, zd, zM)"
        right = f"{RATE.format(w='')} - {weights[0]} * {W1} - {weights[1]} * {W2}"
        unknowns = loop | {k: v for k, v in VECTORS.items() if k != "w"}
        results.certificate(
            identity(
                f"eq{number}",
                f"The leading part of (9{part}) is the left side of ({number}) ({UNIT_NOTE}).",
                left,
                right,
                unknowns,
                f"eq{number}.identity",
                case,
                TIME_UNIT,
                UNIT_ON_FAITH,
            )
        )
        results.quantity(f"eq{number}.identity", 1, method="polynomial identity", source=f"(9{part}), ({number})")
    unknowns = {"C_z": FREE_LOOP["C_z"], "C_d": FREE_LOOP["C_d"], "g": FREE_LOOP["g"], **VECTORS}
    phi = "col(z, v, zd, zM, w)"
    output = "row(C_z, zeros(1, 3), zeros(1, 3), zeros(1, 3), C_d)"
    results.certificate(
        identity(
            "eq21",
            "(21) holds with Y = [C 0 0 0 C_d].",
            "(C_z @ z + C_d @ w) ** 2 - g * w.T @ w",
            f"{phi}.T @ (diag(zeros(12, 12), -g * eye(2)) + {output}.T @ {output}) @ {phi}",
            unknowns,
            "eq21.identity",
            case,
        )
    )
    results.quantity("eq21.identity", 1, method="polynomial identity", source="(21)")
    results.certificate(
        different(
            "eq21-printed",
            "The printed Y = [C 0 0 C_d] has one block less than phi: its row is 11 long, phi 14.",
            "row(C_z, zeros(1, 3), zeros(1, 3), C_d)",
            output,
            unknowns,
            case,
        )
    )
    results.certificate(
        different(
            "eq12-printed",
            "The printed d_M x' ' R x' weighs 2 entries with a 3 x 3 matrix.",
            "take(R, [0, 1], [0, 1])",
            "R",
            {"R": UNKNOWNS9["R"]},
            case,
        )
    )


@task("after Theorem 1")
def slack(case: Case, results: Results) -> None:
    """P2 and P3 do not reduce conservatism."""
    unknowns = {**UNKNOWNS9, **FREE_LOOP}
    on = (
        "[[eye(3), zeros(3, 3), zeros(3, 3), zeros(3, 2), zeros(3, 1)], [A_bar, A_d, zeros(3, 3), B_bar, zeros(3, 1)], "
        "[zeros(3, 3), eye(3), zeros(3, 3), zeros(3, 2), zeros(3, 1)], "
        "[zeros(3, 3), zeros(3, 3), eye(3), zeros(3, 2), zeros(3, 1)], "
        "[zeros(2, 3), zeros(2, 3), zeros(2, 3), eye(2), zeros(2, 1)], "
        "[zeros(1, 3), zeros(1, 3), zeros(1, 3), zeros(1, 2), eye(1)]]"
    )
    sides = []
    for part in "ab":
        special = {key: text.replace("P2", "P1").replace("P3", "(d_M * R)") for key, text in nine(part, "g").items()}
        sides.append([f"(T.T @ {joined(blocks, NINE, SIZES)} @ T)" for blocks in (nine(part, "g"), special)])
    results.certificate(
        identity(
            "eq9-slack",
            "On z' = Abar z + Ad z_d + Bbar w the left sides of (9a), (9b) do not depend on P2, P3 and equal those for "
            "P2 = P1, P3 = d_M R. These have the block -d_M R at z', and that subspace is where they are largest over "
            f"z': so (9) holds for some P2, P3 exactly if it holds for P2 = P1, P3 = d_M R ({UNIT_NOTE}).",
            f"diag({sides[0][0]}, {sides[1][0]})",
            f"diag({sides[0][1]}, {sides[1][1]})",
            unknowns,
            "theorem1.slack_useless",
            case,
            (*TIME_UNIT, ("T", on)),
            faith=(
                "The step from the identity to the equivalence: (9) is negative definite if and only if its block at "
                "z' is and so is its largest value over z', which for P2 = P1, P3 = d_M R is taken on the subspace.",
                *UNIT_ON_FAITH,
            ),
        )
    )
    results.quantity("theorem1.slack_useless", 1, method="polynomial identity", source="(9)")
    results.say("Lemma 1, (2) to (22)", "identities proved")


TASKS = (model, lemma, functional, slack)
