"""Block matrices with named blocks, and boxes and equations entry by entry."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from gainsay.errors import InputError
from gainsay.lmi.affine import Affine, Definite, Entrywise, Equal, Variable, affine


def within(expression: Any, low: Any, high: Any, label: str) -> tuple[Entrywise, Entrywise]:
    """Keep every entry between `low` and `high` (arrays of the same shape): the box of printed digits."""
    read = affine(expression)
    return (
        Entrywise(f"{label} lower", read - np.asarray(low, dtype=float)),
        Entrywise(f"{label} upper", np.asarray(high, dtype=float) - read),
    )


def equal(left: Any, right: Any, label: str) -> Equal:
    """Ask for ``left = right`` entry by entry; 0 stands for the zero matrix."""
    return Equal(label, affine(left) - right)


class BlockMatrix:
    """A symmetric block matrix, filled block by block as a paper prints it.

    Blocks below the diagonal are induced by symmetry; blocks never set are zero. ``F < 0`` makes a constraint.

    Parameters
    ----------
    label : str
        Where it stands in the paper, such as ``"(14)"``.
    *names : str
        Names of the block rows, in the printed order.
    **sizes : int
        Sizes of block rows that no block sets.
    """

    __array_ufunc__ = None

    def __init__(self, label: str, *names: str, **sizes: int) -> None:
        if len(set(names)) != len(names) or not names:
            raise InputError("block rows", field=label, value=names, expected="different names")
        self.label, self.names = label, names
        self._sizes = dict(sizes)
        self._blocks: dict[tuple[str, str], Affine] = {}

    def __setitem__(self, place: tuple[str, str], block: Any) -> None:
        """Set a block; an unknown row or a size that does not fit raises InputError."""
        row, column = place
        read = affine(block)
        for name, size in zip(place, read.shape, strict=True):
            if name not in self.names:
                raise InputError("block row", field=self.label, value=name, expected=" | ".join(self.names))
            if self._sizes.setdefault(name, size) != size:
                raise InputError(
                    f"block {row},{column}", field=self.label, value=read.shape, expected=f"{name}={self._sizes[name]}"
                )
        if self.names.index(row) > self.names.index(column):
            row, column, read = column, row, read.T
        self._blocks[row, column] = read

    def __getitem__(self, place: tuple[str, str]) -> Affine:
        """Return one block, below the diagonal as the transpose."""
        row, column = place
        sizes = dict(self.sizes)
        for name in place:
            if name not in sizes:
                raise InputError("block row", field=self.label, value=name, expected=" | ".join(self.names))
        if (row, column) in self._blocks:
            return self._blocks[row, column]
        if (column, row) in self._blocks:
            return self._blocks[column, row].T
        return affine(np.zeros((sizes[row], sizes[column])))

    @property
    def sizes(self) -> tuple[tuple[str, int], ...]:
        """Names and sizes of the block rows; a row whose size nothing sets raises InputError."""
        for name in self.names:
            if name not in self._sizes:
                raise InputError("size of a block row", field=self.label, value=name, expected="a block or a size")
        return tuple((name, self._sizes[name]) for name in self.names)

    @property
    def assembled(self) -> Affine:
        """The whole matrix as one expression."""
        place, total = {}, 0
        for name, size in self.sizes:
            place[name] = slice(total, total + size)
            total += size
        constant = np.zeros((total, total))
        terms: dict[Variable, np.ndarray] = {}
        for (row, column), block in self._blocks.items():
            for r, c, part in ((row, column, block), (column, row, block.T))[: 1 if row == column else 2]:
                constant[place[r], place[c]] = part.constant
                for variable, coefficient in part.terms.items():
                    if variable not in terms:
                        terms[variable] = np.zeros((total, total, variable.size))
                    terms[variable][place[r], place[c]] = coefficient
        return Affine(constant, terms)

    def sub(self, *names: str, label: str | None = None) -> "BlockMatrix":
        """Return the principal part of the named block rows, in the order given."""
        part = BlockMatrix(label or self.label, *names, **{n: s for n, s in self.sizes if n in names})
        for i, row in enumerate(names):
            for column in names[i:]:
                if (row, column) in self._blocks or (column, row) in self._blocks:
                    part[row, column] = self[row, column]
        return part

    def differences(self, other: "BlockMatrix", tolerance: float = 0.0) -> tuple[tuple[str, str, float], ...]:
        """Compare block by block with another block matrix of the same rows and the same unknowns.

        Returns
        -------
        tuple of (row, column, size)
            Blocks on or above the diagonal whose coefficients differ by more than `tolerance`, and by how much.
        """
        if self.sizes != other.sizes:
            raise InputError("block rows differ", field=self.label, value=other.sizes, expected=str(self.sizes))
        places = []
        for i, row in enumerate(self.names):
            for column in self.names[i:]:
                gap = self[row, column] - other[row, column]
                size = max([np.abs(gap.constant).max(), *(np.abs(c).max() for c in gap.terms.values())])
                if size > tolerance:
                    places.append((row, column, float(size)))
        return tuple(places)

    def value(self, values: Any) -> np.ndarray:
        """Evaluate the whole matrix in floats; see `Affine.value`."""
        return self.assembled.value(values)

    def __lt__(self, other: Any) -> Definite:
        return Definite.difference(other, self, strict=True)

    def __gt__(self, other: Any) -> Definite:
        return Definite.difference(self, other, strict=True)

    def __le__(self, other: Any) -> Definite:
        return Definite.difference(other, self, strict=False)

    def __ge__(self, other: Any) -> Definite:
        return Definite.difference(self, other, strict=False)

    def __neg__(self) -> "BlockMatrix":
        part = BlockMatrix(f"-{self.label}", *self.names, **dict(self.sizes))
        for (row, column), block in self._blocks.items():
            part[row, column] = -block
        return part


def block_diagonal(*blocks: Any) -> Affine:
    """Return the block-diagonal matrix of the given expressions."""
    names: Sequence[str] = [f"b{i}" for i in range(len(blocks))]
    whole = BlockMatrix("diagonal", *names)
    for name, block in zip(names, blocks, strict=True):
        whole[name, name] = block
    return whole.assembled
