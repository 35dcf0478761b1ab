"""Where a computation broke."""

import traceback
from pathlib import Path


def place_of(error: BaseException, root: Path) -> str:
    """Return where in the modules of a paper an error arose."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [f for f in frames if Path(f.filename).is_relative_to(root / "papers")]
    return f", at {Path(own[-1].filename).relative_to(root)}:{own[-1].lineno}" if own else ""
