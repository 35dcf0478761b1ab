"""Rows of what a paper prints, entry by entry, beside what was computed."""

from collections.abc import Iterator, Sequence

import numpy as np

from gainsay.tables.reading import PrintedMatrix


def gain_rows(
    gain: str,
    published: PrintedMatrix,
    resynthesised: np.ndarray | None,
    identified: np.ndarray | None,
    low: np.ndarray | None,
    high: np.ndarray | None,
) -> Iterator[tuple[object, ...]]:
    """Yield the rows of ``gains.csv`` for a gain; parameters as for `Results.gains`."""

    def entry(array: np.ndarray | None, i: int, j: int) -> object:
        return None if array is None else np.asarray(array)[i, j].item()

    computed = (resynthesised, identified, low, high)
    for i, row in enumerate(published.rows):
        for j, printed in enumerate(row):
            rounding = float(printed.low), float(printed.high)
            yield gain, i + 1, j + 1, printed.text, *rounding, *(entry(array, i, j) for array in computed)


def pole_rows(
    name: str, published: PrintedMatrix, recomputed: Sequence[complex], radius: Sequence[float]
) -> Iterator[tuple[object, ...]]:
    """Yield the rows of ``poles.csv`` for published poles; parameters as for `Results.poles`."""
    for number, (row, pole, reach) in enumerate(zip(published.rows, recomputed, radius, strict=True), start=1):
        for part, printed, value in zip(("real", "imaginary"), row, (pole.real, pole.imag), strict=True):
            rounding = float(printed.low), float(printed.high)
            yield name, number, part, printed.text, *rounding, float(value), float(reach)
