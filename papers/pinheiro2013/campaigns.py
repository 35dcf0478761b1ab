"""Campaign of pinheiro2013: the map of (21), corrected, over moments of inertia, a weight and a bound on the H2 norm.

The paper leaves out its moments of inertia and its weights. The map says at which of them the mixed problem of the
pitch axis has a gain within the printed level and a bound on the square root of trace Q.
"""

from collections.abc import Mapping

from gainsay.campaigns import once_a_case
from gainsay.campaigns.feasibility import feasibility_map
from gainsay.statements import Stated
from gainsay.tables import Case
from papers.pinheiro2013 import statements
from papers.pinheiro2013.plant import AXES, Satellite, generalized_plant

#: of the plant of the pitch axis, whatever its numbers
_SIZES = statements.sizes(generalized_plant(Satellite((1.0, 1.0, 1.0), 1.0, 0.0, (1.0, 1.0, 1.0)), "pitch"))


@once_a_case
def _stated(case: Case) -> Stated:
    """(21), corrected, of the pitch axis with the inputs of the map left open."""
    moments = {f"I{axis}": f"inertia*number('inertia_a_{axis}')" for axis in AXES}
    where = {**statements.pitch("a"), **moments, "Q1": "angle_weight"}
    held = [
        statements.corrected_21(_SIZES, where, "number('gamma_mixed')**2") < 0,
        statements.second_21(_SIZES, where) > 0,
        "trace(Q) < bound**2",
    ]
    return Stated(case, held, label="(21)")


def equation_21(case: Case, point: Mapping[str, str]) -> Stated:
    """(21), corrected, of the pitch axis at the printed level of the mixed control, with a bound on trace Q.

    Parameters
    ----------
    case : Case
    point : mapping of str to str
        ``inertia`` over reconstruction A, the same for each moment; ``angle_weight``, Q1; ``bound`` on the square root
        of trace Q.
    """
    stated = _stated(case)
    return stated.changed(where={**point, **stated.where})


CAMPAIGNS = {
    "eq21-map": feasibility_map(
        ("inertia", "angle_weight", "bound"),
        equation_21,
        "solution of (21), corrected, for pitch at gamma = 2, {inertia} times the moments of inertia of reconstruction"
        " A, Q1 = {angle_weight} and trace Q below the square of {bound}",
    )
}
