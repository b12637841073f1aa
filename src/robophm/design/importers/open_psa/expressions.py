"""The probability of a basic event: what the Open-PSA model exchange format calls an expression."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from robophm.core.errors import nearest
from robophm.core.markup import Element
from robophm.design.importers.open_psa.deviates import DEVIATES, Levels
from robophm.design.importers.open_psa.names import Named, Names
from robophm.design.importers.open_psa.periodic_tests import unavailability

_DEPTH = 50  # parameters that are made of parameters

_FUNCTIONS: Mapping[str, tuple[int, int, Callable[..., float]]] = {
    # fewest and most arguments
    "neg": (1, 1, lambda x: -x),
    "add": (1, 1000, lambda *xs: math.fsum(xs)),
    "sub": (1, 1000, lambda x, *xs: x - math.fsum(xs)),
    "mul": (1, 1000, lambda *xs: math.prod(xs)),
    "div": (2, 2, lambda x, y: x / y),
    "pow": (2, 2, math.pow),
    "exp": (1, 1, math.exp),
    "log": (1, 1, math.log),
    "log10": (1, 1, math.log10),
    "sqrt": (1, 1, math.sqrt),
    "abs": (1, 1, abs),
    "ceil": (1, 1, math.ceil),
    "floor": (1, 1, math.floor),
    "mod": (2, 2, math.fmod),
    "sin": (1, 1, math.sin),
    "cos": (1, 1, math.cos),
    "tan": (1, 1, math.tan),
    "asin": (1, 1, math.asin),
    "acos": (1, 1, math.acos),
    "atan": (1, 1, math.atan),
    "sinh": (1, 1, math.sinh),
    "cosh": (1, 1, math.cosh),
    "tanh": (1, 1, math.tanh),
    "mean": (1, 1000, lambda *xs: math.fsum(xs) / len(xs)),
    "min": (1, 1000, min),
    "max": (1, 1000, max),
    "not": (1, 1, lambda x: float(not x)),
    "and": (1, 1000, lambda *xs: float(all(xs))),
    "or": (1, 1000, lambda *xs: float(any(xs))),
    "eq": (2, 2, lambda x, y: float(x == y)),
    "df": (2, 2, lambda x, y: float(x != y)),
    "lt": (2, 2, lambda x, y: float(x < y)),
    "gt": (2, 2, lambda x, y: float(x > y)),
    "leq": (2, 2, lambda x, y: float(x <= y)),
    "geq": (2, 2, lambda x, y: float(x >= y)),
    "ite": (3, 3, lambda condition, x, y: x if condition else y),
    "periodic-test": (4, 11, unavailability),
}
_TIMED = ("exponential", "GLM", "Weibull")
Life = Mapping[str, float]
"""Life of a part: its rate [1/h], or scale [h], shape and location [h] of a Weibull distribution."""

_UNITS = ("bool", "int", "float", "hours", "hours-1", "demands")


class Expressions:
    """The parameters of a model, and what expressions are worth at a mission time [h], None where none is given."""

    def __init__(self, parameters: Names, time: float | None) -> None:
        self.parameters, self.time = parameters, time
        self.uncertain: set[int] = set()
        """The uncertain expressions that were worked out; of each the mean is taken, unless draws are."""
        self._levels: Levels | None = None
        self._initiating = ""
        self._states: Mapping[str, str] = {}
        self._base = ""  # where the expression stands that is worked out
        self._values: dict[str, float] = {}
        self._under_way: list[str] = []

    def drawn(self, levels: Levels | None) -> None:
        """Take the draw of these levels from now on in place of means, or means again."""
        self._levels = levels
        self._values.clear()

    def happened(self, initiating: str, states: Mapping[str, str]) -> None:
        """Tell what tests in expressions are about from now on: the initiating event, and the states of the functional
        events so far."""
        self._initiating, self._states = initiating, states
        self._values.clear()  # a parameter may be made of a test

    def check(self) -> None:
        """Work out every parameter. Raises DesignError for one that has no value."""
        for one in self.parameters:
            self._worth(one, one.said)

    def probability(self, event: Element, base: str = "") -> tuple[float, float]:
        """(p, 1 − p) of a basic event that is defined in ``base``.

        Raises DesignError where it has none, or one outside [0, 1].
        """
        self._base = base
        inside = list(event.inside())
        name = event.attributes.get("name")
        if len(inside) != 1:
            raise event.fault(f"'{name}' has {len(inside)} expressions; expected its probability")
        said = inside[0]
        if said.tag in _TIMED:
            cumulative = self._cumulative_hazard(said)
            if cumulative is not None:
                return -math.expm1(-cumulative), math.exp(-cumulative)
        p = self.value(said)
        if self._levels is not None:
            p = min(max(p, 0.0), 1.0)  # a draw far out of a distribution that is not of probabilities
        if not 0 <= p <= 1:
            raise said.fault(f"'{name}' has the probability {p:g}; expected 0 … 1")
        return p, 1.0 - p

    def life(self, event: Element, base: str = "") -> Life | None:
        """Return the life of a basic event of constant or Weibull rate until the mission time; None for any other."""
        self._base = base
        said = next(iter(event.inside()), None)
        if said is None or said.tag not in ("exponential", "Weibull"):
            return None
        *parameters, time = said.inside()
        if not self._is_mission_time(time):
            return None
        names = ("rate",) if said.tag == "exponential" else ("scale", "shape", "location")
        found = {name: self.value(one) for name, one in zip(names, parameters, strict=True)}
        return found if found.get("location", 0.0) >= 0 else None

    def _is_mission_time(self, said: Element) -> bool:
        base = self._base
        while said.tag == "parameter":
            found = self.parameters.found(said, base)
            said, base = next(iter(found.said.inside())), found.base
        return said.tag == "system-mission-time"

    def value(self, said: Element) -> float:
        """Return the value of an expression."""
        if said.tag in ("float", "int", "bool"):
            return self._number(said)
        if said.tag == "pi":
            return math.pi
        if said.tag == "parameter":
            return self._parameter(said)
        if said.tag == "system-mission-time":
            if self.time is None:
                raise said.fault("asks for the mission time; expected the mission time, in hours")
            return self.time
        if said.tag == "test-initiating-event":
            return float(said.attributes.get("name") == self._initiating)
        if said.tag == "test-functional-event":
            return float(self._states.get(said.attributes.get("name", "")) == said.attributes.get("state", ""))
        if said.tag in _TIMED:
            cumulative = self._cumulative_hazard(said)
            return (
                self._guarded(said, _glm, self._arguments(said, 4, 4))
                if cumulative is None
                else -math.expm1(-cumulative)
            )
        if said.tag in DEVIATES:
            return self._deviate(said)
        if said.tag == "switch" and said.children:
            return self._switched(said)
        if said.tag not in _FUNCTIONS:
            known = (*_FUNCTIONS, *DEVIATES, *_TIMED, "float", "int", "bool", "parameter", "switch",
                     "system-mission-time")  # fmt: skip
            raise said.fault(f"expression '{said.tag}' is not taken{nearest(said.tag, known)}")
        fewest, most, function = _FUNCTIONS[said.tag]
        return self._guarded(said, function, self._arguments(said, fewest, most))

    def _switched(self, said: Element) -> float:
        """The value of the first case whose condition is true, or of the last expression; all are worked out."""
        *cases, other = said.inside()
        found = self.value(other)
        for case in reversed(cases):
            inside = list(case.inside())
            if case.tag != "case" or len(inside) != 2:
                raise case.fault(f"'{case.tag}' of {len(inside)} expressions; expected a case: a condition and a value")
            condition, value = map(self.value, inside)
            found = value if condition else found
        return found

    def _deviate(self, said: Element) -> float:
        kind = DEVIATES[said.tag]
        arguments = self._arguments(said, kind.fewest, kind.most)
        if not kind.valid(*arguments):
            raise said.fault(f"'{said.tag}' of {', '.join(f'{x:g}' for x in arguments)}; expected {kind.expected}")
        self.uncertain.add(id(said))
        if self._levels is None:
            return self._guarded(said, kind.mean, arguments)
        return self._guarded(said, kind.quantile, [self._levels.of(said), *arguments])

    def _number(self, said: Element) -> float:
        text = said.attributes.get("value", "")
        if said.tag == "bool" and text in ("true", "false"):
            return float(text == "true")
        try:
            number = float(text) if said.tag != "bool" else math.nan
        except ValueError:
            says = f"{said.tag} value {text!r:.60} is no number; expected one without a unit"
            raise said.fault(says) from None
        if not math.isfinite(number):
            raise said.fault(f"{said.tag} value {text!r:.60} is not a finite number")
        return number

    def _parameter(self, said: Element) -> float:
        found = self.parameters.found(said, self._base)
        asked, unit = said.attributes.get("unit"), found.said.attributes.get("unit", "float")
        if asked and asked != found.said.attributes.get("unit", asked):
            raise said.fault(f"parameter '{found.name}' is in {unit} and asked for in {asked}; expected the same unit")
        return self._worth(found, said)

    def _worth(self, found: Named, said: Element) -> float:
        """The value of a parameter, for which an element asks."""
        name, definition = found.name, found.said
        if name not in self._values:
            unit = definition.attributes.get("unit", "float")
            if name in self._under_way:
                circle = " → ".join([*self._under_way[self._under_way.index(name) :], name])
                raise said.fault(f"loop: parameter {circle}")
            if len(self._under_way) >= _DEPTH:
                raise said.fault(f"more than {_DEPTH} parameters that are made of each other")
            if unit not in _UNITS:
                raise definition.fault(f"unit '{unit}' is not taken; expected {', '.join(_UNITS)}")
            inside = list(definition.inside())
            if len(inside) != 1:
                raise definition.fault(f"parameter '{name}' has {len(inside)} expressions, not one")
            self._under_way.append(name)
            outside, self._base = self._base, found.base
            self._values[name] = self.value(inside[0])
            self._base = outside
            self._under_way.pop()
        return self._values[name]

    def _arguments(self, said: Element, fewest: int, most: int) -> list[float]:
        inside = [inner for one in said.inside() for inner in (one.inside() if one.tag == "bin" else (one,))]
        if not fewest <= len(inside) <= most:
            expected = str(fewest) if fewest == most else f"at least {fewest}"
            raise said.fault(f"'{said.tag}' has {len(inside)} arguments; expected {expected}")
        return [self.value(one) for one in inside]

    def _cumulative_hazard(self, said: Element) -> float | None:
        """The cumulative hazard of an expression that has one; a GLM with repair has none."""
        if said.tag == "exponential":
            rate, time = self._arguments(said, 2, 2)
            hazard = rate * time
        elif said.tag == "Weibull":
            scale, shape, start, time = self._arguments(said, 4, 4)
            if not (scale > 0 and shape > 0):
                raise said.fault(f"Weibull of scale {scale:g}, shape {shape:g}; expected above zero")
            hazard = self._guarded(said, math.pow, [max(time - start, 0.0) / scale, shape])
        else:
            return None
        if not hazard >= 0:
            raise said.fault(f"'{said.tag}' of a negative rate or time")
        return hazard

    def _guarded(self, said: Element, function: Callable[..., float], arguments: list[float]) -> float:
        try:
            value = function(*arguments)
        except (ArithmeticError, ValueError):
            value = math.nan
        if not math.isfinite(value):
            raise said.fault(f"'{said.tag}' of {', '.join(f'{x:g}' for x in arguments)} is not a number")
        return value


def _glm(gamma: float, rate: float, repair: float, time: float) -> float:
    """The probability of what fails on demand or at a rate, and is repaired at a rate (MEF 2.0d, section 4.3.2)."""
    if rate + repair == 0:
        return gamma
    return (rate - (rate - gamma * (rate + repair)) * math.exp(-(rate + repair) * time)) / (rate + repair)
