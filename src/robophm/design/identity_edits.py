"""Edits of a design that keep the identities of what has a past."""

from __future__ import annotations

from collections.abc import Collection, Iterator, MutableMapping, Sequence
from itertools import count
from typing import Any, NamedTuple

from robophm.design import editing

KINDS = ("modules", "components", "failure_modes", "common_causes")
"""The keys under which things stand that have an identity."""


class Lived(NamedTuple):
    """The identities of what has a past."""

    every: Collection[str] = ()
    doubted: Collection[str] | None = ()
    """Identities, by the design as it is, of which it is to be asked whose past they stand for; None: any may be."""

    def is_doubted(self, identity: str) -> bool:
        """Return whether it is to be asked whose past that of something of this identity is."""
        return self.doubted is None or any(f"{identity}/".startswith(f"{one}/") for one in self.doubted)


NOTHING = Lived()
"""The past of a robot that has not lived yet, or of which no past is kept."""


def rename(document: Any, path: Sequence[str], name: str, lived: Lived = NOTHING) -> None:
    """Rename as ``editing.rename``; what has ``lived`` under an identity, keeps it. Raises LocatedError."""
    before = _identity_at(document, path) if _has_identity(path) else ""
    editing.rename(document, path, name)
    if before:
        _keep(document, (*path[:-1], name), before, lived)


def move(document: Any, path: Sequence[str], to: Sequence[str], lived: Lived = NOTHING) -> None:
    """Move as ``editing.move``; what has ``lived`` under an identity, keeps it. Raises LocatedError."""
    before = _identity_at(document, path)
    editing.move(document, path, to)
    _keep(document, (*to, *path[-2:]), before, lived)


def put(document: Any, path: Sequence[str], value: Any, lived: Lived = NOTHING) -> None:
    """Put as ``editing.put``; a new part is none that has ``lived`` under its name before. Raises LocatedError."""
    new = _has_identity(path) and not _is_there(document, path)
    named = document.get("name") if list(path) == ["name"] else None
    editing.put(document, path, value)
    if new and isinstance(value, MutableMapping) and "identity" not in value:
        taken = [one for place, one in _all_identities(document) if list(place) != list(path)]
        identity = _identity_at(document, path)
        if identity in taken or _is_of(identity, lived.every):
            names = (f"{identity} {n}" for n in count(2))
            free = (name for name in names if name not in taken and not _is_of(name, lived.every))
            editing.put(document, (*path, "identity"), next(free))
    if named is not None and "identity" not in document and named in lived.every:
        _put_first(document, "identity", named)


def state(document: Any, path: str, identity: str) -> None:
    """State the identity of a part or module by its path, "" for the robot. Raises LocatedError where there is none."""
    place = place_at(document, path)
    if place:
        editing.put(document, (*place, "identity"), identity)
    else:
        _put_first(document, "identity", identity)


def place_at(document: Any, path: str) -> tuple[str, ...]:
    """Return the place of a part or module by its path. Raises LocatedError where there is none."""
    place: tuple[str, ...] = ()
    for name in path.split("/") if path else ():
        inside = editing.value_at(document, place).get("modules") or {}
        place += ("modules" if name in inside else "components", name)
        editing.value_at(document, place)
    return place


def _put_first(document: Any, key: str, value: Any) -> None:
    """Put a value at the head of a design, behind its name."""
    if key in document or not hasattr(document, "insert"):  # else ruamel's, which keeps an order
        document[key] = value
    else:
        document.insert(list(document).index("name") + 1 if "name" in document else 0, key, value)


def _is_of(identity: str, lived: Collection[str]) -> bool:
    """Whether something of this identity, or in it, is among what has lived."""
    return identity in lived or any(one.startswith((f"{identity}/", f"{identity} (")) for one in lived)


def _keep(document: Any, path: Sequence[str], identity: str, lived: Lived) -> None:
    """Give what is at a place its identity back, stated only where its place does not say it."""
    here = editing.value_at(document, path)
    stated = here.pop("identity", None)
    by_place = _identity_at(document, path)
    taken = {one for place, one in _all_identities(document) if list(place) != list(path)}
    new_to_it = (by_place in taken or _is_of(by_place, lived.every)) and not _is_of(identity, lived.every)
    known = not lived.is_doubted(identity) and (new_to_it or _is_of(identity, lived.every))
    if identity != by_place and (stated or known):
        here["identity"] = identity


def _has_identity(path: Sequence[str]) -> bool:
    return len(path) >= 2 and len(path) % 2 == 0 and all(kind in KINDS for kind in path[::2])


def _is_there(document: Any, path: Sequence[str]) -> bool:
    here = document
    for key in path:
        if not isinstance(here, MutableMapping) or key not in here:
            return False
        here = here[key]
    return True


def _identity_at(document: Any, path: Sequence[str]) -> str:
    found = ""
    for n in range(2, len(path) + 1, 2):
        here = editing.value_at(document, path[:n])
        stated = here.get("identity") if isinstance(here, MutableMapping) else None
        found = str(stated) if stated else f"{found}/{path[n - 1]}".lstrip("/")
    return found


def _all_identities(level: Any, path: tuple[str, ...] = (), above: str = "") -> Iterator[tuple[tuple[str, ...], str]]:
    """The places below a level that have an identity, and these."""
    for kind in KINDS:
        inside = level.get(kind)
        for name, value in inside.items() if isinstance(inside, MutableMapping) else ():
            if isinstance(value, MutableMapping):
                place, stated = (*path, kind, str(name)), value.get("identity")
                identity = str(stated) if stated else f"{above}/{name}".lstrip("/")
                yield place, identity
                yield from _all_identities(value, place, identity)
