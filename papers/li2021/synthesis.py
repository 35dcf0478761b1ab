"""Synthesis of li2021: what its conditions can and cannot do, and controllers certified for what it promised."""

from typing import Any

import numpy as np

from gainsay.errors import ComputationError
from gainsay.lmi import Solved
from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.statements import Stated, enclose, optimum, prove
from gainsay.systems.norms import hinf_enclosure
from gainsay.tables import Case
from gainsay.tables.designs import Design
from papers.li2021 import derivations, derivations_appendix2, plant, proofs
from papers.li2021 import derivations_identities as identities
from papers.li2021 import proofs_requirements as certify
from papers.li2021.statements import EQ12, EQ20, TABLES, equation_17, linear_13

#: margins at which an infimum is enclosed: its multipliers are to be rounded
MARGINS = (1e-9, 1e-8, 1e-7)
#: digits of certificates whose multipliers have as little room
LONG = (12, 15, 17)
#: digits of those with the room of `by_margin`
ROUNDED = (9, 12, 15, 17)


def decided(results: Results, quantity: str, stated: Stated, **parts: Any) -> None:
    """Decide by the largest common margin whether a program has a point, and prove it."""
    outcome = results.attempted(stated.label, stated.by_margin())
    prove(results, quantity, stated, outcome, digits=ROUNDED, **parts)


@task("Section II.B, factors")
def factors(case: Case, results: Results) -> None:
    """Factorisations of Delta D and Delta G with the corrected factors, and what is misprinted."""
    for certificate in (*(identities.factorisation(case, which) for which in "DG"), *identities.misprints(case)):
        results.prove(certificate, source="Section II.B")
    results.say("Section II.B, factors", "Delta D and Delta G factor with corrected Gamma_D, Gamma_G; four misprints")


@task("(7), Lemmas 1 and 2")
def algebra(case: Case, results: Results) -> None:
    """The reduction (7), Lemma 2 by a completed square, and Lemma 1 with a negative mu."""
    results.prove(identities.reduction(case), source="(6), (7)")
    results.prove(identities.completed_square(case), source="Lemma 2")
    results.prove(identities.negative_multiplier(case), source="Lemma 1")
    results.say("(7), Lemmas 1 and 2", "(7) and Lemma 2 hold; Lemma 1 needs mu > 0")


@task("(20), (B.5)")
def start_ellipsoid(case: Case, results: Results) -> None:
    """(20) does not bound x(0)'(S - N) x(0): a point that satisfies it and not the bound."""
    form = EQ20.defining(x0="printed('x0')", theta="number('theta')")
    stated = Stated(case, [form <= 0, "S > 0", "N < 0", "x0.T @ (S - N) @ x0 >= 2 * theta"])
    results.prove(
        build.feasible_point(
            id="eq20-no-bound",
            point={"S": 9999.0 * np.eye(6), "N": -np.eye(6)},
            statement="S > 0 and N < 0 satisfy (20) for Table 1's x(0) and theta, although "
            "x(0)'(S - N) x(0) > 2 theta: "
            "(B.5) bounds xi(0)'P^-1 xi(0).",
            quantities={"feasible": "eq20.without_bound"},
            **stated.parts(),
        ),
        source="(20)",
    )
    results.say("(20), (B.5)", "does not bound the start: a point satisfies it and leaves the ellipsoid")


@task("(17)")
def theorem2(case: Case, results: Results) -> None:
    """Theorem 2 in its four readings: the same two rows are infeasible for every value of the scalars."""
    readings = [equation_17(divided, thin).sub("1a", "5a") for divided in (False, True) for thin in (False, True)]
    same = sum(rows.formula == readings[0].formula for rows in readings)
    results.quantity(
        "eq17.readings", same, method="readings whose rows 1a and 5a are those of the certificate", source="(17)"
    )
    results.prove(proofs.open_loop_in_disk(case, readings[0]), source="(17)")
    results.say("(17)", f"infeasible for all scalars in {same} readings, Farkas certificate checked")


@task("(13)")
def theorem1(case: Case, results: Results) -> None:
    """Theorem 1 at Table 1's scalars, in both readings of eps2."""
    for divided, quantity in ((False, "eq13.feasible"), (True, "eq13.feasible_divided")):
        stated = Stated(case, [linear_13(divided).defining(TABLES) <= 0], label="(13)")
        reading = "dividing psi_4 and psi_5" if divided else "multiplying psi_3"
        decided(
            results,
            quantity,
            stated,
            id="eq13-infeasible-divided" if divided else "eq13-infeasible",
            sentence=f"solution of (13) at Table 1's scalars, eps2 read as {reading}: of what it gives linear in "
            "X = S^-1, Y = S - N, Fb, Ch = C_f X and a free block, whatever gamma, eps1 and delta_m",
            faith=(proofs.REBUILT,),
            source="(13), Table 1",
        )
    results.say("(13)", "infeasible at Table 1's scalars in both readings of eps2")


@task("(17) against (13)")
def not_equivalent(case: Case, results: Results) -> None:
    """(13) holds at some scalars, although (17) does at none."""
    outcome = proofs.lemma_3(case, uncertain=True, g=TABLES["g"]).by_margin()
    if not isinstance(outcome, Solved):
        raise ComputationError("(13)", "no point with room to spare", outcome.attempts)
    results.prove(proofs.solution_of_13(case, outcome.values), source="Theorem 2")
    results.say("(17) against (13)", "not equivalent: (13) has a solution at some scalars, (17) at none")


@task("(19) with (12)")
def lemma4(case: Case, results: Results) -> None:
    """(19) with the printed C_f against (12) at lambda = 1."""
    decided(
        results,
        "eq19.feasible_with_eq12",
        proofs.input_bound(case),
        id="eq19-against-eq12",
        source="(12), (19)",
        sentence="S and N that satisfy (19) with the printed C_f and rows 1a, 1b and 2 of (15), which (12) gives with "
        "the P of Theorem 1, at the paper's lambda",
    )
    results.say("(19) with (12)", "exclude each other for the printed C_f, Farkas certificate checked")


def rooted(results: Results, quantity: str, stated: Stated, *, sentence: str, id: str) -> float:
    """Enclose the least gamma^2 of (12), and with it gamma."""
    root = optimum(results, stated, margins=MARGINS)
    square = f"{quantity}_squared"
    lower, upper = enclose(results, square, stated, root, sentence=sentence, id=id, source="(12)", digits=LONG)
    gamma = float(np.sqrt(np.clip(root.value, lower, upper)))
    ends = {"lower": float(np.nextafter(np.sqrt(lower), 0)), "upper": float(np.nextafter(np.sqrt(upper), np.inf))}
    results.quantity(quantity, gamma, method=f"square root of {square}", source="(12)", **ends)
    return gamma


@task("(12), all gains")
def lemma3(case: Case, results: Results) -> None:
    """Least gamma of Lemma 3 over all gains at lambda = 1, nominal and with Delta A."""
    sentence = "gamma^2 over all gains and P that satisfy (12) at the paper's lambda"
    nominal = rooted(results, "lemma3.gamma_min", proofs.lemma_3(case), sentence=sentence, id="eq12-gamma")
    uncertain = rooted(
        results,
        "lemma3.gamma_min_uncertain",
        proofs.lemma_3(case, uncertain=True),
        id="eq12-gamma-uncertain",
        sentence=f"{sentence}, bordered by K and L for Delta A",
    )
    results.say("(12), all gains", f"least gamma {nominal:.6f}, with Delta A {uncertain:.6f} at lambda = 1")


@task("(12), band of lambda")
def lambda_band(case: Case, results: Results) -> None:
    """The values of lambda at which (12) can be met at all with the paper's gamma: each end proved from both sides."""
    band = case.designs["lambda_band"]
    for end in ("low", "high"):
        inside, outside = (float(band[f"{end}_{side}"][0, 0]) for side in ("inside", "outside"))
        outcome = proofs.lemma_3(case, lam=repr(inside), g=TABLES["g"]).solve()
        if not isinstance(outcome, Solved):
            raise ComputationError("(12)", f"no point at lambda = {inside}", outcome.attempts)
        results.certificate(proofs.end_of_band(case, outcome.values, inside, end))
        decided(
            results,
            f"lemma3.feasible_beyond_{end}",
            proofs.lemma_3(case, lam=repr(outside), g=TABLES["g"]),
            id=f"eq12-lambda-beyond-{end}",
            source="(12)",
            sentence=f"solution of (12) over all gains at lambda = {outside} and the paper's gamma",
        )
        results.quantity(
            f"lemma3.lambda_{end}",
            float(np.sqrt(inside * outside)),
            lower=min(inside, outside),
            upper=max(inside, outside),
            method="a point on one side, Farkas multipliers on the other",
            source="(12)",
        )
    results.say(
        "(12), band of lambda",
        "feasible at the paper's gamma on a band of lambda, points inside and proofs outside both ends",
    )


@task("(12), printed gains")
def printed_gains(case: Case, results: Results) -> None:
    """The printed gains in (12): infeasible at lambda = 1, least gamma at lambda = 3."""
    stated = proofs.printed_gains(case, *(row for row in EQ12.rows if row != "3"))
    decided(
        results,
        "eq12.printed_feasible",
        stated,
        id="eq12-printed-infeasible",
        source="(12)",
        sentence="P with which the printed gains satisfy (12) at the paper's lambda, even without its row 3, whatever "
        "gamma",
    )
    gamma = rooted(
        results,
        "lemma3.printed_gamma_min",
        proofs.printed_gains(case, lam="number('lambda_pass')"),
        id="eq12-printed",
        sentence="gamma^2 over P that satisfies (12) with the printed gains, nominal A and lambda = 3",
    )
    results.say("(12), printed gains", f"no P at lambda = 1; least gamma {gamma:.6f} at lambda = 3")


def certify_levels(
    case: Case, results: Results, name: str, gains: plant.Gains, formulas: certify.Formulas, design: Design
) -> None:
    """Prove all three requirements at the levels of a search: by arcs, and with one matrix for the disk."""
    quantity = f"certified.{name}.delta_m"
    level, alone = (float(design[entry][0, 0]) for entry in ("level", "level_quadratic"))
    results.prove(
        certify.certificate(
            case,
            f"{name}-delta-m",
            formulas,
            certify.gather(case, gains, level),
            quantity=quantity,
            statement=f"The {name} gains meet disk, norm and torque for gain variations up to dm, inertia included.",
        ),
        source="requirements 1 to 3",
    )
    results.prove(
        certify.certificate(
            case,
            f"{name}-delta-m-quadratic",
            formulas,
            certify.gather(case, gains, alone, one_matrix=True),
            quantity=f"{quantity}_quadratic",
            statement=f"The {name} gains meet disk, norm and torque up to dm, each by one quadratic function.",
        ),
        source="requirements 1 to 3",
    )
    results.say("requirements 1 to 3", f"{name}: certified to {level}, with one P for the disk {alone}")


@task("requirements 1 to 3, printed gains")
def printed_limit(case: Case, results: Results) -> None:
    """Gain variation for which the printed gains are proved to meet all three requirements."""
    gains = plant.controller(case, "proposed")
    certify_levels(case, results, "printed", gains, certify.PRINTED, case.designs["printed_levels"])


@task("our designs")
def designs(case: Case, results: Results) -> None:
    """Our designs: better than the printed gains on the paper's own measures, and with the largest gain variation."""
    for name in ("repaired", "best"):
        design = case.designs[name]
        certify_levels(case, results, name, plant.controller(case, name), certify.of_design(name), design)


@task("trade-off")
def tradeoff(case: Case, results: Results) -> None:
    """Designs between the printed gains and the largest gain variation, each certified at its level."""
    k = plant.rigid(plant.constants(case))
    B, C = np.vstack([k.B, np.zeros((6, 3))]), np.eye(3, 12)
    reached = []
    for number in range(1, 6):
        name, stem = f"tradeoff_{number}", f"tradeoff.{number}"
        design = case.designs[name]
        gains, level = plant.controller(case, name), float(design["level"][0, 0])
        loop = plant.closed_loop(k, gains)
        results.prove(
            certify.certificate(
                case,
                f"tradeoff-{number}-delta-m",
                certify.of_design(name),
                certify.gather(case, gains, level),
                quantity=f"{stem}.delta_m",
                statement=f"Point {number} of the trade-off meets disk, norm and torque for gain variations up to dm.",
            ),
            source="requirements 1 to 3",
        )
        static = np.linalg.norm(C @ np.linalg.solve(loop, B), 2)
        norm = hinf_enclosure(loop, B, C)
        results.quantity(f"{stem}.static_gain", float(static), source="(10)", method="norm of -C A^-1 B")
        results.quantity(
            f"{stem}.norm",
            norm.lower,
            lower=norm.lower,
            upper=norm.upper,
            source="(10)",
            method="exact Hamiltonian of the doubles",
        )
        results.quantity(
            f"{stem}.disk_radius",
            **plant.enclosed_loop(case, name)["disk_radius"],
            source="(10)",
            method="largest |s + 1.01| over the eigenvalues of (10), in balls",
        )
        reached.append(f"{level}")
    results.say("trade-off", f"gain variations {', '.join(reached)}, certified")


TASKS = (
    factors,
    algebra,
    *derivations.TASKS,
    *derivations_appendix2.TASKS,
    start_ellipsoid,
    theorem2,
    theorem1,
    not_equivalent,
    lemma4,
    lemma3,
    lambda_band,
    printed_gains,
    printed_limit,
    designs,
    tradeoff,
)
