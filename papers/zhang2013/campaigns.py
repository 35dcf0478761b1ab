"""Campaigns of zhang2013: the map of (23) over lambda1 and lambda2, corrected and as printed."""

from collections.abc import Callable, Mapping

from gainsay.campaigns import once_a_case
from gainsay.campaigns.feasibility import feasibility_map
from gainsay.statements import Stated
from gainsay.tables import Case
from papers.zhang2013.statements import theorem_2


@once_a_case
def _stated(case: Case, edition: str) -> Stated:
    """(23) of an edition with lambda1 and lambda2 left open."""
    return theorem_2(case, edition, l1="lambda1", l2="lambda2")


def equation_23(edition: str) -> Callable[[Case, Mapping[str, str]], Stated]:
    """(23) of an edition at a lambda1 and a lambda2."""

    def stated(case: Case, point: Mapping[str, str]) -> Stated:
        open_ = _stated(case, edition)
        return open_.changed(where={**point, **open_.where})

    return stated


CAMPAIGNS = {
    f"eq23-{edition}": feasibility_map(
        ("lambda1", "lambda2"),
        equation_23(edition),
        f"solution of (23), {edition}, at lambda1 = {{lambda1}} and lambda2 = {{lambda2}}",
    )
    for edition in ("corrected", "printed")
}
