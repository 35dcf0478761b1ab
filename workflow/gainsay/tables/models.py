"""Typed rows of the tables that a paper's folder holds; the schema and the column documentation come from here."""

from typing import Annotated, Literal, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, StringConstraints

from gainsay.errors import InputError
from gainsay.exact.digits import EXPECTED, PrintedNumber
from gainsay.tables.units import to_si

Verdict = Literal["reproduced", "contradicted", "undetermined", "undecided", "uncheckable", "failed"]
ProvedKind = Literal[
    "identity",
    "definiteness",
    "feasibility",
    "stability",
    "pole-region",
    "norm-bound",
    "cost-bound",
    "input-bound",
    "delay-margin",
]
Kind = Literal[
    "parameter",
    "gain",
    ProvedKind,
    "trajectory",
    "ordering",
    "figure",
    "remark",
]
Comparator = Literal[
    "equal", "at_most", "at_least", "inside", "holds", "fails", "feasible", "infeasible", "less_than", "all_of", ""
]
Weight = Literal["misprint", "gap", "result", ""]
Scan = Literal["possible", "excluded", "open", ""]
Digits = Literal["scan", "confirmed", ""]
HoldsFor = Literal["every", "some", ""]
Step = Literal["synthesis", "audit", "simulation"]
Tolerance = Literal["exact", "rounding", "enclosed", "sampled", "floor"]
ScanItem = Literal[
    "outcome",
    "samples",
    "holding",
    "closer",
    "closer_holding",
    "smallest",
    "largest",
    "turns_on",
    "holds_at",
    "fails_at",
]
VERDICTS: tuple[str, ...] = get_args(Verdict)
#: kinds whose verdict needs a certificate that the checker accepts
PROVED = frozenset(get_args(ProvedKind))


def _unit(value: str) -> str:
    try:
        to_si(value)
    except InputError as error:
        raise ValueError(error.expected) from error
    return value


def _decimal_or_empty(value: str) -> str:
    if value:
        _decimal(value)
    return value


def _decimal(value: str) -> str:
    try:
        PrintedNumber(value)
    except ValueError:
        raise ValueError(EXPECTED) from None
    return value


def _plain(value: str) -> str:
    if value != value.strip() or not value.isprintable() or "\ufffd" in value:
        raise ValueError("text on one line without surrounding blanks or characters that do not show")
    return value


Text = Annotated[str, AfterValidator(_plain)]
Filled = Annotated[str, StringConstraints(min_length=1), AfterValidator(_plain)]
# What has a name may become a file of that name, which must not be longer than 255 bytes with its ending.
Slug = Annotated[str, StringConstraints(pattern=r"^[a-z0-9][a-z0-9_.-]*$", max_length=100)]
Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_]*$", max_length=100)]
QuantityId = Annotated[str, StringConstraints(pattern=r"^[a-z0-9_]+(\.[a-z0-9_]+)*$", max_length=100)]
Measured = Annotated[str, StringConstraints(pattern=r"^(less|more)( [a-z0-9_.]*\{\}[a-z0-9_.]*)+$")]
#: label of an edition, and the blocks meant; a statement without blocks has none
EDITION = r"[^:;$]+[^:;$ ](?:: \(\d+,\d+\)(?: \(\d+,\d+\))*)?"
EDITIONS = rf"^(?:{EDITION}(?:; {EDITION})*)?$"
Unit = Annotated[str, AfterValidator(_unit)]
Decimal = Annotated[str, AfterValidator(_decimal)]
DecimalOrEmpty = Annotated[str, AfterValidator(_decimal_or_empty)]


class Row(BaseModel):
    """A row of a table: immutable, every column named, no other column allowed."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Parameter(Row):
    """A number, choice, matrix or text that the paper prints, or that it leaves out and we assume."""

    name: Name = Field(description="identifier used by the code and in certificates")
    type: Literal["number", "choice", "matrix", "text"] = Field(description="what `value` holds")
    value: Filled = Field(description="decimal digits exactly as printed, a word, or the file of a printed matrix")
    unit: Unit = Field(description="unit of the value; results are in SI")
    where: Filled = Field(description="equation, table, section or sentence of the paper")
    status: Literal["printed", "assumed", "corrected", "method"] = Field(
        description="whose number it is: the paper's, ours for what it leaves out, ours for what it misprints, or a "
        "choice of our own method such as a seed or a number of draws"
    )
    plausible: Text = Field(description="for what the paper leaves out and our method: `low..high` or `a|b|c`")
    note: Text = Field(description="why this value, or what the paper prints instead")
    digits: Digits = Field(
        default="",
        description="of a printed value, how its digits were read: `confirmed` against the published page, or `scan` "
        "(from a scan of the text alone), which empty means as well",
    )

    @property
    def unconfirmed(self) -> bool:
        """Whether the paper prints it and its digits were not held against the published page."""
        return self.status == "printed" and self.digits != "confirmed"


class Quantity(Row):
    """A number that Gainsay computes for the paper."""

    id: QuantityId = Field(description="dotted lower-case identifier")
    unit: Unit = Field(description="SI unit of the value")
    step: Step = Field(description="the step that computes it")
    meaning: Filled = Field(description="what is computed, one sentence")
    requires: Text = Field(
        default="",
        description="of a level of uncertainty that a certificate of kind `level` proves: which parameter is each "
        "requirement met at it, `radius=disk_radius; gamma=gamma`; a certificate with others, more or fewer is refused",
    )

    @property
    def requirements(self) -> frozenset[str]:
        """Entries of `requires`."""
        return frozenset(filter(None, map(str.strip, self.requires.split(";"))))


class Claim(Row):
    """A statement of the paper that can be held against a computation, or a remark that cannot."""

    id: Slug = Field(description="identifier of the claim")
    where: Filled = Field(description="equation, table, figure or sentence of the paper")
    kind: Kind = Field(description="kind of statement; decides the evidence it needs")
    statement: Filled = Field(description="what the paper says, one sentence")
    comparator: Comparator = Field(
        description="how the quantity is held against the published value; empty for remarks"
    )
    quantity: Text = Field(description="the quantity compared; for all_of the claims it joins")
    published: Text = Field(
        description="the published value; `low..high` for inside, and for a threshold that the paper does not print; "
        "a quantity for less_than; empty for what holds or is feasible"
    )
    unit: Unit = Field(description="unit of the published value")
    tolerance: DecimalOrEmpty = Field(description="absolute tolerance; empty: half a unit of the last printed digit")
    expected: Verdict = Field(description="the verdict on record")
    basis: Filled = Field(description="the independent reason for the expected verdict")
    note: Text = Field(description="reading of the text, reason of a stated tolerance")
    reading: Text = Field(
        default="", description="where the two ends of a threshold that the paper does not print come from"
    )
    given: Text = Field(
        default="",
        description="condition under which the claim is judged: `name=value; name=value`, of what the paper leaves out "
        "or of what it prints where a scan is over those inputs alone that bear the print out",
    )
    sentence: Annotated[str, StringConstraints(pattern=r"^([a-z0-9][a-z0-9_.-]*)?$")] = Field(
        default="", description="name shared by the claims that speak of one sentence; they are judged together"
    )
    as_read: Text = Field(
        default="",
        description="where a sentence can be read in several ways, how this claim reads it: claims of a sentence that "
        "are read alike hold together, and readings that differ in verdict leave it undetermined; empty: true of all",
    )
    holds_for: HoldsFor = Field(
        default="",
        description="of a sentence that says `can` or the like: `some` where one input at which it holds bears it out, "
        "and nothing refutes it but a proof over all plausible values; `every` where more is claimed, as of a sentence "
        "without it",
    )
    weight: Weight = Field(
        default="",
        description="of what does not hold: `misprint`; `gap` (the argument fails, the conclusion may stand); "
        "`result` (a number or a conclusion fails)",
    )
    ocr: Scan = Field(
        default="", description="whether the scan of the text could be to blame; `open` where nobody has judged it"
    )


class Erratum(Row):
    """A misprint or error of the paper, with a machine-checked witness."""

    id: Slug = Field(description="identifier of the erratum")
    where: Filled = Field(description="where the paper prints it")
    printed: Text = Field(description="what stands there; empty where `edition` says")
    corrected: Text = Field(description="what should stand there; empty where `edition` says")
    effect: Filled = Field(description="what follows from the difference")
    witness: Filled = Field(description="the quantity or certificate that shows it")
    weight: Weight = Field(default="", description="as of a claim that does not hold")
    ocr: Scan = Field(default="", description="whether the scan of the text could be to blame")
    edition: Annotated[str, StringConstraints(pattern=EDITIONS)] = Field(
        default="",
        description="of a statement: the editions that correct it and the blocks that differ, "
        "`(12) corrected: (1,2) (2,6)`, several parted by `;`; both texts are then typeset from them",
    )


class Reply(Row):
    """What somebody holds against a verdict: shown beside the claim, whatever became of it."""

    claim: Slug = Field(description="the claim whose verdict is disputed")
    disputed: Filled = Field(description="what of it, one sentence")
    ground: Filled = Field(description="the ground given: another reading, a datum, a computation")
    done: Filled = Field(description="what was done: the row that changed, or the reason why none did")
    who: Text = Field(default="", description="who replies, such as `an author`; may be left out")


class NotChecked(Row):
    """A part of the paper that no claim covers."""

    where: Filled = Field(description="equation, table, figure or sentence")
    what: Filled = Field(description="what stands there")
    reason: Filled = Field(description="why it is not checked")


class Toleranced(Row):
    """A value on record with what another machine may differ by."""

    value: Filled = Field(description="the value on record, full double precision")
    unit: Unit = Field(description="its SI unit")
    class_: Tolerance = Field(
        alias="class",
        description="where the tolerance comes from: `exact` (none), `rounding` (an error bound of the arithmetic), "
        "`enclosed` (the width of the enclosure on file), `sampled` (a standard error), "
        "`floor` (the value is rounding noise below it)",
    )
    relative: Decimal = Field(description="relative tolerance")
    absolute: Decimal = Field(description="absolute tolerance, in the unit; the two add up")
    reason: Filled = Field(description="the bound that the tolerance comes from, known before anything was compared")


class Recorded(Toleranced):
    """A quantity on record, written by `make record` alone."""

    quantity: QuantityId = Field(description="the quantity")


class RecordedScan(Toleranced):
    """A number that a scan found, on record; written by `make record` alone."""

    claim: Slug = Field(description="the claim scanned")
    item: ScanItem = Field(description="what the scan found")


class RecordedRead(Row):
    """A parameter that a computation hangs on, on record; written by `make record` alone.

    It read what the paper leaves out, or was made over those inputs alone that bear out what the paper prints.
    """

    quantity: QuantityId = Field(description="the quantity computed")
    parameter: Name = Field(description="the parameter read")
    how: Literal["read", "scanned", "borne_out"] = Field(
        description="read at its value in the table, scanned over all plausible ones, or printed and borne out by all "
        "inputs of a scan"
    )


class RecordedCertificate(Row):
    """What a certificate states, on record; written by `make record` alone."""

    certificate: Slug = Field(description="the certificate")
    formulas: Annotated[str, StringConstraints(pattern=r"^sha256:[0-9a-f]{64}$")] = Field(
        description="SHA-256 of all that it states: kind, formulas, table entries and conclusions, not the witness"
    )


class RecordedPublished(Row):
    """How an entry of a gain or a pole that the paper prints came out, on record; written by `make record` alone.

    Claims have their verdict in claims.csv, and what nothing can be held against has none.
    """

    what: Literal["gain", "pole"] = Field(description="what is printed")
    entry: Filled = Field(description="the entry, as in published.csv")
    published: Filled = Field(description="the digits as printed")
    verdict: Verdict = Field(description="the verdict on record")


class Campaign(Row):
    """A computation too large for a run of the workflow: evaluated in blocks, by chunks, here or on a cluster."""

    name: Slug = Field(description="name of the campaign, as in the paper's module `campaigns`")
    kind: Literal["scan", "map", "draws", "box"] = Field(
        description="`scan`: numbers over a grid of inputs; `map`: what is proved at each point of a grid; "
        "`draws`: counts over random draws; `box`: what is proved over every cell of a box"
    )
    inputs: Filled = Field(description="range of each input: `name=low..high; name=low..high log`")
    resolution: Filled = Field(
        description="points (of a box: cells) along each input, one number for all or `24x16`; the number of draws"
    )
    seed: Text = Field(description="seed of the draws; empty where nothing is drawn")
    block: Filled = Field(description="points evaluated together: a result depends on it where arithmetic does")
    chunk: Filled = Field(description="points of one job, whole blocks; no result depends on it")
    claim: Text = Field(description="the claim of claims.csv that it speaks of; may be empty")
    question: Filled = Field(description="what it answers, one sentence")


class PaperFile(BaseModel):
    """`paper.toml`: citation, designs, runs and figures."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    title: Filled = Field(description="title as published")
    authors: list[Filled] = Field(min_length=1, description="authors as published")
    journal: Filled = Field(description="journal")
    year: int = Field(ge=1900, le=2100, description="year of publication")
    doi: Annotated[str, StringConstraints(pattern=r"^(10\.[0-9]{4,9}/\S+)?$")] = Field(
        default="", description="DOI without resolver; empty where the text at hand gives none"
    )
    finding: list[Filled] = Field(default=[], max_length=2, description="what was found, in two sentences")
    draft: bool = Field(default=False, description="whether what is not on record yet is no difference")
    designs: dict[Slug, Filled] = Field(default={}, description="designs that synthesis makes: name and what it is")
    runs: dict[Slug, Filled] = Field(description="simulated runs: name and what is simulated")
    figures: dict[Slug, Filled] = Field(description="figures: name and caption")
    printed: dict[Name, Name] = Field(
        default={},
        description="matrix of a design to the printed one that it stands for, where that has another name",
    )
    measures: dict[
        QuantityId,
        Annotated[
            str,
            StringConstraints(
                pattern=r"^(less|more)(( [a-z0-9_.]*\{\}[a-z0-9_.]*)+| [a-z0-9_]+( [a-z0-9_]+=[a-z0-9_.]+)+)$"
            ),
        ],
    ] = Field(
        default={},
        description="table of designs: quantity of the printed design, then which is better, `less` or `more`, and "
        "the quantity of another design or run, `{}` for its name; where several are given, the first that there is. "
        "Where the paper prints no design: quantity of one of ours, `less` or `more`, its name, and `design=quantity` "
        "for each that it is held against",
    )


def columns(model: type[Row]) -> tuple[str, ...]:
    """Return the columns of a table, what a row is named by first."""
    own = [name for name in model.model_fields if name in model.__annotations__]
    inherited = [name for name in model.model_fields if name not in own]
    return tuple(model.model_fields[name].alias or name for name in (*own, *inherited))


def optional(model: type[Row]) -> tuple[str, ...]:
    """Return the columns that a table may leave out: no row of it has anything to say there."""
    return tuple(field.alias or name for name, field in model.model_fields.items() if not field.is_required())


#: file name -> model of its rows
TABLES: dict[str, type[Row]] = {
    "parameters.csv": Parameter,
    "quantities.csv": Quantity,
    "claims.csv": Claim,
    "errata.csv": Erratum,
    "not_checked.csv": NotChecked,
    "replies.csv": Reply,
    "recorded.csv": Recorded,
    "recorded_scans.csv": RecordedScan,
    "recorded_reads.csv": RecordedRead,
    "recorded_certificates.csv": RecordedCertificate,
    "recorded_published.csv": RecordedPublished,
    "campaigns.csv": Campaign,
}
