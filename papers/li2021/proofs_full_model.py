"""The full model (6) with (8) and all that the paper leaves out of Figure 6, in linear fractional form: its torque.

State (q, q', eta, eta', x_f, c). Twelve channels carry the gain variations of (9), three Delta J, twelve Delta G and
Delta D, and three the disturbance: d(t) = Delta(t) d_max c(t), where c decays so slowly that it is above one up to the
horizon. So one quadratic function bounds the torque for every phase and speed of the variation, every inertia within
the envelope and every start of the modes in its range, where samples would tell of themselves alone.
"""

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from gainsay.lmi import solve
from gainsay.proof import Certificate, build
from gainsay.results import Results, task
from gainsay.systems import loop_proofs
from gainsay.tables import Case
from papers.li2021 import plant
from papers.li2021.proofs_requirements import PRINTED
from papers.li2021.statements import FACTORS, PLANT
from papers.li2021.statements_torque import torque_within

#: (6) and its loop with (8)
FLEXIBLE = (
    (
        "Cm",
        "2 * diag("
        + ", ".join(f"number('modal_damping_{i}') * number('modal_frequency_{i}')" for i in (1, 2, 3, 4))
        + ")",
    ),
    ("Lambda", "diag(" + ", ".join(f"number('modal_frequency_{i}')**2" for i in (1, 2, 3, 4)) + ")"),
    ("I7", "inverse([[J0, F.T], [F, eye(4)]])"),
    ("acc", "I7 @ [[-G0, -D0, zeros(3, 4), zeros(3, 4)], [zeros(4, 3), -n * F @ turn, -Lambda, -Cm]]"),
    ("Afl", "col(row(zeros(3, 3), eye(3), zeros(3, 8)), acc[0:3, 0:14], row(zeros(4, 10), eye(4)), acc[3:7, 0:14])"),
    ("Bfl", "col(zeros(3, 3), I7[0:3, 0:3], zeros(4, 3), I7[3:7, 0:3])"),
    ("loop", "[[Afl, Bfl @ Cf], [Bf @ row(eye(3), zeros(3, 11)), Af]]"),
)
#: decay of c, 1/s: c(0) is 2.5 where the horizon is 300 s, which is little against the torque of the start
DECAY = "0.003"
#: what is certified, N m: half of u_max
BOUND = "1"
#: the share of its square that the solver is asked to stay within, so that there is room for rounding
SHARE = "19/20"
STATES = 21
#: multiplier that each channel uses: one for Delta J, one for Delta G and Delta D together
OF_CHANNEL = np.array([*range(12), *[12] * 3, *[13] * 12, 14, 15, 16])
BLOCKS = (*[["repeated", 1]] * 12, ["full", 3, 3], ["full", 12, 12], *[["repeated", 1]] * 3)
CHANNELLED = (
    ("dm", "number('delta_m')"),
    ("Acl", f"diag(loop, -{DECAY})"),
    ("Bcl", "col(Bfl, zeros(7, 3))"),
    (
        "H",
        "row(col(zeros(14, 6), Af, zeros(1, 6)), col(zeros(14, 3), Bf, zeros(1, 3)), Bcl, -Bcl, "
        "-Bcl @ row(XG, XD), Bcl)",
    ),
    ("Wcl", "row(zeros(3, 3), XJ, zeros(3, 15))"),
    ("K", "diag(printed('GammaG'), printed('GammaD'))"),
    # moduli of the coefficients in Table 1, all positive, times the largest inertia
    ("most", "printed('disturbance') @ [[1], [1], [1]]"),
    (
        "dmax",
        "number('disturbance_amplitude') * col(most[0, 0] * (J1 + d1), most[1, 0] * (J2 - d2), most[2, 0] * (J3 + d3))",
    ),
    (
        "Cz",
        "col(dm * row(zeros(6, 14), eye(6), zeros(6, 1)), dm * row(eye(3), zeros(3, 18)), "
        "dm * row(zeros(3, 14), Cf, zeros(3, 1)), Wcl @ Acl, row(K, zeros(12, 15)), row(zeros(3, 20), dmax))",
    ),
    ("Dw", "col(zeros(12, 30), Wcl @ H, zeros(15, 30))"),
    ("k", "(1 + dm) * row(zeros(3, 14), Cf, zeros(3, 1))"),
)
FAITH = (
    "That (6) with (8), (9), Delta J, Delta D, Delta G and Table 1's disturbance is the linear fractional form given.",
    "That the norm of k xi is no smaller than that of the torque (I + F3) C_f x_f.",
)


def linear_fractional(case: Case) -> tuple[np.ndarray, ...]:
    """A (21, 21), H (21, 30), Cz (30, 21) and Dw (30, 30) of the full model, as the certificate has them."""
    return loop_proofs.values(case, ("Acl", "H", "Cz", "Dw"), (*PLANT, *FACTORS, *PRINTED, *FLEXIBLE, *CHANNELLED))


def start(case: Case, modes: float) -> np.ndarray:
    """State at the start with every modal coordinate at `modes`, kg^0.5 m, shape (21,)."""
    above = np.exp(float(DECAY) * case.number("horizon"))
    return np.concatenate([case.matrix("x0").ravel(), np.full(4, modes), np.zeros(10), [above]])


def witness(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """P (21, 21) and the 17 multipliers of a torque within `BOUND`, from the farther end of the modes' range.

    Raises
    ------
    ComputationError
        If the solver finds none.
    """
    A, H, Cz, Dw = linear_fractional(case)
    begin = start(case, float(case.plausible("modal_start")[1]))
    drive = H / np.linalg.norm(H, axis=0)
    T = np.linalg.cholesky(
        solve_continuous_lyapunov(A, -(1e-2 * drive @ drive.T + np.outer(begin, begin) + 1e-4 * np.eye(STATES)))
    )
    inv = np.linalg.inv(T)
    ratio = np.sqrt(np.linalg.norm(Cz @ T, axis=1) / np.linalg.norm(inv @ H, axis=0))
    c = np.exp([np.mean(np.log(ratio[i == OF_CHANNEL])) for i in range(max(OF_CHANNEL) + 1)])
    each = c[OF_CHANNEL]
    output = (1 + case.number("delta_m")) * plant.controller(case, "proposed").C @ T[14:20]
    size = float(np.linalg.norm(output, 2) ** 2)
    near = {"P": size * np.eye(STATES), **{f"d{i}": size for i in range(len(c))}}
    data = {
        "A": inv @ A @ T,
        "H": inv @ H * each,
        "Cz": Cz @ T / each[:, None],
        "Dw": Dw * each / each[:, None],
        "k": output,
        "x0": (inv @ begin)[:, None],
    }
    program = torque_within(data, OF_CHANNEL, f"{SHARE} * ({BOUND})**2").program()
    values = solve(program, near=near, rounds=1).need("Figure 6, torque bound").values
    P = inv.T @ values["P"] @ inv
    return (P + P.T) / 2, np.array([values[f"d{i}"] for i in range(len(c))]) / c**2


def certificate(case: Case, P: np.ndarray, multipliers: np.ndarray) -> Certificate:
    """The torque stays below `BOUND` over the whole box: a certificate."""
    begin = (
        "col(printed('x0'), plausible('modal_start') * [[1], [1], [1], [1]], zeros(10, 1), "
        f"exp({DECAY} * number('horizon')))"
    )
    return build.certificate(
        "quadratic_bound",
        id="full-torque",
        tables=case,
        statement=f"The torque of (6) with the printed proposed gains is at most {BOUND} N m up to the horizon, for "
        "every gain variation within delta_m, every inertia within 5 % and every plausible start of the modes.",
        definitions=(*PLANT, *FACTORS, *PRINTED, *FLEXIBLE, *CHANNELLED, ("x0", begin)),
        fields={
            "A": "Acl",
            "H": "H",
            "Cz": "Cz",
            "Dw": "Dw",
            "blocks": list(BLOCKS),
            "x0": "x0",
            "inputs": [{"of": "torque", "row": "k", "bound": BOUND}],
        },
        witness={"P": P} | {f"D{i}": [[float(x)]] for i, x in enumerate(multipliers, start=1)},
        quantities={"torque": "audit.torque_over_inputs"},
        faith=FAITH,
        digits=(9, 12, 17),
    )


@task("Figure 6, torque bound")
def torque_over_inputs(case: Case, results: Results) -> None:
    """Certify the torque bound over what the paper leaves out: phase of the variation, inertia, start of the modes."""
    results.certificate(certificate(case, *witness(case)))
    results.quantity(
        "audit.torque_over_inputs",
        float(BOUND),
        upper=float(BOUND),
        lower=0.0,
        source="Figure 6",
        method="certificate full-torque, over the whole box of what the paper leaves out",
    )
    results.say("Figure 6, torque bound", f"at most {BOUND} N m over phase, inertia and start of the modes")
