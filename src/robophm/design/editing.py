"""Edits of a design's document, the YAML of its file as nested mappings and lists, comments attached.

Whatever names a part is kept in step: a part that gets another name has it in every diagram, one that is deleted is
drawn nowhere, a new one is drawn in series with what its level has. An edit that cannot be made raises LocatedError;
the document may then be half changed, and is to be thrown away.
"""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping, MutableSequence, Sequence
from copy import deepcopy
from itertools import count
from typing import Any, Literal

from robophm.core.errors import nearest
from robophm.design.located_error import LocatedError, Path
from robophm.design.references import leaves, place_of, rewrite, rewrite_all, seen_from

Kind = Literal["series", "parallel", "k_of_n", "standby", "load_sharing", "network"]
PARTS = ("modules", "components")
"""The keys of a level under which its parts stand."""


def put(document: Any, path: Sequence[str], value: Any) -> None:
    """Put a value at a place, and make what is around it where that is missing. Raises LocatedError."""
    if not path:
        raise LocatedError((), "a whole design is put in place as text")
    around, value = _around(document, path), deepcopy(value)
    key = path[-1]
    if isinstance(around, MutableSequence):
        at = _index(around, path)
        around[at : at + 1] = [value]
        return
    new = key not in around
    around[key] = value
    if new and len(path) >= 2 and path[-2] in PARTS:
        _draw(value_at(document, path[:-2]), key)


def delete(document: Any, path: Sequence[str]) -> None:
    """Take away what is at a place; a part also out of all diagrams. Raises LocatedError where there is nothing."""
    around = value_at(document, path[:-1]) if path else None
    if around is None or not _has(around, path[-1]):
        raise LocatedError(tuple(path), "there is nothing here to delete")
    if isinstance(around, MutableSequence):
        del around[_index(around, path)]
        return
    if len(path) >= 2 and path[-2] in PARTS:
        gone = place_of(path)
        rewrite_all(document, lambda name: None if (name + "/").startswith(gone + "/") else name)
    del around[path[-1]]
    if not around and len(path) > 1:  # no empty 'signals: {}' is left behind
        outer = value_at(document, path[:-2])
        if isinstance(outer, MutableMapping):
            del outer[path[-2]]


def rename(document: Any, path: Sequence[str], name: str) -> None:
    """Give what is at a place another name, in the same order, in all diagrams too. Raises LocatedError."""
    around = value_at(document, path[:-1]) if path else None
    if not isinstance(around, MutableMapping) or path[-1] not in around:
        raise LocatedError(tuple(path), "there is nothing here to rename")
    old = path[-1]
    if name == old:
        return
    level = value_at(document, path[:-2]) if len(path) >= 2 and path[-2] in PARTS else None
    taken = around if level is None else [other for key in PARTS for other in level.get(key, ())]
    if name in taken:
        raise LocatedError(tuple(path), f"'{name}' is there already; names of one level must differ")
    if level is not None:
        was = place_of(path)
        now = f"{was.rpartition('/')[0]}/{name}".lstrip("/")
        rewrite_all(document, lambda said: now + said[len(was) :] if (said + "/").startswith(was + "/") else said)
    _rename_key(around, old, name)


def wire(document: Any, path: Sequence[str], diagram: Any) -> None:
    """Draw a level anew; None: all that it has in series. Raises LocatedError."""
    level = _level(document, path)
    if diagram is None:
        level.pop("diagram", None)
    else:
        level["diagram"] = diagram


def group(document: Any, path: Sequence[str], members: Sequence[str], kind: Kind, k: int | None = None) -> None:
    """Put parts of one level, which stand side by side in its diagram, into a group. Raises LocatedError."""
    level = _level(document, path)
    wanted = set(members)
    if len(wanted) < 2:
        raise LocatedError(tuple(path), "a group needs at least two parts")
    diagram = level.get("diagram")
    if diagram is None:
        diagram = {"series": list(_names(level))}
    elif not (isinstance(diagram, MutableMapping) and "series" in diagram):
        diagram = {"series": [diagram]}
    for blocks in _rows(diagram, dependent=False):
        inside = [i for i, block in enumerate(blocks) if set(leaves(block)) <= wanted]
        if {name for i in inside for name in leaves(blocks[i])} == wanted:
            break
    else:
        raise LocatedError(
            (*path, "diagram"),
            f"{', '.join(sorted(wanted))} do not stand side by side; expected parts of one row or group",
        )
    taken = [blocks[i] for i in inside]
    for i in reversed(inside):
        del blocks[i]
    blocks.insert(inside[0], _grouped(taken, kind, k, tuple(path), {*_names(level)}))
    level["diagram"] = _tidy(diagram)


def move(document: Any, path: Sequence[str], to: Sequence[str]) -> None:
    """Take a part to another level, in series with what that draws; whoever names it goes on to. Raises LocatedError.

    ``to`` is the place of a module, or () for the robot.
    """
    if len(path) < 2 or path[-2] not in PARTS:
        raise LocatedError(tuple(path), "is no part; expected a module or a component")
    around, source, target = value_at(document, path[:-1]), value_at(document, path[:-2]), _level(document, to)
    was, now, name = place_of(path), place_of((*to, *path[-2:])), path[-1]
    if not _has(around, name):
        raise LocatedError(tuple(path), "there is nothing here to move")
    if f"{place_of(to)}/".startswith(f"{was}/"):
        raise LocatedError(tuple(path), "a module cannot be moved into itself")
    if source is target:
        return
    if name in _names(target):
        raise LocatedError((*to, path[-2], name), f"'{name}' is there already; names of one level must differ")
    _undraw(source, {name, f"/{was}"})
    rewrite_all(document, lambda said: now + said[len(was) :] if (said + "/").startswith(was + "/") else said)
    comment = around.ca.items.get(name) if hasattr(around, "ca") else None
    value = around.pop(name)
    if not around:
        del source[path[-2]]
    if isinstance(value, MutableMapping) and "depends_on" in value:
        value["depends_on"] = rewrite(
            value["depends_on"], lambda said: seen_from(place_of(to), place_of(path[:-2]), said)
        )
    held = target.setdefault(path[-2], type(around)())
    held[name] = value
    if comment is not None:
        held.ca.items[name] = comment
    if f"/{now}" not in leaves(target.get("diagram")):
        _draw(target, name)


def place(
    document: Any, path: Sequence[str], members: Sequence[str], beside: Sequence[str] = (), *, before: bool = False
) -> None:
    """Draw parts of a level elsewhere: behind or before others in their smallest common group. Raises LocatedError.

    Beside nothing is at the end of the outermost series. Groups of which all members are taken go along whole.
    """
    level = _level(document, path)
    wanted, diagram = set(members), level.get("diagram")
    unknown = sorted((wanted | set(beside)) - set(_names(level)))
    if unknown or not wanted or wanted & set(beside):
        what = f"there is no '{unknown[0]}' here" if unknown else "parts are placed beside other parts"
        raise LocatedError(tuple(path), what)
    if diagram is None:
        diagram = {"series": list(_names(level))}
    elif not (isinstance(diagram, MutableMapping) and isinstance(diagram.get("series"), MutableSequence)):
        diagram = {"series": [diagram]}
    row, at = _beside(diagram, set(beside), before, tuple(path))
    taken = [deepcopy(block) for block in _whole(diagram, wanted)]
    taken += [name for name in members if name not in {_stem(leaf) for block in taken for leaf in leaves(block)}]
    free = any(row is one for one in _rows(diagram, dependent=False))
    if not free and not all(isinstance(block, str) for block in taken):
        raise LocatedError(tuple(path), "standby and load sharing are of parts and modules, not of groups")
    row.insert(at, _HERE)
    diagram = rewrite(diagram, lambda name: None if _stem(name) in wanted else name)
    for blocks in _rows(diagram if isinstance(diagram, MutableMapping) else (diagram := {"series": [diagram]})):
        if _HERE in blocks:
            i = blocks.index(_HERE)
            blocks[i : i + 1] = taken
    level["diagram"] = _tidy(diagram)


_HERE = "\0"  # where something will be drawn; no part has this name


def _stem(name: str) -> str:
    """The part's name without a member's number: 'motor' for 'motor[2]'."""
    return name.partition("[")[0]


def _beside(diagram: Any, beside: set[str], before: bool, path: Path) -> tuple[MutableSequence[Any], int]:
    """The list of the smallest group that holds these, and where in it."""
    if not beside:
        return diagram["series"], len(diagram["series"])
    for blocks in _rows(diagram):
        holding = [i for i, block in enumerate(blocks) if beside & set(map(_stem, leaves(block)))]
        if beside <= {_stem(name) for i in holding for name in leaves(blocks[i])}:
            if any(isinstance(blocks[i], MutableMapping) and "network" in blocks[i] for i in holding):
                raise LocatedError(
                    (*path, "diagram"),
                    f"{', '.join(sorted(beside))}: in a network, whose links say what is beside what",
                )
            return blocks, holding[0] if before else holding[-1] + 1
    raise LocatedError((*path, "diagram"), f"{', '.join(sorted(beside))} are drawn in no group of this level")


def _whole(block: Any, wanted: set[str]) -> Iterator[Any]:
    """The largest blocks that are of these parts alone."""
    held = set(map(_stem, leaves(block)))
    if held and held <= wanted:
        yield block
    elif isinstance(block, MutableMapping):
        for inner in _own_lists(block):
            for one in inner:
                yield from _whole(one, wanted)


def _undraw(level: Any, names: set[str]) -> None:
    """Take a part, or what is in it, out of a level's own diagram."""
    if (diagram := level.get("diagram")) is None:
        return
    left = rewrite(diagram, lambda said: None if any(f"{_stem(said)}/".startswith(f"{n}/") for n in names) else said)
    if left is None:
        del level["diagram"]
    elif left is not diagram:
        level["diagram"] = left


def ungroup(document: Any, path: Sequence[str], members: Sequence[str]) -> None:
    """Dissolve the smallest group that holds all these parts into what is around it. Raises LocatedError."""
    level = _level(document, path)
    wanted = set(members)
    best: tuple[int, MutableSequence[Any], int] | None = None
    outer: Any = {"series": [level.get("diagram")]}
    for blocks in _rows(outer, dependent=False):
        for i, block in enumerate(blocks):
            held = set(leaves(block)) if not isinstance(block, str) else set()
            if wanted <= held and (best is None or len(held) <= best[0]):
                best = (len(held), blocks, i)
    if best is None or not wanted:
        raise LocatedError((*path, "diagram"), "these parts are in no group of this level")
    _, blocks, i = best
    blocks[i : i + 1] = _members(blocks[i], {*_names(level)})
    level["diagram"] = _tidy(outer)


def _level(document: Any, path: Sequence[str]) -> Any:
    level = value_at(document, path)
    if not isinstance(level, MutableMapping) or not levels_path(path):
        raise LocatedError(tuple(path), "is no level of the design; expected the robot or a module")
    return level


def levels_path(path: Sequence[str]) -> bool:
    """Whether a path is that of the robot or a module."""
    return len(path) % 2 == 0 and all(key == "modules" for key in path[::2])


def _names(level: Any) -> Iterator[str]:
    for key in PARTS:
        yield from level.get(key) or ()


def _own_lists(block: Any) -> Iterator[MutableSequence[Any]]:
    """The list of a group's members."""
    for kind in ("series", "parallel", "k_of_n", "standby", "load_sharing"):
        inner = block.get(kind)
        inner = inner.get("of") if isinstance(inner, MutableMapping) else inner
        if isinstance(inner, MutableSequence):
            yield inner


def _rows(block: Any, *, dependent: bool = True) -> Iterator[MutableSequence[Any]]:
    """The lists of members in a diagram, inner before outer; or only those in which groups can stand."""
    if isinstance(block, MutableMapping):
        for inner in _own_lists(block):
            for one in inner:
                yield from _rows(one, dependent=dependent)
            if dependent or not block.keys() & {"standby", "load_sharing"}:
                yield inner


def _members(block: Any, names: set[str]) -> list[Any]:
    """The members of a group; for a network, its parts."""
    if "network" in block:
        return [name for name in dict.fromkeys(leaves(block)) if _stem(name) in names]
    inner = next(iter(block.values()))
    return list(inner["of"] if isinstance(inner, MutableMapping) else inner)


def _grouped(taken: list[Any], kind: Kind, k: int | None, path: Path, names: set[str]) -> Any:
    if kind in ("series", "parallel"):
        return {kind: taken}
    if kind == "k_of_n":
        return {"k_of_n": {"k": k or max(len(taken) - 1, 1), "of": taken}}
    if not all(isinstance(one, str) for one in taken):
        raise LocatedError(
            path, f"{kind.replace('_', ' ')} is of parts and modules, not of groups; put them into a module"
        )
    if kind == "network":
        start, end = (_free(word, names) for word in _ENDS)
        return {"network": {"from": start, "to": end, "links": [[start, one, end] for one in taken]}}
    if kind == "standby":
        return {"standby": {"of": taken, "active": k or 1}}
    return {"load_sharing": {"of": taken, "k": k or 1, "exponent": 1.0}}


_ENDS = ("in", "out")  # of a new network


def _free(word: str, names: set[str]) -> str:
    return next(name for n in count(1) if (name := word if n == 1 else f"{word} {n}") not in names)


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


def value_at(document: Any, path: Sequence[str]) -> Any:
    """Return the value at a place. Raises LocatedError where there is nothing."""
    here = document
    for n, key in enumerate(path):
        if not _has(here, key):
            known = list(here) if isinstance(here, MutableMapping) else []
            raise LocatedError(tuple(path[: n + 1]), f"there is no '{key}'{nearest(key, [str(one) for one in known])}")
        here = here[int(key)] if isinstance(here, MutableSequence) else here[key]
    return here


def _around(document: Any, path: Sequence[str]) -> Any:
    """The mapping or list that a place is in, made where there is none. Raises LocatedError if a value is there."""
    here = document
    for n, key in enumerate(path[:-1]):
        if isinstance(here, MutableSequence):
            here = here[_index(here, path[: n + 1])]
        else:
            if here.get(key) is None:
                here[key] = {}
            here = here[key]
        if not isinstance(here, MutableMapping | MutableSequence):
            raise LocatedError(tuple(path[: n + 1]), "holds a value; expected keys with values")
    return here


def _has(here: Any, key: str) -> bool:
    if isinstance(here, MutableSequence):
        return key.isdecimal() and int(key) < len(here)
    return isinstance(here, MutableMapping) and key in here


def _index(here: MutableSequence[Any], path: Sequence[str]) -> int:
    if not path[-1].isdecimal() or int(path[-1]) > len(here):
        raise LocatedError(tuple(path), f"'{path[-1]}' is no place in a list of {len(here)}")
    return int(path[-1])


def _rename_key(mapping: Any, old: str, new: str) -> None:
    """Rename a key in its place, with the comments that stand there."""
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
