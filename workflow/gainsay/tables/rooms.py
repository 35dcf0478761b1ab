"""The modules that a paper's folder may hold: the same rooms in every paper, so that a reader knows where to look."""

import re

from gainsay.errors import InputError, nearest
from gainsay.tables.case import Case
from gainsay.tables.files import listed

#: room -> what it is for; a paper has those it needs
ROOMS = {
    "plant": "the physics that only this paper has: models, uncertainty, closed loops",
    "statements": "each inequality of the paper once, as text, and the programs made of them",
    "conditions": "what inequalities give: least levels, largest margins, gains, and conditions of our own",
    "derivations": "the paper's algebra and proofs, step by step, as identities and implications",
    "proofs": "certificates of what was found in floating point",
    "response": "trajectories of the closed loops, and the numbers read off them",
    "scans": "claims over every plausible value of what the paper leaves out",
    "searches": "designs that `gainsay search` finds: `SEARCHES`",
    "campaigns": "what a computation too large for a run computes, block by block",
    "synthesis": "what the paper's inequalities say: `TASKS` of that step",
    "audit": "what the printed numbers do: `TASKS` of that step",
    "runs": "the runs that are logged: `RUNS`, and their `LAYOUT` for viewers",
    "figures": "figures drawn from the logs: `FIGURES`",
}
_PART = re.compile(r"(?P<room>[a-z]+)(_[a-z][a-z0-9_]*)?", re.ASCII)


def check_rooms(case: Case) -> None:
    """Refuse a module of a paper that is neither a room, ``<room>.py``, nor part of one, ``<room>_<part>.py``.

    Raises
    ------
    InputError
        At the first, naming the rooms there are.
    """
    for path in listed(case.folder, case.root):
        if path.suffix != ".py" or path.name == "__init__.py":
            continue
        match = _PART.fullmatch(path.stem)
        if match is None or match["room"] not in ROOMS:
            near = nearest(path.stem, ROOMS)
            meant = f"{near}.py, perhaps; " if near else ""
            expected = f"{meant}<room>.py or <room>_<part>.py, the rooms being {', '.join(ROOMS)}"
            raise InputError(f"papers/{case.name}/{path.name} is not a room of a paper", expected=expected)
