"""Chunks and gathered results as Parquet files: whole or not at all, checked page by page, the same to the byte."""

import hashlib
import json
import secrets
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gainsay.campaigns.plan import Block, Plan
from gainsay.errors import InputError, missing_extra
from gainsay.results.manifest import current_manifest, manifest_path
from gainsay.tables.files import naming, open_regular, write_json

_FORMAT = "1"
#: what a column of a type is made of, as numpy calls it: nothing is cut to a whole number, nothing read from a text
_KINDS = {"int64": "iu", "double": "iuf"}


def folder(plan: Plan) -> Path:
    """Folder of everything of a paper's campaigns."""
    return plan.case.results / "campaigns"


def chunk_path(plan: Plan, number: int) -> Path:
    """File of a chunk, in a folder named by what its content depends on and by the size of its chunks."""
    return folder(plan) / plan.row.name / f"{plan.digest}-{plan.row.chunk}" / f"chunk-{number:07d}.parquet"


def _arrow() -> Any:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError("pyarrow is not installed", expected=missing_extra("pyarrow")) from None
    return pyarrow


def _schema(plan: Plan) -> Any:
    arrow = _arrow()
    types = {"int64": arrow.int64(), "float64": arrow.float64(), "string": arrow.string()}
    fields = [arrow.field("index", arrow.int64(), nullable=False)]
    return arrow.schema(fields + [arrow.field(name, types[type_]) for name, type_ in plan.evaluation.columns.items()])


def _array(field: Any, values: Sequence[Any]) -> Any:
    """Array of a column, from its bytes: an array of Python objects would load pandas, half a second a process."""
    arrow = _arrow()
    if field.type == arrow.string():
        if not all(isinstance(text, str) for text in values):
            raise InputError("column", field=field.name, value=str(type(values[0])), expected=str(field.type))
        texts = [text.encode() for text in values]
        ends = np.cumsum([0, *map(len, texts)], dtype=np.int32)
        return arrow.StringArray.from_buffers(len(texts), arrow.py_buffer(ends), arrow.py_buffer(b"".join(texts)))
    held = np.ascontiguousarray(values)
    if held.dtype.kind not in _KINDS[str(field.type)]:
        raise InputError("column", field=field.name, value=str(held.dtype), expected=str(field.type))
    held = held.astype(field.type.to_pandas_dtype())
    return arrow.Array.from_buffers(field.type, len(held), [None, arrow.py_buffer(held)])


class _Writer:
    """A Parquet file under a temporary name that takes its own when it is whole, in groups of one number of rows.

    However rows come, they are put together once: a file of a group a point takes longer to write than its points.
    """

    def __init__(self, path: Path, plan: Plan) -> None:
        self.arrow, self.path, self.schema = _arrow(), path, _schema(plan)
        self.waiting: list[Any] = []
        self.group = plan.evaluation.group
        path.parent.mkdir(parents=True, exist_ok=True)
        # on a cluster two machines may write the same chunk, under the same number of a process
        self.part = path.with_name(f".{secrets.token_hex(8)}.{path.name}.part")
        self.file = self.arrow.parquet.ParquetWriter(
            self.part,
            self.schema,
            compression="zstd",
            write_page_checksum=True,
            write_statistics=True,
            store_schema=False,
        )

    def __enter__(self) -> "_Writer":
        return self

    def write(self, table: Any) -> None:
        self.waiting.append(table)
        if sum(map(len, self.waiting)) >= self.group:
            rows = self._together()
            whole = len(rows) - len(rows) % self.group
            self.file.write_table(rows[:whole], row_group_size=self.group)
            self.waiting = [rows[whole:]]

    def _together(self) -> Any:
        nothing = self.arrow.Table.from_batches([], schema=self.schema)  # an empty table of the schema's loads pandas
        return self.arrow.concat_tables([nothing, *self.waiting]).combine_chunks()

    def note(self, content: Mapping[str, str]) -> None:
        self.file.add_key_value_metadata(dict(content))

    def __exit__(self, kind: type | None, *rest: object) -> None:
        try:
            if kind is None and (rows := self._together()):
                self.file.write_table(rows, row_group_size=self.group)
            self.file.close()
            if kind is None:
                self.part.replace(self.path)
        finally:
            self.part.unlink(missing_ok=True)


def _block_table(plan: Plan, block: Any, schema: Any) -> tuple[Any, dict[str, int]]:
    table = plan.evaluation.block(plan.case, block)
    if set(table) != set(plan.evaluation.columns):
        raise InputError(plan.row.name, field="columns", value=sorted(table), expected=str(list(schema.names[1:])))
    rows = {len(column) for column in table.values()}
    if len(rows) != 1:
        raise InputError(plan.row.name, field="columns", value=sorted(rows), expected="columns of one length")
    count = rows.pop()
    if count not in (1, block.size):
        raise InputError(plan.row.name, field="rows", value=count, expected=f"one a block, or {block.size}")
    index = [block.first] if count == 1 else list(block.indices)
    columns = {"index": index, **table}
    arrays = [_array(field, columns[field.name]) for field in schema]
    return _arrow().Table.from_arrays(arrays, schema=schema), plan.evaluation.count(table)


def write_chunk(plan: Plan, number: int) -> dict[str, int]:
    """Evaluate the blocks of a chunk one after the other and write their rows; return what was counted.

    A chunk that is killed leaves nothing that counts as one.
    """
    total: Counter[str] = Counter()
    points = 0
    path = chunk_path(plan, number)
    with naming(path), _Writer(path, plan) as file:
        for block in plan.blocks(number):
            table, counts = _block_table(plan, block, file.schema)
            total.update(counts)
            points += block.size
            file.write(table)
        file.note(_about(plan, number, points, total))
    return dict(total)


def _about(plan: Plan, number: int, points: int, counts: Mapping[str, int]) -> dict[str, str]:
    about = {"paper": plan.case.name, "campaign": plan.row.name, "digest": plan.digest, "chunk": number}
    whole = {**about, "points": points, "counts": dict(sorted(counts.items())), "format": _FORMAT}
    return {"gainsay": json.dumps(whole, sort_keys=True)}


def about_chunk(path: Path, root: Path) -> dict[str, Any]:
    """Read what a chunk says of itself: paper, campaign, digest, chunk, points and counts.

    Raises
    ------
    InputError
        If it is no chunk, or cut off.
    """
    arrow = _arrow()
    file = str(path.relative_to(root))
    try:
        with open_regular(path, root) as opened:
            about = json.loads((arrow.parquet.read_metadata(opened).metadata or {})[b"gainsay"])
    except (OSError, KeyError, ValueError, RecursionError, arrow.ArrowException) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("no whole chunk", file=file, expected="a chunk of a campaign") from None
    counts = about.get("counts") if isinstance(about, dict) else None
    if not isinstance(counts, dict) or any(type(number) is not int for number in counts.values()):
        raise InputError("no whole chunk", file=file, expected="a chunk of a campaign")
    return about


def _rows(plan: Plan, number: int, about: Mapping[str, Any]) -> Iterator[Any]:
    """Yield the rows of a chunk by row group, every page checked, and what it says of itself held against them.

    Raises
    ------
    InputError
        If the chunk is damaged: it is removed, so that the next run makes it again.
    """
    path, arrow, schema = chunk_path(plan, number), _arrow(), _schema(plan)
    counted: Counter[str] = Counter()
    try:
        with arrow.parquet.ParquetFile(path, page_checksum_verification=True) as opened:
            for group in range(opened.metadata.num_row_groups):
                rows = opened.read_row_group(group).cast(schema)
                counted.update(plan.evaluation.count({name: rows[name].to_pylist() for name in schema.names[1:]}))
                yield rows
        points = sum(block.size for block in plan.blocks(number))
        # the checksums are those of pages: what stands after them is held against the rows
        if (about["counts"], about.get("points")) != (dict(counted), points):
            raise ValueError("it counts what is not in its rows")
    except (OSError, ValueError, TypeError, arrow.ArrowException) as error:
        path.unlink(missing_ok=True)
        file = str(path.relative_to(plan.case.root))
        raise InputError(f"damaged and removed: {error}", file=file, expected="a whole chunk; run again") from None


def gather(plan: Plan) -> dict[str, Any]:
    """Join all chunks in the order of their points, count exactly, and write table and manifest; return the manifest.

    Raises
    ------
    InputError
        If a chunk is missing, damaged, or of other tables.
    """
    total: Counter[str] = Counter()
    path = folder(plan) / f"{plan.row.name}.parquet"
    with naming(path), _Writer(path, plan) as file:
        for number in range(plan.chunks):
            chunk = chunk_path(plan, number)
            about = about_chunk(chunk, plan.case.root)
            expected = {"digest": plan.digest, "chunk": number, "campaign": plan.row.name, "paper": plan.case.name}
            if any(about.get(key) != value for key, value in expected.items()):
                file_name = str(chunk.relative_to(plan.case.root))
                raise InputError(
                    "another chunk", file=file_name, value=about, expected=f"chunk {number} of {plan.digest}"
                )
            for rows in _rows(plan, number, about):
                file.write(rows)
            total.update(about["counts"])
    manifest = _manifest(plan, total)
    write_json(manifest_path(plan.case, plan.row.name), manifest)
    return manifest


def _manifest(plan: Plan, total: Mapping[str, int]) -> dict[str, Any]:
    """What is said of the gathered table beside it."""
    path, counts = folder(plan) / f"{plan.row.name}.parquet", dict(sorted(total.items()))
    with path.open("rb") as opened:
        digest = hashlib.file_digest(opened, "sha256").hexdigest()
    return {
        "format": _FORMAT,
        "paper": plan.case.name,
        **{key: getattr(plan.row, key) for key in ("name", "kind", "inputs", "resolution", "seed", "block", "claim")},
        "question": plan.row.question,
        "depends_on": plan.digest,
        "points": plan.points,
        "counts": counts,
        "told": plan.evaluation.findings(plan, counts),
        "table": {"file": path.name, "sha256": digest},
    }


def manifest_doubt(plan: Plan) -> str:
    """Say what is wrong with the manifest of a campaign: it is of other tables or code, or not what its table gives.

    Raises
    ------
    InputError
        If nothing is gathered, or the table is damaged.
    """
    total: Counter[str] = Counter()
    for batch in gathered(plan, list(plan.evaluation.columns)):
        total.update(plan.evaluation.count({name: column.tolist() for name, column in batch.items()}))
    manifest = current_manifest(plan.case, plan.row.name, plan.digest)
    if manifest is None:
        return "its manifest is of other tables or code, or cannot be read"
    wanted = json.loads(json.dumps(_manifest(plan, total)))
    said = {*wanted, *manifest} - {"claim", "question"}  # results do not depend on them
    wrong = sorted(key for key in said if wanted.get(key) != manifest.get(key))
    return f"its manifest has another {', '.join(wrong)} than its table gives" if wrong else ""


def gathered(plan: Plan, columns: list[str]) -> Iterator[Mapping[str, np.ndarray]]:
    """Yield some columns of the gathered table by row group, in order."""
    path = folder(plan) / f"{plan.row.name}.parquet"
    if not path.is_file():
        raise InputError(
            "not gathered", file=str(path.relative_to(plan.case.root)), expected="snakemake campaigns first"
        )
    arrow = _arrow()
    try:
        with arrow.parquet.ParquetFile(path, page_checksum_verification=True) as opened:
            for group in range(opened.metadata.num_row_groups):  # batches of the whole file would hold much of it
                rows = opened.read_row_group(group, columns=columns)
                yield {name: _values(rows[name]) for name in columns}
    except (OSError, KeyError, arrow.ArrowException) as error:
        file = str(path.relative_to(plan.case.root))
        raise InputError(f"damaged: {error}", file=file, expected="a gathered table; gather again") from None


def _values(column: Any) -> np.ndarray:
    """Values of a column; texts as objects, since an array of texts gives each the room of the longest."""
    values = column.to_pylist()
    return np.array(values, dtype=object) if column.type == _arrow().string() else np.asarray(values)


def doubts(plan: Plan) -> Iterator[tuple[int, str]]:
    """Yield the index of every row of the gathered table and what is wrong with its proof, nothing where it holds.

    Raises
    ------
    InputError
        If the rows of the campaign carry no proofs, or nothing is gathered.
    """
    if plan.evaluation.recheck is None:
        raise InputError(
            plan.row.name, field="kind", value=plan.row.kind, expected="a map or a box, whose rows carry proofs"
        )
    names = ["index", *plan.evaluation.columns]
    for batch in gathered(plan, names):
        for k, index in enumerate(batch["index"]):
            row = {name: batch[name][k] for name in names}
            yield int(index), plan.evaluation.recheck(plan.case, Block(plan, int(index), 1), row)
