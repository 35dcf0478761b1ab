"""Errata of a paper with the texts that follow from the editions of its statements."""

from dataclasses import replace

from gainsay.errors import InputError
from gainsay.statements import Statement
from gainsay.statements.errata import corrections, from_editions
from gainsay.steps.modules import paper_module
from gainsay.tables import Case


def _editions(case: Case) -> tuple[Statement, ...]:
    """Return ``EDITIONS`` of a paper's statements; none where it has no such module or list."""
    if not (case.folder / "statements.py").is_file():
        return ()
    return tuple(getattr(paper_module(case, "statements"), "EDITIONS", ()))


def with_texts(case: Case) -> Case:
    """Return the case with what is printed and what should stand there in every erratum.

    Raises
    ------
    InputError
        If an erratum names an edition or a block that is none, or a cell of an edition stands in no erratum.
    Exception
        Whatever a paper's broken module raises.
    """
    editions, filled = _editions(case), dict(case.errata)
    file = f"papers/{case.name}/errata.csv"
    for row, (id, erratum) in enumerate(case.errata.items(), start=2):
        if erratum.edition:
            try:
                printed, corrected = from_editions(erratum.edition, editions)
            except InputError as error:
                raise InputError(
                    file=file, row=row, field="edition", value=error.value, expected=error.expected
                ) from error
            filled[id] = erratum.model_copy(update={"printed": printed, "corrected": corrected})
    unsaid = corrections((erratum.edition for erratum in case.errata.values()), editions)
    if unsaid:
        raise InputError(file=file, field="edition", value="", expected=f"{unsaid[0]}, which no erratum names")
    return replace(case, errata=filled)
