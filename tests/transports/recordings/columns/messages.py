"""Random messages of any type of a type store of rosbags, and the fields to ask them for."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype

from robophm.transports.signals.message_type import numeric_fields

INTEGERS = {f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)}
INTEGERS |= {f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)}
INTEGERS |= {"byte": INTEGERS["int8"], "char": INTEGERS["uint8"]}


def message(store: Any, chance: random.Random, type_: str, longest: int = 4) -> Any:
    """A message whose sequences have up to ``longest`` elements."""
    values = [_value(store, chance, description, longest) for _, description in store.fielddefs[type_][1]]
    return store.types[type_](*values)


def numeric_types(store: Any) -> list[str]:
    """Every type of the store that holds a number."""
    return [name for name in sorted(store.fielddefs) if any(numeric_fields(store.fielddefs, name))]


def fields_of(store: Any, type_: str, chance: random.Random, longest: int = 4) -> Iterator[str]:
    """Every numeric field of a type; of each array in it one element, of a sequence maybe one beyond its end."""
    for field in numeric_fields(store.fielddefs, type_):
        part, path = type_, []
        for name in field.replace("[]", "").split("."):
            node, detail = dict(store.fielddefs[part][1])[name]
            if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
                (_, part), length = detail
                path.append(f"{name}[{chance.randrange(length if node == Nodetype.ARRAY else longest)}]")
            else:
                path.append(name)
                part = detail
        yield ".".join(path)


def _value(store: Any, chance: random.Random, description: Any, longest: int) -> Any:
    node, detail = description
    if node not in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        return _single(store, chance, description, longest)
    inner, length = detail
    if node == Nodetype.SEQUENCE:
        length = chance.randint(0, min(longest, length or longest))
    values = [_single(store, chance, inner, longest) for _ in range(length)]
    if inner[0] == Nodetype.BASE and inner[1][0] != "string":
        return np.array(values, {"byte": "int8", "char": "uint8"}.get(inner[1][0], inner[1][0]))
    return values


def _single(store: Any, chance: random.Random, description: Any, longest: int) -> Any:
    node, detail = description
    if node == Nodetype.NAME:
        return message(store, chance, detail, longest)
    name = detail[0]
    if name == "string":
        return chance.choice(["", "a", "base_link", "ü", "x" * chance.randrange(30)])
    if name == "bool":
        return chance.random() < 0.5
    if name in INTEGERS:
        return chance.choice([*INTEGERS[name], chance.randint(*INTEGERS[name])])
    number = chance.choice([float("nan"), float("inf"), -0.0, chance.uniform(-1e6, 1e6)])
    return float(np.float32(number)) if name == "float32" else number
