"""The audit of what section 4 prints: n, (1)-(3), (39)-(44); what its figures say is in `scans`."""

from collections.abc import Sequence
from fractions import Fraction
from itertools import product

import numpy as np
from flint import arb, arb_mat, fmpq, fmpq_mat

from gainsay.dynamics.relative_orbit import clohessy_wiltshire
from gainsay.exact.ball import precision
from gainsay.proof import Certificate, build
from gainsay.results import Results, task
from gainsay.statements import identical
from gainsay.systems import loop_proofs
from gainsay.systems.pole_sets import match_poles, pole_clusters
from gainsay.tables import Case
from papers.wan2014 import plant
from papers.wan2014.audit_models import first_order, model_accuracy
from papers.wan2014.proofs_two_body import flights_end_at_target
from papers.wan2014.scans import over_starts, start_boundary
from papers.wan2014.statements import A_FORMULA

#: a pole nearer to its place than this is not worth a certificate that it is missed, 1/s
_WORTH_PROVING = 1e-3
DEFINITIONS = (("n", "number('mean_motion')"), ("A", A_FORMULA), ("B", "[[zeros(3, 3)], [eye(3)]] / number('mass')"))
OBSERVER_FORMULA = "A - printed('L') @ printed('C')"
#: what the rounding of n = 1.13e-3 changes in an entry of A at most: 2 n by 1e-5
RATE_ROUNDING = 1e-5


@task("Section 4, n")
def mean_motion(case: Case, results: Results) -> None:
    """Enclose n from the perigee radius and e over every plausible gravitational parameter."""
    proved = build.certificate(
        "enclosed",
        id="mean-motion",
        tables=case,
        statement="sqrt(mu / a^3), a = r_p / (1 - e), for every plausible mu.",
        definitions=(
            ("mu", "plausible('gravitational_parameter')"),
            ("a", "number('perigee_radius') / (1 - number('eccentricity'))"),
        ),
        fields={"formula": "sqrt(mu / a**3)"},
        quantities={"value": "audit.mean_motion"},
    )
    results.prove(proved, source="Section 4")


def observability_rank(A: fmpq_mat, C: fmpq_mat) -> int:
    """Return the rank of the observability matrix of (A, C), exactly."""
    rows, block = [], C
    for _ in range(A.nrows()):
        rows += block.tolist()
        block = block * A
    return fmpq_mat(rows).rank()


@task("(6), (39)")
def observability(case: Case, results: Results) -> None:
    """Count the observable ones among the 64 diagonal 0/1 output matrices, in rationals."""
    n = case.exact("mean_motion")
    exact = [[fmpq(0)] * 6 for _ in range(6)]
    for i in range(3):
        exact[i][3 + i] = fmpq(1)
    rate = fmpq(n.numerator, n.denominator)
    exact[3][0], exact[3][4], exact[4][3], exact[5][2] = 3 * rate**2, 2 * rate, -2 * rate, -(rate**2)
    A = fmpq_mat(exact)
    count = 0
    for measured in product((0, 1), repeat=6):
        C = fmpq_mat([[int(i == j and measured[i]) for j in range(6)] for i in range(6)])
        count += observability_rank(A, C) == 6
    exactly = "rank of the observability matrix in rationals"
    results.enclosed("audit.observable_outputs", Fraction(count), Fraction(count), method=exactly, source="Section 4")
    rows = [[fmpq(x.numerator, x.denominator) for x in row] for row in case.printed("C").exact]
    rank = observability_rank(A, fmpq_mat(rows))
    results.enclosed("audit.observability_rank", Fraction(rank), Fraction(rank), method=exactly, source="(39)")
    results.say("(6), (39)", f"{count} of 64 output matrices observable; (39) has rank {rank}")


@task("(3), (42)")
def factorisation(case: Case, results: Results) -> None:
    """Prove Delta A = E1 Lambda E2 for every e, n and M, and that Lambda' Lambda < I fails."""
    results.prove(
        identical(
            case,
            "eq3.factorisation",
            "Delta A of (2) equals E1 Lambda E2 of (42) for every e, n and M (s = sin M, c = cos M).",
            "Delta",
            "E1 @ Lambda @ E2",
            "e n s c",
            definitions=(
                ("E1", "printed('E1_over_e') * e"),
                ("P", "printed('E2_coefficient')"),
                # (42) prints n^2 everywhere but in rows 3 and 4, columns 5 and 4, where it prints n
                ("linear", "P[2, 4] * unit(6, 2) @ unit(6, 4).T + P[3, 3] * unit(6, 3) @ unit(6, 3).T"),
                ("E2", "n**2 * (P - linear) + n * linear"),
                ("Lambda", "diag(s, -s, c, c, -0.5*c, c)"),
                ("row_x", "[[10*e*n**2*c, -2*e*n**2*s, 0, 0, 4*e*n*c, 0]]"),
                ("row_y", "[[2*e*n**2*s, e*n**2*c, 0, -4*e*n*c, 0, 0]]"),
                ("row_z", "[[0, 0, -3*e*n**2*c, 0, 0, 0]]"),
                ("Delta", "col(zeros(3, 6), row_x, row_y, row_z)"),
            ),
        ),
        source="(2), (3), (42)",
    )
    results.certificate(
        build.certificate(
            "not_definite",
            id="eq3-strict-bound",
            tables=case,
            statement="Lambda' Lambda < I fails at M = 0: its third diagonal entry cos M is then 1.",
            definitions=(("Lambda", "diag(0, 0, 1, 1, -0.5, 1)"),),
            fields={"constraint": "eye(6) - Lambda.T @ Lambda > zeros(6, 6)"},
            witness={"z": [["0"], ["0"], ["1"], ["0"], ["0"], ["0"]]},
            quantities={"definite": "eq3.strict_bound"},
        )
    )
    results.quantity("eq3.strict_bound", 0, method="I - Lambda' Lambda is singular at M = 0", source="(3), (42)")
    dead = int(np.sum(~case.matrix("E1_over_e").any(axis=0)))
    results.quantity("audit.dead_channels", dead, method="zero columns of E1", source="(42)")
    results.say("(3), (42)", "factorisation holds for every e, n, M; the strict bound fails at M = 0")


def pole_points(case: Case) -> list[list[str]]:
    """Return the six poles of (40) as pairs of decimals."""
    pairs = case.printed("observer_poles").rows
    return [[re.text, sign + im.text] for re, im in pairs for sign in ("", "-")]


def _depends_on_rate() -> np.ndarray:
    """1 for the entries of A that hold n, shape (6, 6)."""
    return (clohessy_wiltshire(1.0) != clohessy_wiltshire(2.0)).astype(float)


@task("(40), (41)")
def observer_poles(case: Case, results: Results) -> None:
    """Compare the poles of A - LC with (40); prove that no L with the printed digits places them."""
    model, C, printed = plant.design_model(case), case.matrix("C"), case.printed("observer_poles")
    A = model.A - case.matrix("L") @ C
    rounding = np.array([[float(x) for x in row] for row in case.printed("L").half_units])
    clusters = pole_clusters(A, rounding @ np.abs(C) + _depends_on_rate() * RATE_ROUNDING)
    matched = match_poles([complex(float(re.value), float(im.value)) for re, im in printed.rows], clusters)
    results.poles(
        "(40)",
        published=printed,
        recomputed=[complex(c.centre.real, abs(c.centre.imag)) for c in matched],
        radius=[c.radius for c in matched],
    )
    for id, quantity, change, sentence in (
        ("eq40-distance", "audit.observer_pole_error", "", "Distance of the poles of A - LC from (40), best matching."),
        (
            "eq40-distance-corrected",
            "observer.pole_error_corrected",
            " - 0.0225 * unit(6, 1) @ unit(6, 0).T",
            "The same with -0.0025 for the entry -0.025 of L.",
        ),
    ):
        results.prove(
            loop_proofs.pole_distance(
                case,
                f"{OBSERVER_FORMULA}{change}",
                pole_points(case),
                definitions=DEFINITIONS,
                id=id,
                statement=sentence,
                quantity=quantity,
            ),
            source="(40), (41)",
        )
    results.prove(
        loop_proofs.abscissa(
            case,
            OBSERVER_FORMULA,
            definitions=DEFINITIONS,
            id="observer-abscissa",
            statement="Spectral abscissa of A - LC with the printed L.",
            quantity="audit.observer_abscissa",
        ),
        source="(41)",
    )
    missed = []
    for number, (row, cluster) in enumerate(zip(printed.rows, matched, strict=True), start=1):
        place = complex(float(row[0].value), float(row[1].value))
        if abs(complex(cluster.centre.real, abs(cluster.centre.imag)) - place) < _WORTH_PROVING:
            continue
        results.certificate(
            build.certificate(
                "not_an_eigenvalue",
                id=f"eq40-pole-pair-{number}",
                tables=case,
                statement=f"{row[0].text} + j{row[1].text} is no pole of A - LC for any L, n that round as printed.",
                definitions=(("n", "interval(0.001125, 0.001135)"), ("A", A_FORMULA), ("L", "box('L')")),
                fields={"matrix": "A - L @ printed('C')", "real": row[0].text, "imaginary": row[1].text},
                quantities={"eigenvalue": "eq40.poles_placed"},
            )
        )
        missed.append(row[0].text)
    results.quantity(
        "eq40.poles_placed",
        int(not missed),
        method="regularity of s I - A + LC over the printed digits",
        source="(40), (41)",
    )
    results.certificate(
        half_plane(case, "observer-stable", ("A - LC", OBSERVER_FORMULA), "-0.4", "audit.observer_abscissa")
    )
    results.say("(40), (41)", f"{len(missed)} of 3 pole pairs of (40) missed; stable")


def half_plane(case: Case, id: str, named: tuple[str, str], alpha: str, quantity: str) -> Certificate:
    """Return a certificate that a matrix, by name and formula, has its spectrum left of alpha (decimal text)."""
    name, formula = named
    return loop_proofs.poles_left_of(
        case,
        formula,
        alpha,
        definitions=DEFINITIONS,
        id=id,
        statement=f"Every eigenvalue of {name}, with the printed gains, has a real part below {alpha} 1/s.",
        quantities={"abscissa": quantity},
    )


@task("(10), (11)")
def feedback_poles(case: Case, results: Results) -> None:
    """Compute the poles of A - BK with the printed K and certify their half plane."""
    results.prove(
        loop_proofs.abscissa(
            case,
            "A - B @ printed('K')",
            definitions=DEFINITIONS,
            id="feedback-abscissa",
            statement="Spectral abscissa of A - BK with the printed K.",
            quantity="audit.feedback_abscissa",
        ),
        source="(44)",
    )
    results.certificate(
        half_plane(case, "feedback-stable", ("A - BK", "A - B @ printed('K')"), "0", "audit.feedback_abscissa")
    )


def _rational(rows: Sequence[Sequence[Fraction]]) -> fmpq_mat:
    return fmpq_mat([[fmpq(x.numerator, x.denominator) for x in row] for row in rows])


def _ball(value: Fraction, half_unit: Fraction) -> arb:
    return arb(fmpq(value.numerator, value.denominator), fmpq(half_unit.numerator, half_unit.denominator))


def interval_gain(case: Case) -> list[list[arb]]:
    """Return the ball enclosure of Y X^-1 over every X and Y that round to the printed digits."""

    def box(name: str) -> arb_mat:
        printed = case.printed(name)
        return arb_mat(
            [
                [_ball(value, half) for value, half in zip(*rows, strict=True)]
                for rows in zip(printed.exact, printed.half_units, strict=True)
            ]
        )

    with precision(128):
        return (box("Y") * box("X").inv()).tolist()


@task("(43), (44)")
def gain_rounding(case: Case, results: Results) -> None:
    """Compare K with Y X^-1 from the printed digits, and count the entries that the digits' rounding explains."""
    X, Y, K = (_rational(case.printed(name).exact) for name in "XYK")
    computed = Y * X.inv()
    ratios = [abs(a / b) for a, b in zip(computed.entries(), K.entries(), strict=True)]
    ratio = max(max(r, 1 / r) for r in ratios)
    results.quantity(
        "audit.gain_ratio",
        int(ratio.p) / int(ratio.q),
        method="largest factor between K and Y X^-1, entry by entry, in rationals",
        source="(43), (44)",
    )
    enclosure, printed = interval_gain(case), case.printed("K")
    inside = sum(
        enclosure[i][j].overlaps(_ball(printed.exact[i][j], printed.half_units[i][j]))
        for i in range(3)
        for j in range(6)
    )
    results.quantity(
        "audit.gain_entries_explained",
        inside,
        source="(43), (44)",
        method="entries of K inside the ball enclosure of Y X^-1 over the rounding box",
    )
    results.say(
        "(43), (44)",
        f"Y X^-1 off by a factor up to {int(ratio.p) / int(ratio.q):.1f}; rounding explains {inside} of 18 entries",
    )


TASKS = (
    mean_motion,
    observability,
    factorisation,
    first_order,
    model_accuracy,
    observer_poles,
    feedback_poles,
    gain_rounding,
    over_starts,
    flights_end_at_target,
    start_boundary,
)
