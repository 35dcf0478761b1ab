"""Campaign of wan2014: the largest thrust of the printed gains over the starts of the observer; none is given."""

from collections.abc import Mapping, Sequence

import numpy as np

from gainsay.campaigns.scan import grid_scan
from gainsay.tables import Case
from papers.wan2014.scans import Flights

INPUTS = ("estimate_position_share", "estimate_velocity_share")


def thrust_ratio(case: Case, points: Sequence[Mapping[str, str]]) -> np.ndarray:
    """Largest thrust over its bound of (5), all axes, of the flights from many starts of the observer.

    Parameters
    ----------
    case : Case
    points : sequence of mapping of str to str
        Parts of the true position and velocity that the estimates start with.

    Returns
    -------
    ndarray, shape (number of points,)
    """
    starts = [(float(point[INPUTS[0]]), float(point[INPUTS[1]])) for point in points]
    return Flights(case, starts).thrust_ratios()


CAMPAIGNS = {"thrust-over-starts": grid_scan(INPUTS, "thrust_ratio", thrust_ratio, 1.0)}
