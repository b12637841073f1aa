"""How the parts of a design are wired: its diagrams of names become diagrams of units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

from robophm.blocks import diagram as blocks
from robophm.core.errors import StructureError, nearest
from robophm.design import schema
from robophm.design.fault import Fault, Path
from robophm.design.robot import Component, Module


class Wiring:
    """Diagrams of names become diagrams of units; a module drawn inside itself is found."""

    def __init__(
        self, modules: Mapping[str, Any], components: Mapping[str, Component], places: Mapping[str, Path]
    ) -> None:
        self.modules, self.components, self.places = modules, components, places
        self.expanded: dict[str, blocks.Block] = {}
        self.under_way: list[str] = []

    def module(self, module: Module) -> Module:
        """The module and those in it, with their diagrams."""
        inner = tuple(self.module(child) for child in module.modules)
        diagram = self.path(module.path, ())
        return replace(module, modules=inner, wiring=self._wiring(module.path), diagram=diagram)

    def _wiring(self, path: str) -> blocks.Block:
        level = self.modules[path]
        place = (*self.places[path], "diagram")
        if level.diagram is None:
            names = [_join(path, name) for name in (*level.modules, *level.components)]
            return blocks.Series(*names)
        return self._named(path, level.diagram, place)

    def _named(self, level: str, diagram: Any, place: Path) -> blocks.Block:
        """The diagram with every name made a path from the robot down."""
        if isinstance(diagram, str):
            return blocks.Unit(self._resolve(level, diagram, place))
        try:
            if isinstance(diagram, schema.Series):
                return blocks.Series(*self._inner(level, diagram.series, (*place, "series")))
            if isinstance(diagram, schema.Parallel):
                return blocks.Parallel(*self._inner(level, diagram.parallel, (*place, "parallel")))
            if isinstance(diagram, schema.Network):
                return self._network(level, diagram.network, (*place, "network"))
            group = diagram.k_of_n
            return blocks.KOutOfN(group.k, *self._inner(level, group.of, (*place, "k_of_n", "of")))
        except StructureError as error:
            raise Fault(place, str(error)) from None

    def _inner(self, level: str, diagrams: Iterable[Any], place: Path) -> list[blocks.Block]:
        return [self._named(level, diagram, (*place, str(i))) for i, diagram in enumerate(diagrams)]

    def _network(self, level: str, network: schema.NetworkGroup, place: Path) -> blocks.Network:
        links: list[blocks.Link] = []
        for i, said in enumerate(network.links):
            at = (*place, "links", str(i))
            if isinstance(said, list):
                links += [blocks.Link(start, end) for start, end in pairwise(said)]
                continue
            start, end = said.between or (str(said.start), str(said.end))
            through = self._named(level, said.through, (*at, "through")) if said.through is not None else None
            links.append(blocks.Link(start, end, through, one_way=said.between is None))
        ends, nodes = (network.start, network.end), {}
        for name in network.junctions:
            if self._is_part(level, name):
                raise Fault((*place, "junctions"), f"'{name}' is a part, which may fail; expected it in links alone")
            if not any(name in (link.start, link.end) for link in links):
                raise Fault((*place, "junctions"), f"no link joins '{name}' to anything")
        for name in dict.fromkeys(name for link in links for name in (link.start, link.end)):
            if name not in network.junctions and (name not in ends or self._is_part(level, name)):
                if not self._is_part(level, name):
                    known = (*network.junctions, *ends, *self._known(level))
                    raise Fault((*place, "links"), f"'{name}' is neither a part nor in junctions{nearest(name, known)}")
                nodes[name] = blocks.Unit(self._resolve(level, name, (*place, "links")))
        try:
            return blocks.Network(*ends, links, nodes)
        except StructureError as error:
            raise Fault(place, str(error).removeprefix("network: ")) from None

    def _is_part(self, level: str, name: str) -> bool:
        path = (name[1:] if name.startswith("/") else _join(level, name)).partition("[")[0]
        return path in self.components or path in self.modules

    def _resolve(self, level: str, name: str, place: Path) -> str:
        """A name in a diagram: of this level, below it by path, or from the robot down after a leading '/'."""
        path = name[1:] if name.startswith("/") else _join(level, name)
        stem, bracket, _ = path.partition("[")
        component = self.components.get(stem)
        if component and bracket:
            if path in component.units:
                return path
            raise Fault(
                place,
                f"'{name}': {stem} has quantity {component.quantity}; expected [1] … [{component.quantity}]",
            )
        if path in self.modules or component:
            return path
        raise Fault(place, f"unknown part '{name}'{nearest(name, self._known(level))}")

    def _known(self, level: str) -> list[str]:
        """The names that a diagram of this level may draw."""
        paths = (*self.components, *self.modules)
        return [path.removeprefix(f"{level}/") if level else path for path in paths if path]

    def block(self, path: Path, diagram: Any, place: Path) -> blocks.Block:
        """A diagram that a level draws, expanded to units."""
        return self._expand(self._named("/".join(path), diagram, place), place)

    def path(self, path: str, place: Path) -> blocks.Block:
        """The expanded diagram of a module or component, or one member of a component."""
        component = self.components.get(path.partition("[")[0])
        if component:
            if path in component.units:
                return blocks.Unit(path)
            return blocks.KOutOfN(component.required, *component.units)
        if path in self.under_way:
            circle = [*self.under_way[self.under_way.index(path) :], path]
            raise Fault(place, f"cycle: {' → '.join(step or 'the robot' for step in circle)} contains itself")
        if path not in self.expanded:
            self.under_way.append(path)
            self.expanded[path] = self._expand(self._wiring(path), (*self.places[path], "diagram"))
            self.under_way.pop()
        return self.expanded[path]

    def _expand(self, block: blocks.Block, place: Path) -> blocks.Block:
        if isinstance(block, blocks.Unit):
            return self.path(block.name, place)
        return blocks.with_blocks(block, [self._expand(child, place) for child in block.blocks])


def _join(level: str, name: str) -> str:
    return f"{level}/{name}" if level else name


def drawn_names(level: Any) -> Iterable[str]:
    """Every name in every diagram of a design."""
    stack: list[Any] = [level.diagram, *getattr(level, "functions", {}).values()]
    while stack:
        block = stack.pop()
        if isinstance(block, str):
            yield block
        elif isinstance(block, schema.Network):
            for link in block.network.links:
                stack += link if isinstance(link, list) else [*(link.between or (link.start, link.end)), link.through]
        elif block is not None:
            for kind in ("series", "parallel", "k_of_n"):
                inner = getattr(block, kind, None)
                stack.extend(getattr(inner, "of", inner) or ())
    for module in level.modules.values():
        yield from drawn_names(module)
