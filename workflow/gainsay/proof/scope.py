"""What a certificate's formulas see: the tables (recorded as they are read), definitions, unknowns and witness."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Protocol

from flint import arb, arb_mat, fmpq_mpoly_ctx

from gainsay.errors import CertificateError, GainsayError
from gainsay.exact.ball import ball, hull
from gainsay.exact.matrix import Matrix, RingError
from gainsay.exact.rational import exact, rational_matrix, to_text
from gainsay.proof import formulas
from gainsay.proof.certificate import Certificate

__all__ = ["CaseTables", "MappingTables", "Reader", "Scope", "Tables", "adapted"]

#: entries of all unknowns of a certificate together
MOST_ENTRIES = 4_000
STRUCTURES = ("symmetric", "full", "diagonal", "skew")


class Tables(Protocol):
    """What a certificate is checked against, under the name of its paper; `gainsay.tables.Case` is one."""

    @property
    def name(self) -> str:
        """Name of the paper."""

    def exact(self, name: str) -> Fraction:
        """Parameter in SI."""

    def plausible(self, name: str) -> tuple[Fraction, Fraction]:
        """Ends of the plausible range of a number that the paper leaves out, in SI."""

    def printed(self, name: str) -> Any:
        """Printed matrix, with `.exact` and `.half_units`, tuples of rows of `Fraction`."""

    def design(self, name: str, entry: str) -> Any:
        """Matrix of a design: rows of floats or exact numbers."""


class _Printed:
    def __init__(self, rows: Sequence[Sequence[object]], half_units: Sequence[Sequence[object]] | None) -> None:
        self.exact = tuple(tuple(exact(x) for x in row) for row in rows)
        halves = half_units if half_units is not None else [[_half_unit(x) for x in row] for row in rows]
        self.half_units = tuple(tuple(exact(x) for x in row) for row in halves)


def _half_unit(value: object) -> Fraction:
    """Half a unit of the last digit of a decimal text."""
    mantissa, _, power = str(value).lower().partition("e")
    places = len(mantissa.partition(".")[2])
    return Fraction(1, 2) * Fraction(10) ** (int(power or 0) - places)


class MappingTables:
    """Tables from plain mappings, for builders and tests.

    Parameters
    ----------
    numbers : mapping of str to exact number
    printed : mapping of str to rows of decimal texts
    designs : mapping of (name, entry) to rows of floats
    name : str
        Of the paper.
    ranges : mapping of str to two exact numbers
        Plausible values.
    """

    def __init__(
        self,
        numbers: Mapping[str, object] | None = None,
        printed: Mapping[str, Sequence[Sequence[str]]] | None = None,
        designs: Mapping[tuple[str, str], Any] | None = None,
        name: str = "tables",
        ranges: Mapping[str, tuple[object, object]] | None = None,
    ) -> None:
        self.name = name
        self._numbers, self._printed = dict(numbers or {}), dict(printed or {})
        self._designs, self._ranges = dict(designs or {}), dict(ranges or {})

    def exact(self, name: str) -> Fraction:
        """Parameter in SI."""
        return exact(self._numbers[name])

    def plausible(self, name: str) -> tuple[Fraction, Fraction]:
        """Ends of a plausible range."""
        low, high = self._ranges[name]
        return exact(low), exact(high)

    def printed(self, name: str) -> Any:
        """Printed matrix."""
        return _Printed(self._printed[name], None)

    def design(self, name: str, entry: str) -> Any:
        """Rows of a design's matrix."""
        return self._designs[(name, entry)]


class CaseTables:
    """A paper's tables and designs as the checker reads them."""

    def __init__(self, case: Any) -> None:
        self.case, self.name = case, str(case.name)

    def exact(self, name: str) -> Fraction:
        """Parameter in SI."""
        return self.case.exact(name)

    def plausible(self, name: str) -> tuple[Fraction, Fraction]:
        """Ends of the plausible range of a number that the paper leaves out, in SI."""
        return self.case.plausible(name)

    def printed(self, name: str) -> Any:
        """Printed matrix."""
        return self.case.printed(name)

    def design(self, name: str, entry: str) -> Any:
        """Rows of a design's matrix; no file is read but that of a design which the paper declares."""
        return self.case.designs[name].exact(entry)

    def has_quantity(self, name: str) -> bool:
        """Whether the quantity is declared."""
        return name in self.case.quantities

    def requirements(self, quantity: str) -> frozenset[str]:
        """What is required where a quantity is a level of uncertainty, each as in ``gamma=gamma_max``."""
        return self.case.quantities[quantity].requirements


def adapted(tables: Any) -> Tables:
    """Tables as formulas read them, of a case or of what is such tables already."""
    return CaseTables(tables) if hasattr(tables, "quantities") else tables


class Reader:
    """Reads tables for formulas and records every value read, as text."""

    def __init__(self, tables: Tables, owner: str) -> None:
        self.tables, self.owner = adapted(tables), owner
        self.data: dict[str, dict[str, Any]] = {}

    def _read(self, what: str, name: str, read: Any) -> Any:
        try:
            return read()
        except GainsayError as error:
            raise CertificateError(f"{self.owner}: {what} {name!r}: {error}") from error
        except (KeyError, LookupError, AttributeError, TypeError, ValueError, OSError) as error:
            raise CertificateError(f"{self.owner}: the tables have no {what} {name[:80]!r} that can be read") from error

    def _record(self, group: str, name: str, value: Any) -> None:
        self.data.setdefault(group, {})[name] = value

    def number(self, name: str) -> Matrix:
        """Parameter in SI."""
        value = self._read("parameter", name, lambda: exact(self.tables.exact(name)))
        self._record("number", name, to_text(value))
        return Matrix.number(value)

    def plausible(self, name: str) -> Matrix:
        """Every plausible value of a number that the paper leaves out, as a ball."""
        return Matrix.number(hull(*self._range(name)))

    def ends(self, name: str) -> Matrix:
        """Row of its least and its greatest plausible value."""
        return Matrix(rational_matrix([self._range(name)]))

    def _range(self, name: str) -> tuple[Fraction, Fraction]:
        low, high = self._read("plausible range", name, lambda: tuple(map(exact, self.tables.plausible(name))))
        self._record("plausible", name, f"{to_text(low)}..{to_text(high)}")
        return low, high

    def printed(self, name: str) -> Matrix:
        """Matrix as printed."""
        rows = self._read("printed matrix", name, lambda: self.tables.printed(name).exact)
        self._record("printed", name, [[to_text(x) for x in row] for row in rows])
        return Matrix(rational_matrix(rows))

    def half_units(self, name: str) -> Matrix:
        """Half units of the last printed digits."""
        rows = self._read("printed matrix", name, lambda: self.tables.printed(name).half_units)
        self._record("half_units", name, [[to_text(x) for x in row] for row in rows])
        return Matrix(rational_matrix(rows))

    def box(self, name: str) -> Matrix:
        """Every matrix that rounds to the printed digits, as balls."""
        middle, half = self.printed(name), self.half_units(name)
        lines = zip(middle.rows(), half.rows(), strict=True)
        return Matrix(arb_mat([[_box(x, h) for x, h in zip(p, q, strict=True)] for p, q in lines]))

    def design(self, name: str, entry: str) -> Matrix:
        """Matrix of a design, the binary numbers as they are."""
        read = self._read("design", f"{name}.{entry}", lambda: _rows(self.tables.design(name, entry)))
        self._record(
            "design", f"{name}.{entry}", [[repr(x) if isinstance(x, float) else to_text(x) for x in r] for r in read]
        )
        return Matrix(rational_matrix(read))


def _box(middle: object, half: object) -> arb:
    return ball(middle, half)


def _rows(values: Any) -> list[list[object]]:
    listed = values.tolist() if hasattr(values, "tolist") else values
    if not isinstance(listed, Sequence) or isinstance(listed, str):
        return [[listed]]
    return [list(row) if isinstance(row, Sequence) and not isinstance(row, str) else [row] for row in listed]


class Scope:
    """Evaluates the formulas of one certificate.

    Parameters
    ----------
    certificate : Certificate
    tables : Tables
    """

    def __init__(self, certificate: Certificate, tables: Tables) -> None:
        self.certificate = certificate
        self.reader = Reader(tables, certificate.id)
        self.names: dict[str, Matrix] = {}
        self.context: Any = None
        for name in certificate.unknowns:
            self._check_name(name)

    def fail(self, message: object) -> CertificateError:
        """An error that names the certificate."""
        return CertificateError(f"{self.certificate.id}: {message}".replace("\n", " "))

    def field(self, name: str, default: Any = None) -> Any:
        """Field of the kind; refused if it is missing and has no default."""
        value = self.certificate.fields.get(name, default)
        if value is None:
            raise self.fail(f"field {name!r} is missing")
        return value

    def fields_fit(self, *groups: tuple[str | tuple[str, ...], ...]) -> None:
        """Refuse fields of which a kind would use some and pass over others: each group is given whole or not at all.

        A group whose last member is in brackets lists fields that may be left out: ``("H", "Cz", ("Dw",))``.
        """
        for group in groups:
            mandatory = [name for name in group if isinstance(name, str)]
            free = [name for part in group if not isinstance(part, str) for name in part]
            given = [name for name in (*mandatory, *free) if name in self.certificate.fields]
            missing = [name for name in mandatory if name not in self.certificate.fields]
            if given and missing:
                raise self.fail(f"field {given[0]!r} is given without {', '.join(map(repr, missing))}")

    def define(self) -> None:
        """Evaluate the definitions in order; unknowns must be bound before."""
        for name, text in self.certificate.definitions:
            self._check_name(name)
            if name in self.names or name in self.certificate.unknowns:
                raise self.fail(f"the name {name!r} is defined twice")
            self.names[name] = self.evaluate(text)

    def bind(self, name: str, value: Matrix) -> None:
        """Give a name a value before the definitions, which may not define it again."""
        self._check_name(name)
        self.names[name] = value

    def _check_name(self, name: str) -> None:
        try:
            formulas.check_name(name)
        except CertificateError as error:
            raise self.fail(error) from error

    def evaluate(self, text: str) -> Matrix:
        """Value of a formula."""
        try:
            return formulas.evaluate(text, self.names, self.reader)
        except CertificateError as error:
            raise self.fail(error) from error

    def constraint(self, text: str) -> tuple[Matrix, str]:
        """Difference and relation of a constraint."""
        try:
            return formulas.constraint(text, self.names, self.reader)
        except CertificateError as error:
            raise self.fail(error) from error

    def number(self, text: object) -> Fraction:
        """Exact value of a formula that is a rational number."""
        try:
            return self.evaluate(str(text)).value()
        except RingError as error:
            raise self.fail(f"{text!r}: {error}") from error

    def witness(self, name: str, shape: tuple[int, int] | None = None) -> Matrix:
        """Matrix of the witness, exact."""
        if name not in self.certificate.witness:
            raise self.fail(f"witness {name!r} is missing")
        rows = self.certificate.witness[name]
        if isinstance(rows, str):
            rows = [[rows]]
        if not isinstance(rows, list) or any(
            not isinstance(r, list) or any(not isinstance(x, str) for x in r) for r in rows
        ):
            raise self.fail(f"witness {name!r}: expected rows of exact texts")
        try:
            value = Matrix(rational_matrix(rows))
        except ValueError as error:
            raise self.fail(f"witness {name!r}: {error}") from error
        if shape is not None and value.shape != tuple(shape):
            raise self.fail(f"witness {name!r} has shape {value.shape}, expected {tuple(shape)}")
        return value

    def symmetric_witness(self, name: str, size: int) -> Matrix:
        """Symmetric matrix of the witness."""
        value = self.witness(name, (size, size))
        if not value.equals(value.T):
            raise self.fail(f"witness {name!r} is not symmetric")
        return value

    def unknown_shapes(self) -> dict[str, tuple[tuple[int, int], str]]:
        """Shape and structure of each unknown, in the order of their names."""
        result: dict[str, tuple[tuple[int, int], str]] = {}
        count = 0
        for name in sorted(self.certificate.unknowns):
            raw = self.certificate.unknowns[name]
            if not isinstance(raw, Mapping) or not set(raw) <= {"shape", "structure"}:
                raise self.fail(f"unknown {name!r}: expected a shape and a structure")
            shape, structure = raw.get("shape", [1, 1]), raw.get("structure", "full")
            sizes_fit = (
                isinstance(shape, list | tuple) and len(shape) == 2 and all(type(k) is int and k > 0 for k in shape)
            )
            if not sizes_fit or structure not in STRUCTURES:
                raise self.fail(f"unknown {name!r}: expected a shape [m, n] and a structure of {', '.join(STRUCTURES)}")
            if structure != "full" and shape[0] != shape[1]:
                raise self.fail(f"unknown {name!r}: {structure} and not square")
            result[name] = ((shape[0], shape[1]), structure)
            count += shape[0] * shape[1]
            if count > MOST_ENTRIES:
                raise self.fail(f"unknowns of more than {MOST_ENTRIES} entries")
        return result

    def bind_witness(self) -> None:
        """Give every unknown the value that the witness has for it."""
        for name, (shape, structure) in self.unknown_shapes().items():
            value = self.witness(name, shape)
            if not has_structure(value, structure):
                raise self.fail(f"witness {name!r} is not {structure}")
            self.names[name] = value

    def bind_indeterminates(self) -> None:
        """Let the entries of every unknown be indeterminates of one polynomial ring."""
        shapes = self.unknown_shapes()
        entries = {name: positions(shape, structure) for name, (shape, structure) in shapes.items()}
        variables = [f"{name}_{i}_{j}" for name, places in entries.items() for i, j in places]
        if not variables:
            return
        self.context = fmpq_mpoly_ctx.get(variables)
        generators = iter(self.context.gens())
        zero = self.context.constant(0)
        for name, ((m, n), structure) in shapes.items():
            rows = [[zero] * n for _ in range(m)]
            for i, j in entries[name]:
                generator = next(generators)
                rows[i][j] = generator
                if structure in ("symmetric", "skew") and i != j:
                    rows[j][i] = generator if structure == "symmetric" else -generator
            self.names[name] = Matrix(rows)


def positions(shape: tuple[int, int], structure: str) -> list[tuple[int, int]]:
    """Places of the independent entries of a matrix of that structure."""
    m, n = shape
    keep = {
        "full": lambda i, j: True,
        "symmetric": lambda i, j: i <= j,
        "diagonal": lambda i, j: i == j,
        "skew": lambda i, j: i < j,
    }[structure]
    return [(i, j) for i in range(m) for j in range(n) if keep(i, j)]


def has_structure(value: Matrix, structure: str) -> bool:
    """Whether a rational matrix has that structure."""
    if structure == "symmetric":
        return value.equals(value.T)
    if structure == "skew":
        return value.equals(-value.T)
    if structure == "diagonal":
        return all(x == 0 for i, row in enumerate(value.rows()) for j, x in enumerate(row) if i != j)
    return True
