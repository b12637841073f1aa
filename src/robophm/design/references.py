"""Names of parts in a design's document: in diagrams, functions, dependences, common causes, knowledge."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping, MutableSequence, Sequence
from typing import Any

Rewriting = Callable[[str], str | None]
"""A function from the path of a part to its new path, or None where the part is gone."""


def place_of(path: Sequence[str]) -> str:
    """Return the path of the part at a place: Power/Board for modules, Power, modules, Board."""
    return "/".join(path[1::2])


def levels(document: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the robot and its modules as path and mapping, outer before inner."""
    yield path, document
    modules = document.get("modules")
    if isinstance(modules, MutableMapping):
        for name, module in modules.items():
            if isinstance(module, MutableMapping):
                yield from levels(module, f"{path}/{name}" if path else str(name))


def leaves(block: Any) -> Iterator[str]:
    """Yield the names in a diagram, as written."""
    if isinstance(block, str):
        yield block
    elif isinstance(block, MutableSequence):
        for one in block:
            yield from leaves(one)
    elif isinstance(block, MutableMapping):
        for key, inner in block.items():
            if key not in ("k", "active", "dormancy", "switch", "exponent", "factors", "junctions"):
                yield from leaves(inner)


def rewrite_all(document: Any, new: Rewriting) -> None:
    """Rename parts in a whole document by what ``new`` makes of their paths; names of parts that are gone go."""
    for level, said in levels(document):

        def here(name: str, level: str = level) -> str | None:
            return _renamed(name, level, new)

        for holder in (said, *_parts(said)):
            for key in ("diagram", "depends_on"):
                if key in holder and (key == "depends_on" or holder is said):
                    _replace(holder, key, rewrite(holder[key], here))
        for key in ("functions",) if not level else ():
            _each(said, key, here)
        causes = said.get("common_causes")
        for name in list(causes) if isinstance(causes, MutableMapping) else ():
            if isinstance(causes[name], MutableMapping) and "of" in causes[name]:
                _filter(causes[name]["of"], here)
                if len(causes[name]["of"]) < 2:
                    _drop(said, "common_causes", name)


def rewrite(block: Any, new: Rewriting) -> Any:
    """Rename parts in a diagram, changed in place where it is a group; return None where nothing of it is left."""
    if isinstance(block, str):
        return new(block)
    if isinstance(block, MutableSequence):  # a list of what something depends on
        _blocks(block, new)
        return block if len(block) else None
    if not isinstance(block, MutableMapping):
        return block
    for kind in ("series", "parallel"):
        if isinstance(block.get(kind), MutableSequence):
            return _collapsed(block, block[kind], new)
    for kind in ("k_of_n", "standby", "load_sharing"):
        inner = block.get(kind)
        if isinstance(inner, MutableMapping) and isinstance(inner.get("of"), MutableSequence):
            left = _collapsed(block, inner["of"], new)
            for count, most in (("k", len(inner["of"])), ("active", len(inner["of"]) - 1)):
                if isinstance(inner.get(count), int) and inner[count] > max(most, 1):
                    inner[count] = max(most, 1)
            return left
    if isinstance(block.get("network"), MutableMapping):
        return _network(block, new)
    return block


def _network(block: Any, new: Rewriting) -> Any:
    network = block["network"]
    links = network.get("links")
    if not isinstance(links, MutableSequence):
        return block
    nodes = {str(name) for name in network.get("junctions") or ()}

    def keep(name: str) -> str | None:
        return name if name in nodes else new(name)

    for i in reversed(range(len(links))):
        link = links[i]
        if isinstance(link, MutableSequence):
            _filter(link, keep)
            if len(link) < 2:
                del links[i]
        elif isinstance(link, MutableMapping):
            for key in ("from", "to"):
                if key in link and (found := keep(str(link[key]))) is not None:
                    link[key] = found
            if isinstance(link.get("between"), MutableSequence):
                _filter(link["between"], keep)
            if "through" in link:
                _replace(link, "through", rewrite(link["through"], new))
            if "between" in link and len(link["between"]) < 2:
                del links[i]
    for key in ("from", "to"):
        if isinstance(network.get(key), str) and (found := keep(network[key])) is not None:
            network[key] = found
    return block if len(links) else None


def _renamed(name: str, level: str, new: Rewriting) -> str | None:
    """A name as written at a level, after its part's path has changed."""
    stem, bracket, rest = name.partition("[")
    whole = stem.startswith("/")
    path = stem[1:] if whole else f"{level}/{stem}" if level else stem
    found = new(path)
    if found is None or found == path:
        return None if found is None else name
    above = new(level) if level else ""  # the level itself may have another path: what is in it stays
    inside = f"{above}/" if above else ""
    if not whole and found.startswith(inside):
        return found[len(inside) :] + bracket + rest
    return f"/{found}{bracket}{rest}"


def seen_from(level: str, was: str, name: str) -> str:
    """Return a name, written at the level ``was``, as another level has to write it."""
    path = name[1:] if name.startswith("/") else f"{was}/{name}" if was else name
    inside = f"{level}/" if level else ""
    return path[len(inside) :] if path.startswith(inside) else f"/{path}"


def _collapsed(block: Any, inside: Any, new: Rewriting) -> Any:
    before = len(inside)
    _blocks(inside, new)
    if not len(inside):
        return None
    return inside[0] if len(inside) == 1 < before else block


def _blocks(blocks: Any, new: Rewriting) -> None:
    for i in reversed(range(len(blocks))):
        found = rewrite(blocks[i], new)
        if found is None:
            del blocks[i]
        elif found is not blocks[i]:
            blocks[i] = found


def _filter(names: Any, new: Rewriting) -> None:
    for i in reversed(range(len(names))):
        if isinstance(names[i], str) and (found := new(names[i])) != names[i]:
            if found is None:
                del names[i]
            else:
                names[i] = found


def _parts(level: Any) -> Iterator[Any]:
    for key in ("modules", "components"):
        inside = level.get(key)
        if isinstance(inside, MutableMapping):
            yield from (part for part in inside.values() if isinstance(part, MutableMapping))


def _each(holder: Any, key: str, new: Rewriting) -> None:
    inside = holder.get(key)
    for name in list(inside) if isinstance(inside, MutableMapping) else ():
        if (found := rewrite(inside[name], new)) is None:
            _drop(holder, key, name)
        elif found is not inside[name]:
            inside[name] = found


def _drop(holder: Any, key: str, name: str) -> None:
    del holder[key][name]
    if not holder[key]:
        del holder[key]


def _replace(holder: Any, key: str, found: Any) -> None:
    if found is None:
        del holder[key]
    elif found is not holder[key]:
        holder[key] = found
