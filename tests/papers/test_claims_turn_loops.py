"""A physical input under which each claim on a number of li2021 and wan2014 turns; every such claim is named here."""

import math
from dataclasses import replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from flint import fmpq, fmpq_mat

from gainsay.scans.criterion import NUMERIC
from gainsay.systems.norms import hinf_norm
from gainsay.systems.regions import HalfPlane
from gainsay.tables import read_case
from papers.li2021 import audit as inspection
from papers.li2021 import plant as satellite
from papers.li2021 import response
from papers.wan2014 import audit as rendezvous
from papers.wan2014 import plant as chaser
from papers.wan2014 import scans
from tests.papers.turning import changed, turns

ROOT = Path(__file__).parents[2]
LI, WAN = (read_case(ROOT, paper) for paper in ("li2021", "wan2014"))
MU = 3.986004418e14
DAY, SIDEREAL_DAY = 86400.0, 86164.0905


# --- li2021 -----------------------------------------------------------------------------------------------------------


def scaled(name: str, factor: float) -> satellite.Gains:
    """Printed gains of a controller, the torque it asks for multiplied."""
    gains = satellite.controller(LI, name)
    return satellite.Gains(gains.A, gains.B, factor * gains.C)


def norm(gains: satellite.Gains) -> float:
    A, B, C = inspection.reduced_loop(LI, gains)
    return hinf_norm(A, B, C)[0]


def reach(gains: satellite.Gains) -> float:
    return inspection.disk_of(LI).reach(inspection.reduced_loop(LI, gains)[0])


def proved_level(gains: satellite.Gains) -> float:
    """Variation of all gains at which the disk is kept: 5 % where the vertices are inside, none where (10) is not."""
    return 0.05 if reach(gains) < 1 and inspection.vertices(LI, gains)[0] < 1 else 0.0


def open_loop_size(rate: float) -> float:
    k = replace(satellite.constants(LI), orbital_rate=rate)
    return float(np.abs(np.linalg.eigvals(satellite.rigid(k).A)).max())


def flexible_abscissa(gains: satellite.Gains) -> float:
    return HalfPlane().reach(satellite.closed_loop(satellite.flexible(satellite.constants(LI)), gains))


def flown(gains: satellite.Gains, horizon: str) -> dict[str, float]:
    """Shares of the largest excursion in the last 100 s, and the largest torque."""
    loop = response.FlexibleLoop(changed(LI, horizon=horizon), gains)
    return {name: value for name, (_, value, _) in loop.extremes(loop.solve(20)).items()}


LI_VALUES = {
    # closed forms: the rate of a period, and Kepler's third law
    "audit.orbital_rate": lambda: [2 * math.pi / t for t in (DAY, SIDEREAL_DAY)],
    "audit.orbit_radius": lambda: [(MU * (t / (2 * math.pi)) ** 2) ** (1 / 3) for t in (DAY, SIDEREAL_DAY)],
    # an orbit of a quarter of an hour, were there one
    "audit.open_loop.largest": lambda: [open_loop_size(n) for n in (7.2722e-5, 7e-3)],
    "audit.proposed.disk_radius": lambda: [reach(scaled("proposed", f)) for f in (1, 4)],
    "audit.proposed.hinf": lambda: [norm(scaled("proposed", f)) for f in (1, 0.01)],
    "audit.comparison.hinf": lambda: [norm(scaled("comparison", f)) for f in (1, 0.01)],
    "audit.proposed.flexible_abscissa": lambda: [flexible_abscissa(scaled("proposed", f)) for f in (1, -1)],
}


@pytest.mark.parametrize("quantity", LI_VALUES)
def test_loop_of_li2021(quantity):
    turns(LI, quantity, LI_VALUES[quantity]())


@pytest.mark.slow
def test_variation_of_gains_of_li2021():
    turns(LI, "certified.printed.delta_m", [proved_level(scaled("proposed", f)) for f in (1, 4)])


@pytest.fixture(scope="module")
def manoeuvres() -> list[dict[str, float]]:
    """The printed run, one that ends after 110 s, and one with ten times the torque."""
    printed = scaled("proposed", 1)
    return [flown(printed, "300"), flown(printed, "110"), flown(scaled("proposed", 10), "110")]


#: quantity -> what it reads of a run, and the run that turns it
LI_RUNS = {
    "audit.proposed.angle_share": ("angle_share", 1),
    "audit.proposed.rate_share": ("rate_share", 1),
    "audit.proposed.mode_share": ("mode_share", 1),
    "audit.proposed.peak_torque": ("peak_torque", 2),
    "audit.torque_over_inputs": ("peak_torque", 2),
}


@pytest.mark.slow
@pytest.mark.parametrize("quantity", LI_RUNS)
def test_runs_of_li2021(manoeuvres, quantity):
    name, by = LI_RUNS[quantity]
    turns(LI, quantity, [manoeuvres[0][name], manoeuvres[by][name]])


# --- wan2014 ----------------------------------------------------------------------------------------------------------


def mean_motion(eccentricity: float) -> float:
    return math.sqrt(MU / (6728140.0 / (1 - eccentricity)) ** 3)


def abscissa(matrix: np.ndarray) -> float:
    return float(np.linalg.eigvals(matrix).real.max())


def relative_motion(rate: str) -> fmpq_mat:
    """A of (2) in rationals."""
    n = fmpq(*Fraction(rate).as_integer_ratio())
    rows = [[fmpq(0)] * 6 for _ in range(6)]
    for i in range(3):
        rows[i][3 + i] = fmpq(1)
    rows[3][0], rows[3][4], rows[4][3], rows[5][2] = 3 * n * n, 2 * n, -2 * n, -n * n
    return fmpq_mat(rows)


def rank(measured: tuple[int, ...], rate: str = "1.13e-3") -> int:
    C = fmpq_mat([[int(i == j and measured[i]) for j in range(6)] for i in range(6)])
    return rendezvous.observability_rank(relative_motion(rate), C)


def observable(rate: str) -> int:
    """Number of sets of measured states that are enough; without orbital motion all three positions are needed."""
    return sum(rank(measured, rate) == 6 for measured in product((0, 1), repeat=6))


MODEL = chaser.design_model(WAN)
K, L, C = (WAN.matrix(name) for name in "KLC")
WAN_VALUES = {
    "audit.mean_motion": lambda: [mean_motion(e) for e in (0.01, 0.1)],
    "audit.observer_abscissa": lambda: [abscissa(MODEL.A - s * L @ C) for s in (1, -1)],
    "audit.feedback_abscissa": lambda: [abscissa(MODEL.A - s * MODEL.B @ K) for s in (1, -1)],
    "audit.observable_outputs": lambda: [observable(rate) for rate in ("1.13e-3", "0")],
    "audit.observability_rank": lambda: [rank(m) for m in ((1, 1, 1, 0, 0, 0), (0, 0, 0, 1, 1, 1))],
}


@pytest.mark.parametrize("quantity", WAN_VALUES)
def test_loop_of_wan2014(quantity):
    turns(WAN, quantity, WAN_VALUES[quantity]())


@pytest.mark.parametrize("axis", "xyz")
def test_a_blind_start_asks_more_thrust_than_there_is(axis):
    loop = chaser.ClosedLoop(WAN, K, L)
    peaks = []
    for position_share in (1.0, 0.0):
        trajectory = loop.simulate(scans.start(WAN, position_share, 0.0), 60.0, rtol=1e-8)
        peaks.append(chaser.peak_thrust(loop, trajectory, "xyz".index(axis))[1])
    turns(WAN, f"full_lyapunov.thrust_{axis}", peaks)


@pytest.mark.slow
def test_flights_of_wan2014():
    """An observer a hundred times slower settles late; what ends early has not arrived."""
    slow = np.vstack([0.01 * np.eye(3), 2.5e-5 * np.eye(3)])
    shares, ends = [], []
    for gain in (L, slow):
        trajectory = chaser.ClosedLoop(WAN, K, gain).simulate(scans.start(WAN, 1.0, 0.0), 20000.0, rtol=1e-8)
        capture = chaser.capture_time(trajectory, scans.CAPTURE_RADIUS)
        shares.append(scans.settling_time(WAN, trajectory) / capture)
        ends += [trajectory(np.array([time]))[0] for time in (20000.0, 1000.0)]
    turns(WAN, "audit.error_settling_share", shares)
    turns(WAN, "audit.final_range", [float(np.linalg.norm(state[chaser.POSITION])) for state in ends])
    turns(WAN, "audit.final_speed", [float(np.linalg.norm(state[chaser.VELOCITY])) for state in ends])


# --- both -------------------------------------------------------------------------------------------------------------

NAMED = {
    "li2021": {*LI_VALUES, *LI_RUNS, "certified.printed.delta_m"},
    "wan2014": {
        *WAN_VALUES, *(f"full_lyapunov.thrust_{axis}" for axis in "xyz"),
        "audit.error_settling_share", "audit.final_range", "audit.final_speed",
    },
}  # fmt: skip


@pytest.mark.parametrize("case", [LI, WAN], ids=lambda case: case.name)
def test_every_claim_on_a_number_is_turned_here_or_by_its_own_scan(case):
    for claim in case.claims.values():
        if claim.comparator not in NUMERIC or claim.quantity in NAMED[case.name]:
            continue
        # readings or starts of which some bear it out and some do not
        assert case.recorded_scans[claim.id, "outcome"].value == "depends", claim.id
        ends = [float(case.recorded_scans[claim.id, end].value) for end in ("smallest", "largest")]
        turns(case, claim.quantity, ends)
