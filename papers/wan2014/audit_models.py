"""Audit of the models: (2) to first order in the eccentricity, and (1), (2) against the two-body motion."""

import numpy as np

from gainsay.dynamics.relative_orbit import clohessy_wiltshire, relative_acceleration
from gainsay.results import Results, task
from gainsay.simulation.ode import integrate
from gainsay.statements import identical
from gainsay.tables import Case
from papers.wan2014 import plant


def model_errors(case: Case, end: float = 3000.0) -> dict[str, float]:
    """Return the largest position errors of model (1) and of its circular part against the two-body problem, m.

    The chaser drifts without thrust from the printed initial state; both models use the mean motion of the orbit.
    """
    orbit, e = plant.target_orbit(case), case.number("eccentricity")
    n = orbit.mean_motion
    A, x0 = clohessy_wiltshire(n), case.matrix("x0").ravel()

    def two_body(t: float, state: np.ndarray) -> np.ndarray:
        x = state[:6].tolist()
        pull = relative_acceleration(orbit, state[6], tuple(x[:3]), tuple(x[3:]))
        return np.array([*x[3:], *pull, orbit.angular_momentum / orbit.radius(state[6]) ** 2])

    time = np.linspace(0, end, 301)
    truth = integrate(two_body, np.append(x0, 0.0), end, rtol=1e-11, atol=1e-9)(time)[:, :3]
    models = {"noncircular": lambda t, x: (A + plant.noncircular_part(e, n, n * t)) @ x, "circular": lambda t, x: A @ x}
    return {
        name: float(np.max(np.linalg.norm(integrate(f, x0, end, rtol=1e-11, atol=1e-9)(time)[:, :3] - truth, axis=1)))
        for name, f in models.items()
    }


@task("(2)")
def first_order(case: Case, results: Results) -> None:
    """Prove that (2) is the linearised motion about an elliptic orbit to first order in e."""
    w, a = "rate", "acceleration"
    results.prove(
        identical(
            case,
            "eq2.first_order",
            "The rows of the accelerations in A + Delta A of (2) are those of the motion linearised about an "
            "elliptic orbit, to first order in e (s = sin M, c = cos M).",
            "col(row_x, row_y, row_z)",
            f"col([[{w}**2 + 2*g, {a}, 0, 0, 2*{w}, 0]], [[-{a}, {w}**2 - g, 0, -2*{w}, 0, 0]], [[0, 0, -g, 0, 0, 0]])",
            "e n s c",
            definitions=(
                # r = a (1 - e c); g = mu / r^3; rate of the true anomaly n (a/r)^2, its derivative -2 e n^2 s
                ("inverse_radius", "1 + e*c"),
                ("g", "n**2 * inverse_radius**3"),
                ("rate", "n * inverse_radius**2"),
                ("acceleration", "-2*e*n**2*s"),
                ("row_x", "[[3*n**2 + 10*e*n**2*c, -2*e*n**2*s, 0, 0, 2*n + 4*e*n*c, 0]]"),
                ("row_y", "[[2*e*n**2*s, e*n**2*c, 0, -2*n - 4*e*n*c, 0, 0]]"),
                ("row_z", "[[0, 0, -n**2 - 3*e*n**2*c, 0, 0, 0]]"),
            ),
            modulo=["e**2"],
            at={"e": "0", "s": "0"},
            faith=("That r = a (1 - e cos M) to first order in e, from Kepler's equation.",),
        ),
        source="(2)",
    )
    results.say("(2)", "has every term of first order in e")


@task("(1), (2)")
def model_accuracy(case: Case, results: Results) -> None:
    """Set model (1) and the model of a circular orbit beside the two-body problem."""
    for name, error in model_errors(case).items():
        results.quantity(
            f"audit.model_error.{name}",
            error,
            source="Section 2.1",
            method="largest position error over 3000 s of free drift, 301 samples",
        )
        results.say("(1), (2)", f"{name} model errs by {error:.4g} m in 3000 s")
