"""A run of a linear system, declared in one call: what is logged, and which quantities are read off it."""

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from gainsay.errors import InputError, one_of
from gainsay.logs.reader import Log
from gainsay.logs.runs import Measured, RunSpec
from gainsay.logs.writer import LogWriter

if TYPE_CHECKING:
    from gainsay.simulation.linear import Response

#: steps of the second mesh for each of the first, where the fastest mode does not ask for more; and most of them
_SECOND, _MOST = 1.7, 400_000
#: relative rounding of a number; and that of the exponentials, for each radian of the fastest mode
_ROUNDING, _OF_MODE = 1e-12, 8 * float(np.finfo(float).eps)
_METHOD = "matrix exponentials; band: another mesh"

Respond = Callable[[Any, int], "Response"]
Signals = Callable[[Any], Mapping[str, tuple[Mapping[str, str], ArrayLike]]]
Numbers = Callable[[Any, "Response"], Mapping[str, float]]


def linear_run(
    name: str,
    respond: Respond,
    signals: Signals,
    numbers: Numbers,
    *,
    steps: int = 400,
    also: Callable[[Any, LogWriter], None] | None = None,
) -> RunSpec:
    """Declare a run of dx/dt = A x: logged at every step, its quantities computed on two meshes.

    Parameters
    ----------
    name : str
        As paper.toml declares it.
    respond : callable
        ``respond(case, steps)`` returns the `Response`.
    signals : callable
        ``signals(case)`` returns, for each topic, the units of its fields and the matrix C, shape (fields, states), of
        what is logged there: ``{"/control": ({"u": "N"}, -K)}``.
    numbers : callable
        ``numbers(case, response)`` returns quantities by their ids, in SI.
    steps : int, optional
        Of the mesh that is logged. A mesh of 1.7 times as many gives the bands, or a finer one where the fastest mode
        would turn by more than a radian, or fall to less than 1/e, within a step: what the first mesh passes over the
        second one sees.
    also : callable, optional
        ``also(case, log)`` logs bounds and further events.

    Returns
    -------
    RunSpec

    Raises
    ------
    InputError
        When it runs: if a number is no quantity of the step simulation, shapes do not fit, or a mode is so fast that
        no mesh of 400 000 steps follows it.
    """

    def simulate(case: Any, designs: Mapping[str, Any], log: LogWriter) -> None:
        response = respond(case, steps)
        for topic, (units, C) in signals(case).items():
            log.signal(topic, units, response.time, response.states @ np.atleast_2d(C).T)
        turned = float(np.abs(np.linalg.eigvals(response.A)).max()) * response.end
        if turned > _MOST:
            expected = f"a system without modes that turn or decay by more than {_MOST} rad over the run"
            raise InputError(f"run {name}", field="modes", value=turned, expected=expected)
        log.summary("rounding", max(_ROUNDING, _OF_MODE * turned), "1")
        second = numbers(case, respond(case, max(round(_SECOND * steps), math.ceil(turned))))
        for quantity, value in numbers(case, response).items():
            unit = _unit(case, quantity)
            log.summary(_field(quantity), value, unit)
            log.summary(f"{_field(quantity)}_second", second[quantity], unit)
        log.event(0.0, "start", case.paper.runs[name])
        if also is not None:
            also(case, log)

    return RunSpec(name, simulate, _measure)


def _measure(case: Any, log: Log) -> dict[str, Measured]:
    """Read every quantity of the log, with the distance of the two meshes, and rounding, as its band."""
    numbers = {}
    for quantity in (name for name in case.quantities if _field(name) in log.summaries):
        value, second = log.summaries[_field(quantity)], log.summaries[f"{_field(quantity)}_second"]
        band = abs(value - second) + log.summaries["rounding"] * abs(value)
        numbers[quantity] = Measured(value, _METHOD, value - band, value + band)
    return numbers


def _field(quantity: str) -> str:
    return quantity.replace(".", "_").replace("-", "_")


def _unit(case: Any, quantity: str) -> str:
    row = case.quantities.get(quantity)
    if row is None or row.step != "simulation":
        known = [name for name, row in case.quantities.items() if row.step == "simulation"]
        raise InputError(
            "number of a run", value=quantity, expected=f"a quantity of the step simulation, {one_of(quantity, known)}"
        )
    return row.unit
