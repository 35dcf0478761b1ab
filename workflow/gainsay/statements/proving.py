"""The outcome of the solver chooses the proof: one call gives certificate, quantity, ends and method."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from gainsay.errors import CertificateError, ComputationError
from gainsay.lmi import Infeasible, Infimum, Solved, infimum, interior_multipliers
from gainsay.proof import Certificate, build
from gainsay.results import Results
from gainsay.results.ends import proved_ends
from gainsay.statements.instability import wrong_inertia
from gainsay.statements.program import Stated

__all__ = ["above", "below", "enclose", "optimum", "prove"]

# margins of multipliers that are to survive rounding, tried in turn: a narrow one loses less of the bound
_INSIDE = (1e-9, 1e-8, 1e-7, 1e-6)


def optimum(results: Results, stated: Stated, where: str = "", *, margins: tuple[float, ...] | None = None) -> Infimum:
    """Infimum of a program; the attempts of the solver are kept.

    Parameters
    ----------
    results : Results
        Takes the attempts.
    stated : Stated
        With an objective.
    where : str, optional
        What the attempts are kept under; the label of the program unless given.
    margins : tuple of float, optional
        Of the multipliers: see `gainsay.lmi.infimum`.

    Raises
    ------
    ComputationError
        If it was not enclosed.
    """
    outcome = results.attempted(where or stated.label, stated.infimum(margins))
    return outcome.need(f"{where}: {stated.label}" if where else stated.label)


def prove(
    results: Results,
    quantity: str,
    stated: Stated,
    outcome: Any,
    *,
    sentence: str,
    source: str = "",
    id: str | None = None,
    faith: Sequence[str] = (),
    digits: Sequence[int] = build.DIGITS,
) -> Certificate | None:
    """Prove that a program has a point, or that it has none, by what the solver found.

    Parameters
    ----------
    results : Results
        Takes the certificate and the quantity: 1 where it has a point, 0 where it has none.
    quantity : str
    stated : Stated
        The program.
    outcome : Solved, Infeasible or any other outcome of `gainsay.lmi.solve`
        For the program, or for one with further wishes where it is a point.
    sentence : str
        What the program asks, for people, as the end of "There is" or "There is no": ``"X > 0 that satisfies (14)"``.
    source : str, optional
        Equation behind it.
    id : str, optional
        Id of the certificate; that of the quantity with dashes unless given.
    faith : sequence of str, optional
        What the step from the paper to this program takes on faith.
    digits : sequence of int, optional
        As for `gainsay.proof.build.certificate`: where fewer are known not to do.

    Returns
    -------
    Certificate or None
        None where neither side could be proved: the quantity is then undecided.
    """
    parts = {
        **stated.parts(),
        "id": id or build.id_of(quantity),
        "quantities": {"feasible": quantity},
        "faith": faith,
        "digits": digits,
    }
    parts["fields"] = {key: value for key, value in parts["fields"].items() if key != "minimise"}
    try:
        if isinstance(outcome, Solved):
            made = build.feasible_point(
                statement=f"There is {sentence}.", point=_point(stated, outcome.values), **parts
            )
        else:
            made = _refuted(stated, outcome, statement=f"There is no {sentence}.", **parts)
    except CertificateError as error:
        results.undecided(quantity, str(error), source=source)
        results.say(stated.label, f"undecided: {error}")
        return None
    results.prove(made, source=source)
    return made


def _refuted(stated: Stated, outcome: Any, **parts: Any) -> Certificate:
    """Certificate of multipliers where the outcome has some, else, or where they do not do, of a wrong inertia."""
    reason = f"{type(outcome).__name__} after {len(outcome.attempts)} attempts"
    if isinstance(outcome, Infeasible) and np.isfinite(outcome.farkas.distance):
        try:
            return _by_multipliers(stated, outcome.farkas.multipliers, **parts)
        except CertificateError as error:
            reason = str(error)
    try:
        return wrong_inertia(stated, **parts)
    except CertificateError as error:
        raise CertificateError(f"{reason}; {error}") from error


def _by_multipliers(stated: Stated, multipliers: Mapping[str, Any], **parts: Any) -> Certificate:
    try:
        return build.farkas(multipliers=_multipliers(stated, multipliers), **parts)
    except CertificateError:
        # others further inside their cones survive rounding
        inside = interior_multipliers(stated.program(), multipliers)
        if inside is None:
            raise
        return build.farkas(multipliers=_multipliers(stated, inside), **parts)


def above(
    case: Any, quantity: str, stated: Stated, values: Mapping[str, Any], *, sentence: str, id: str, **more: Any
) -> Certificate:
    """Certificate that a point bounds the infimum of the program from above.

    Parameters
    ----------
    case : gainsay.tables.Case
    quantity : str
    stated : Stated
        With an objective.
    values : mapping of str to array_like
        The point.
    sentence : str
        What is minimised, for people: ``"rho over (14), (30), (31)"``.
    id : str
    **more
        As for `gainsay.proof.build.certificate`: faith, precision, digits.
    """
    return build.feasible_point(
        id=id,
        statement=f"A point bounds the infimum of {sentence} from above.",
        point=_point(stated, values),
        quantities={"objective": quantity},
        **stated.parts(),
        **more,
    )


def below(
    case: Any, quantity: str, stated: Stated, multipliers: Mapping[str, Any], *, sentence: str, id: str, **more: Any
) -> Certificate:
    """Certificate that multipliers bound the infimum of the program from below; parameters as for `above`."""

    def made(weights: Mapping[str, Any]) -> Certificate:
        return build.dual_bound(
            id=id,
            statement=f"Multipliers bound the infimum of {sentence} from below.",
            multipliers=_multipliers(stated, weights),
            quantities={"objective": quantity},
            **stated.parts(),
            **more,
        )

    try:
        return made(multipliers)
    except CertificateError as error:
        refused = error
    # others further inside their cones, which lose a little of the bound and survive rounding
    for margin in _INSIDE:
        inside = infimum(stated.program(), margins=(margin,))
        if isinstance(inside, Infimum) and inside.multipliers:
            with suppress(CertificateError):
                return made(inside.multipliers)
    raise refused


def enclose(
    results: Results,
    quantity: str,
    stated: Stated,
    outcome: Any,
    *,
    sentence: str,
    source: str = "",
    id: str | None = None,
    faith: Sequence[str] = (),
    digits: Sequence[int] = build.DIGITS,
) -> tuple[float, float]:
    """Enclose the infimum of a program by a point and by multipliers, each with its certificate.

    Parameters
    ----------
    results : Results
        Takes certificates ``<id>-above`` and ``<id>-below`` and the quantity with both ends.
    quantity, stated, source, id, faith, digits
        As for `prove`.
    outcome : Infimum
    sentence : str
        As for `above`.

    Returns
    -------
    (lower, upper) : tuple of float
        The proved ends; ``-inf`` where no multipliers could be certified.

    Raises
    ------
    ComputationError
        If there is no point: use `prove` where the program may have none.
    """
    if not isinstance(outcome, Infimum):
        raise ComputationError(stated.label, f"{type(outcome).__name__} where an infimum is needed", outcome.attempts)
    name = id or build.id_of(quantity)
    more: dict[str, Any] = {"sentence": sentence, "faith": faith, "digits": digits}
    top = above(results.case, quantity, stated, outcome.solved.values, id=f"{name}-above", **more)
    made, reason = [top], ""
    try:
        made.append(below(results.case, quantity, stated, outcome.multipliers, id=f"{name}-below", **more))
    except CertificateError as error:
        reason = f"; no lower end: {error}"
    for certificate in made:
        results.certificate(certificate)
    ends = [proved_ends(certificate.conclusions[-1]) for certificate in made]
    lower, upper = max(low for low, _ in ends), min(high for _, high in ends)
    value = min(max(outcome.value if np.isfinite(outcome.value) else outcome.upper, lower), upper)
    results.quantity(
        quantity,
        value,
        method=f"semidefinite program, enclosed by certificates {', '.join(c.id for c in made)}{reason}",
        source=source,
        lower=lower if np.isfinite(lower) else None,
        upper=upper,
    )
    return lower, upper


def _point(stated: Stated, values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: values[name] for name in stated.unknowns}


def _multipliers(stated: Stated, multipliers: Mapping[str, Any]) -> dict[str, Any]:
    """Multipliers of the constraints that the certificate states; those of printed digits are found by the checker."""
    labels = {constraint.label for constraint in stated.constraints}
    return {label: value for label, value in multipliers.items() if label in labels}
