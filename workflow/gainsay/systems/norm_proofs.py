"""A norm of a system whose matrices are formulas over the tables: its value beside the proof that a level bounds it."""

from collections.abc import Callable, Mapping
from typing import Literal

from gainsay.proof import Certificate
from gainsay.results import Results
from gainsay.systems import loop_proofs
from gainsay.systems.loop_proofs import Definitions, values
from gainsay.systems.norms import h2_norm, hinf_norm

__all__ = ["prove_norm"]


def prove_norm(
    results: Results,
    quantity: str,
    norm: Literal["hinf", "h2"],
    system: Mapping[str, str],
    level: str,
    *,
    definitions: Definitions,
    statement: str = "",
    source: str = "",
) -> None:
    """Prove that a norm of a stable system is below a level; the quantity is the norm itself, with that upper end.

    Parameters
    ----------
    results : Results
    quantity : str
    norm : {"hinf", "h2"}
    system : mapping of str to str
        Formulas of ``A``, ``B``, ``C`` and, of an H-infinity norm, ``D`` where it is not zero.
    level : str
        Formula, such as ``"1.2"`` or ``"number('gamma')"``.
    definitions : mapping of str to str, or pairs
        Names that the formulas use, in order.
    statement : str, optional
        What is proved, a sentence; by default one made of the formulas.
    source : str, optional
        Equation or sentence behind it.

    Raises
    ------
    InputError
        If the system is unstable, or the norm is not below the level.
    CertificateError
        If the proof is not accepted, by a margin too small for rounded digits.

    Examples
    --------
    The complementary sensitivity of a loop with the gain K::

        prove_norm(results, "audit.peak", "hinf", {"A": "A - B@K", "B": "B", "C": "K"}, "1.3", definitions=FORMULAS)
    """
    case = results.case
    certify: Callable[..., Certificate] = loop_proofs.norm_below if norm == "hinf" else loop_proofs.h2_norm_below
    name = "H-infinity" if norm == "hinf" else "H2"
    certificate = certify(
        case,
        system,
        level,
        definitions=definitions,
        statement=statement or f"The {name} norm of the system of {', '.join(system.values())} is below {level}.",
        quantities={"norm": quantity},
    )
    matrices = values(case, system.values(), definitions)
    norm_value = hinf_norm(*matrices)[0] if norm == "hinf" else h2_norm(*matrices)
    results.prove(certificate, source=source, values={quantity: norm_value})
