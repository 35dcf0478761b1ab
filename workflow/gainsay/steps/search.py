"""Find designs of a paper and write them into its folder; no step of a run does this."""

import time
from collections.abc import Callable

from gainsay.errors import InputError, one_of
from gainsay.steps.modules import paper_module
from gainsay.tables import Case, read_case
from gainsay.tables.designs import FoundDesign, write_design

#: a search of a paper: its tables -> the design
Search = Callable[[Case], FoundDesign]


def searches_of(case: Case) -> dict[str, Search]:
    """Return the searches of a paper: design name -> function, in the order in which they build on each other.

    Raises
    ------
    InputError
        If the paper has none.
    """
    if not (case.folder / "searches.py").is_file():
        raise InputError("file not found", file=f"papers/{case.name}/searches.py", expected="the searches of the paper")
    return dict(paper_module(case, "searches").SEARCHES)


def _line(case: Case, name: str, design: FoundDesign, seconds: float) -> str:
    ended = "converged" if design.converged else "DID NOT CONVERGE"
    outcome = ", ".join(f"{key} {value:.6g}" for key, value in design.outcome.items())
    return f"{case.name}  search      {name}: {ended}; {outcome}  {seconds:.1f} s"


def search(case: Case, design: str | None = None) -> None:
    """Search one design of a paper, or all, and write each into ``papers/<paper>/designs`` as it is found.

    Parameters
    ----------
    case : Case
    design : str, optional
        A name of ``[designs]`` in ``paper.toml``; default: all that have a search.

    Raises
    ------
    InputError
        If the paper has no search of that name, or the search finds gains that are not finite.
    """
    searches = searches_of(case)
    if design is not None and design not in searches:
        raise InputError("design", value=design, expected=one_of(design, searches))
    for name in searches if design is None else (design,):
        if name not in case.paper.designs:
            raise InputError(
                "design", file=f"papers/{case.name}/paper.toml", value=name, expected="a name of [designs]"
            )
        start = time.perf_counter()
        result = searches[name](case)
        write_design(case.folder, name, result)
        print(_line(case, name, result, time.perf_counter() - start), flush=True)
        case = read_case(case.root, case.name)  # a later search may build on this design
