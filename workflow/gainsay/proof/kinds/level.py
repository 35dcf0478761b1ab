"""Several requirements hold at once at a level of uncertainty, each proved by a kind of its own.

Theorem: let ``level`` be a number on which the other definitions depend, such as the bound on a gain variation. If
every part is proved, all over the same definitions, then all that the parts prove holds at this level, so the largest
level at which it holds is at least this one. (Where the uncertainty is scaled by the level, every smaller variation is
among those covered, so that no lower level has to be proved.)

What is required is the paper's: the radius and shift of a disk, the level of a norm, the bound on an input or a cost of
a part must each be an entry of the parameter table, as ``number('gamma')`` or a definition that is one. A level at
which weaker requirements hold would be no level of the paper's. A part is of a kind that proves a requirement met: one
that proves it missed, as a lower bound on a norm does, has a level of the same name. Every part must depend on the
level. A quantity that is concluded names them too, in its column ``requires``; with others, more or fewer, the
certificate is refused.

Fields: ``level``, the name of a definition that is a rational number; ``parts``, a list of {"name", "kind", "fields"},
the fields as that kind demands. Witness: for each part what its kind demands, named ``part.name``, as in ``disk.P``.
Proved: ``level`` at_least its value, and all that the parts prove, named ``part.of``, as in ``disk.radius``.
"""

from collections.abc import Iterator, Mapping
from types import ModuleType

from gainsay.errors import CertificateError
from gainsay.exact.rational import to_text
from gainsay.proof import formulas, kinds
from gainsay.proof.certificate import Certificate
from gainsay.proof.kinds import Proved
from gainsay.proof.scope import Scope

THEOREM = "every requirement proved at the level by a kind of its own"
FAITH = (
    "That the uncertainty at every smaller level is among that at the level.",
    "That the parameters which quantities.csv names as what a quantity requires are the paper's own requirements.",
)
REQUIRED = ("level", "parts")
OPTIONAL = ()
LEVELS = ()
FOUND = ()

#: kinds that prove a requirement met
_MET_BY = ("bounded_real", "contour", "lyapunov", "quadratic_bound", "robust_disk", "robust_norm", "stein")
#: entries of fields that are no formulas, whatever they look like
_NO_FORMULAS = ("blocks", "of")


def _parts(scope: Scope) -> list[tuple[str, str, dict]]:
    given = scope.field("parts")
    if not isinstance(given, list) or not given:
        raise scope.fail("field 'parts': expected name, kind and fields for each")
    result = []
    for entry in given:
        match entry:
            case {"name": str(name), "kind": str(kind), "fields": dict(fields)} if len(entry) == 3:
                result.append((name, kind, fields))
            case _:
                raise scope.fail(f"part {entry!r}: expected name, kind and fields")
    names = [name for name, _, _ in result]
    if len(set(names)) < len(names):
        raise scope.fail("field 'parts': expected a different name for each part")
    for name in names:
        formulas.check_name(name)
    for name in scope.certificate.witness:
        if name.partition(".")[0] not in names:
            raise scope.fail(f"witness {name!r} belongs to no part")
    return result


def _part(scope: Scope, name: str, kind: str, fields: dict) -> list[Proved]:
    """Apply the kind of a part to its fields and its share of the witness."""
    module = kinds.load(kind)
    if kind not in _MET_BY:
        raise scope.fail(f"part {name!r}: a part of kind {kind!r} proves no requirement met: {', '.join(_MET_BY)} do")
    for field in module.REQUIRED:
        if field not in fields:
            raise scope.fail(f"part {name!r}: field {field!r} is missing")
    for field in fields:
        if field not in (*module.REQUIRED, *module.OPTIONAL):
            raise scope.fail(f"part {name!r}: unknown field {field!r} of kind {kind}")
    _requirement(scope, name, module, fields)
    whole = scope.certificate
    own = {key.partition(".")[2]: rows for key, rows in whole.witness.items() if key.partition(".")[0] == name}
    part = whole.changed(id=f"{whole.id}, {name}", kind=kind, fields=fields, witness=own)
    inner = Scope(part, scope.reader.tables)
    # what the part's formulas read is data of the whole
    inner.reader = scope.reader
    return module.prove(inner)


def _names(value: object) -> set[str]:
    """Names that the formulas within a field use, at any depth."""
    if isinstance(value, str):
        try:
            return set(formulas.names_in(value))
        except CertificateError:  # a label
            return set()
    if isinstance(value, dict):
        return set().union(*(_names(part) for key, part in value.items() if key not in _NO_FORMULAS))
    return set().union(*map(_names, value)) if isinstance(value, list) else set()


def _levels(definitions: Mapping[str, str], module: ModuleType, fields: dict) -> Iterator[tuple[str, str, str | None]]:
    """Yield what a part requires, its formula and its parameter; the half plane of zero is no requirement."""
    for name in (*module.LEVELS, "shift"):
        head, _, tail = name.partition(".")
        given = fields.get(head, [])
        for text in [entry[tail] for entry in given] if tail else [given] if given else []:
            if (name, text) != ("alpha", "0"):
                yield tail or head, text, formulas.parameter_of(text, definitions)


def requirements(certificate: Certificate) -> frozenset[str]:
    """What the parts of a certificate require, each as ``gamma=`` and the name of a parameter."""
    definitions = dict(certificate.definitions)
    every = (_levels(definitions, kinds.load(part["kind"]), part["fields"]) for part in certificate.fields["parts"])
    return frozenset(f"{what}={parameter}" for part in every for what, _, parameter in part)


def _requirement(scope: Scope, part: str, module: ModuleType, fields: dict) -> None:
    """Refuse a part that asks for something else than the tables say, or that does not depend on the level."""
    definitions = dict(scope.certificate.definitions)
    for what, text, parameter in _levels(definitions, module, fields):
        if parameter is None:
            raise scope.fail(
                f"part {part!r}: {what} is {text!r}, expected an entry of the parameter table, number('...'): "
                "a level means something for the paper's own requirements alone"
            )
    used, new = set(), _names(fields)
    while new:
        used |= new
        new = set().union(*(_names(definitions[name]) for name in new if name in definitions)) - used
    if scope.field("level") not in used:
        raise scope.fail(f"part {part!r} does not depend on the level {scope.field('level')!r}")


def prove(scope: Scope) -> list[Proved]:
    """Prove every part at the level."""
    name = scope.field("level")
    if name not in [defined for defined, _ in scope.certificate.definitions]:
        raise scope.fail(f"field 'level': {name!r} is not a definition")
    scope.define()
    proofs = [Proved("level", "at_least", to_text(scope.number(name)))]
    for part, kind, fields in _parts(scope):
        for p in _part(scope, part, kind, fields):
            proofs.append(Proved(f"{part}.{p.of}", p.relation, p.value))
    return proofs
