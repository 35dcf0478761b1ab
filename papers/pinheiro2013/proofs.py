"""Proofs of pinheiro2013: over whole boxes of plausible inputs, and that (21) does not minimise what (20) asks for."""

import numpy as np

from gainsay.proof import build
from gainsay.results import Results, task
from gainsay.systems import loop_proofs
from gainsay.systems.norms import h2_norm
from gainsay.tables import Case
from papers.pinheiro2013 import conditions_pitch as pitch
from papers.pinheiro2013 import statements
from papers.pinheiro2013.plant import generalized_plant, reconstruction, short

#: how far the other gain stays below the level, so that four digits of it meet the level
_BELOW = 0.999
#: relative room between a norm and its bounds
_ROOM = 1e-5


@task("gamma_min without d")
def without_disturbance(case: Case, results: Results) -> None:
    """Prove that the printed gamma_min excludes a w without d: the norm of D11 is then about the 10 % of the moments.

    A row of D11 holds the share itself, two products with n^2 (pitch), or three with n and two with n^2 (roll and yaw),
    each times a ratio of moments; the rows have no column in common.
    """
    results.prove(
        build.certificate(
            "enclosed",
            id="channels-alone-level",
            tables=case,
            statement="Without d in w the infimum of the level is 0.1 to three digits for all plausible inputs,"
            " not 0.2.",
            definitions={
                "share": "number('inertia_change')",
                "n": "plausible('orbital_rate')",
                "u": "plausible('inertia_b_y')/plausible('inertia_b_x')",
                "v": "plausible('inertia_b_z')/plausible('inertia_b_x')",
                "most": "share*sqrt(1 + n**2 + (n**2 + 16*n**4)*(u**2 + v**2))",
            },
            fields={"formula": "most"},
            quantities={"value": "plausible.channels_alone.gamma_min"},
            faith=(
                "That no row of D11 without the column of d is longer, u and v the ratios of the other two moments"
                " to that of the row's axis.",
            ),
        ),
        source="(18), Section 5",
    )


@task("pitch over all plausible inputs")
def pitch_stays_stable(case: Case, results: Results) -> None:
    """Prove that a pitch gain that meets gamma = 100 stays stable for all 10 % changes, whatever the missing inputs.

    Under a steady w the angle is |r| w/k1 and z_inf holds it twice, so that a level gamma needs k1 >= sqrt 2 |r|/gamma,
    where |r| >= 1/I with d among w: the stiffness I k1 = K1 + 3 n^2 (Ix - Iz) is at least sqrt 2/gamma. The changes
    take at most 3 n^2 p (Ix + Iz) of it; the damping K2 and the moment keep their signs.
    """
    results.prove(
        build.certificate(
            "enclosed",
            id="pitch-stiffness-plausible",
            tables=case,
            statement="A pitch loop that meets gamma = 100 keeps a positive stiffness under every 10 % change.",
            definitions={
                "share": "number('inertia_change')",
                "n": "plausible('orbital_rate')",
                "Ix": "plausible('inertia_a_x')",
                "Iz": "plausible('inertia_a_z')",
                "least": "sqrt(2)/number('gamma_max') - 3*n**2*share*(Ix + Iz)",
            },
            fields={"formula": "least"},
            quantities={"value": "plausible.pitch_stiffness"},
            faith=(
                "That a stable loop of pitch which meets a level gamma has a stiffness of at least sqrt 2/gamma, by"
                " its response at rest, and that positive stiffness and damping are stability.",
            ),
        ),
        source="(12), (21), Section 5",
    )


@task("(20) against (21)")
def not_equivalent(case: Case, results: Results) -> None:
    """Prove that the gain of (21) at gamma = 2, pitch, B, has a larger H2 norm than another that meets the level."""
    plant, gamma = generalized_plant(reconstruction(case, "b"), "pitch"), case.number("gamma_mixed")
    digits = [f"{k:.4g}" for k in pitch.true_optimum(plant, _BELOW * gamma)[0][0]]
    other = np.array([digits], dtype=float)
    shared = case.designs["b_mixed"]["K_pitch"]
    formulas = {"shared": "design('b_mixed', 'K_pitch')", "other": f"[[{', '.join(digits)}]]"}
    for name, K in (("shared", shared), ("other", other)):
        A, B, _, _, C = plant.closed(K)
        norm = h2_norm(A, B, C)
        low, high = (f"{norm * (1 + sign * _ROOM):.8g}" for sign in (-1, 1))
        results.prove(
            loop_proofs.h2_norm_below(
                case,
                {"A": "closed_A", "B": "B1", "C": "closed_C2"},
                high,
                lower=low,
                definitions=statements.closed("b", "pitch", formulas[name]),
                id=f"eq20-{name}",
                statement=f"Bounds on the H2 norm from w to z_2 of the {name} gain at gamma = 2, pitch, B.",
                quantities={"norm": f"eq20.{name}.pitch"},
            ),
            source="(20), (21)",
            values={f"eq20.{name}.pitch": norm},
        )
    results.certificate(
        loop_proofs.norm_below(
            case,
            statements.TO_Z_INF,
            "number('gamma_mixed')",
            definitions=statements.closed("b", "pitch", formulas["other"]),
            id="eq20-other-level",
            statement="The other gain meets gamma = 2, pitch, B.",
        )
    )
    results.say("(20), (21)", f"H2 norm of {short(shared)}, which (21) gives, above that of {short(other)}")


TASKS = (without_disturbance, pitch_stays_stable, not_equivalent)
