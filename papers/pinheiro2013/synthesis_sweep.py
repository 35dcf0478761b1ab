"""The least H2 norm over the level: one shared X as in (21), and the optimum over the two gains."""

from gainsay.errors import ComputationError
from gainsay.lmi import Solved, sweep
from gainsay.results import Results, task
from gainsay.systems.norms import hinf_norm
from gainsay.tables import Case
from papers.pinheiro2013 import conditions as mixed
from papers.pinheiro2013 import conditions_gains as gains
from papers.pinheiro2013 import conditions_pitch as pitch
from papers.pinheiro2013.conditions import AGREE
from papers.pinheiro2013.plant import generalized_plant, reconstruction

PARETO = ("0.15", "0.3", "0.5", "1", "2", "5", "10", "30")


@task("gamma sweep")
def pareto(case: Case, results: Results) -> None:
    """Follow the least H2 norm over gamma: one shared X as in (21), and the true optimum over the two gains."""
    plant = generalized_plant(reconstruction(case, "b"), "pitch")
    values = [float(level) for level in PARETO]
    points = dict(sweep(lambda gamma: mixed.mixed_program(plant, gamma), values))
    count = len(values)
    stationary, _ = gains.least_trace_gains(gains.stack([plant] * count, values, [mixed.limit_gain(plant)] * count))
    for level, gamma, K in zip(PARETO, values, stationary, strict=True):
        outcome = points[gamma]
        if not isinstance(outcome, Solved):
            raise ComputationError("gamma sweep", f"no solution at gamma = {gamma!r}", outcome.attempts)
        trace, (A, B, _, _, C2) = mixed.trace_of_gain(plant, K, gamma), plant.closed(K)
        if not abs(trace / outcome.objective - 1) < AGREE:
            raise ComputationError(
                "gamma sweep", f"traces {outcome.objective!r} by the LMI, {trace!r} by Newton's method"
            )
        shared = mixed.h2_norm(A, B, C2)
        gain, true = pitch.true_optimum(plant, gamma)
        A, B, C, D, C2 = plant.closed(gain)
        if abs(mixed.h2_norm(A, B, C2) / true - 1) > 1e-8 or hinf_norm(A, B, C, D)[0] > gamma * (1 + 1e-8):
            raise ComputationError("gamma sweep", f"closed forms at gamma = {gamma!r} disagree with the norms")
        results.quantity(
            f"b.pareto.gamma_{level}.shared",
            shared,
            source="(20), (21)",
            method="H2 norm of the stationary gain of the trace of Q; one LMI program for all levels agrees",
        )
        results.quantity(
            f"b.pareto.gamma_{level}.true",
            true,
            source="(20)",
            method="closed forms of both norms in the two gains, minimised along the active level",
        )
        if true > shared * (1 + 1e-9):
            raise ComputationError("gamma sweep", f"optimum {true!r} above the shared-X design {shared!r}")
        if level == "2":
            results.quantity(
                "b.gamma_2.shared_excess.pitch",
                shared / true - 1,
                source="(20), (21)",
                method="H2 norm of the gain of least trace over the least H2 norm at the same level",
            )
    results.say("gamma sweep", f"{len(values)} levels from {values[0]:g} to {values[-1]:g}")
