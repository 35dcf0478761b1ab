"""What the controllers do."""

from gainsay.results import Results, task
from gainsay.systems.norm_proofs import prove_norm
from gainsay.systems.norms import hinf_norm
from gainsay.systems.synthesis import h2_output_feedback
from gainsay.tables import Case
from papers.scherer1997.plant import MIXED_LOOP, plant


@task("mixed")
def mixed_controller(case: Case, results: Results) -> None:
    """Both norms of one loop, each with a Lyapunov matrix of its own."""
    loop = {"A": "Al", "B": "Bl"}
    prove_norm(results, "audit.hinf", "hinf", loop | {"C": "Linf"}, "number('gamma')", definitions=MIXED_LOOP)
    prove_norm(results, "audit.h2", "h2", loop | {"C": "L2"}, "number('h2_level')", definitions=MIXED_LOOP)


@task("H2")
def h2_controller(case: Case, results: Results) -> None:
    """Its H-infinity norm: below gamma, so that gamma alone would cost no H2 norm at all."""
    loop = plant(case, "inf").with_controller(h2_output_feedback(plant(case, "2")).controller)
    norm, _ = hinf_norm(loop.A, loop.B, loop.C)
    results.quantity("audit.h2_optimal_hinf", norm, method="level set of the Hamiltonian matrix")


TASKS = (mixed_controller, h2_controller)
