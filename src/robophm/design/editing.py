"""Edits of a design's document, the YAML of its file as nested mappings and lists, comments attached.

Whatever names a part is kept in step: a part that gets another name has it in every diagram, one that is deleted is
drawn nowhere, a new one is drawn in series with what its level has. An edit that cannot be made raises Fault; the
document may then be half changed, and is to be thrown away.
"""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping, MutableSequence, Sequence
from copy import deepcopy
from typing import Any, Literal

from robophm.core.errors import nearest
from robophm.design.fault import Fault, Path
from robophm.design.references import leaves, place_of, rewrite_all

Kind = Literal["series", "parallel", "k_of_n", "standby", "load_sharing"]
PARTS = ("modules", "components")
"""The keys of a level under which its parts stand."""


def put(document: Any, path: Sequence[str], value: Any) -> None:
    """Put a value at a place, what is around it made where it is missing. Raises Fault."""
    if not path:
        raise Fault((), "a whole design is put in place as text")
    around, value = _around(document, path), deepcopy(value)
    key = path[-1]
    if isinstance(around, MutableSequence):
        at = _index(around, path)
        around[at : at + 1] = [value]
        return
    new = key not in around
    around[key] = value
    if new and len(path) >= 2 and path[-2] in PARTS:
        _draw(_at(document, path[:-2]), key)


def delete(document: Any, path: Sequence[str]) -> None:
    """Take away what is at a place; a part also out of all diagrams. Raises Fault where there is nothing."""
    around = _at(document, path[:-1]) if path else None
    if around is None or not _has(around, path[-1]):
        raise Fault(tuple(path), "there is nothing here to delete")
    if isinstance(around, MutableSequence):
        del around[_index(around, path)]
        return
    if len(path) >= 2 and path[-2] in PARTS:
        gone = place_of(path)
        rewrite_all(document, lambda name: None if (name + "/").startswith(gone + "/") else name)
    del around[path[-1]]
    if not around and len(path) > 1:  # no empty 'signals: {}' is left behind
        outer = _at(document, path[:-2])
        if isinstance(outer, MutableMapping):
            del outer[path[-2]]


def rename(document: Any, path: Sequence[str], name: str) -> None:
    """Give what is at a place another name, in the same order, in all diagrams too. Raises Fault."""
    around = _at(document, path[:-1]) if path else None
    if not isinstance(around, MutableMapping) or path[-1] not in around:
        raise Fault(tuple(path), "there is nothing here to rename")
    old = path[-1]
    if name == old:
        return
    level = _at(document, path[:-2]) if len(path) >= 2 and path[-2] in PARTS else None
    taken = around if level is None else [other for key in PARTS for other in level.get(key, ())]
    if name in taken:
        raise Fault(tuple(path), f"'{name}' is there already; names of one level must differ")
    if level is not None:
        was = place_of(path)
        now = f"{was.rpartition('/')[0]}/{name}".lstrip("/")
        rewrite_all(document, lambda said: now + said[len(was) :] if (said + "/").startswith(was + "/") else said)
    _rename_key(around, old, name)


def wire(document: Any, path: Sequence[str], diagram: Any) -> None:
    """Draw a level anew; None: all that it has in series. Raises Fault."""
    level = _level(document, path)
    if diagram is None:
        level.pop("diagram", None)
    else:
        level["diagram"] = diagram


def group(document: Any, path: Sequence[str], members: Sequence[str], kind: Kind, k: int | None = None) -> None:
    """Put parts of one level, which stand side by side in its diagram, into a group. Raises Fault."""
    level = _level(document, path)
    wanted = set(members)
    if len(wanted) < 2:
        raise Fault(tuple(path), "a group needs at least two parts")
    diagram = level.get("diagram")
    if diagram is None:
        diagram = {"series": list(_names(level))}
    elif not (isinstance(diagram, MutableMapping) and "series" in diagram):
        diagram = {"series": [diagram]}
    for blocks in _lists(diagram):
        inside = [i for i, block in enumerate(blocks) if set(leaves(block)) <= wanted]
        if {name for i in inside for name in leaves(blocks[i])} == wanted:
            break
    else:
        raise Fault(
            (*path, "diagram"),
            f"{', '.join(sorted(wanted))} do not stand side by side; expected parts of one row or group",
        )
    taken = [blocks[i] for i in inside]
    for i in reversed(inside):
        del blocks[i]
    blocks.insert(inside[0], _grouped(taken, kind, k, tuple(path)))
    level["diagram"] = _tidy(diagram)


def ungroup(document: Any, path: Sequence[str], members: Sequence[str]) -> None:
    """Dissolve the smallest group that holds all these parts into what is around it. Raises Fault."""
    level = _level(document, path)
    wanted = set(members)
    best: tuple[int, MutableSequence[Any], int] | None = None
    outer: Any = {"series": [level.get("diagram")]}
    for blocks in _lists(outer):
        for i, block in enumerate(blocks):
            held = set(leaves(block)) if not isinstance(block, str) else set()
            if wanted <= held and (best is None or len(held) <= best[0]):
                best = (len(held), blocks, i)
    if best is None or not wanted:
        raise Fault((*path, "diagram"), "these parts are in no group of this level")
    _, blocks, i = best
    blocks[i : i + 1] = _members(blocks[i])
    level["diagram"] = _tidy(outer)


def _level(document: Any, path: Sequence[str]) -> Any:
    level = _at(document, path)
    if not isinstance(level, MutableMapping) or not levels_path(path):
        raise Fault(tuple(path), "is no level of the design; expected the robot or a module")
    return level


def levels_path(path: Sequence[str]) -> bool:
    """Whether a path is that of the robot or a module."""
    return len(path) % 2 == 0 and all(key == "modules" for key in path[::2])


def _names(level: Any) -> Iterator[str]:
    for key in PARTS:
        yield from level.get(key) or ()


def _lists(block: Any) -> Iterator[MutableSequence[Any]]:
    """The lists of blocks in a diagram, inner before outer."""
    if isinstance(block, MutableMapping):
        for kind in ("series", "parallel", "k_of_n"):
            inner = block.get(kind)
            inner = inner.get("of") if kind == "k_of_n" and isinstance(inner, MutableMapping) else inner
            if isinstance(inner, MutableSequence):
                for one in inner:
                    yield from _lists(one)
                yield inner


def _members(block: Any) -> list[Any]:
    inner = next(iter(block.values()))
    return list(inner["of"] if isinstance(inner, MutableMapping) else inner)


def _grouped(taken: list[Any], kind: Kind, k: int | None, path: Path) -> Any:
    if kind in ("series", "parallel"):
        return {kind: taken}
    if kind == "k_of_n":
        return {"k_of_n": {"k": k or max(len(taken) - 1, 1), "of": taken}}
    if not all(isinstance(one, str) for one in taken):
        raise Fault(path, f"{kind.replace('_', ' ')} is of parts and modules, not of groups; put them into a module")
    if kind == "standby":
        return {"standby": {"of": taken, "active": k or 1}}
    return {"load_sharing": {"of": taken, "k": k or 1, "exponent": 1.0}}


def _tidy(block: Any) -> Any:
    """Series inside series run together, groups of one are what they hold."""
    if not isinstance(block, MutableMapping):
        return block
    for kind in ("series", "parallel"):
        if kind in block:
            inner = [_tidy(one) for one in block[kind]]
            if kind == "series":
                inner = [
                    part
                    for one in inner
                    for part in (one["series"] if isinstance(one, MutableMapping) and "series" in one else [one])
                ]
            if len(inner) == 1:
                return inner[0]
            if inner != list(block[kind]):
                block[kind] = inner
    return block


def _draw(level: Any, name: str) -> None:
    """A new part in series with what a level draws; nothing where it draws none."""
    diagram = level.get("diagram")
    if diagram is None or name in leaves(diagram):
        return
    if isinstance(diagram, MutableMapping) and isinstance(diagram.get("series"), MutableSequence):
        diagram["series"].append(name)
    else:
        level["diagram"] = {"series": [diagram, name]}


def _at(document: Any, path: Sequence[str]) -> Any:
    """What is at a place. Raises Fault where there is nothing."""
    here = document
    for n, key in enumerate(path):
        if not _has(here, key):
            known = list(here) if isinstance(here, MutableMapping) else []
            raise Fault(tuple(path[: n + 1]), f"there is no '{key}'{nearest(key, [str(one) for one in known])}")
        here = here[int(key)] if isinstance(here, MutableSequence) else here[key]
    return here


def _around(document: Any, path: Sequence[str]) -> Any:
    """The mapping or list that a place is in, made where there is none. Raises Fault where a value stands instead."""
    here = document
    for n, key in enumerate(path[:-1]):
        if isinstance(here, MutableSequence):
            here = here[_index(here, path[: n + 1])]
        else:
            if here.get(key) is None:
                here[key] = {}
            here = here[key]
        if not isinstance(here, MutableMapping | MutableSequence):
            raise Fault(tuple(path[: n + 1]), "holds a value; expected keys with values")
    return here


def _has(here: Any, key: str) -> bool:
    if isinstance(here, MutableSequence):
        return key.isdecimal() and int(key) < len(here)
    return isinstance(here, MutableMapping) and key in here


def _index(here: MutableSequence[Any], path: Sequence[str]) -> int:
    if not path[-1].isdecimal() or int(path[-1]) > len(here):
        raise Fault(tuple(path), f"'{path[-1]}' is no place in a list of {len(here)}")
    return int(path[-1])


def _rename_key(mapping: Any, old: str, new: str) -> None:
    """In its place, with the comments that stand there."""
    if hasattr(mapping, "insert"):  # ruamel's, which keeps comments by key
        at, value = list(mapping).index(old), mapping[old]
        comment = mapping.ca.items.get(old)
        del mapping[old]
        mapping.insert(at, new, value)
        if comment is not None:
            mapping.ca.items[new] = comment
        return
    items = [(new if key == old else key, value) for key, value in mapping.items()]
    mapping.clear()
    mapping.update(items)
