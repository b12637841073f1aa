"""Random messages of any type, made of what a message class of rosbags takes."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype

from robophm.transports.message_type import numeric_fields

RANGES = {
    f"{sign}int{bits}": (0, 2**bits - 1) if sign else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)
    for sign in ("", "u")
    for bits in (8, 16, 32, 64)
} | {"byte": (-128, 127), "char": (0, 255)}
DTYPES = {"byte": "int8", "char": "uint8"}


def number(chance: random.Random, name: str) -> Any:
    if name == "bool":
        return chance.random() < 0.5
    if name in RANGES:
        return chance.choice([*RANGES[name], chance.randint(*RANGES[name])])
    value = chance.choice([float("nan"), float("inf"), -0.0, chance.uniform(-1e6, 1e6)])
    return float(np.float32(value)) if name == "float32" else value


def single(store: Any, chance: random.Random, description: Any, longest: int) -> Any:
    node, detail = description
    if node == Nodetype.NAME:
        return message(store, chance, detail, longest)
    if detail[0] == "string":
        return chance.choice(["", "a", "base_link", "ü", "x" * chance.randrange(30)])
    return number(chance, detail[0])


def value(store: Any, chance: random.Random, description: Any, longest: int) -> Any:
    node, detail = description
    if node not in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        return single(store, chance, description, longest)
    inner, length = detail
    if node == Nodetype.SEQUENCE:
        length = chance.randint(0, min(longest, length or longest))
    values = [single(store, chance, inner, longest) for _ in range(length)]
    if inner[0] == Nodetype.BASE and inner[1][0] != "string":
        return np.array(values, DTYPES.get(inner[1][0], inner[1][0]))
    return values


def message(store: Any, chance: random.Random, type_: str, longest: int = 4) -> Any:
    """A message; sequences have up to ``longest`` elements."""
    definition = store.fielddefs[type_][1]
    return store.types[type_](*(value(store, chance, description, longest) for _, description in definition))


def numeric_types(store: Any) -> list[str]:
    """Every type of the store that holds a number."""
    return [name for name in sorted(store.fielddefs) if any(numeric_fields(store.fielddefs, name))]


def indexed(store: Any, type_: str, chance: random.Random, longest: int = 4) -> Iterator[str]:
    """Every numeric field of a type, each array in it at some index that may be beyond a sequence's end."""
    for field in numeric_fields(store.fielddefs, type_):
        part, path = type_, []
        for step in field.split("."):
            name = step.removesuffix("[]")
            (node, detail) = dict(store.fielddefs[part][1])[name]
            if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
                (node, inner), length = detail
                path.append(f"{name}[{chance.randrange(length if (length and length < 100) else longest)}]")
            else:
                path.append(name)
                inner = detail
            part = inner
        yield ".".join(path)


assert re
