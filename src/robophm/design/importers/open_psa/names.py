"""Names of an Open-PSA model: what is public has one of its own, what is private only that of where it is defined."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from robophm.core.errors import nearest
from robophm.core.markup import Element


class Named(NamedTuple):
    """A definition: its name in the model, its element, its kind, and the path of what it stands in."""

    name: str
    said: Element
    kind: str
    base: str


class Names:
    """Definitions by their names, and by their paths: "tree.component.name"."""

    def __init__(self) -> None:
        self._named: dict[str, Named] = {}
        self._by_path: dict[str, Named] = {}

    def __iter__(self) -> Iterator[Named]:
        return iter(self._named.values())

    @property
    def named(self) -> Mapping[str, Named]:
        """Return all definitions by their names."""
        return self._named

    def add(self, said: Element, kind: str, base: str, *, public: bool) -> None:
        """Take a definition. Raises DesignError where the name is taken, or none.

        An event without an expression may be said again with one, as of one that is named in a tree and has its
        probability in the model data.
        """
        own = name_of(said)
        if "." in own:
            raise said.fault(f"'{own}' is no name; expected one without a dot")
        path = f"{base}.{own}" if base else own
        one = Named(own if public else path, said, kind, base)
        for first in (self._named.get(one.name), self._by_path.get(path)):
            if first is None:
                continue
            again = first.kind == kind == "basic-event"
            if again and not list(said.inside()):
                return
            if not again or list(first.said.inside()):
                raise said.fault(f"'{own}' is defined twice; first in line {first.said.line}")
        self._named[one.name] = self._by_path[path] = one

    def found(self, said: Element, base: str, kind: str = "") -> Named:
        """Return what an element refers to, which stands in ``base``: what is next to it comes first.

        Raises DesignError where there is none, or one of another ``kind``.
        """
        name = name_of(said)
        found = self._by_path.get(f"{base}.{name}") if base else None
        if found is None:
            found = (self._by_path if "." in name else self._named).get(name)
        what = "parameter " if said.tag == "parameter" else ""
        if found is None:
            raise said.fault(f"{what}'{name}' is not defined{nearest(name, self._named)}")
        if kind and found.kind != kind:
            raise said.fault(f"'{name}' is used as a {kind}, but is a {found.kind}")
        return found


def name_of(said: Element) -> str:
    """Return the name that an element has. Raises DesignError where it has none."""
    name = said.attributes.get("name", "").strip()
    if not name:
        raise said.fault(f"'{said.tag}' has no name")
    return name
