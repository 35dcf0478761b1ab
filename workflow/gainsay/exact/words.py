"""Matrix expressions in unknown matrices, for identities that hold whatever the entries and sizes are.

An expression is a block matrix whose blocks are sums of words: products of letters (unknown matrices, their transposes
and inverses) with a rational coefficient and powers of unknown numbers, which commute with everything. A letter beside
its own inverse cancels; a symmetric letter is its own transpose. Two expressions with the same sums of words are equal
for all matrices of the shapes, numbers and inverses in question: a proof for every size at once, short enough to read.

Sums that differ may still be equal (x'Ay and y'A'x are, as blocks of larger words): what is not proved is not refuted.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from gainsay.exact.budget import spend

__all__ = ["Letter", "Words", "WordsError", "identity", "nothing", "stacked"]

#: an unknown with flags: inverse, transposed
Factor = tuple[str, bool, bool]
Word = tuple[Factor, ...]
#: powers of unknown numbers, by name in order
Scalars = tuple[tuple[str, int], ...]
Sum = dict[tuple[Scalars, Word], Fraction]
_MOST_TERMS = 5_000
#: units of work of a product of two words, or of an entry in a sum
_OF_WORD = 2_000


class WordsError(ValueError):
    """An operation that the blocks or the letters do not allow."""


@dataclass(frozen=True)
class Letter:
    """An unknown matrix or, of shape (1, 1), a number.

    Parameters
    ----------
    name : str
    rows, columns : int
    symmetry : int
        1 for its own transpose, -1 for its negative, 0 for neither.
    invertible : bool
        Whether an inverse may be written; of a number, negative powers.
    """

    name: str
    rows: int
    columns: int
    symmetry: int = 0
    invertible: bool = False

    @property
    def is_number(self) -> bool:
        """Whether it commutes with everything."""
        return (self.rows, self.columns) == (1, 1)


@dataclass(frozen=True)
class Words:
    """A block matrix of sums of words.

    Parameters
    ----------
    heights, widths : tuple of int
        Sizes of the block rows and columns.
    blocks : mapping of (int, int) to Sum
        Those that are not zero.
    letters : mapping of str to Letter
    """

    heights: tuple[int, ...]
    widths: tuple[int, ...]
    blocks: Mapping[tuple[int, int], Sum]
    letters: Mapping[str, Letter]

    @classmethod
    def number(cls, value: Fraction, letters: Mapping[str, Letter]) -> "Words":
        """A rational number."""
        return cls((1,), (1,), {(0, 0): {((), ()): value}} if value else {}, letters)

    @classmethod
    def letter(cls, name: str, letters: Mapping[str, Letter]) -> "Words":
        """An unknown."""
        letter = letters[name]
        term: tuple[Scalars, Word] = (((name, 1),), ()) if letter.is_number else ((), ((name, False, False),))
        return cls((letter.rows,), (letter.columns,), {(0, 0): {term: Fraction(1)}}, letters)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return sum(self.heights), sum(self.widths)

    @property
    def is_number(self) -> bool:
        """Whether the shape is (1, 1)."""
        return self.shape == (1, 1)

    @property
    def is_zero(self) -> bool:
        """Whether every sum is empty."""
        return not self.blocks

    def equals(self, other: "Words") -> bool:
        """Whether both are the same sums of words, so that they are equal whatever the letters are."""
        return self.shape == other.shape and (self - other).is_zero

    def __neg__(self) -> "Words":
        return self * Words.number(Fraction(-1), self.letters)

    def __add__(self, other: "Words") -> "Words":
        if self.shape != other.shape:
            raise WordsError(f"a sum of shapes {self.shape} and {other.shape}")
        left, right = _alike(self, other)
        blocks = {place: dict(terms) for place, terms in left.blocks.items()}
        for place, terms in right.blocks.items():
            _add(blocks.setdefault(place, {}), terms)
        return _made(left.heights, left.widths, blocks, self.letters)

    def __sub__(self, other: "Words") -> "Words":
        return self + -other

    def __mul__(self, other: "Words") -> "Words":
        """Product with a number."""
        number, matrix = (self, other) if self.is_number else (other, self)
        if not number.is_number:
            raise WordsError("`*` takes a number; use `@` for matrices")
        factor = number.blocks.get((0, 0), {})
        if any(word for _, word in factor) and not matrix.is_number:
            raise WordsError("a factor that is a product of matrices")
        blocks = {place: _product(factor, terms) for place, terms in matrix.blocks.items()}
        return _made(matrix.heights, matrix.widths, blocks, self.letters)

    def __matmul__(self, other: "Words") -> "Words":
        if self.shape[1] != other.shape[0]:
            raise WordsError(f"a product of shapes {self.shape} and {other.shape}")
        left, right = self, other
        while left.widths != right.heights:
            inner = _common(left.widths, right.heights)
            left, right = left.split(left.heights, inner), right.split(inner, right.widths)
        blocks: dict[tuple[int, int], Sum] = {}
        for (i, k), first in left.blocks.items():
            for (m, j), second in right.blocks.items():
                if k != m:
                    continue
                _add(blocks.setdefault((i, j), {}), _product(first, second))
        return _made(left.heights, right.widths, blocks, self.letters)

    @property
    def T(self) -> "Words":
        """The transpose."""
        blocks = {}
        for (i, j), terms in self.blocks.items():
            turned: Sum = {}
            for (scalars, word), coefficient in terms.items():
                sign, back = _transposed(word, self.letters)
                turned[scalars, back] = turned.get((scalars, back), Fraction(0)) + sign * coefficient
            blocks[j, i] = turned
        return _made(self.widths, self.heights, blocks, self.letters)

    def inverse(self) -> "Words":
        """Inverse of a number, of a letter with a factor, or of a block diagonal of these.

        Raises
        ------
        WordsError
            If it is anything else, or a letter is not said to be invertible.
        """
        blocks: dict[tuple[int, int], Sum] = {}
        if self.heights != self.widths or set(self.blocks) != {(i, i) for i in range(len(self.heights))}:
            raise WordsError("inverse of what is not a block diagonal of numbers and letters")
        for place, terms in self.blocks.items():
            if len(terms) != 1:
                raise WordsError("inverse of a sum")
            ((scalars, word), coefficient) = next(iter(terms.items()))
            for name in (*(name for name, _ in scalars), *(name for name, _, _ in word)):
                if not self.letters[name].invertible:
                    raise WordsError(f"inverse of {name!r}, which is not said to be invertible")
            back = tuple((name, not inverse, turned) for name, inverse, turned in reversed(word))
            blocks[place] = {(tuple((name, -power) for name, power in scalars), back): 1 / coefficient}
        return _made(self.heights, self.widths, blocks, self.letters)

    def monomial(self) -> tuple[Scalars, Fraction] | None:
        """Powers and coefficient of a number that is one product; None of anything else."""
        terms = self.blocks.get((0, 0), {})
        if not self.is_number or len(terms) != 1:
            return None
        ((scalars, word), coefficient) = next(iter(terms.items()))
        return None if word else (scalars, coefficient)

    def split(self, heights: Sequence[int], widths: Sequence[int]) -> "Words":
        """The same matrix in blocks at least as small: zeros and multiples of the identity are split, words cannot be.

        A multiple of the identity is split in rows and columns alike, so that the blocks may come out smaller than
        asked for.
        """
        heights, widths = self._even(tuple(heights), tuple(widths))
        rows, columns = _parts(self.heights, heights), _parts(self.widths, widths)
        blocks: dict[tuple[int, int], Sum] = {}
        for (i, j), terms in self.blocks.items():
            if len(rows[i]) == len(columns[j]) == 1:
                blocks[rows[i][0], columns[j][0]] = terms
            elif any(word for _, word in terms):
                raise WordsError("a block that would have to be cut: write it in the blocks of its neighbours")
            else:
                blocks |= dict.fromkeys(zip(rows[i], columns[j], strict=True), terms)
        return Words(heights, widths, blocks, self.letters)

    def _even(self, heights: tuple[int, ...], widths: tuple[int, ...]) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Sizes of blocks that cut rows and columns of every multiple of the identity alike."""
        while True:
            rows, columns = _parts(self.heights, heights), _parts(self.widths, widths)
            for (i, j), terms in self.blocks.items():
                down, across = [heights[p] for p in rows[i]], [widths[q] for q in columns[j]]
                if down != across and not any(word for _, word in terms):
                    both = _common(down, across)
                    heights = (*heights[: rows[i][0]], *both, *heights[rows[i][-1] + 1 :])
                    widths = (*widths[: columns[j][0]], *both, *widths[columns[j][-1] + 1 :])
                    break
            else:
                return heights, widths


def _alike(one: Words, other: Words) -> tuple[Words, Words]:
    """Both in the same blocks."""
    while (one.heights, one.widths) != (other.heights, other.widths):
        heights, widths = _common(one.heights, other.heights), _common(one.widths, other.widths)
        one, other = one.split(heights, widths), other.split(heights, widths)
    return one, other


def identity(size: int, letters: Mapping[str, Letter]) -> Words:
    """The identity."""
    return Words((size,), (size,), {(0, 0): {((), ()): Fraction(1)}}, letters)


def nothing(rows: int, columns: int, letters: Mapping[str, Letter]) -> Words:
    """The zero matrix."""
    return Words((rows,), (columns,), {}, letters)


def stacked(rows: Sequence[Sequence[Words | None]], letters: Mapping[str, Letter]) -> Words:
    """Block matrix; None is the transpose of the block across the diagonal, the number zero fills a block of any size.

    Raises
    ------
    WordsError
        If the blocks do not fit, or a star has no block across the diagonal.
    """
    if len({len(row) for row in rows}) != 1:
        raise WordsError("block rows of different lengths")
    cells: list[list[Words]] = []
    for i, row in enumerate(rows):
        cells.append([])
        for j, cell in enumerate(row):
            mirrored = rows[j][i] if cell is None and j < len(rows) and i < len(rows[j]) else None
            chosen = mirrored.T if mirrored is not None else cell
            if chosen is None:
                raise WordsError("a star without a block across the diagonal")
            cells[i].append(chosen)

    def fills(cell: Words) -> bool:
        return cell.is_number and cell.is_zero

    def size(line: Iterable[Words], side: int) -> int:
        sizes = {cell.shape[side] for cell in line if not fills(cell)} or {1}
        if len(sizes) != 1:
            raise WordsError(f"blocks of sizes {', '.join(map(str, sorted(sizes)))} beside each other do not fit")
        return sizes.pop()

    heights = [size(row, 0) for row in cells]
    widths = [size(column, 1) for column in zip(*cells, strict=True)]
    total = nothing(sum(heights), sum(widths), letters)
    for i, row in enumerate(cells):
        for j, cell in enumerate(row):
            if not fills(cell):
                down = (*heights[:i], *cell.heights, *heights[i + 1 :])
                across = (*widths[:j], *cell.widths, *widths[j + 1 :])
                total = total + Words(down, across, {(i + p, j + q): t for (p, q), t in cell.blocks.items()}, letters)
    return total


def _made(
    heights: tuple[int, ...], widths: tuple[int, ...], blocks: Mapping[tuple[int, int], Sum], letters: Mapping
) -> Words:
    kept: dict[tuple[int, int], Sum] = {}
    for (i, j), terms in blocks.items():
        if heights[i] == widths[j] == 1:
            terms = _as_number(terms, letters)
        left = {term: value for term, value in terms.items() if value}
        if len(left) > _MOST_TERMS:
            raise WordsError(f"a sum of {len(left)} words: at most {_MOST_TERMS}")
        if left:
            kept[i, j] = left
    return Words(heights, widths, kept, letters)


def _as_number(terms: Sum, letters: Mapping[str, Letter]) -> Sum:
    """A number is its own transpose: of a word and its transpose the first in order stands for both."""
    result: Sum = {}
    for (scalars, word), value in terms.items():
        sign, back = _transposed(word, letters)
        chosen, factor = (word, 1) if word <= back else (back, sign)
        if word == back and sign < 0:
            continue  # equal to its own negative
        result[scalars, chosen] = result.get((scalars, chosen), Fraction(0)) + factor * value
    return result


def _transposed(word: Word, letters: Mapping[str, Letter]) -> tuple[int, Word]:
    sign, back = 1, []
    for name, inverse, turned in reversed(word):
        symmetry = letters[name].symmetry
        sign *= symmetry or 1
        back.append((name, inverse, turned if symmetry else not turned))
    return sign, tuple(back)


def _joined(left: tuple[Scalars, Word], right: tuple[Scalars, Word]) -> tuple[Scalars, Word]:
    powers = dict(left[0])
    for name, power in right[0]:
        powers[name] = powers.get(name, 0) + power
    word = list(left[1])
    for factor in right[1]:
        if word and word[-1] == (factor[0], not factor[1], factor[2]):
            word.pop()
        else:
            word.append(factor)
    return tuple(sorted((n, p) for n, p in powers.items() if p)), tuple(word)


def _product(left: Sum, right: Sum) -> Sum:
    """Products of every word of one sum with every word of the other."""
    spend(_OF_WORD * len(left) * len(right), "a product of sums of words")
    result: Sum = {}
    for a, p in left.items():
        for b, q in right.items():
            term = _joined(a, b)
            result[term] = result.get(term, Fraction(0)) + p * q
    return result


def _add(whole: Sum, terms: Sum) -> None:
    """Add words to a sum, in place."""
    spend(_OF_WORD * len(terms), "a sum of words")
    for term, coefficient in terms.items():
        whole[term] = whole.get(term, Fraction(0)) + coefficient


def _common(one: Sequence[int], other: Sequence[int]) -> tuple[int, ...]:
    """Common refinement of two partitions of the same size."""
    if sum(one) != sum(other):
        raise WordsError(f"blocks of sizes {tuple(one)} and {tuple(other)} do not fit")
    ends = sorted({sum(sizes[: k + 1]) for sizes in (one, other) for k in range(len(sizes))})
    return tuple(end - start for start, end in zip([0, *ends[:-1]], ends, strict=True))


def _parts(coarse: Sequence[int], fine: Sequence[int]) -> list[list[int]]:
    """Numbers of the fine blocks that make up each coarse one."""
    result: list[list[int]] = []
    k = 0
    for size in coarse:
        own: list[int] = []
        while sum(fine[m] for m in own) < size:
            own.append(k)
            k += 1
        if sum(fine[m] for m in own) != size:
            raise WordsError("blocks that do not fit")
        result.append(own)
    return result
