"""Dynamic fault trees in the Galileo format, as Galileo, DFTCalc and Storm read them.

Each statement ends with a semicolon: ``toplevel "System"; "System" wsp "Pump" "Spare"; "Pump" lambda=1e-4;``. Gates:
and, or, 2of3 or vot2, pand, por, their -excl forms, wsp, csp, hsp and spare; fdep, pdep=0.5, seq, mutex. Basic events:
lambda (with phases: Erlang), prob, rate and shape (Weibull), mean and stddev (of the logarithm: lognormal), dorm.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from robophm.blocks.dynamic_modules import DynamicAnswer, solve
from robophm.blocks.dynamic_tree import Basic, Dependency, DynamicTree, Gate, Kind, Restriction, order
from robophm.core.errors import DesignError, StructureError, nearest
from robophm.core.files import stream_of

MOST_BYTES = 5_000_000
"""A larger file is refused."""

MOST_INPUTS = 250
"""The most inputs of a gate for which order matters."""

_TOKEN = re.compile(r'"([^"]*)"|([^\s";]+)')
_ORDERED: Mapping[str, Kind] = {
    "pand": "pand", "pand-incl": "pand", "pand<=": "pand", "pand-excl": "pand exclusive", "pand<": "pand exclusive",
    "por": "por", "por-incl": "por", "por<=": "por", "por-excl": "por exclusive", "por<": "por exclusive",
    "wsp": "spare", "csp": "spare", "hsp": "spare", "spare": "spare",
}  # fmt: skip
_COUNT = re.compile(r"vot(\d{1,6})|(\d{1,6})of(\d{1,6})")
_LAW = re.compile(r"[a-z]+=")
_GATES = ("and", "or", "2of3", "vot2", *_ORDERED, "fdep", "pdep=0.5", "seq", "mutex")
_LAWS: tuple[frozenset[str], ...] = tuple(
    map(frozenset, (("lambda",), ("lambda", "phases"), ("prob",), ("rate", "shape"), ("mean", "stddev")))
)
_LAW_NAMES = sorted({name for law in _LAWS for name in law} | {"dorm"})


@dataclass(frozen=True)
class GalileoTree:
    """A dynamic fault tree, and P(failed by a time) of the basic events whose rate is not constant."""

    name: str
    tree: DynamicTree
    laws: Mapping[int, Callable[[float], float]] = field(default_factory=dict)

    def solved(self, time: float, until: float = math.inf) -> DynamicAnswer:
        """Return how likely the top event is by a time, in the unit of the rates; raises as ``solve``."""
        return solve(self.tree, time, self.laws, until)


def load(path: Path) -> GalileoTree:
    """Read a tree. Raises DesignError, one line with file and line, for what is none or not taken."""
    return _Reader(path).tree()


class _Line:
    def __init__(self, where: str, tokens: list[str]) -> None:
        self.where, self.tokens = where, tokens

    def fault(self, message: str) -> DesignError:
        return DesignError(f"{self.where}: {message}")


class _Reader:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.lines: dict[str, _Line] = {}
        self.top: str | None = None
        for line in self._lines():
            first = line.tokens[0]
            if first == "toplevel" and len(line.tokens) == 2:
                if self.top is not None:
                    raise line.fault("toplevel is said twice")
                self.top = line.tokens[1]
            elif first == "param":
                raise line.fault("parameters are not taken; expected numbers")
            elif len(line.tokens) < 2:
                raise line.fault(f"'{first}' is nothing; expected a gate with inputs or a basic event with lambda=")
            elif first in self.lines:
                raise line.fault(f"'{first}' is defined twice; first in {self.lines[first].where}")
            else:
                self.lines[first] = line
        if self.top is None:
            raise DesignError(f'{path}: has no top event; expected a line toplevel "System";')

    def _lines(self) -> list[_Line]:
        try:
            with stream_of(self.path) as file:
                raw = file.read(MOST_BYTES + 1)
        except OSError as error:
            raise DesignError(f"{self.path}: cannot be read: {error.strerror}") from None
        if len(raw) > MOST_BYTES:
            raise DesignError(f"{self.path}: is larger than {MOST_BYTES:,} bytes")
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            raise DesignError(f"{self.path}: is no text in UTF-8") from None
        text = re.sub(r"/\*.*?\*/", lambda found: "\n" * found.group().count("\n"), text, flags=re.DOTALL)
        found = []
        number, begun, statement = 1, 1, ""
        for line in text.split("\n"):
            rest = line.split("//")[0]
            while ";" in rest:
                head, _, rest = rest.partition(";")
                found.append((begun, statement + head))
                statement, begun = "", number
            statement += rest + " "
            number += 1
            if not statement.strip():
                statement, begun = "", number
        if statement.strip():
            raise DesignError(f"{self.path}:{begun}: expected a semicolon at the end of {statement.strip()!r:.60}")
        return [
            _Line(f"{self.path}:{at}", [a or b for a, b in _TOKEN.findall(said)]) for at, said in found if said.strip()
        ]

    def tree(self) -> GalileoTree:
        assert self.top is not None
        kinds = {name: line.tokens[1] for name, line in self.lines.items()}
        special = {name for name, kind in kinds.items() if kind in ("fdep", "seq", "mutex") or kind.startswith("pdep=")}
        number = {name: i for i, name in enumerate(name for name in self.lines if name not in special)}
        if self.top not in number:
            raise DesignError(f"{self.path}: the top event '{self.top}' is not defined{nearest(self.top, number)}")
        laws: dict[int, Callable[[float], float]] = {}
        elements: list[Basic | Gate] = []
        for name in number:
            line = self.lines[name]
            if _LAW.match(kinds[name]):
                law = self._law(line)
                elements.append(_basic(name, law))
                if set(law) - {"lambda", "dorm"} and law.get("prob") not in (0.0, 1.0):
                    laws[number[name]] = partial(_failed_by, law)
            else:
                elements.append(self._gate(line, name, number, special))
        dependencies, restrictions = [], []
        for name in special:
            line = self.lines[name]
            inputs = self._inputs(line, number, ())
            if kinds[name] in ("seq", "mutex"):
                restrictions.append(Restriction(inputs, kinds[name] == "mutex"))
                continue
            for one in inputs[1:]:
                if isinstance(elements[one], Gate):
                    raise line.fault(
                        f"'{elements[one].name}' depends on something, but is a gate; expected basic events"
                    )
            chance = 1.0 if kinds[name] == "fdep" else self._number(line, kinds[name].partition("=")[2], "pdep")
            if not 0 <= chance <= 1:
                raise line.fault(f"pdep={chance:g}; expected 0 … 1")
            dependencies.append(Dependency(inputs[0], inputs[1:], chance))
        try:
            order(elements)
        except StructureError as error:
            raise DesignError(f"{self.path}: {error}") from None
        tree = DynamicTree(tuple(elements), number[self.top], tuple(dependencies), tuple(restrictions))
        return GalileoTree(self.top, tree, laws)

    def _gate(self, line: _Line, name: str, number: Mapping[str, int], special: set[str]) -> Gate:
        kind = line.tokens[1]
        inputs = self._inputs(line, number, special)  # what only constrains never fails, and is no input
        n = len(inputs)
        if kind in ("and", "or"):
            return Gate(name, "at least", inputs, n if kind == "and" else 1)
        if counted := _COUNT.fullmatch(kind):
            k = int(counted[1] or counted[2])
            if not 1 <= k <= n or (counted[3] and int(counted[3]) != n):
                raise line.fault(
                    f"'{kind}' of {n} inputs; expected at least one and at most all of so many as are listed"
                )
            return Gate(name, "at least", inputs, k)
        if kind not in _ORDERED:
            raise line.fault(f"'{kind}' is not taken{nearest(kind, _GATES)}")
        if n > MOST_INPUTS or (kind in ("wsp", "csp", "hsp", "spare") and len(set(inputs)) < n):
            raise line.fault(f"'{kind}' of {n} inputs; expected at most {MOST_INPUTS}, each once")
        return Gate(name, _ORDERED[kind], inputs)

    def _inputs(self, line: _Line, number: Mapping[str, int], without: set[str] | tuple[()]) -> tuple[int, ...]:
        named = [name for name in line.tokens[2:] if name not in without]
        for name in named:
            if name not in number:
                raise line.fault(f"'{name}' is not defined{nearest(name, number)}")
        if not named:
            raise line.fault(f"'{line.tokens[0]}' has no inputs")
        return tuple(number[name] for name in named)

    def _law(self, line: _Line) -> dict[str, float]:
        found: dict[str, float] = {}
        for said in line.tokens[1:]:
            name, equals, text = said.partition("=")
            if not equals or name not in _LAW_NAMES or name in found:
                raise line.fault(f"'{said:.60}' is not taken{nearest(name, _LAW_NAMES)}")
            found[name] = self._number(line, text, name)
        if frozenset(found) - {"dorm"} not in _LAWS:
            known = ", ".join(" and ".join(sorted(law)) for law in _LAWS)
            raise line.fault(f"'{line.tokens[0]}' has {', '.join(found)}; expected {known}")
        for name, value in found.items():
            least, most = (-math.inf if name == "mean" else 0.0), (1.0 if name in ("prob", "dorm") else math.inf)
            above = name in ("rate", "shape", "stddev", "phases")
            if not least <= value <= most or (above and not value) or (name == "phases" and value != int(value)):
                raise line.fault(f"{name}={value:g}; expected one that can be")
        return found

    @staticmethod
    def _number(line: _Line, text: str, name: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise line.fault(f"{name}={text!r:.60}; expected a number")
        return value


def _basic(name: str, law: Mapping[str, float]) -> Basic:
    return Basic(name, law.get("lambda", 0.0), law.get("dorm", 1.0), law.get("prob") == 1.0)


def _failed_by(law: Mapping[str, float], time: float) -> float:
    """P(failed by a time) of a law that is not exponential."""
    from scipy.special import gammainc, ndtr

    if "prob" in law:
        return law["prob"]
    if "phases" in law:
        return float(gammainc(law["phases"], law["lambda"] * time))
    if "shape" in law:
        return -math.expm1(-((law["rate"] * time) ** law["shape"]))
    return float(ndtr((math.log(time) - law["mean"]) / law["stddev"])) if time > 0 else 0.0
