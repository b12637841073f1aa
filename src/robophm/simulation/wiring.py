"""The wiring of a design for the simulator: diagrams, networks and names become the structure of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from robophm.core.errors import nearest
from robophm.simulation.design_keys import MAX_DEPTH, LocatedError, Place, known_keys, read_whole
from robophm.simulation.structure import Block, Group, Route

MOST_BLOCKS = 1_000_000
"""The most blocks in all diagrams of a robot."""


class Wiring:
    """The diagrams of all levels as blocks; each module is expanded once."""

    def __init__(self, levels: Mapping[str, dict[str, Any]], components: Mapping[str, Group]) -> None:
        self.levels = levels
        self.components = components
        self.expanded: dict[str, Block] = {}
        self.under_way: list[str] = []
        self.blocks = 0

    def module(self, path: str, place: Place) -> Block:
        """Return the block of a module, or of the robot. Raises LocatedError."""
        if path in self.under_way:
            raise LocatedError(place, f"cycle: '{path or 'the robot'}' contains itself")
        if path not in self.expanded:
            self.under_way.append(path)
            level = self.levels[path]
            names = [*(level.get("modules") or {}), *(level.get("components") or {})]
            diagram = level.get("diagram")
            if diagram is None:
                diagram = {"series": [str(name) for name in names]}
            self.expanded[path] = self.block(path, diagram, (*self._place(path), "diagram"), 0)
            self.under_way.pop()
        return self.expanded[path]

    def block(self, level: str, diagram: Any, place: Place, depth: int) -> Block:
        """Return the block that a diagram describes, whose names are those of a level. Raises LocatedError."""
        self.blocks += 1
        if self.blocks > MOST_BLOCKS or depth > MAX_DEPTH:
            raise LocatedError(place, f"a diagram of more than {MOST_BLOCKS:,} blocks, or more than {MAX_DEPTH} deep")
        if isinstance(diagram, str):
            return self._named(level, diagram, place)
        kinds = list(diagram) if isinstance(diagram, dict) else []
        if kinds and kinds[0] in ("standby", "load_sharing"):
            raise LocatedError(
                place, f"{kinds[0]}: parts that depend on each other are not simulated; expected other blocks"
            )
        if len(kinds) != 1 or kinds[0] not in ("series", "parallel", "k_of_n", "network"):
            raise LocatedError(
                place, "not a block; expected a part's name, or one of series, parallel, k_of_n, network"
            )
        kind, inside = kinds[0], diagram[kinds[0]]
        if kind == "network":
            return self._network(level, inside, place, depth)
        k: Any = 1
        if kind == "k_of_n":
            known_keys(place, inside, "k_of_n")
            k, inside = inside.get("k"), inside.get("of")
        if not isinstance(inside, list) or not inside:
            raise LocatedError(place, f"{kind} of nothing; expected a list of blocks")
        blocks = tuple(self.block(level, one, place, depth + 1) for one in inside)
        return Group(len(blocks) if kind == "series" else read_whole(place, k, len(blocks)), blocks)

    def _network(self, level: str, said: Any, place: Place, depth: int) -> Block:
        known_keys(place, said, "network")
        start, end = str(said.get("from")), str(said.get("to"))
        lists = [said.get(name) or [] for name in ("links", "junctions")]
        if not all(isinstance(one, list) for one in lists):
            raise LocatedError(place, "expected lists of links and junctions")
        links: list[tuple[str, str, Block | None]] = []
        for link in lists[0]:
            if isinstance(link, list):
                links += [way for a, b in pairwise(map(str, link)) for way in ((a, b, None), (b, a, None))]
                continue
            known_keys((*place, "links"), link, "link")
            block = link.get("through")
            through = None if block is None else self.block(level, block, (*place, "links"), depth + 1)
            joined = link.get("between", [link.get("from"), link.get("to")])
            if not isinstance(joined, list) or len(joined) != 2:
                raise LocatedError((*place, "links"), f"{joined!r:.60} joins no two nodes")
            a, b = map(str, joined)
            links += [(a, b, through)] + [(b, a, through)] * ("between" in link)
        named = dict.fromkeys(name for a, b, _ in links for name in (a, b))
        perfect = {name for name in (start, end) if not self._is_part(level, name)} | set(map(str, lists[1]))
        nodes = {name: self._named(level, name, (*place, "links")) for name in named if name not in perfect}
        ends = {str(start)}
        for _ in named:
            ends |= {b for a, b, _ in links if a in ends}
        if end not in ends or start == end:
            raise LocatedError(place, f"no path leads from '{start}' to '{end}'")
        return Route(start, end, tuple(links), nodes)

    def _is_part(self, level: str, name: str) -> bool:
        path = name[1:] if name.startswith("/") else f"{level}/{name}" if level else name
        return path.partition("[")[0] in self.components or path in self.levels

    def _named(self, level: str, name: str, place: Place) -> Block:
        path = name[1:] if name.startswith("/") else f"{level}/{name}" if level else name
        stem, bracket, index = path.partition("[")
        if stem in self.components:
            group = self.components[stem]
            members = {str(i): part for i, part in enumerate(group.blocks, 1)}
            if not bracket:
                return group
            if index.removesuffix("]") in members and len(members) > 1:
                return members[index.removesuffix("]")]
            raise LocatedError(place, f"'{name}': expected [1] … [{len(members)}]")
        if path not in self.levels or not path:
            raise LocatedError(
                place, f"unknown part '{name}'{nearest(path, [*self.components, *filter(None, self.levels)])}"
            )
        return self.module(path, place)

    def _place(self, path: str) -> Place:
        return tuple(step for name in path.split("/") if name for step in ("modules", name))
