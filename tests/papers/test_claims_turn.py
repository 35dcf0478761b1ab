"""A physical input under which each claim on a number or a scan of zhang2013 and pinheiro2013 turns."""

from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import block_diag

from gainsay.errors import CertificateError
from gainsay.proof import Certificate
from gainsay.systems.delay_spectrum import hinf_norm as delayed_norm
from gainsay.systems.delay_spectrum import spectral_abscissa, unstable_root_count
from gainsay.systems.norms import h2_norm, hinf_norm
from gainsay.tables import read_case
from papers.pinheiro2013 import audit, scans, scans_studies
from papers.pinheiro2013 import conditions as mixed
from papers.pinheiro2013 import conditions_pitch as pitch
from papers.pinheiro2013.plant import generalized_plant, linear_model, reconstruction
from papers.zhang2013 import proofs
from papers.zhang2013 import response as flight
from papers.zhang2013.plant import Spacecraft
from tests.papers.turning import changed, turns

ROOT = Path(__file__).parents[2]
ZHANG, PINHEIRO = (read_case(ROOT, paper) for paper in ("zhang2013", "pinheiro2013"))


def middle(proved: Certificate) -> float:
    """Middle of what a certificate encloses."""
    low, high = next(c.value for c in proved.conclusions if c.relation == "inside").split("..")
    return float((Fraction(low) + Fraction(high)) / 2)


# --- pinheiro2013 -----------------------------------------------------------------------------------------------------

#: the three gains given to other levels: what the paper says of one controller then speaks of another
EXCHANGED = {"hinf": "h2", "mixed": "mixed", "h2": "hinf"}


def exchanged(study: scans_studies.Study) -> scans_studies.Study:
    """The study with the gains of pure H-infinity and pure H2 control exchanged."""
    other = scans_studies.Designs(PINHEIRO, dict(study.point))
    other.gains = {(level, group): study.gains[EXCHANGED[level], group] for level, group in study.gains}
    return scans_studies.Study(PINHEIRO, dict(study.point), other)


@pytest.fixture(scope="module")
def studies() -> list[scans_studies.Study]:
    """Reconstruction A; with exchanged gains; with heavy moments; in rad/s; with soft, with unstable gains; others."""
    here = scans_studies.Study(PINHEIRO, {"disturbance_horizon": 6000.0, "harmonics": 1})
    heavy = scans_studies.Study(PINHEIRO, {f"inertia_{a}": 20.0 for a in "xyz"})
    fast = scans_studies.Study(PINHEIRO, {"rate_unit": "rad/s"}, here.designs)
    soft = scans_studies.Designs(PINHEIRO, dict(here.point))
    # Gains a hundred thousandth as strong: the stiffness is then that of gravity gradient, which a change may turn.
    soft.gains = {key: (1e-5 if key[0] == "hinf" else 1.0) * K for key, K in here.gains.items()}
    unstable = scans_studies.Designs(PINHEIRO, dict(here.point))
    unstable.gains = {key: -K for key, K in here.gains.items()}
    slender = {"inertia_x": 20.0, "inertia_y": 20.0, "inertia_z": 5.8, "orbital_rate": 1.2e-3, "norm_inputs": "d_alone"}
    light = scans_studies.Study(PINHEIRO, {**slender, "angle_weight": 0.0142, "rate_weight": 0.03})
    damped = {"inertia_x": 13.8, "inertia_y": 10.2, "inertia_z": 6.7, "orbital_rate": 8.5e-4, "angle_weight": 0.036}
    slow = scans_studies.Study(PINHEIRO, {**damped, "rate_weight": 6.2, "harmonics": 5, "disturbance_horizon": 6400.0})
    others = [scans_studies.Study(PINHEIRO, {}, soft), scans_studies.Study(PINHEIRO, {}, unstable), light, slow]
    return [here, exchanged(here), heavy, fast, *others]


#: studies that turn a quantity, by number; the first holds the printed design
TURNED_BY = {
    "scan.gamma_min": 2, "scan.worst_abscissa": 5, "scan.range_ratio": 4, "scan.mixed_torque": 3,
    "scan.robustness_ratio": 6, "scan.disturbed_torque_ratio": 7,
}  # fmt: skip


@pytest.mark.parametrize(
    "question", [q for q in scans.QUESTIONS if any(c.quantity == q.quantity for c in PINHEIRO.claims.values())],
    ids=lambda question: question.quantity,
)  # fmt: skip
def test_scans_of_pinheiro2013(studies, question):
    pair = [studies[0], studies[TURNED_BY.get(question.quantity, 1)]]
    turns(PINHEIRO, question.quantity, [question.value(study) for study in pair])


@pytest.mark.parametrize("name", ["a", "b"])
@pytest.mark.parametrize("group", ["pitch", "roll_yaw"])
def test_designs_of_pinheiro2013(name, group):
    satellite = reconstruction(PINHEIRO, name)
    plant = generalized_plant(satellite, group)
    designs = {level: PINHEIRO.designs[f"{name}_{level}"][f"K_{group}"] for level in ("hinf", "mixed", "h2")}
    levels = {"hinf": 0.2, "mixed": 2.0, "h2": 100.0}
    for level, K in designs.items():
        # (23): a gain a thousandth as strong misses the level, one three times as strong the bound on the H2 norm.
        A, B, C, D, C2 = plant.closed(K)
        assert hinf_norm(A, B, C, D)[0] <= levels[level] < hinf_norm(*plant.closed(1e-3 * K)[:4])[0]
        bound = h2_norm(A, B, C2)
        A, B, _, _, C2 = plant.closed(3 * K)
        assert h2_norm(A, B, C2) > bound * (1 + 1e-3)
        # Robustness: without the damping that the gain gives, the loop is no longer stable.
        half = K.shape[1] // 2
        undamped = K @ block_diag(np.eye(half), np.zeros((half, half)))
        for gain, stable in ((K, True), (undamped, False)):
            A, B = linear_model(satellite, group)
            assert (np.linalg.eigvals(A - B @ gain).real.max() < -1e-12) == stable


@pytest.mark.parametrize("name", ["a", "b"])
@pytest.mark.parametrize("group", ["pitch", "roll_yaw"])
def test_small_gain_of_pinheiro2013(name, group):
    # The design keeps its poles at changes of 50 %; with a millionth of its gain a body of other moments loses them:
    # the stiffness that is left is that of gravity gradient, whose sign the moments decide.
    plant, K = generalized_plant(reconstruction(PINHEIRO, name), group), PINHEIRO.designs[f"{name}_hinf"][f"K_{group}"]
    corners = [plant.uncertain(5.0 * np.array(signs)) for signs in product((-1, 1), repeat=3)]
    values = [max(np.linalg.eigvals(A - B @ gain).real.max() for A, B in corners) for gain in (K, 1e-6 * K)]
    turns(PINHEIRO, f"{name}.gamma_0.2.small_gain_abscissa.{group}", values)


def test_torque_that_can_saturate_the_wheel(studies):
    # Reconstruction A, roll, at a level that the wheel was not meant for, and at gamma = 2.
    values = [float(studies[0].peak_torque(level)[1]) for level in ("hinf", "mixed")]
    turns(PINHEIRO, "a.gamma_0.2.peak_torque.roll", values)


def test_order_of_two_gains_at_one_level():
    # Where no level binds, the H2 limit has the least norm of all gains, and the order is as the sentence has it.
    plant = generalized_plant(reconstruction(PINHEIRO, "b"), "pitch")
    limit, _ = mixed.h2_gain(plant)
    here, other = (h2_norm(A, B, C2) for A, B, _, _, C2 in (plant.closed(K) for K in (limit, 1.1 * limit)))
    assert here < other
    # At gamma = 2 it binds, and another gain than that of (21) has the smaller norm.
    found, _ = pitch.true_optimum(plant, 2.0)
    A, B, C, D, C2 = plant.closed(found)
    A2, B2, _, _, of_shared = plant.closed(PINHEIRO.designs["b_mixed"]["K_pitch"])
    assert hinf_norm(A, B, C, D)[0] < 2.0 * (1 + 1e-9)
    assert h2_norm(A, B, C2) < h2_norm(A2, B2, of_shared)


def test_stiffness_over_all_plausible_inputs_can_be_lost():
    # By hand: a satellite at a thousand times the orbital rate has 3 n^2 p (Ix + Iz) = 17 N m against sqrt 2/100.
    n, share, moments = 1.2, 0.1, 40.0
    turns(PINHEIRO, "plausible.pitch_stiffness", [np.sqrt(2) / 100, np.sqrt(2) / 100 - 3 * n**2 * share * moments])


class Silent:
    """Results that keep nothing."""

    def prove(self, certificate, **more) -> None:
        pass

    def say(self, *words) -> None:
        pass


@pytest.mark.parametrize(
    ("name", "printed", "other"),
    [("ROTATION", "cf*st*sp - sf*cp", "cf*st*sp + sf*cp"), ("RATE", "[0, -sf, cf*ct]", "[0, sf, cf*ct]"),
     ("LINEAR_RATE", "e*dpsi + n*e*phi", "e*dpsi - n*e*phi")],
)  # fmt: skip
def test_another_sign_in_a_formula_of_kinematics_is_refused(monkeypatch, name, printed, other):
    # (2) is then no rotation, (3) not its rate, (6) not (5) for small angles.
    assert printed in getattr(audit, name)
    monkeypatch.setattr(audit, name, getattr(audit, name).replace(printed, other))
    with pytest.raises(CertificateError):
        audit.kinematics(PINHEIRO, Silent())


# --- zhang2013 --------------------------------------------------------------------------------------------------------

CRAFT = Spacecraft.of(ZHANG)
K, L = (np.array(ZHANG.printed(name).exact, dtype=object) for name in "KL")
POINT = {
    "delay_mean": 0.015, "delay_amplitude": 0.015, "delay_frequency": 6.0, "w1_frequency": 1.0, "horizon": 100.0,
    "delay_mode": "paper", "observer_start": "zero",
}  # fmt: skip


def test_loop_of_zhang2013():
    values = [spectral_abscissa(CRAFT.design_loop(gain, L), 0.0) for gain in (K, -K)]
    turns(ZHANG, "audit.abscissa", values)
    turns(ZHANG, "audit.observer_bandwidth", [float((gain @ CRAFT.B)[0, 0]) for gain in (L, -L)])
    # Closed form: a steady w1 moves y by 0.1/K1, two units a newton metre at K1 = 0.05.
    weak = np.array([[Fraction(-1, 20), Fraction(-1, 2)]], dtype=object)
    turns(ZHANG, "audit.hinf.delay_0", [delayed_norm(CRAFT.design_loop(gain, L), 0.0).value for gain in (K, weak)])
    counts = [unstable_root_count(CRAFT.flexible_loop(K, L, "paper"), delay) for delay in (1.0, 0.03)]
    turns(ZHANG, "flexible.unstable_roots_at_one_second", counts)


def test_orbit_of_zhang2013():
    # Kepler's third law by hand at 500 km and at 1000 km.
    turns(ZHANG, "audit.orbit_rate", [np.sqrt(398600.4418 / (6378.137 + h) ** 3) for h in (500.0, 1000.0)])


@pytest.mark.parametrize(
    ("quantity", "form"),
    [("audit.w1_rms", proofs.w1_rms), ("audit.w2_rate_rms", proofs.w2_rate_rms), ("audit.residual_error", None)],
)
def test_what_a_square_integrable_disturbance_would_turn(quantity, form):
    def value(size: str) -> float:
        if form is None:
            return middle(proofs.residual_error(ZHANG, "w1_frequency", size, quantity))
        return middle(form(ZHANG, size, quantity))

    # What is square-integrable leaves no amplitude over long times.
    printed = "number('w1_amplitude') ** 2 * (number('w1_cosine') ** 2 + number('w1_sine') ** 2)"
    turns(ZHANG, quantity, [value(printed), value("0")])


@pytest.fixture(scope="module")
def flights() -> list[dict[str, float]]:
    """The printed gains on the spacecraft, on one a hundred times as heavy, and under a hundred thousand times w1."""
    heavy, pushed = changed(ZHANG, J="3572"), changed(ZHANG, w1_amplitude="4.5")
    return [flight.scan_numbers(case, POINT) for case in (ZHANG, heavy, pushed)]


@pytest.mark.parametrize(
    ("quantity", "by"),
    [("audit.convergence", 1), ("run.theta_end", 1), ("run.rate_end", 1), ("audit.rejection", 2),
     ("audit.vibration_ratio", 2)],
)  # fmt: skip
def test_scans_of_zhang2013(flights, quantity, by):
    turns(ZHANG, quantity, [flights[0][quantity], flights[by][quantity]])
