"""What holds over whole boxes of plausible inputs of pinheiro2013, proved by interval arithmetic on closed formulas."""

from gainsay.proof import build
from gainsay.results import task


def between(case, name: str) -> str:
    """Formula of every plausible value of a number that the paper leaves out."""
    low, _, high = case.parameters[name].plausible.partition("..")
    return f"interval({low}, {high})"


@task("gamma_min without d")
def without_disturbance(case, results):
    """Prove that the printed gamma_min excludes a w without d: the norm of D11 is then about the 10 % of the moments.

    A row of D11 holds the share itself, two products with n^2 (pitch), or three with n and two with n^2 (roll and yaw),
    each times a ratio of moments; the rows have no column in common.
    """
    low, _, high = case.parameters["inertia_b_x"].plausible.partition("..")
    results.prove(
        build.certificate(
            "enclosed", id="channels-alone-level", paper=case.name, tables=case,
            statement="Without d in w the infimum of the level is 0.1 to three digits for all plausible inputs,"
            " not 0.2.",
            definitions={
                "share": "number('inertia_change')", "n": between(case, "orbital_rate"),
                "u": f"interval({low}/{high}, {high}/{low})", "v": "u",
                "most": "share*sqrt(1 + n**2 + (n**2 + 16*n**4)*(u**2 + v**2))",
            },
            fields={"formula": "most"},
            quantities={"value": "plausible.channels_alone.gamma_min"},
            faith=("That no row of D11 without the column of d is longer, u and v the ratios of the other two moments"
                   " to that of the row's axis.",),
        ),
        source="(18), Section 5",
    )  # fmt: skip


@task("pitch over all plausible inputs")
def pitch_stays_stable(case, results):
    """Prove that a pitch gain that meets gamma = 100 stays stable for all 10 % changes, whatever the missing inputs.

    Under a steady w the angle is |r| w/k1 and z_inf holds it twice, so that a level gamma needs k1 >= sqrt 2 |r|/gamma,
    where |r| >= 1/I with d among w: the stiffness I k1 = K1 + 3 n^2 (Ix - Iz) is at least sqrt 2/gamma. The changes
    take at most 3 n^2 p (Ix + Iz) of it; the damping K2 and the moment keep their signs.
    """
    results.prove(
        build.certificate(
            "enclosed", id="pitch-stiffness-plausible", paper=case.name, tables=case,
            statement="A pitch loop that meets gamma = 100 keeps a positive stiffness under every 10 % change.",
            definitions={
                "share": "number('inertia_change')", "n": between(case, "orbital_rate"),
                "Ix": between(case, "inertia_a_x"), "Iz": between(case, "inertia_a_z"),
                "least": "sqrt(2)/number('gamma_max') - 3*n**2*share*(Ix + Iz)",
            },
            fields={"formula": "least"},
            quantities={"value": "plausible.pitch_stiffness"},
            faith=("That a stable loop of pitch which meets a level gamma has a stiffness of at least sqrt 2/gamma, by"
                   " its response at rest, and that positive stiffness and damping are stability.",),
        ),
        source="(12), (21), Section 5",
    )  # fmt: skip


TASKS = (without_disturbance, pitch_stays_stable)
