"""The block diagrams of a design: its diagrams of names become diagrams of units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from robophm.blocks import diagram as blocks
from robophm.core.errors import StructureError, nearest
from robophm.design import schema_blocks
from robophm.design.located_error import LocatedError, Path
from robophm.design.robot import Component, Module


class DiagramBuilder:
    """Expands diagrams of names to diagrams of units, and finds what contains, or depends on, itself."""

    def __init__(
        self,
        modules: Mapping[str, Any],
        components: Mapping[str, Component],
        places: Mapping[str, Path],
        depends_on: Mapping[str, Any],
        causes: Mapping[str, Sequence[str]],
    ) -> None:
        self.modules, self.components, self.places, self.depends_on = modules, components, places, depends_on
        self.causes = causes
        """Common causes that are in series with each unit."""
        self.expanded: dict[str, blocks.Block] = {}
        self.under_way: list[tuple[str, str]] = []
        """The expansions under way: (what is done, to which path)."""
        self.groups: dict[str, blocks.Group] = {}  # of parts that depend on each other, by name
        self.group_places: dict[str, Path] = {}

    def module(self, module: Module) -> Module:
        """Return the module and those in it, with their diagrams."""
        inner = tuple(self.module(child) for child in module.modules)
        parts = tuple(self.components[part.path] for part in module.components)
        wiring, diagram = self._wiring(module.path), self.path("", module.path, ())
        return replace(module, modules=inner, components=parts, wiring=wiring, diagram=diagram)

    def parts(self, level: str, names: Iterable[str], place: Path) -> list[str]:
        """Return the paths of the components or units that are named at a level."""
        found = []
        for i, name in enumerate(names):
            at = (*place, str(i))
            found.append(self._resolve(level, name, at))
            if found[-1] in self.modules:
                raise LocatedError(at, f"'{name}' is a module; expected a part")
        return found

    def needs(self, path: str) -> blocks.Block:
        """Return the diagram of what a module or component depends on, as drawn."""
        level, said = path.rpartition("/")[0], self.depends_on[path]
        place = (*self.places[path], "depends_on")
        if isinstance(said, list):
            return blocks.Series(*(self._named(level, one, (*place, str(i))) for i, one in enumerate(said)))
        return self._named(level, said, place)

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
            if isinstance(diagram, schema_blocks.Series):
                return blocks.Series(*self._inner(level, diagram.series, (*place, "series")))
            if isinstance(diagram, schema_blocks.Parallel):
                return blocks.Parallel(*self._inner(level, diagram.parallel, (*place, "parallel")))
            if isinstance(diagram, schema_blocks.Network):
                return self._network(level, diagram.network, (*place, "network"))
            if isinstance(diagram, schema_blocks.KOutOfN):
                group = diagram.k_of_n
                return blocks.KOutOfN(group.k, *self._inner(level, group.of, (*place, "k_of_n", "of")))
            return self._group(level, diagram, place)
        except StructureError as error:
            raise LocatedError(place, str(error)) from None

    def _inner(self, level: str, diagrams: Iterable[Any], place: Path) -> list[blocks.Block]:
        return [self._named(level, diagram, (*place, str(i))) for i, diagram in enumerate(diagrams)]

    def _network(self, level: str, network: schema_blocks.NetworkGroup, place: Path) -> blocks.Network:
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
                raise LocatedError(
                    (*place, "junctions"), f"'{name}' is a part, which may fail; expected it in links alone"
                )
            if not any(name in (link.start, link.end) for link in links):
                raise LocatedError((*place, "junctions"), f"no link joins '{name}' to anything")
        for name in dict.fromkeys(name for link in links for name in (link.start, link.end)):
            if name not in network.junctions and (name not in ends or self._is_part(level, name)):
                if not self._is_part(level, name):
                    known = (*network.junctions, *ends, *self._known(level))
                    raise LocatedError(
                        (*place, "links"), f"'{name}' is neither a part nor in junctions{nearest(name, known)}"
                    )
                nodes[name] = blocks.Unit(self._resolve(level, name, (*place, "links")))
        try:
            return blocks.Network(*ends, links, nodes)
        except StructureError as error:
            raise LocatedError(place, str(error).removeprefix("network: ")) from None

    def _group(
        self, level: str, diagram: schema_blocks.Standby | schema_blocks.LoadSharing, place: Path
    ) -> blocks.Block:
        """A group whose members are paths; the equal parts of a component are members of their own."""
        kind, said = ("standby", diagram.standby) if isinstance(diagram, schema_blocks.Standby) else (
            "load_sharing", diagram.load_sharing)  # fmt: skip
        place = (*place, kind)
        members: list[tuple[str, ...]] = []
        for name in said.of:
            path = self._resolve(level, name, place)
            component = self.components.get(path)
            units = component.units if component else (path,)
            if component and component.required not in (1, component.quantity):
                raise LocatedError(
                    place, f"'{name}': {component.required} of {component.quantity}; expected a quantity alone"
                )
            members += [(unit,) for unit in units]
        name = f"{kind.replace('_', ' ')} of {', '.join(member for (member,) in members)}"
        if isinstance(said, schema_blocks.StandbyGroup):
            return blocks.Standby(name, tuple(members), said.active, said.dormancy, said.switch)
        factors = tuple(said.factors or ()) or blocks.equal_share(len(members), said.k, said.exponent or 0.0)
        return blocks.LoadSharing(name, tuple(members), said.k, factors)

    def _expand_group(self, level: str, group: blocks.Group, place: Path) -> blocks.Block:
        """The group down to units, once for each name; in series with what all its members depend on.

        What one member alone depends on is part of it, and ages whichever works.
        """
        paths = [path for (path,) in group.members]
        needed = [series(self.path(level, path, place)) for path in paths]
        common = [
            block for block in needed[0]
            if all(block in others for others in needed[1:]) and not self._of_members(paths, block)
        ]  # fmt: skip
        members, always = [], set[str]()
        for path, wanted in zip(paths, needed, strict=True):
            parts = [self._member(path, block, place) for block in wanted if block not in common]
            for block in parts:
                if not _within(block.name, path):
                    always.add(block.name)
                    others = [one for one, these in zip(paths, needed, strict=True) if one != path and block in these]
                    if any(_within(block.name, one) for one in paths):
                        raise LocatedError(
                            place, f"'{path}' depends on '{block.name}' of its own group; expected on others"
                        )
                    if others:
                        raise LocatedError(
                            place, f"'{path}' and '{others[0]}' depend on '{block.name}', others of their group do "
                            "not; expected that one does, or all",
                        )  # fmt: skip
            members.append(tuple(block.name for block in parts))
        found = replace(group, members=tuple(members), always=frozenset(always))
        if self.groups.setdefault(group.name, found) != found:
            raise LocatedError(place, f"{group.name}: drawn elsewhere with other numbers; expected the same")
        self.group_places.setdefault(group.name, place)
        return blocks.Series(found, *common) if common else found

    def _member(self, path: str, block: blocks.Block, place: Path) -> blocks.Unit:
        """The unit that a block in series in a member of a group has to be. Raises LocatedError."""
        if not isinstance(block, blocks.Unit) or isinstance(block, blocks.Group):
            raise LocatedError(
                place, f"'{path}' is not of parts in series; expected a part, or a module of parts in series"
            )
        component = self.components.get(block.name.partition("[")[0])
        if not component:
            raise LocatedError(
                place, f"'{path}' may fail together with others ({block.name}); expected a part that does not"
            )
        for mode in component.modes:
            if mode.scaling == "hazard":
                raise LocatedError(place, f"{mode.path}: scaling 'hazard' in a group of parts; expected 'age'")
            if mode.uncertainty:
                raise LocatedError(
                    place,
                    f"{mode.path}: 'uncertainty' or an unknown quality in a group; expected an exact rate",
                )
        return block

    def _of_members(self, paths: Iterable[str], block: blocks.Block) -> bool:
        """Whether a block is a part of a member of a group, or a cause by which such parts may fail together."""
        return isinstance(block, blocks.Unit) and any(
            any(_within(unit, path) for path in paths)
            for unit in (block.name, *(unit for unit, causes in self.causes.items() if block.name in causes))
        )

    def check_groups(self, used: Iterable[str]) -> None:
        """Raise LocatedError where a member of a group is drawn outside it too."""
        of: dict[str, str] = {}
        for name, group in self.groups.items():
            for unit in (unit for member in group.members for unit in member):
                other = of.setdefault(unit, name)
                if other != name:
                    raise LocatedError(self.group_places[name], f"'{unit}' is a member of two groups; expected of one")
        if alone := next((unit for unit in sorted(used) if unit in of), None):
            always = alone in self.groups[of[alone]].always
            raise LocatedError(
                self.group_places[of[alone]],
                f"'{alone}', on which a member depends, is needed outside the group too; expected that all members do"
                if always else f"'{alone}' is drawn outside its group too; expected in it alone",
            )  # fmt: skip

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
            raise LocatedError(
                place,
                f"'{name}': {stem} has quantity {component.quantity}; expected [1] … [{component.quantity}]",
            )
        if path in self.modules or component:
            return path
        raise LocatedError(place, f"unknown part '{name}'{nearest(name, self._known(level))}")

    def _known(self, level: str) -> list[str]:
        """The names that a diagram of this level may draw."""
        paths = (*self.components, *self.modules)
        below = f"{level}/" if level else ""
        return [path.removeprefix(below) if path.startswith(below) else f"/{path}" for path in paths if path]

    def block(self, path: Path, diagram: Any, place: Path) -> blocks.Block:
        """Expand a diagram that a level draws to units."""
        level = "/".join(path)
        return self._expand(level, self._named(level, diagram, place), place)

    def path(self, level: str, path: str, place: Path) -> blocks.Block:
        """Return what must work so that a module, component or member, drawn at a level, does its work.

        It needs what it depends on, and what the modules around it do, up to one that is around the level too.
        """
        itself = self._itself(path, place)
        steps = path.partition("[")[0].split("/")
        around = ("/".join(steps[: n + 1]) for n in range(len(steps)))
        needed = [one for one in around if one in self.depends_on and not f"{level}/".startswith(f"{one}/")]
        if not needed:
            return itself
        return blocks.Series(itself, *(self._once("depends on", one, place) for one in needed))

    def _itself(self, path: str, place: Path) -> blocks.Block:
        component = self.components.get(path.partition("[")[0])
        if not component:
            return self._once("contains", path, place)
        if path in component.units:
            return self._unit(path, self.causes.get(path, ()))
        first, *others = (self.causes.get(unit, ()) for unit in component.units)
        of_all = [cause for cause in first if all(cause in causes for causes in others)]  # need not be told apart
        units = (
            self._unit(unit, [cause for cause in self.causes.get(unit, ()) if cause not in of_all])
            for unit in component.units
        )
        group = blocks.KOutOfN(component.required, *units)
        return blocks.Series(group, *of_all) if of_all else group

    @staticmethod
    def _unit(name: str, causes: Sequence[str]) -> blocks.Block:
        return blocks.Series(name, *causes) if causes else blocks.Unit(name)

    def _once(self, what: str, path: str, place: Path) -> blocks.Block:
        """The expanded diagram of what a module contains, or of what something depends on; each is expanded once."""
        key = f"{what} {path}"
        if key not in self.expanded:
            if (what, path) in self.under_way:
                circle = [*self.under_way[self.under_way.index((what, path)) :], (what, path)]
                steps = " → ".join(step or "the robot" for _, step in circle)
                raise LocatedError(place, f"cycle: {steps} {what} itself")
            self.under_way.append((what, path))
            if what == "contains":
                level, drawn, at = path, self._wiring(path), (*self.places[path], "diagram")
            else:
                level, drawn, at = path.rpartition("/")[0], self.needs(path), (*self.places[path], "depends_on")
            self.expanded[key] = self._expand(level, drawn, at)
            self.under_way.pop()
        return self.expanded[key]

    def _expand(self, level: str, block: blocks.Block, place: Path) -> blocks.Block:
        if isinstance(block, blocks.Group):
            return self._expand_group(level, block, place)
        if isinstance(block, blocks.Unit):
            return self.path(level, block.name, place)
        return blocks.with_blocks(block, [self._expand(level, child, place) for child in block.blocks])


def series(block: blocks.Block) -> list[blocks.Block]:
    """Return the blocks that must all work: the diagram itself, or what it is a series of, each once."""
    found: list[blocks.Block] = []
    todo = [block]
    while todo:
        top = todo.pop()
        if isinstance(top, blocks.Series) or (
            isinstance(top, blocks.Parallel | blocks.KOutOfN) and getattr(top, "k", 1) == len(top.blocks)
        ):
            todo += reversed(top.blocks)
        elif top not in found:
            found.append(top)
    return found


def _within(unit: str, path: str) -> bool:
    """Whether a unit is that part, or one in that module."""
    return unit == path or unit.startswith(f"{path}/")


def _join(level: str, name: str) -> str:
    return f"{level}/{name}" if level else name


def distinguished_parts(level: Any) -> Iterable[str]:
    """Yield the names by which a design tells equal parts apart: as 'motor[2]', in a group, or failing together."""
    for group in level.common_causes.values():
        yield from group.of
    stack: list[Any] = [level.diagram, *getattr(level, "functions", {}).values()]
    stack += [below.depends_on for below in (*level.modules.values(), *level.components.values())]
    while stack:
        block = stack.pop()
        if isinstance(block, str):
            if block.endswith("]"):
                yield block
        elif isinstance(block, list):
            stack += block
        elif isinstance(block, schema_blocks.Standby | schema_blocks.LoadSharing):
            yield from (block.standby if isinstance(block, schema_blocks.Standby) else block.load_sharing).of
        elif isinstance(block, schema_blocks.Network):
            stack += block.network.links
        elif isinstance(block, schema_blocks.NetworkLink):
            stack += [*(block.between or (block.start, block.end)), block.through]
        elif block is not None:
            inner = getattr(block, next(kind for kind in schema_blocks.BLOCKS if hasattr(block, kind)))
            stack += getattr(inner, "of", inner)
    for module in level.modules.values():
        yield from distinguished_parts(module)
