"""What two Riccati equations and the inequalities say of each norm, and of both at once."""

from gainsay.results import Results, task
from gainsay.statements import Stated, prove
from gainsay.systems.synthesis import h2_output_feedback, hinf_least_level
from gainsay.tables import Case
from papers.scherer1997.plant import plant
from papers.scherer1997.statements import BOUNDED_REAL, COUPLING, H2, MIXED


@task("H2")
def least_h2_norm(case: Case, results: Results) -> None:
    """The regulator on the Kalman filter's estimate; no controller does better."""
    norm = h2_output_feedback(plant(case, "2")).norm
    results.quantity(
        "h2.least", norm.lower, method="norm of the H2-optimal loop, enclosed", lower=norm.lower, upper=norm.upper
    )


@task("H-infinity")
def least_hinf_norm(case: Case, results: Results) -> None:
    """Between a level that two Riccati equations refuse and one that they reach."""
    low, high = hinf_least_level(plant(case, "inf"))
    results.quantity("hinf.least", high, method="two Riccati equations; band: bisection", lower=low, upper=high)


@task("LMI")
def inequalities(case: Case, results: Results) -> None:
    """Points of the inequalities at the published levels, certified."""
    hinf = (COUPLING > 0, BOUNDED_REAL.given(level="9.509") < 0)
    for quantity, constraints, sentence in (
        ("lmi.h2", (*H2, "trace(Q) < 7.7485**2"), "a controller with an H2 norm below 7.7485"),
        ("lmi.hinf", hinf, "a controller with an H-infinity norm below 9.509"),
        ("lmi.mixed", MIXED, "one Lyapunov matrix for an H-infinity norm below gamma and an H2 norm below our level"),
    ):
        stated = Stated(case, constraints, label=quantity)
        prove(results, quantity, stated, stated.solve(), sentence=sentence)


TASKS = (least_h2_norm, least_hinf_norm, inequalities)
