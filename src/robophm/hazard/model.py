"""A declared model: a formula whose inputs, ranges, units, source and every factor can be asked for.

A hazard model gives a hazard rate, an acceleration gives a factor of it. Both are one function with keyword
inputs and one declaration, from which come the checks of a design
and what ``robophm rate`` lists and explains.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.errors import ModelError, UnitError, nearest
from robophm.core.table import Source, Table, above, below
from robophm.core.units import quantity

Array = npt.NDArray[np.float64]

PER_MILLION_HOURS = 1e-6
"""Factor from the handbooks' failures per 10⁶ h to 1/h."""

FARTHEST = 1e6
"""Largest number that is tried of an input without limits."""

TEMPERATURE = "temperature"
"""The stress that all parts of a place have in common: from it follow the temperatures of cases and junctions."""

BLOCK = 2**16
"""How many samples a formula takes at once: few enough that what it computes on the way stays in the cache."""


@dataclass(frozen=True, eq=False)
class Factor:
    """A number in a formula, with its symbol and where it comes from; products and sums remember their parts."""

    symbol: str
    value: Array | float
    note: str = ""
    parts: tuple[Factor, ...] = ()
    outside: npt.NDArray[np.bool_] | bool = False
    """Flags of where an input is beyond what the handbook covers (an overstress S > 1); shape of ``value``."""
    beyond: Callable[[], str] = str
    """Returns what is then wrong, with the numbers: "the applied voltage 60 V is more than the rated voltage 50 V"."""

    def __mul__(self, other: Factor | float) -> Factor:
        return self._join("·", other, lambda a, b: a * b)

    def __add__(self, other: Factor | float) -> Factor:
        return self._join("+", other, lambda a, b: a + b)

    def _join(self, sign: str, other: Factor | float, of: Callable[[Any, Any], Any]) -> Factor:
        if not isinstance(other, Factor):
            other = Factor(f"{other:g}", other)
        kept = self.parts if self.symbol == sign else (self,)
        return Factor(sign, of(self.value, other.value), parts=(*kept, other))

    def leaves(self) -> Iterator[Factor]:
        """The factors that are not made of others, in the order of the formula."""
        if not self.parts:
            yield self
        for part in self.parts:
            yield from part.leaves()


def more_than(what: str, value: Array | float, limit: str, most: Array | float, unit: str) -> Callable[[], str]:
    """Return a factor's ``beyond``: what is more than which limit; ``most`` and ``value`` [``unit``]."""

    def words() -> str:
        amounts = [f"{float(np.max(number)):.6g} {unit}".rstrip() for number in (value, most)]
        return f"{what} {amounts[0]} is more than {limit} {amounts[1]}"

    return words


Otherwise = Callable[[Mapping[str, Any]], tuple[float, str] | None]
"""A function of the other inputs that gives the value for an open one, and why; None where it does not count."""


@dataclass(frozen=True)
class Choice:
    """An input that is one word of a table or list."""

    options: Table | tuple[str, ...]
    description: str = ""
    default: str | None = None
    aliases: Mapping[str, str] = field(default_factory=dict)
    """Names that people use for an option, and the option: {"mlcc": "CDR"}."""
    required: bool = True
    shared: bool = False
    """Whether its words are those of many models, which are listed once and say nothing of this one."""

    @cached_property
    def _spellings(self) -> Mapping[str, set[str]]:
        spellings: dict[str, set[str]] = {}
        for said, option in (*zip(self.options, self.options, strict=True), *self.aliases.items()):
            spellings.setdefault(_spelled(said), set()).add(option)
        return spellings

    def meant(self, written: str) -> list[str]:
        """The options that a word may mean, in whatever case and with blanks, hyphens or underscores between words."""
        if written in self.options:
            return [written]
        return sorted(self._spellings.get(_spelled(written), ()))

    @property
    def listed(self) -> list[str]:
        """The options as an error or a help text names them; shared ones with the word that is said most for each."""
        words = {option: word for word, option in reversed([*self.aliases.items()])} if self.shared else {}
        return [f"{option} ({words[option]})" if option in words else option for option in self.options]

    def option(self, written: str) -> str | None:
        """The one option that a word means; None where it means none, or more than one."""
        meant = self.meant(written)
        return meant[0] if len(meant) == 1 else None


def _spelled(words: str) -> str:
    """Words without what people vary in writing them: case, and what stands between."""
    return " ".join(re.split(r"[\s_-]+", words.casefold())).strip()


@dataclass(frozen=True)
class Range:
    """An input that is a number in a unit, valid from ``low`` to ``high``, both included."""

    low: float
    high: float
    unit: str
    description: str = ""
    default: float | None = None
    required: bool = True
    whole: bool = False
    """Whether it counts things: pins, gates, contacts."""
    otherwise: Otherwise | None = None
    """Value for an input that may be left open and counts all the same."""
    monotone: int = 0
    """+1 where the result never falls with this input, −1 where it never rises, 0 where it may do either."""
    stress: str = ""
    """Other name by which it is bound or stated of the part itself: a capacitor's ``dc_voltage`` is its ``voltage``."""
    warmth: Literal["ambient", "own"] | None = None
    """Kind of a temperature in operation: that around the part, or the part's own, warmer by a rise; None for
    others."""

    @property
    def driver(self) -> str:
        """The stress that determines it, under whatever name it goes itself; "" where only its own name does."""
        return TEMPERATURE if self.warmth else self.stress

    @property
    def span(self) -> str:
        """The range in words, with its unit: ``-55 … 175 degC``."""
        return f"{self.low:.10g} … {self.high:.10g} {self.unit}".rstrip()

    def holds(self, number: Array | float) -> npt.NDArray[np.bool_]:
        """Return where a number lies in this range; a limit does, however it was rounded on the way."""
        return ~(below(number, self.low) | above(number, self.high))

    def written(self, number: float) -> str:
        """A number of this range with its unit."""
        return f"{number:.10g} {self.unit}".rstrip()


@dataclass(frozen=True)
class Assumed:
    """The value that is assumed for an input that was not stated, and why."""

    value: str | float | None
    """Value that is assumed; None where the input counts as not there."""
    why: str


@dataclass(frozen=True)
class Note:
    """An input that is the user's own words, such as where a figure is from."""

    description: str = ""
    required: bool = True
    default: None = None


Input = Choice | Range | Note

LONGEST_NOTE = 500
"""The most characters of a user's note."""


class Evaluation(NamedTuple):
    """A model's result and, shape for shape, whether an input lay outside the model's printed range."""

    value: Array
    extrapolated: npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Model:
    """A formula with declared inputs. ``unit`` is that of its result: '1/h', or '' for an acceleration."""

    name: str
    formula: str
    source: Source
    unit: str
    inputs: Mapping[str, Input]
    function: Callable[..., Factor] = field(repr=False)
    description: str = ""
    """Title: the first line of its file, or what follows the formula."""

    def __repr__(self) -> str:
        return f"<Model {self.name}: {self.formula}>"

    def __reduce_ex__(self, protocol: Any) -> str | tuple[Any, ...]:
        """One that is declared goes to another process by its name: its function has that name no more."""
        module, name = self.function.__module__, getattr(self.function, "__qualname__", "")
        if getattr(sys.modules.get(module), name, None) is self:
            return _declared, (module, name)
        return super().__reduce_ex__(protocol)

    @cached_property
    def numbers(self) -> Mapping[str, Range]:
        """The inputs that are numbers, and so can be measured."""
        return {name: entry for name, entry in self.inputs.items() if isinstance(entry, Range)}

    @cached_property
    def must_be_given(self) -> tuple[str, ...]:
        """The inputs without which there is no answer."""
        return tuple(name for name, entry in self.inputs.items() if entry.required and entry.default is None)

    def answers_by(self, stress: str) -> bool:
        """Whether it has an input of this name, or one that follows from such a stress."""
        return stress in self.inputs or any(entry.driver == stress for entry in self.numbers.values())

    def settle(self, given: Mapping[str, object]) -> dict[str, str | float]:
        """The inputs as a user wrote them ('60 degC', 'CDR'), converted, checked, with defaults filled in.

        Raises ModelError for an unknown or missing input, a word that is not a choice, a number out of range, and
        UnitError for a number without its unit.
        """
        for name in given:
            if name not in self.inputs:
                raise ModelError(f"{self.name} has no input '{name}'{nearest(name, self.inputs)}")
        settled: dict[str, str | float] = {}
        for name, entry in self.inputs.items():
            value = given.get(name, entry.default)
            if value is None and isinstance(entry, Range) and entry.otherwise:
                continue  # until all choices are known
            if value is None:
                if entry.required:
                    raise ModelError(f"{self.name} needs the input '{name}' ({self.expected(name)})")
            elif isinstance(entry, Note):
                settled[name] = self._words(name, value)
            elif isinstance(entry, Choice):
                meant = entry.meant(str(value))
                if len(meant) != 1:
                    may_be = "; it may be " + " or ".join(f"'{option}'" for option in meant)
                    hint = may_be if meant else nearest(str(value), (*entry.options, *entry.aliases), entry.listed)
                    raise ModelError(f"{self.name}: {name} '{value}' is not one of its choices{hint}")
                settled[name] = meant[0]
            else:
                try:
                    number = quantity(value, entry.unit) if name in given else float(entry.default or 0.0)
                except UnitError as error:
                    raise UnitError(f"{self.name}: {name}: {error}") from None
                if not entry.holds(number):
                    raise ModelError(f"{self.name}: {name} {entry.written(number)} is outside {entry.span}")
                if entry.whole and number != round(number):
                    raise ModelError(f"{self.name}: {name} {entry.written(number)}; expected {self.expected(name)}")
                settled[name] = min(max(number, entry.low), entry.high)
        for name, entry in self.numbers.items():  # what is around the part moves its own temperature, said or not
            if entry.warmth and entry.otherwise and name not in settled and (other := entry.otherwise(settled)):
                settled[name] = float(other[0])
        # A combination that the handbook has no answer for is an error now, not a flag on the robot.
        for factor in self.explain(settled).leaves():
            if np.any(factor.outside):
                what = factor.beyond() or f"{factor.symbol}: {factor.note}"
                raise ModelError(f"{self.name}: {what}: outside the handbook's range")
        return settled

    def _words(self, name: str, value: object) -> str:
        if not isinstance(value, str) or not value.strip() or len(value) > LONGEST_NOTE:
            raise ModelError(f"{self.name}: {name} {value!r:.60}; expected {self.expected(name)}")
        return " ".join(value.split())

    def expected(self, name: str) -> str:
        """Return what an input accepts, in words."""
        entry = self.inputs[name]
        if isinstance(entry, Choice):
            return "one of " + ", ".join(entry.listed)
        if isinstance(entry, Note):
            return f"words, at most {LONGEST_NOTE} characters"
        return f"a whole number of {entry.span}" if entry.whole else entry.span

    def assumed(self, given: Collection[str], settled: Mapping[str, Any]) -> dict[str, Assumed]:
        """The assumption for every input that was not stated, of settled inputs; what does not matter is left out."""
        found: dict[str, Assumed] = {}
        for name, entry in self.inputs.items():
            if name in given:
                continue
            if entry.default is not None:
                found[name] = Assumed(entry.default, "this model's default")
            elif isinstance(entry, Range) and entry.otherwise:
                if other := entry.otherwise(settled):
                    found[name] = Assumed(*other)
            elif isinstance(entry, Range) and self.answers_to(name, settled):
                found[name] = Assumed(None, "not stated, and counts as not there")
        return found

    def answers_to(self, name: str, settled: Mapping[str, Any]) -> bool:
        """Whether a number that settled inputs leave open would change the result: a Zener's voltage would not."""
        entry = self.numbers[name]
        low, high = np.clip((entry.low, entry.high), -FARTHEST, FARTHEST)
        try:
            alone = self.evaluate(settled).value
            value = self.evaluate({**settled, name: np.array([low, (low + high) / 2, high])}).value
        except ModelError:  # it counts with others, which are left open too
            return True
        return not bool(np.all(value == alone))

    def explain(self, inputs: Mapping[str, Any]) -> Factor:
        """The result as a tree of factors. Inputs are settled ones; numbers may be arrays that broadcast."""
        return self.function(**inputs)

    def evaluate(self, inputs: Mapping[str, Any]) -> Evaluation:
        """The result for settled inputs, numbers being scalars or arrays that broadcast. Never raises for a range.

        Raises ModelError where the formula has no answer at all.
        """
        lines = {name: np.asarray(inputs[name]) for name in self.numbers if np.ndim(inputs.get(name, 0.0))}
        shapes = {line.shape for line in lines.values()}
        if len(shapes) == 1 and len(shape := shapes.pop()) == 1 and shape[0] > BLOCK:
            return self._evaluate_in_blocks(inputs, lines, shape[0])
        explained = self.explain(inputs)
        result = np.asarray(explained.value, dtype=float)
        flags = [factor.outside for factor in explained.leaves()]
        for name, entry in self.numbers.items():
            line = lines.get(name)
            if line is not None and line.size and not (entry.low <= line.min() and line.max() <= entry.high):
                flags.append(~entry.holds(line))
            elif line is None and name in inputs:
                flags.append(not entry.holds(inputs[name]))
        # what is one for all samples costs no pass over them
        outside = np.asarray(any(flag for flag in flags if not np.ndim(flag)))
        for flag in flags:
            outside = outside | flag if np.ndim(flag) else outside
        # an input that this choice of others does not use counts too
        shape = np.broadcast_shapes(result.shape, outside.shape, *(line.shape for line in lines.values()))
        return Evaluation(np.broadcast_to(result, shape), np.broadcast_to(outside, shape))

    def _evaluate_in_blocks(self, inputs: Mapping[str, Any], lines: Mapping[str, Array], size: int) -> Evaluation:
        value, extrapolated = np.empty(size), np.empty(size, dtype=bool)
        for start in range(0, size, BLOCK):
            block = slice(start, start + BLOCK)
            value[block], extrapolated[block] = self.evaluate({
                **inputs, **{name: line[block] for name, line in lines.items()}
            })  # fmt: skip
        return Evaluation(value, extrapolated)


def _declared(module: str, name: str) -> Model:
    found: Model = getattr(import_module(module), name)
    return found


def hazard_model(
    *, source: Source, inputs: Mapping[str, Input], unit: str = "1/h"
) -> Callable[[Callable[..., Factor]], Model]:
    """Declare a function as a hazard model; its result is in ``unit``. The first docstring line is the formula."""
    return lambda function: _declare(function, _module_name(function), source, inputs, unit)


def acceleration(*, source: Source, inputs: Mapping[str, Input]) -> Callable[[Callable[..., Factor]], Model]:
    """Declare a function as an acceleration: a factor of the hazard rate that is 1 at the reference stress."""
    return lambda function: _declare(function, function.__name__, source, inputs, "")


def _module_name(function: Callable[..., Factor]) -> str:
    return function.__module__.removeprefix("robophm.hazard.").removeprefix("handbooks.")


def _declare(
    function: Callable[..., Factor], name: str, source: Source, inputs: Mapping[str, Input], unit: str
) -> Model:
    taken = inspect.signature(function).parameters
    if set(taken) != set(inputs):
        raise TypeError(f"{function.__module__}.{function.__qualname__}: declared {set(inputs)}, takes {set(taken)}")
    documentation = inspect.getdoc(function)
    if not documentation:
        raise TypeError(f"{function.__module__}.{function.__qualname__}: no docstring, whose first line is the formula")
    formula, _, more = documentation.partition("\n")
    file = inspect.getmodule(function)
    title = (inspect.getdoc(file) or "").partition("\n")[0] if unit else ""
    description = " ".join(f"{title} {more}".split())
    return Model(name, formula, source, unit, inputs, function, description)
