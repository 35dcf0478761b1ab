"""Audit of the printed controllers: poles, norms, vertices, random gains; and of what the model leaves out."""

from collections.abc import Mapping
from fractions import Fraction
from itertools import product

import numpy as np
from flint import arb
from scipy.integrate import solve_ivp

from gainsay.dynamics import attitude
from gainsay.exact.ball import ball, hull, lower, precision, upper
from gainsay.results import Results, task
from gainsay.scans import over_choice
from gainsay.systems import loop_proofs
from gainsay.systems.norms import hinf_enclosure
from gainsay.systems.regions import Disk, HalfPlane
from gainsay.tables import Case
from papers.li2021 import derivations_identities as identities
from papers.li2021 import plant
from papers.li2021.audit_draws import random_gains
from papers.li2021.plant import Gains
from papers.li2021.proofs_full_model import FLEXIBLE, torque_over_inputs
from papers.li2021.proofs_lemma3 import corrected_disk, disk_of_lemma_3
from papers.li2021.proofs_requirements import COMPARISON, PRINTED
from papers.li2021.response import METHOD, STEPS, FlexibleLoop
from papers.li2021.statements import PLANT

FORMULAS = {"proposed": PRINTED, "comparison": COMPARISON}
LOOP = (("Acl", "[[A0, B @ Cf], [Bf @ C, Af]]"), ("Bcl", "col(B, zeros(6, 3))"), ("Ccl", "row(C, zeros(3, 6))"))
MU_EARTH = Fraction("3.986004418e14")
#: what is measured of a response of the full model, see `response.FlexibleLoop.extremes`
MEASURED_IN_TIME = (
    "peak_torque",
    "residual_angle",
    "residual_rate",
    "settling_time",
    "peak_mode",
    "residual_mode",
)


def reduced_loop(case: Case, gains: Gains) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A, B and C of (10) from d~ to y, nominal inertia."""
    nominal = plant.rigid(plant.constants(case))
    B, C = np.vstack([nominal.B, np.zeros((6, 3))]), np.hstack([nominal.C, np.zeros((3, 6))])
    return plant.closed_loop(nominal, gains), B, C


def vertices(case: Case, gains: Gains) -> tuple[float, float, np.ndarray]:
    """Largest disk reach and abscissa over all signs of 5 % in twelve gain factors and three inertias, and where."""
    k = plant.constants(case)
    signs, inertias = np.array(list(product((-1, 1), repeat=12))), np.array(list(product((-1, 1), repeat=3)))
    factors = 1 + case.number("delta_m") * signs
    loops = np.concatenate(
        [
            plant.closed_loop(plant.rigid(k, delta), gains, factors[:, :6], factors[:, 6:9], factors[:, 9:])
            for delta in inertias
        ]
    )
    reach, worst = disk_of(case).farthest(loops)
    abscissa, _ = HalfPlane().farthest(loops)
    inertia, factor = divmod(worst, len(signs))
    return reach, abscissa, np.concatenate([signs[factor], inertias[inertia]])


def disk_of(case: Case) -> Disk:
    """D(a, b) of the paper."""
    return Disk(case.number("disk_centre"), case.number("disk_radius"))


def unstable_fraction(case: Case, gains: Gains, total: int, batch: int = 20_000) -> tuple[float, float]:
    """Fraction of constant draws 1 + U(0, 1) of the twelve factors with an unstable (10), and its standard error."""
    nominal, generator = plant.rigid(plant.constants(case)), np.random.default_rng(int(case.number("seed")))
    unstable = 0
    for first in range(0, total, batch):
        factors = 1 + generator.random((min(batch, total - first), 12))
        loops = plant.closed_loop(nominal, gains, factors[:, :6], factors[:, 6:9], factors[:, 9:])
        unstable += int(np.sum(~HalfPlane().each(loops)))
    share = unstable / total
    return share, float(np.sqrt(share * (1 - share) / total))


@task("Section IV, orbit")
def orbit(case: Case, results: Results) -> None:
    """Rate and radius of a 24 h orbit, and the period of the printed radius."""
    with precision(128):
        rate = 2 * arb.pi() / ball(3600 * case.exact("orbit_period"))
        radius = (ball(MU_EARTH) * (ball(3600 * case.exact("orbit_period")) / (2 * arb.pi())) ** 2).root(3)
        periods = 2 * arb.pi() * (hull(*case.rounded("orbit_radius")) ** 3 / ball(MU_EARTH)).sqrt()
    period = 2 * np.pi * np.sqrt(case.number("orbit_radius") ** 3 / float(MU_EARTH))
    results.enclosed("audit.orbital_rate", lower(rate), upper(rate), method="2 pi / 24 h", source="Section IV")
    results.enclosed(
        "audit.orbit_radius",
        lower(radius),
        upper(radius),
        source="Section IV",
        method="Kepler's third law, mu = 3.986004418e14 m^3/s^2",
    )
    results.enclosed(
        "audit.orbit_period",
        lower(periods),
        upper(periods),
        value=period,
        digits=True,
        source="Section IV",
        method="Kepler's third law, mu = 3.986004418e14 m^3/s^2",
    )
    results.say("Section IV, orbit", f"radius of 42241 km: period {period / 3600:.4f} h")


@task("(2) to (6)")
def kinematics(case: Case, results: Results) -> None:
    """The rotation, the rates and the linear model as identities; the printed rotation is none."""
    for certificate in identities.kinematics(case):
        results.prove(certificate, source="(2) to (6)")
    results.say("(2) to (6)", "hold with the entry (3,2) of the rotation corrected; the display after (4) has it right")


@task("Figure 3, open loop")
def open_loop(case: Case, results: Results) -> None:
    """Open-loop poles: near the origin, some in the right half plane, proved."""
    A, exact = plant.rigid(plant.constants(case)).A, plant.rigid(plant.exact_constants(case)).A
    values = np.linalg.eigvals(A)
    for name, of in (("abscissa", lambda s: s.real), ("largest", abs)):
        results.quantity(
            f"audit.open_loop.{name}",
            **plant.enclosed_poles(exact, of),
            source="Figure 3",
            method="eigenvalues of A0 in balls",
        )
    results.quantity(
        "audit.open_loop.right_half_plane",
        int(np.sum(values.real > 1e-9)),
        method="eigenvalues of A0 with a real part above 1e-9 1/s",
        source="Figure 3",
    )
    results.certificate(
        loop_proofs.pole_right_of(
            case,
            "A0",
            "1e-6",
            definitions=PLANT,
            id="open-loop-unstable",
            statement="A0 has an eigenvalue in the open right half plane.",
            quantities={"abscissa": "audit.open_loop.abscissa", "stable": "audit.open_loop.stable"},
        )
    )
    results.quantity(
        "audit.open_loop.stable", 0, method="Lyapunov's inequality with an indefinite P", source="Figure 3"
    )
    results.say("Figure 3, open loop", f"abscissa {values.real.max():.3g} 1/s, poles within {np.abs(values).max():.2g}")


def certify_nominal(case: Case, results: Results, name: str, norm: float, reach: float) -> None:
    """Certificates of disk and norm for a printed controller."""
    definitions = (*PLANT, *FORMULAS[name], *LOOP)
    centre, radius, gamma = case.number("disk_centre"), f"{reach + 2e-4:.4f}", f"{norm * (1 + 2e-5):.6g}"
    results.certificate(
        loop_proofs.poles_in_disk(
            case,
            "Acl",
            "number('disk_centre')",
            radius,
            definitions=definitions,
            id=f"{name}-disk",
            statement=f"The poles of (10) with the printed {name} gains lie in D({centre}, {radius}).",
            quantities={"radius": f"audit.{name}.disk_radius"},
        )
    )
    results.certificate(
        loop_proofs.norm_below(
            case,
            {"A": "Acl", "B": "Bcl", "C": "Ccl"},
            gamma,
            definitions=definitions,
            id=f"{name}-norm",
            statement=f"The norm from d~ to y of (10) with the printed {name} gains is below {gamma}.",
            quantities={"norm": f"audit.{name}.hinf"},
        )
    )


@task("(6) with (8)")
def flexible_loop(case: Case, results: Results) -> None:
    """The full model under the proposed gains: stable, but its modes lie outside the disk; both proved."""
    definitions, alpha, radius = (*PLANT, *PRINTED, *FLEXIBLE), "-0.006", "1.2"
    results.certificate(
        loop_proofs.poles_left_of(
            case,
            "loop",
            alpha,
            definitions=definitions,
            id="flexible-stable",
            statement=f"Every pole of (6) with the printed proposed gains has a real part below {alpha}.",
            quantities={"abscissa": "audit.proposed.flexible_abscissa"},
        )
    )
    results.certificate(
        loop_proofs.pole_outside_disk(
            case,
            "loop",
            "number('disk_centre')",
            radius,
            definitions=definitions,
            id="flexible-outside-disk",
            statement=f"(6) with the printed proposed gains has a pole outside "
            f"D({case.number('disk_centre')}, {radius}).",
            quantities={"radius": "audit.proposed.flexible_disk_radius"},
        )
    )
    gains, k, disk = plant.controller(case, "proposed"), plant.constants(case), disk_of(case)
    reach = {
        "reduced": plant.enclosed_loop(case, "proposed")["disk_radius"]["value"],
        "full": disk.reach(plant.closed_loop(plant.flexible(k), gains)),
    }
    method = f"eigenvalues, {case.choice('pole_model')} model"
    over_choice(case, results, "audit.disk_over_models", "pole_model", reach, method=method, source="Section V")
    results.say("(6) with (8)", "stable, and outside the disk that the reduced loop keeps")


def measure(case: Case, results: Results, name: str, poles: Mapping[str, Mapping[str, float]], draws: int) -> str:
    """Measure a controller on the models of the paper and under other gains; return what was found in a few words.

    Parameters
    ----------
    case, results : Case, Results
    name : str
        Of the controller.
    poles : mapping
        What is wanted of `plant.enclosed_loop`, in balls over the digits of its gains.
    draws : int
        Behind the unstable fraction.
    """
    gains = plant.controller(case, name)
    A, B, C = reduced_loop(case, gains)
    disk, k = disk_of(case), plant.constants(case)
    flexible = plant.closed_loop(plant.flexible(k), gains)
    worst, worst_abscissa, where = vertices(case, gains)
    static = -C @ np.linalg.solve(A, B @ plant.disturbance(case, k) @ np.array([1.0, 0.0, 1.0]))
    share, error = unstable_fraction(case, gains, draws)
    methods = {
        "disk_radius": "largest |s + 1.01| over the eigenvalues of (10), in balls over the printed digits",
        "abscissa": "eigenvalues of (10), in balls over the printed digits",
    }
    for quantity, enclosure in poles.items():
        results.quantity(f"audit.{name}.{quantity}", **enclosure, method=methods[quantity], source="Section IV")
    rows = {
        "flexible_abscissa": (HalfPlane().reach(flexible), "eigenvalues of (6) with (8), 20 states"),
        "flexible_disk_radius": (disk.reach(flexible), "largest |s + 1.01| over the 20 eigenvalues of (6) with (8)"),
        "worst_disk_radius": (
            worst,
            f"eigenvalues at 2^15 vertices; worst at signs {''.join('+-'[int(s < 0)] for s in where)}",
        ),
        "worst_abscissa": (worst_abscissa, "eigenvalues at 2^15 vertices"),
        "static_roll_error": (abs(static[0]), "static gain of (10) times d(0)"),
        "unstable_fraction": (share, f"{draws} draws, standard error {error:.2g}"),
    }
    for quantity, (value, method) in rows.items():
        results.quantity(f"audit.{name}.{quantity}", float(value), method=method, source="Section IV")
    return f"vertices {worst:.4f}, unstable {share:.4f}"


def audit_controller(case: Case, results: Results, name: str) -> tuple[float, float]:
    """Every quantity of one controller that needs no simulation; return its norm and how far poles lie from -1.01."""
    bounds = hinf_enclosure(*reduced_loop(case, plant.controller(case, name)))
    poles = plant.enclosed_loop(case, name)
    results.quantity(
        f"audit.{name}.hinf",
        bounds.lower,
        lower=bounds.lower,
        upper=bounds.upper,
        source="Section IV",
        method=f"exact Hamiltonian of the doubles, attained at {bounds.frequency:.3g} rad/s",
    )
    measures = measure(case, results, name, poles, int(case.number("draws")))
    reach = poles["disk_radius"]["value"]
    results.say(f"Section IV, {name}", f"disk {reach:.4f}, norm {bounds.lower:.4f}, {measures}")
    return bounds.lower, reach


@task("Section IV, proposed controller")
def proposed(case: Case, results: Results) -> None:
    """Audit the printed proposed gains."""
    certify_nominal(case, results, "proposed", *audit_controller(case, results, "proposed"))


@task("Section IV, controller of [39]")
def comparison(case: Case, results: Results) -> None:
    """Audit the printed gains of the comparison controller."""
    certify_nominal(case, results, "comparison", *audit_controller(case, results, "comparison"))


@task("our designs")
def designs(case: Case, results: Results) -> None:
    """Audit our own designs the same way."""
    for name in ("repaired", "best"):
        audit_controller(case, results, name)


@task("trade-off")
def tradeoff(case: Case, results: Results) -> None:
    """Measure the points of the trade-off beside the printed gains.

    No claim rests on what is simulated here, and no log is kept of it.
    """
    for name in (name for name in case.designs if name.startswith("tradeoff_")):
        poles = {"abscissa": plant.enclosed_loop(case, name)["abscissa"]}
        words = measure(case, results, name, poles, int(case.number("tradeoff_draws")))
        results.say(f"trade-off, {name}", words)
        loop = FlexibleLoop(case, plant.controller(case, name))
        first, second = (loop.extremes(loop.solve(steps)) for steps in (STEPS, 2 * STEPS))
        for quantity in MEASURED_IN_TIME:
            value = first[quantity][1]
            band = 2 * abs(value - second[quantity][1])
            results.quantity(
                f"audit.{name}.{quantity}",
                value,
                lower=value - band,
                upper=value + band,
                source="Section IV",
                method=METHOD,
            )


@task("(6), small angles")
def small_angles(case: Case, results: Results) -> None:
    """Rigid nonlinear attitude (1)-(4) against the linear (5)-(6) under the proposed controller."""
    k, gains = plant.constants(case), plant.controller(case, "proposed")
    J, n = np.array(k.inertia, dtype=float), k.orbital_rate
    rigid_only = plant.Constants(n, k.inertia, k.envelope, np.zeros((1, 3)), (1.0,), (0.0,))
    linear = plant.closed_loop(plant.rigid(rigid_only), gains)
    horizon, x0 = case.number("horizon"), case.matrix("x0").ravel()
    tight = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-15}

    def gap(scale: float) -> float:
        angles, rates = scale * x0[:3], scale * x0[3:]
        first = np.concatenate([angles, attitude.rate_body(angles, rates, n), np.zeros(6)])

        def nonlinear(t: float, s: np.ndarray) -> np.ndarray:
            torque = gains.C @ s[6:]
            omega = s[3:6]
            turn = (torque + attitude.gravity_gradient(J, s[:3], n) - np.cross(omega, J * omega)) / J
            return np.concatenate([attitude.euler_rates(s[:3], omega, n), turn, gains.A @ s[6:] + gains.B @ s[:3]])

        times = np.linspace(0, min(horizon, 60.0), 241)
        true = solve_ivp(nonlinear, (0, times[-1]), first, t_eval=times, **tight).y
        near = solve_ivp(
            lambda t, s: linear @ s, (0, times[-1]), np.concatenate([scale * x0, np.zeros(6)]), t_eval=times, **tight
        ).y
        return float(np.abs(true[:3] - near[:3]).max() / (scale * np.abs(x0[:3]).max()))

    for scale, name in ((1.0, "printed"), (4.0, "fourfold"), (12.0, "twelvefold")):
        results.quantity(
            f"audit.small_angle.{name}",
            gap(scale),
            source="(5), (6), Remark 1",
            method="largest angle difference over the largest initial angle, no disturbance",
        )
    results.say("(6), small angles", f"linear model off by {gap(1.0):.2%} of the start from Table 1's angles")


TASKS = (
    orbit,
    kinematics,
    open_loop,
    proposed,
    comparison,
    flexible_loop,
    designs,
    tradeoff,
    small_angles,
    torque_over_inputs,
    disk_of_lemma_3,
    corrected_disk,
    random_gains,
)
