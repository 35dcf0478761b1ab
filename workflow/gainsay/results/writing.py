"""What a step writes: quantities, certificates, gains, scans and failures, each file whole or not at all."""

import math
import os
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol, TypeVar

import numpy as np

from gainsay.errors import ComputationError, GainsayError, InputError, one_of
from gainsay.exact.rational import doubles_around
from gainsay.results.broken import place_of
from gainsay.results.ends import proved_numbers
from gainsay.results.listing import derived_listing, write_listing
from gainsay.results.published_rows import gain_rows, pole_rows
from gainsay.results.returned import FROM_DIGITS, PARTS, UNDECIDED, read_returned
from gainsay.tables.case import Case
from gainsay.tables.files import remove_abandoned, write_atomically, write_csv, write_json
from gainsay.tables.reading import PrintedMatrix
from gainsay.tables.reads import apart, recording

#: whether every line of a step's log is printed too (GAINSAY_VERBOSE=1), as one wants it who works on a paper
VERBOSE = os.environ.get("GAINSAY_VERBOSE", "") not in ("", "0")


class Attempted(Protocol):
    """An outcome that remembers what was attempted."""

    @property
    def attempts(self) -> Sequence[Any]:
        """One a run of a solver."""


Outcome = TypeVar("Outcome", bound=Attempted)


def _listed(value: object) -> object:
    """Write what JSON does not know: arrays as lists, anything else by its text; a note must never stop a step."""
    return value.tolist() if hasattr(value, "tolist") else str(value)


class Results:
    """Collects what a step of a paper finds and writes it when the step ends.

    Parameters
    ----------
    case : Case
    step : str
        One of `STEPS`.
    verify : callable, optional
        Takes a certificate and raises where it proves nothing; given by the step, which knows the checker.
    """

    def __init__(self, case: Case, step: str, verify: Callable[[Any], object] | None = None) -> None:
        self.case, self.step, self._verify = case, step, verify
        self._rows: dict[str, list[Sequence[object]]] = {part: [] for part in PARTS}
        self._seen: set[str] = set()
        self._reads: set[str] = set()
        self._attempts: list[dict[str, object]] = []
        self._written: dict[str, str] = {}
        self._lines: list[str] = []
        self._said = False
        self._begun = time.perf_counter()
        self._clock = time.perf_counter()
        self._forget_earlier_files()

    def _listing(self) -> Path:
        return self.case.results / "parts" / f"{self.step}.files.csv"

    def _kept_listing(self) -> Path:
        """The list once more, where Snakemake does not delete it before the step begins."""
        return self.case.results / "attempts" / self._listing().name

    def _forget_earlier_files(self) -> None:
        """Delete what an earlier run of the step left, so that an interrupted step does not look like a done one."""
        remove_abandoned(self.case.results)
        for listing in (self._listing(), self._kept_listing()):
            with suppress(InputError):  # a list that is damaged names no file for sure
                for row in read_returned(listing, self.case.root):
                    (self.case.results / row["file"]).unlink(missing_ok=True)
        self._listing().unlink(missing_ok=True)
        derived_listing(self._listing(), self.case.results).unlink(missing_ok=True)
        for part in PARTS:
            (self.case.results / "parts" / f"{self.step}.{part}.csv").unlink(missing_ok=True)

    def _is_table(self, file: str | Path | None) -> bool:
        return file is not None and str(file).replace(f"{self.case.root}/", "").startswith("papers/")

    def _discard(self) -> None:
        for file in self._written:
            (self.case.results / file).unlink(missing_ok=True)

    def _file(self, relative: str) -> Path:
        if relative in self._written:
            raise ComputationError(relative, "written twice")
        self._written[relative] = ""
        return self.case.results / relative

    def list_file(self, relative: str, *, of: str = "") -> None:
        """List a file that the step has written by other means: a log, a figure, a view.

        Parameters
        ----------
        relative : str
            Below the paper's results.
        of : str, optional
            The file it is made of and held against too, where its own bytes are never the same twice.
        """
        self._file(relative)
        self._written[relative] = of

    def quantity(
        self,
        quantity: str,
        value: float,
        *,
        method: str,
        source: str = "",
        lower: float | None = None,
        upper: float | None = None,
    ) -> None:
        """Add a computed number.

        Parameters
        ----------
        quantity : str
            An id declared in the paper's quantities.csv.
        value : float
            In the declared unit.
        method : str
            How it was computed, one line.
        source : str, optional
            Equation, sentence or file behind it.
        lower, upper : float, optional
            A proved or numerical enclosure.

        Raises
        ------
        ComputationError
            If the id is not declared for this step, was given already, or a number is not finite.
        """
        numbers = [float(x) for x in (value, lower, upper) if x is not None]
        if not all(math.isfinite(x) for x in numbers):
            raise ComputationError(quantity, f"not finite: {numbers}")
        if (lower is not None and lower > value) or (upper is not None and upper < value):
            raise ComputationError(quantity, f"{value} outside its own enclosure {lower}..{upper}")
        unit = self._declared(quantity)
        ends = [None if x is None else float(x) for x in (lower, upper)]
        self._rows["quantities"].append((quantity, float(value), unit, *ends, method, source))

    def enclosed(
        self,
        quantity: str,
        low: Fraction,
        high: Fraction,
        *,
        method: str,
        source: str = "",
        value: float | None = None,
        digits: bool = False,
    ) -> None:
        """Add a number by its enclosure.

        Parameters
        ----------
        quantity : str
            An id declared in the paper's quantities.csv.
        low, high : Fraction
            Exact ends, in the declared unit.
        method, source : str
            As in `quantity`.
        value : float, optional
            By default the double nearest to the middle.
        digits : bool
            Whether the enclosure carries the rounding of what the paper prints, so that every value in it is one of
            which the paper may speak.
        """
        lower, upper = doubles_around(low, high)
        method = f"{FROM_DIGITS} {method}" if digits else method
        value = float((low + high) / 2) if value is None else value
        self.quantity(quantity, value, method=method, source=source, lower=lower, upper=upper)

    def _declared(self, quantity: str) -> str:
        """Unit of a quantity that this step is to compute, once."""
        declared = self.case.quantities.get(quantity)
        if declared is None or declared.step != self.step:
            own = [name for name, row in self.case.quantities.items() if row.step == self.step]
            known = one_of(quantity, own)
            raise ComputationError(quantity, f"not declared for the step {self.step} in quantities.csv, {known}")
        if quantity in self._seen:
            raise ComputationError(quantity, "computed twice")
        self._seen.add(quantity)
        self._note_reads(quantity, self._reads, "read")
        return declared.unit

    def _note_reads(self, quantity: str, names: Iterable[str], how: str) -> None:
        rows = ((quantity, name, how) for name in sorted(names))
        self._rows["reads"] += [row for row in rows if row not in self._rows["reads"]]

    @contextmanager
    def apart(self) -> Iterator[None]:
        """Record what is read of what the paper leaves out for the quantities and scans written inside alone.

        What is read inside is not held against quantities written after it: none of them may depend on a value that was
        computed here.
        """
        before = self._reads
        try:
            with apart(before) as self._reads:
                yield
        finally:
            self._reads = before

    def measured(self, measures: Mapping[str, Any], source: str) -> None:
        """Add quantities measured from a log: id -> value, method, lower and upper."""
        for quantity, number in measures.items():
            self.quantity(
                quantity, number.value, method=number.method, source=source, lower=number.lower, upper=number.upper
            )

    def certificate(self, certificate: Any) -> None:
        """Write a certificate, once the checker has accepted it.

        Raises
        ------
        ComputationError
            If the checker refuses it.
        """
        if self._verify is not None:
            try:
                self._verify(certificate)
            except GainsayError as error:
                raise ComputationError(certificate.id, f"certificate refused: {error}") from error
        write_atomically(self._file(f"certificates/{certificate.id}.json"), certificate.to_json())

    def prove(self, certificate: Any, *, source: str = "", values: Mapping[str, float] | None = None) -> None:
        """Write a certificate and every quantity that it concludes on: value, ends and method follow from the proof.

        Parameters
        ----------
        certificate : gainsay.proof.Certificate
            With a conclusion on at least one quantity. ``holds`` gives 1, ``fails`` gives 0, ``at_most`` an upper end,
            ``at_least`` a lower end, ``inside`` both.
        source : str, optional
            Equation or sentence behind the quantities.
        values : mapping of str to float, optional
            Computed value of a quantity of which the certificate proves ends; without one it is the middle of
            what encloses it, or the level that was asked for.

        Raises
        ------
        ComputationError
            If the checker refuses the certificate, it concludes on no quantity, or a value lies outside the ends.
        """
        self.certificate(certificate)
        enclosures = proved_numbers(certificate)
        if not enclosures:
            raise ComputationError(certificate.id, "concludes on no quantity")
        for quantity, proved in enclosures.items():
            self.quantity(
                quantity,
                (values or {}).get(quantity, proved.value),
                method=f"proved by certificate {certificate.id}",
                source=source,
                lower=proved.lower,
                upper=proved.upper,
            )

    def undecided(self, quantity: str, reason: str, *, source: str = "") -> None:
        """Add a quantity of which neither side could be proved: a limit of our method, with how far it got.

        Parameters
        ----------
        quantity : str
            An id declared in the paper's quantities.csv.
        reason : str
            What was tried, one line.
        source : str, optional
            Equation or sentence behind it.
        """
        unit = self._declared(quantity)
        self._rows["quantities"].append((quantity, math.nan, unit, None, None, f"{UNDECIDED} {reason}", source))

    def gains(
        self,
        gain: str,
        *,
        published: PrintedMatrix,
        resynthesised: np.ndarray | None = None,
        identified: np.ndarray | None = None,
        low: np.ndarray | None = None,
        high: np.ndarray | None = None,
    ) -> None:
        """Add a gain entry by entry: as printed with its rounding interval, and as synthesised again.

        Parameters
        ----------
        published : PrintedMatrix
        resynthesised : ndarray, optional
            Same shape.
        identified : ndarray of bool, optional
            Whether the synthesis determines the entry.
        low, high : ndarray, optional
            Range of the entry over near-optimal solutions.
        """
        self._rows["gains"] += gain_rows(gain, published, resynthesised, identified, low, high)

    def poles(
        self, name: str, *, published: PrintedMatrix, recomputed: Sequence[complex], radius: Sequence[float]
    ) -> None:
        """Add published pole locations, each with the pole that was matched to it.

        Parameters
        ----------
        name : str
            Where they are printed, such as ``(40)``.
        published : PrintedMatrix, shape (k, 2)
            Real part and modulus of the imaginary part of each pole or conjugate pair, 1/s.
        recomputed : sequence of complex, length k
            The matched poles, those of pairs with a positive imaginary part, 1/s.
        radius : sequence of float, length k
            How far each may lie from there within the rounding of the printed gains, 1/s.
        """
        self._rows["poles"] += pole_rows(name, published, recomputed, radius)

    def scan(self, scan: Any) -> None:
        """Write a scan over plausible inputs, what of it was read and scanned over, and what its inputs bear out."""
        self._note_reads(scan.quantity, {one.parameter or one.name for one in scan.inputs}, "scanned")
        self._note_reads(scan.quantity, self._reads, "read")
        self._note_reads(scan.quantity, scan.bears_out, "borne_out")
        write_json(self._file(f"scans/{scan.quantity}.json"), scan.to_json())

    def attempted(self, where: str, outcome: Outcome) -> Outcome:
        """Keep the attempts of a solver's outcome, not deterministic and never compared, and return the outcome."""
        self._attempts.append({"where": where, "content": list(outcome.attempts)})
        return outcome

    def say(self, where: str, outcome: str) -> None:
        """Keep a line of the step's log: paper, step, place in the paper, what was found, seconds since the last."""
        now = time.perf_counter()
        head = f"{self.case.name}  {self.step:<10}  {where}  {outcome}"
        line = f"{head:<100}  {now - self._clock:6.1f} s"
        self._lines.append(line)
        if VERBOSE or outcome.startswith("FAILED"):
            print(line, flush=True)
        self._clock, self._said = now, True

    @contextmanager
    def task(self, where: str, name: str, *, quiet: bool = False) -> Iterator[None]:
        """Run a part of the step: if it breaks, keep a failed record and go on.

        Bad input is no broken computation: it ends the step. A quiet part says nothing when all is well.
        """
        self._said = False
        try:
            with recording() as self._reads:
                yield
        except Exception as error:  # whatever broke must not hide the paper's other results
            # A table at fault is bad input; else, even where a result file is at fault, a computation of ours broke.
            if isinstance(error, InputError) and self._is_table(error.file):
                self._discard()
                raise
            message = " ".join(str(error).replace(f"{self.case.root}/", "").split()) or type(error).__name__
            attempts = [dict(a) for a in getattr(error, "attempts", ())]
            self._rows["failures"].append((self.step, where, name, message))
            self._attempts.append(
                {"where": where, "failed": message, "attempts": attempts, "traceback": traceback.format_exc()}
            )
            tried = f", {len(attempts)} attempts" if attempts else ""
            place = place_of(error, self.case.root)
            self.say(
                where,
                f"FAILED{tried}: {message}{place}; traceback in results/{self.case.name}/attempts/{self.step}.json",
            )
        else:
            if not self._said and not quiet:
                self.say(where, "done")

    def close(self) -> None:
        """Write the tables of this step, then the list of all its files, and say in one line what it did."""
        parts, attempts = self.case.results / "parts", self.case.results / "attempts"
        write_json(attempts / f"{self.step}.json", self._attempts, default=_listed)
        write_atomically(attempts / f"{self.step}.log", "".join(f"{line}\n" for line in self._lines))
        made = dict(self._written)
        for part, columns in PARTS.items():
            write_csv(parts / f"{self.step}.{part}.csv", columns, self._rows[part])
            made[f"parts/{self.step}.{part}.csv"] = ""
        write_listing(self._listing(), self.case.results, made)
        write_atomically(self._kept_listing(), self._listing().read_bytes())
        counts = [(len(self._rows["quantities"]), "numbers")]
        for folder in ("certificates", "scans", "logs", "figures"):
            counts.append((sum(file.startswith(f"{folder}/") for file in self._written), folder))
        counts.append((len(self._rows["failures"]), "FAILED"))
        summary = ", ".join(f"{count} {noun}" for count, noun in counts if count) or "nothing to do"
        print(f"{self.case.name}  {self.step:<10}  {summary}  {time.perf_counter() - self._begun:.1f} s", flush=True)
