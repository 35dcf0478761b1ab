"""Audit of zhang2013: the printed K and L on the design model and on the flexible plant."""

from functools import partial

import numpy as np
from flint import fmpq

from gainsay.errors import ComputationError
from gainsay.exact.ball import ball, hull, lower, precision, upper
from gainsay.lmi.affine import Affine
from gainsay.proof.build import certificate
from gainsay.results import Results, task
from gainsay.statements import prove
from gainsay.systems import loop_proofs
from gainsay.systems.delay import DelayMargin, DelaySystem
from gainsay.systems.delay_bounds import bessel_legendre
from gainsay.systems.delay_spectrum import hinf_norm, rightmost_roots, spectral_abscissa, unstable_root_count
from gainsay.tables import Case
from papers.zhang2013 import derivations, proofs
from papers.zhang2013.conditions import (
    channel_blocks,
    delay_below,
    enclosed_norm,
    largest_delay,
    least_gamma,
    lifted,
    point_at,
    turning_delay,
)
from papers.zhang2013.plant import MODES, Spacecraft
from papers.zhang2013.proofs import PRINTED_GAINS
from papers.zhang2013.proofs_flight import angle_settles
from papers.zhang2013.scans import figures
from papers.zhang2013.statements import PLANT, PRINTED_LOOP, reduced_theorem_1, structured_theorem_1, theorem_1
from papers.zhang2013.synthesis import certify_on_flexible

DELAY_WIDTH, FLEXIBLE_WIDTH = 1e-5, 1e-4
"""Relative widths to which the delay at which a condition turns is bisected, design model and flexible plant."""


def _blocks_at(parts: tuple[np.ndarray, np.ndarray, np.ndarray], mu: float, d_M: float) -> tuple[Affine, ...]:
    A, Bd, Cd = parts
    return channel_blocks(A, Bd, Cd, d_M, mu)


def printed(case: Case) -> tuple[Spacecraft, tuple, tuple]:
    """Spacecraft, K and L as printed."""
    return Spacecraft.of(case), case.printed("K").exact, case.printed("L").exact


def checked_margin(loop: DelaySystem, where: str) -> DelayMargin:
    """Exact delay margin, confirmed by the rightmost roots a little before and after it."""
    margin = loop.quasi_polynomial.margin()
    if not np.isfinite(margin.delay) or margin.delay == 0:
        return margin
    before, after = (spectral_abscissa(loop, margin.delay * (1 + e)) for e in (-1e-5, 1e-5))
    crossing = rightmost_roots(loop, margin.delay, 2)[0]
    if not before < 0 < after or abs(crossing.real) > 1e-9 or abs(abs(crossing.imag) - margin.frequency) > 1e-8:
        raise ComputationError(where, f"delay margin {margin.delay!r} is not where the rightmost roots cross")
    return margin


@task("(3), (5)")
def poles(case: Case, results: Results) -> None:
    """Poles without delay."""
    results.prove(
        loop_proofs.abscissa(
            case,
            "A + B @ printed('K')",
            definitions=PLANT,
            id="audit-abscissa",
            statement="Spectral abscissa of A + BK with the printed K.",
            quantity="audit.abscissa",
        ),
        source="(3)",
    )
    results.prove(
        certificate(
            "enclosed",
            id="audit-bandwidth",
            tables=case,
            definitions=PLANT,
            statement="L B of the printed L.",
            fields={"formula": "printed('L') @ B", "low": "0"},
            quantities={"value": "audit.observer_bandwidth"},
        ),
        source="(5)",
    )


@task("(7)")
def delay_margin(case: Case, results: Results) -> None:
    """Exact constant-delay margin of the design model, and what Legendre polynomials prove of it."""
    craft, K, L = printed(case)
    loop = craft.design_loop(K, L)
    margin = checked_margin(loop, "(7)")
    results.quantity(
        "audit.delay_margin",
        margin.delay,
        lower=margin.lower,
        upper=margin.upper,
        source="(7)",
        method="quasi-polynomial, roots isolated; confirmed by rightmost roots",
    )
    # e is not delayed and does not feed on x: (7) is stable exactly if L B > 0 and the loop of x is
    parts = loop.A[:2, :2], loop.Bd[:2], loop.Cd[:, :2]
    proved = 0.0
    for degree in (0, 1, 2):  # what a degree proves, the next one proves too
        condition = partial(bessel_legendre, *parts, degree=degree)
        proved, refuted = turning_delay(condition, proved, margin.upper, DELAY_WIDTH)
        results.quantity(
            f"bessel_legendre.delay_max_order{degree}",
            proved,
            lower=proved,
            # the condition of degree 0 that fails at a delay fails at every longer one; beyond the margin all fail
            upper=refuted if degree == 0 else margin.upper,
            source="(7)",
            method=f"bisection over checked points; checked multipliers refute it at {refuted:.9g} s",
        )
    results.say("(7)", f"stable up to a constant delay of {margin.delay:.9g} s")


@task("(7), (8)")
def norm(case: Case, results: Results) -> None:
    """Exact H-infinity norm without delay and at d_M."""
    craft, K, L = printed(case)
    loop = craft.design_loop(K, L)
    results.certificate(proofs.norm_without_delay(case, hinf_norm(loop, 0.0).value * (1 + 1e-3)))
    for name, delay in (("delay_0", fmpq(0)), ("delay_30ms", fmpq(3, 100))):
        level = enclosed_norm(loop, delay)
        results.quantity(f"audit.hinf.{name}", **level, source="(7), (8)")
        results.say("(7), (8)", f"norm {level['value']:.9g} at a delay of {float(delay.p) / float(delay.q):g} s")


@task("(9)")
def analysis(case: Case, results: Results) -> None:
    """Theorem 1 for the printed gains: at gamma = 1.5, its least gamma, its largest delay."""
    craft, K, L = printed(case)
    gamma, d_M = case.number("gamma"), case.number("d_M")
    stated = theorem_1(case, PRINTED_LOOP)
    prove(
        results,
        "theorem1.feasible",
        stated,
        stated.point(lifted(point_at(reduced_theorem_1(case, PRINTED_LOOP)), d_M)),
        id="theorem1-printed-gains",
        sentence="solution of (9a) and (9b) for the printed K and L on the design model",
        source="(9)",
        faith=(proofs.THEOREM_1_ON_FAITH,),
    )
    least = least_gamma(reduced_theorem_1(case, PRINTED_LOOP, g="gamma2"))
    with_slack = least_gamma(theorem_1(case, PRINTED_LOOP, g="gamma2"))
    # Theorem 1 bounds the norm for every constant delay up to d_M: its gamma cannot be below the norm at d_M
    floor = hinf_norm(craft.design_loop(K, L), d_M).value
    value = float(np.sqrt(least.bound))
    worst = least_gamma(reduced_theorem_1(case, PRINTED_LOOP, g="gamma2", mu="1"))
    results.quantity(
        "theorem1.gamma_min",
        value,
        lower=floor,
        upper=float(np.sqrt(least.upper)),
        source="(9)",
        method="P2 = P1, P3 = d_M R without loss; upper: checked point, lower: exact norm at d_M",
    )
    results.quantity(
        "theorem1.gamma_min_with_slack",
        float(np.sqrt(with_slack.upper)),
        lower=floor,
        upper=float(np.sqrt(with_slack.upper)),
        source="(9)",
        method="P2 and P3 free, at a checked point; lower: exact norm at d_M",
    )
    results.quantity(
        "theorem1.gamma_min_mu_one",
        float(np.sqrt(worst.bound)),
        lower=floor,
        upper=float(np.sqrt(worst.upper)),
        method="as theorem1.gamma_min",
        source="(9)",
    )
    limit = craft.design_loop(K, L).quasi_polynomial.margin().delay
    for quantity, form, source in (
        ("theorem1.delay_max", reduced_theorem_1, "(9)"),
        ("structured.delay_max", structured_theorem_1, "(9), (25)"),
    ):
        delay, infeasible = largest_delay(case, partial(form, loop=PRINTED_LOOP), gamma, limit)
        results.quantity(
            quantity,
            delay,
            lower=delay,
            upper=infeasible,
            source=source,
            method="root of the least gamma; lower: checked point, upper: an enclosure of the least gamma lies above "
            "gamma",
        )
    results.say("(9)", f"least gamma {value:.7g}; certified at gamma = {gamma:g}")


@task("(1), (4), (6)")
def flexible(case: Case, results: Results) -> None:
    """The printed gains on the spacecraft with its two modes."""
    craft, K, L = printed(case)
    for mode in MODES:
        loop = craft.flexible_loop(K, L, mode)
        margin = checked_margin(loop, f"flexible plant, {mode}")
        results.quantity(
            f"flexible.delay_margin.{mode}",
            margin.delay,
            lower=margin.lower,
            upper=margin.upper,
            method="quasi-polynomial, roots isolated; confirmed by rightmost roots",
            source="(1), (4), (6)",
        )
        results.say("(1), (4), (6)", f"{mode}: stable up to a constant delay of {margin.delay:.9g} s")
    results.quantity(
        "flexible.unstable_roots_at_one_second",
        unstable_root_count(craft.flexible_loop(K, L, "paper"), 1.0),
        method="argument principle around every root with a real part of zero or more, in balls",
        source="Introduction; (1), (4), (6)",
    )
    d_M = case.number("d_M")
    for name, mode in (("flexible.abscissa", "paper"), ("flexible.no_observer.abscissa", "no_observer")):
        results.quantity(
            name,
            spectral_abscissa(craft.flexible_loop(K, L, mode), d_M),
            source="(1), (4), (6)",
            method="spectral discretisation and Newton",
        )
    for mode, quantity in (("paper", "flexible.theorem1_feasible"), ("all", "flexible.theorem1_feasible_all")):
        certify_on_flexible(results, PRINTED_GAINS, mode, quantity, f"flexible-theorem1-{mode}")


@task("(25), flexible plant")
def structure(case: Case, results: Results) -> None:
    """The block-diagonal structure of (25) cannot prove the flexible loop stable, not even without delay."""
    stated = proofs.block_diagonal_lyapunov(case)
    outcome = results.attempted("(25)", stated.solve())
    prove(
        results,
        "flexible.block_diagonal_lyapunov",
        stated,
        outcome,
        id="flexible-block-diagonal",
        sentence="block-diagonal Lyapunov matrix diag(P11, P12) for the flexible loop without delay",
        source="(1), (4), (6), (25)",
    )
    results.say("(25), flexible plant", f"block-diagonal Lyapunov matrix: {type(outcome).__name__.lower()}")


@task("LMI delay bounds, flexible plant")
def flexible_bounds(case: Case, results: Results) -> None:
    """Constant and varying delays that LMIs prove for the flexible loop, against its exact margins."""
    craft, K, L = printed(case)
    mu = case.number("mu")
    for mode in MODES:
        loop = craft.flexible_loop(K, L, mode)
        parts = loop.A, loop.Bd, loop.Cd
        limit = loop.quasi_polynomial.margin()
        proved, beyond = 0.0, limit.upper
        for degree in (0, 1, 2):  # what a degree proves, the next one proves too
            condition = partial(bessel_legendre, *parts, degree=degree)
            proved, refuted = turning_delay(condition, proved, limit.upper, FLEXIBLE_WIDTH)
            beyond = refuted if degree == 0 else beyond
            results.quantity(
                f"flexible.bessel_legendre_{degree}.{mode}",
                proved,
                lower=proved,
                upper=refuted,
                method="bisection over checked points; upper: checked multipliers refute the condition there",
                source="(1), (4), (6)",
            )
        # (9b) where z(t - d) = z(t - d_M) is the condition of degree 0 with S = Q1 + Q2, less mu Q2: what degree 0 does
        # not prove, Theorem 1 does not prove
        proved = delay_below(partial(_blocks_at, parts, mu), beyond)
        results.quantity(
            f"flexible.theorem1.{mode}",
            proved,
            lower=proved,
            upper=beyond,
            method="checked point; upper: checked multipliers refute Jensen's condition, which (9b) implies",
            source="(1), (4), (6), (9)",
        )
        results.say("LMI delay bounds, flexible plant", f"{mode}: Theorem 1 proves {proved:.6g} s")


@task("circular orbit")
def orbit(case: Case, results: Results) -> None:
    """The orbit rate that belongs to the printed altitude."""
    rate = np.sqrt(case.number("earth_parameter") / (case.number("earth_radius") + case.number("altitude")) ** 3)
    low, high = (case.exact("earth_radius") + altitude for altitude in case.rounded("altitude"))
    with precision(128):
        rates = (ball(case.exact("earth_parameter")) / hull(low, high) ** 3).sqrt()
    results.enclosed(
        "audit.orbit_rate",
        lower(rates),
        upper(rates),
        value=rate,
        digits=True,
        source="Numerical example",
        method="Kepler's third law",
    )


@task("after (1), after (5)")
def disturbance(case: Case, results: Results) -> None:
    """What the persistent w1 of the example does to the assumptions of the paper and to e(t) -> 0."""
    size = "number('w1_amplitude') ** 2 * (number('w1_cosine') ** 2 + number('w1_sine') ** 2)"
    results.prove(proofs.w1_rms(case, size, "audit.w1_rms"), source="Numerical example")
    results.prove(proofs.w2_rate_rms(case, size, "audit.w2_rate_rms"), source="after (3), Numerical example")
    results.certificate(proofs.larger_than_max(case))
    for quantity, name in (("audit.residual_error", "w1_frequency"), ("audit.residual_error_orbit_rate", "orbit_rate")):
        results.prove(proofs.residual_error(case, name, size, quantity), source="(1), (4), (6)")
    results.say("after (5)", "w1 persists: the estimation error keeps its amplitude, certified")


TASKS = (
    *derivations.TASKS,
    orbit,
    disturbance,
    figures,
    angle_settles,
    poles,
    delay_margin,
    norm,
    analysis,
    flexible,
    structure,
    flexible_bounds,
)
