"""A user's arithmetic, ``base * exp(0.05 * (t - 25))``: read by a small parser of its own, never run as code.

Numbers, names, ``+ - * / **``, parentheses and the functions below; ``**`` binds as in Python (−2**2 is −4). A text
becomes a list of steps on a stack of NumPy arrays, so that nothing is looked up, called or imported that is not
listed here, and no text makes the reader or the arithmetic work hard.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from robophm.core.errors import ModelError, nearest

Array = npt.NDArray[np.float64]

LONGEST_EXPRESSION = 1000
"""The most characters of an expression."""

MOST_STEPS = 300
"""Numbers, names, operators and calls in one expression."""

DEEPEST = 30
"""Parentheses, signs and powers inside each other."""

FUNCTIONS: Mapping[str, tuple[int, Callable[..., Any]]] = {
    "exp": (1, np.exp),
    "log": (1, np.log),
    "log10": (1, np.log10),
    "sqrt": (1, np.sqrt),
    "abs": (1, np.abs),
    "min": (2, np.minimum),
    "max": (2, np.maximum),
    "pow": (2, np.power),
}
"""Functions that may be called: how many arguments each takes (min and max: at least), and what it does."""

CONSTANTS: Mapping[str, float] = {"pi": math.pi, "e": math.e}

_SIGNS: Mapping[str, Callable[..., Any]] = {
    "+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide, "**": np.power,
}  # fmt: skip
_TOKEN = re.compile(
    r"[ \t\r\n]*(?:(?P<number>(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<sign>\*\*|[-+*/(),]))",
)
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,99}\Z")
_LONGEST_NUMBER = 40


@dataclass(frozen=True)
class Expression:
    """An expression that has been read. ``names`` are the variables in it, in their order."""

    text: str
    names: tuple[str, ...]
    _steps: tuple[float | str | tuple[Callable[..., Any], int], ...]

    def __call__(self, values: Mapping[str, npt.ArrayLike]) -> Array:
        """The value for numbers or arrays that broadcast; NaN or infinite where the arithmetic has no answer."""
        stack: list[Any] = []
        with np.errstate(all="ignore"):
            for step in self._steps:
                if isinstance(step, str):
                    stack.append(np.asarray(values[step], dtype=float))
                elif isinstance(step, float):
                    stack.append(np.float64(step))
                else:
                    function, takes = step
                    arguments = stack[len(stack) - takes :]
                    stack[len(stack) - takes :] = [function(*arguments)]
        result: Array = np.asarray(stack.pop(), dtype=float)
        return result


def check_name(name: str) -> None:
    """Raise ModelError for a name that no variable may have."""
    if not _NAME.match(name):
        raise ModelError(f"'{name}' cannot be a variable; expected letters, digits and _, not first a digit")
    if name in FUNCTIONS or name in CONSTANTS:
        raise ModelError(f"'{name}' cannot be a variable; it is a function or constant of formulas")


def read(text: str, names: Iterable[str]) -> Expression:
    """Read an expression of the given variables. Raises ModelError with the place where it is none."""
    return _Reader(text, names).expression()


class _Words:
    """The words of a text, one at a time: a place that only moves forward."""

    def __init__(self, text: str) -> None:
        if len(text) > LONGEST_EXPRESSION:
            raise ModelError(f"formula is {len(text)} characters long; expected at most {LONGEST_EXPRESSION}")
        self.text = text
        self.at = 0
        self.kind, self.word, self.begins = "", "", 0
        """Kind, text and place of the present word; at the end there is no kind."""
        self.advance()

    def advance(self) -> None:
        match = _TOKEN.match(self.text, self.at)
        if match is None:
            self.begins = self.at + len(self.text[self.at :]) - len(self.text[self.at :].lstrip(" \t\r\n"))
            if self.begins < len(self.text):
                raise self.error("a number, a name or one of + - * / ** ( ) ,")
            self.kind, self.word = "", ""
            return
        self.kind = str(match.lastgroup)
        self.word, self.begins, self.at = match[self.kind], match.start(self.kind), match.end()

    def error(self, expected: str) -> ModelError:
        found = repr(self.text[self.begins : self.begins + 20]) if self.begins < len(self.text) else "the end"
        return ModelError(f"formula, character {self.begins + 1}: expected {expected}; found {found}")


class _Reader(_Words):
    """A reader by precedence of operators; its result has operands first."""

    def __init__(self, text: str, names: Iterable[str]) -> None:
        self.known = frozenset(names)
        self.used: dict[str, None] = {}
        self.steps: list[float | str | tuple[Callable[..., Any], int]] = []
        self.depth = 0
        super().__init__(text)

    def expression(self) -> Expression:
        self.sum()
        if self.kind:
            raise self.error("an operator or the end")
        return Expression(self.text, tuple(self.used), tuple(self.steps))

    def sum(self) -> None:
        self.chain(("+", "-"), lambda: self.chain(("*", "/"), self.signed))

    def chain(self, signs: tuple[str, ...], operand: Callable[[], None]) -> None:
        operand()
        while self.kind == "sign" and self.word in signs:
            sign = self.word
            self.advance()
            operand()
            self.add((_SIGNS[sign], 2))

    def signed(self) -> None:
        """−x and +x, which bind less than a power to their right."""
        if self.kind == "sign" and self.word in ("-", "+"):
            minus = self.word == "-"
            self.advance()
            self.deeper(self.signed)
            if minus:
                self.add((np.negative, 1))
        else:
            self.power()

    def power(self) -> None:
        self.operand()
        if self.word == "**":
            self.advance()
            self.deeper(self.signed)
            self.add((np.power, 2))

    def operand(self) -> None:
        if self.kind == "number":
            value = float(self.word) if len(self.word) <= _LONGEST_NUMBER else math.inf
            if not math.isfinite(value):
                raise self.error("a number that is not too large or long")
            self.add(value)
            self.advance()
        elif self.kind == "name":
            self.named()
        elif self.word == "(":
            self.advance()
            self.deeper(self.sum)
            self.close()
        else:
            raise self.error("a number, a variable, a function or '('")

    def named(self) -> None:
        name = self.word
        if name in FUNCTIONS:
            self.advance()
            self.call(name)
        elif name in CONSTANTS:
            self.add(CONSTANTS[name])
            self.advance()
        elif name in self.known:
            self.used[name] = None
            self.add(name)
            self.advance()
        else:
            known = nearest(name, {*self.known, *FUNCTIONS, *CONSTANTS})
            raise ModelError(f"formula, character {self.begins + 1}: no variable or function '{name[:60]}'{known}")

    def call(self, name: str) -> None:
        if self.word != "(":
            raise self.error(f"'(' after {name}")
        self.advance()
        takes, function = FUNCTIONS[name]
        count = 1
        self.deeper(self.sum)
        while self.word == ",":
            self.advance()
            self.deeper(self.sum)
            count += 1
            if name in ("min", "max"):
                self.add((function, 2))
        if count != takes and (name not in ("min", "max") or count < takes):
            wanted = f"at least {takes}" if name in ("min", "max") else f"{takes}"
            raise self.error(f"{name} to take {wanted}, not {count},")
        if name not in ("min", "max"):
            self.add((function, takes))
        self.close()

    def close(self) -> None:
        if self.word != ")":
            raise self.error("')'")
        self.advance()

    def deeper(self, inside: Callable[[], None]) -> None:
        self.depth += 1
        if self.depth > DEEPEST:
            raise self.error(f"at most {DEEPEST} parentheses, signs and powers inside each other")
        inside()
        self.depth -= 1

    def add(self, step: float | str | tuple[Callable[..., Any], int]) -> None:
        self.steps.append(step)
        if len(self.steps) > MOST_STEPS:
            raise self.error(f"at most {MOST_STEPS} numbers, names and operators")
