"""Synthesis of li2021: what its conditions can and cannot do, and controllers certified for what it promised."""

from collections.abc import Mapping

import numpy as np
from scipy.linalg import block_diag, solve_continuous_lyapunov

from gainsay.errors import ComputationError
from gainsay.lmi import Program, Solved, infimum, solve
from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.statements import Stated
from gainsay.systems.norms import hinf_enclosure
from gainsay.tables import Case
from gainsay.tables.designs import Design
from papers.li2021 import conditions as lmis
from papers.li2021 import derivations, plant, proofs
from papers.li2021 import derivations_equivalence as equivalence
from papers.li2021 import derivations_identities as identities
from papers.li2021 import proofs_requirements as certify
from papers.li2021.statements import EQ20, TABLES, linear_13


def refutation(program: Program, where: str, results: Results) -> Mapping[str, np.ndarray]:
    """Farkas multipliers of a program that must have no point, by label of the constraint."""
    found = infimum(lmis.pushed(program), margins=(1e-7,)).need(where)
    results.attempt(where, list(found.attempts))
    return {label: z for label, z in found.multipliers.items() if label != "t < 1"}


@task("Section II.B, factors")
def factors(case: Case, results: Results) -> None:
    """Factorisations of Delta D and Delta G with the corrected factors, and what is misprinted."""
    for which in "DG":
        results.certificate(identities.factorisation(case, which))
        results.quantity(f"factorisation.{which.lower()}", 1, method="polynomial identity in delta_1, delta_2, delta_3",
                         source="Section II.B")  # fmt: skip
    results.certificate(identities.misprint(
        case, "g0-parentheses", "G0(3,3) as printed, n^2 J20 - J10, is not n^2 (J20 - J10).",
        "n**2 * J2 - J1", "n**2 * (J2 - J1)", "misprint.g0",
    ))  # fmt: skip
    results.certificate(identities.misprint(
        case, "d0-third-row", "D0 as printed, with two rows, is not D(J0) of (6).",
        "n * (J1 + J3 - J2) * turn[0:2, 0:3]", "D0", "misprint.d0",
    ))  # fmt: skip
    padded = (("printed_third", "[[0, 1, 0, -1, 0, 0]]"),)
    results.certificate(identities.misprint(
        case, "gamma-d-third-row", "The third row of Gamma_D as printed, filled with zeros, is not the one needed.",
        "printed_third", "printed('GammaD').T[2:3, 0:6]", "misprint.gamma_d", padded,
    ))  # fmt: skip
    results.certificate(identities.misprint(
        case, "gamma-g-rows", "Gamma_G as printed has five rows and columns; Xi_G Delta_G Gamma_G needs 6x3.",
        "[[4, 0, 0, 1, 0], [0, 0, 1, -1, 0], [0, 0, 1, -1, 0], [0, 1, -1, 0, 0], [0, 1, 0, 0, 1]].T",
        "printed('GammaG')", "misprint.gamma_g",
    ))  # fmt: skip
    for name in ("g0", "d0", "gamma_d", "gamma_g"):
        results.quantity(f"misprint.{name}", 0, method="the two sides differ", source="Section II.B")
    results.say("Section II.B, factors", "Delta D and Delta G factor with corrected Gamma_D, Gamma_G; four misprints")


@task("(7), Lemmas 1 and 2")
def algebra(case: Case, results: Results) -> None:
    """The reduction (7), Lemma 2 by a completed square, and Lemma 1 with a negative mu."""
    wanted = (
        identities.reduction(case),
        identities.completed_square(case),
        identities.negative_multiplier(case),
    )
    for certificate in wanted:
        results.certificate(certificate)
    method = "polynomial identity"
    results.quantity("eq7.reduction", 1, method=method, source="(6), (7)")
    results.quantity("lemma2.identity", 1, method=method, source="Lemma 2")
    results.quantity("lemma1.without_sign", 1, method="a point with mu = -1", source="Lemma 1")
    results.say("(7), Lemmas 1 and 2", "(7) and Lemma 2 hold; Lemma 1 needs mu > 0")


@task("(20), (B.5)")
def start_ellipsoid(case: Case, results: Results) -> None:
    """(20) does not bound x(0)'(S - N) x(0): a point that satisfies it and not the bound."""
    form = EQ20.defining(x0="printed('x0')", theta="number('theta')")
    stated = Stated(case, [form <= 0, "S > 0", "N < 0", "x0.T @ (S - N) @ x0 >= 2 * theta"])
    results.prove(build.feasible_point(
        id="eq20-no-bound", paper=case.name, point={"S": 9999.0 * np.eye(6), "N": -np.eye(6)},
        statement="S > 0 and N < 0 satisfy (20) for Table 1's x(0) and theta, although x(0)'(S - N) x(0) > 2 theta: "
        "(B.5) bounds xi(0)'P^-1 xi(0).",
        quantities={"feasible": "eq20.without_bound"}, **stated.parts(),
    ), source="(20)")  # fmt: skip
    results.say("(20), (B.5)", "does not bound the start: a point satisfies it and leaves the ellipsoid")


@task("(17)")
def theorem2(case: Case, results: Results) -> None:
    """Theorem 2 in its four readings: the same two rows are infeasible for every value of the scalars."""
    model, scalars = lmis.Model.of(case), lmis.table1(case)
    unknowns = lmis.theorem2_unknowns()
    readings = [
        lmis.theorem2(model, scalars, unknowns, divided, thin) for divided in (False, True) for thin in (False, True)
    ]
    rows = [form.sub("1a", "5a") for form in readings]
    same = sum(not rows[0].differences(other) for other in rows)
    results.quantity("eq17.readings", same, method="readings whose rows 1a and 5a are those of the certificate",
                     source="(17)")  # fmt: skip
    results.certificate(proofs.disk_block(case))
    results.quantity(
        "eq17.feasible", 0, method="Farkas multipliers of rows 1a and 5a, no scalar in them", source="(17)"
    )
    results.say("(17)", f"infeasible for all scalars in {same} readings, Farkas certificate checked")


@task("(13)")
def theorem1(case: Case, results: Results) -> None:
    """Theorem 1 at Table 1's scalars, in both readings of eps2."""
    for divided, quantity in ((False, "eq13.feasible"), (True, "eq13.feasible_divided")):
        stated = Stated(case, [linear_13(divided).defining(**TABLES) <= 0], label="(13)")
        reading = "dividing psi_4 and psi_5" if divided else "multiplying psi_3"
        results.prove(build.farkas(
            id="eq13-infeasible-divided" if divided else "eq13-infeasible", paper=case.name,
            multipliers=refutation(stated.program(), "(13)", results),
            statement=f"(13) has no solution at Table 1's scalars, eps2 read as {reading}: what it gives linear in "
            "X = S^-1, Y = S - N, Fb, Ch = C_f X and a free block has none, whatever gamma, eps1 and delta_m.",
            quantities={"feasible": quantity},
            faith=("That (13), which is lost, reads as rebuilt: a condition that gives (15), as Lemma 1 says.",),
            **stated.parts(),
        ), source="(13), Table 1")  # fmt: skip
    results.say("(13)", "infeasible at Table 1's scalars in both readings of eps2")


@task("(17) against (13)")
def not_equivalent(case: Case, results: Results) -> None:
    """(13) holds at some scalars, although (17) does at none."""
    program = lmis.lemma3_synthesis(
        lmis.Model.of(case), case.number("lambda"), case.number("gamma"), case.number("eps1")
    )
    found = solve(lmis.pushed(program))
    if not isinstance(found, Solved):
        raise ComputationError("(13)", "no point with room to spare", found.attempts)
    results.certificate(equivalence.certificate(case, found.values))
    results.quantity("eq13.feasible_elsewhere", 1, source="Theorem 2",
                     method=f"a point at eps2 = {equivalence.EPS2}, delta_m = {equivalence.DELTA_M}")  # fmt: skip
    results.say("(17) against (13)", "not equivalent: (13) has a solution at some scalars, (17) at none")


@task("(19) with (12)")
def lemma4(case: Case, results: Results) -> None:
    """(19) with the printed C_f against (12) at lambda = 1."""
    model, scalars = lmis.Model.of(case), lmis.table1(case)
    program = lmis.lemma4_against_lemma3(model, case.matrix("Cf"), scalars)
    results.certificate(proofs.lemma4_against_lemma3(case, refutation(program, "(19)", results)))
    results.quantity("eq19.feasible_with_eq12", 0, method="Farkas multipliers of the rows of the rates",
                     source="(12), (19)")  # fmt: skip
    results.say("(19) with (12)", "exclude each other for the printed C_f, Farkas certificate checked")


def least_gamma(case: Case, results: Results, lam: str, uncertain: bool, quantity: str, stem: str) -> float:
    """Least gamma of (12) over all gains, with a certificate on each side."""
    model = lmis.Model.of(case)
    eps1 = case.number("eps1") if uncertain else None
    program = lmis.lemma3_synthesis(model, float(lam), eps1=eps1)
    found = infimum(program, margins=(1e-7, 1e-8, 1e-9)).need("(12)")
    results.attempt("(12)", list(found.attempts))
    square = f"{quantity}_squared"
    results.certificate(proofs.lemma3_point(
        case, f"{stem}-point", found.solved.values, lam, quantity=square, uncertain=uncertain))  # fmt: skip
    multiplier = found.multipliers["(12)"]
    results.certificate(proofs.lemma3_bound(
        case, f"{stem}-bound", multiplier, lam, quantity=square, uncertain=uncertain))  # fmt: skip
    gamma = float(np.sqrt(found.value))
    low, high = float(np.sqrt(found.lower)), float(np.sqrt(found.upper))
    method = "semidefinite program after the change of variables, enclosed by a point and by multipliers"
    results.quantity(square, found.value, lower=found.lower, upper=found.upper, method=method, source="(12)")
    results.quantity(quantity, gamma, lower=low, upper=high, method=method, source="(12)")
    return gamma


@task("(12), all gains")
def lemma3(case: Case, results: Results) -> None:
    """Least gamma of Lemma 3 over all gains at lambda = 1, nominal and with Delta A."""
    nominal = least_gamma(case, results, "1", False, "lemma3.gamma_min", "eq12-gamma")
    uncertain = least_gamma(case, results, "1", True, "lemma3.gamma_min_uncertain", "eq12-gamma-uncertain")
    results.say("(12), all gains", f"least gamma {nominal:.6f}, with Delta A {uncertain:.6f} at lambda = 1")


@task("(12), band of lambda")
def lambda_band(case: Case, results: Results) -> None:
    """The values of lambda at which (12) can be met at all with the paper's gamma: each end proved from both sides."""
    model, gamma, band = lmis.Model.of(case), case.number("gamma"), case.designs["lambda_band"]
    for end in ("low", "high"):
        inside, outside = (float(band[f"{end}_{side}"][0, 0]) for side in ("inside", "outside"))
        found = solve(lmis.lemma3_synthesis(model, inside, gamma))
        if not isinstance(found, Solved):
            raise ComputationError("(12)", f"no point at lambda = {inside}", found.attempts)
        results.certificate(proofs.lemma3_feasible(case, f"eq12-lambda-{end}", found.values, repr(inside), end))
        beyond = refutation(lmis.lemma3_synthesis(model, outside, gamma), "(12)", results)
        quantity = f"lemma3.feasible_beyond_{end}"
        results.certificate(proofs.lemma3_infeasible(
            case, f"eq12-lambda-beyond-{end}", beyond["(12)"], repr(outside), quantity))  # fmt: skip
        results.quantity(quantity, 0, method=f"Farkas multipliers at lambda = {outside}", source="(12)")
        results.quantity(f"lemma3.lambda_{end}", float(np.sqrt(inside * outside)), lower=min(inside, outside),
                         upper=max(inside, outside), method="a point on one side, Farkas multipliers on the other",
                         source="(12)")  # fmt: skip
    results.say(
        "(12), band of lambda",
        "feasible at the paper's gamma on a band of lambda, points inside and proofs outside both ends",
    )


@task("(12), printed gains")
def printed_gains(case: Case, results: Results) -> None:
    """The printed gains in (12): infeasible at lambda = 1, least gamma at lambda = 3."""
    model, gains = lmis.Model.of(case), plant.controller(case, "proposed")
    loop = plant.closed_loop(plant.rigid(plant.constants(case)), gains)
    T = np.linalg.cholesky(solve_continuous_lyapunov(loop, -np.eye(12)))
    inverse = np.linalg.inv(T)
    failing = refutation(lmis.lemma3_analysis(model, gains, case.number("lambda"), T, np.inf), "(12)", results)
    scale = block_diag(T, np.eye(9), T)
    results.certificate(proofs.printed_gains_fail(case, scale @ failing["(12)"] @ scale.T))
    results.quantity("eq12.printed_feasible", 0, method="Farkas multipliers, gamma left out", source="(12)")
    found = infimum(lmis.lemma3_analysis(model, gains, case.number("lambda_pass"), T)).need("(12)")
    values, scale = found.solved.values, block_diag(T, np.eye(12), T)
    results.certificate(proofs.printed_gains_pass(case, inverse.T @ values["P"] @ inverse, float(values["g2"])))
    results.certificate(proofs.printed_gains_bound(case, scale @ found.multipliers["(12)"] @ scale.T))
    ends = {"lower": found.lower, "upper": found.upper}
    method = "semidefinite program in a full P at lambda = 3, enclosed by a point and by multipliers"
    results.quantity("lemma3.printed_gamma_min_squared", found.value, method=method, source="(12)", **ends)
    roots = {end: float(np.sqrt(value)) for end, value in ends.items()}
    results.quantity("lemma3.printed_gamma_min", float(np.sqrt(found.value)), method=method, source="(12)", **roots)
    results.say("(12), printed gains", f"no P at lambda = 1; least gamma {np.sqrt(found.value):.6f} at lambda = 3")


def certify_levels(case: Case, results: Results, name: str, gains, formulas, found: Design) -> None:
    """Prove all three requirements at the levels of a search: by arcs, and with one matrix for the disk."""
    quantity = f"certified.{name}.delta_m"
    level, alone = (float(found[entry][0, 0]) for entry in ("level", "level_quadratic"))
    evidence = certify.gather(case, gains, level)
    results.certificate(certify.certificate(
        case, f"{name}-delta-m", formulas, evidence, quantity=quantity,
        statement=f"The {name} gains meet disk, norm and torque for gain variations up to dm, inertia included.",
    ))  # fmt: skip
    method = f"certified; disk: {len(evidence.scales)} arcs; norm and torque: one quadratic function each"
    results.quantity(quantity, level, source="requirements 1 to 3", method=method)
    results.certificate(certify.certificate(
        case, f"{name}-delta-m-quadratic", formulas, certify.gather(case, gains, alone, one_matrix=True),
        quantity=f"{quantity}_quadratic",
        statement=f"The {name} gains meet disk, norm and torque up to dm, each by one quadratic function.",
    ))  # fmt: skip
    results.quantity(f"{quantity}_quadratic", alone, source="requirements 1 to 3",
                     method="certified; disk by one P as well")  # fmt: skip
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
        found = case.designs[name]
        certify_levels(case, results, name, plant.gains_of(found), certify.of_design(name), found)


@task("trade-off")
def tradeoff(case: Case, results: Results) -> None:
    """Designs between the printed gains and the largest gain variation, each certified at its level."""
    k = plant.rigid(plant.constants(case))
    B, C = np.vstack([k.B, np.zeros((6, 3))]), np.eye(3, 12)
    reached = []
    for number in range(1, 6):
        name, stem = f"tradeoff_{number}", f"tradeoff.{number}"
        found = case.designs[name]
        gains, level = plant.gains_of(found), float(found["level"][0, 0])
        loop = plant.closed_loop(k, gains)
        results.certificate(certify.certificate(
            case, f"tradeoff-{number}-delta-m", certify.of_design(name), certify.gather(case, gains, level),
            quantity=f"{stem}.delta_m",
            statement=f"Point {number} of the trade-off meets disk, norm and torque for gain variations up to dm.",
        ))  # fmt: skip
        static = np.linalg.norm(C @ np.linalg.solve(loop, B), 2)
        norm = hinf_enclosure(loop, B, C)
        certified = "certified; disk by arcs, norm and torque by one P each"
        results.quantity(f"{stem}.delta_m", level, source="requirements 1 to 3", method=certified)
        results.quantity(f"{stem}.static_gain", float(static), source="(10)", method="norm of -C A^-1 B")
        results.quantity(f"{stem}.norm", norm.lower, lower=norm.lower, upper=norm.upper, source="(10)",
                         method="exact Hamiltonian of the doubles")  # fmt: skip
        results.quantity(f"{stem}.disk_radius", **plant.enclosed_loop(case, name)["disk_radius"], source="(10)",
                         method="largest |s + 1.01| over the eigenvalues of (10), in balls")  # fmt: skip
        reached.append(f"{level}")
    results.say("trade-off", f"gain variations {', '.join(reached)}, certified")


TASKS = (
    factors,
    algebra,
    *derivations.TASKS,
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
