"""Construction of a robot from the values of its design file, with every contradiction named."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

from robophm.blocks import diagram as blocks
from robophm.core.errors import RobophmError, nearest
from robophm.core.signal import SECOND, signal_name
from robophm.design import schema
from robophm.design.build_diagram import DiagramBuilder, distinguished_parts
from robophm.design.build_mode import ModeBuilder
from robophm.design.build_task import build_task
from robophm.design.build_thresholds import build_thresholds
from robophm.design.common_cause import CommonCauses
from robophm.design.known_parts import BuiltPart, KnownLevel, KnownParts, LevelKey, content, content_of
from robophm.design.located_error import LocatedError, Path
from robophm.design.robot import Component, FailureMode, MeasuredClock, Module, Robot, Usage
from robophm.design.scope import Scope
from robophm.design.sensor_inputs import SensorCover, assumed, undriven
from robophm.design.thresholds import NO_LIMITS
from robophm.parts import FIGURES
from robophm.parts import part as library_part

MOST_PARTS = 1000
"""Equal parts of a component that can be told apart; n equal parts in series may be many more."""


_OF_ONE_MODE = {*FIGURES, "hazard", "life", "clock", "scaling", "initial_exposure", "learned", "wear", "failed_when"}


UNTAKEN = (
    "no part below takes this input: a rate by itself is the same under any stress; expected an `acceleration` beside "
    "it, a hazard model or a part of the library"
)
"""A warning on a signal that changes no figure."""

MOST_DRAWN = 1_000_000
"""Parts in a diagram when all modules, and all that they depend on, are drawn in their places."""


def build(design: schema.RobotFile, said: Mapping[str, Any], known: KnownParts | None = None) -> Robot:
    """Build a robot from its design, of which the file says ``said``; parts that are ``known`` are not built again.

    Raises LocatedError (a DesignError with its place) at the first contradiction.
    """
    known = known or KnownParts()
    known.begin()
    try:
        robot = _Builder(design, known).robot(said)
        known.keep()
        return robot
    except RecursionError:
        raise LocatedError((), "what contains or depends on one another is nested too deeply") from None


class _Builder:
    def __init__(self, design: schema.RobotFile, parts: KnownParts) -> None:
        self.design = design
        self.parts = parts
        self.components: dict[str, Component] = {}
        self.modules: dict[str, schema._Group] = {}
        self.identities: dict[str, str] = {}  # of the robot's levels, by path
        self.known: dict[str, str] = {}  # paths of parts and failure modes, by identity
        self.places: dict[str, Path] = {}
        self.depends_on: dict[str, Any] = {}
        self.contents: dict[Path, str] = {}  # all that is stated of each part
        self.drivers: dict[Path, None] = {}  # places of the signals that drive something, in the order of the design
        self.notes: list[str] = []
        self.modes = ModeBuilder(design.usage)
        self.covered: list[tuple[Component, SensorCover]] = []
        self.told_apart = {
            name.partition("[")[0].rpartition("/")[2] for name in distinguished_parts(design)
        }  # last steps of names drawn as 'motor[2]', of members of a group, and of those that may fail together

    def robot(self, document: Mapping[str, Any]) -> Robot:
        design = self.design
        root = self._module((), (), design, Scope(), (), document)
        groups = CommonCauses(self.components, self.identities)
        expand = DiagramBuilder(self.modules, self.components, self.places, self.depends_on, groups.of)
        for level, said in self.modules.items():
            for name, group in said.common_causes.items():
                place = (*self.places[level], "common_causes", name)
                groups.add(level, name, place, group, expand.parts(level, group.of, (*place, "of")))
        functions = {name: expand.block((), diagram, ("functions", name)) for name, diagram in design.functions.items()}
        whole = expand.module(root)
        used = self._used(expand, (whole.diagram, *functions.values()))
        clocks: dict[str, MeasuredClock] = {
            name: self.modes.measured_clock(name, ("clocks", name), b) for name, b in design.clocks.items()
        }
        self.drivers |= {("clocks", name): None for name in clocks}
        warnings, notes = self._remarks(used)
        robot = Robot(
            **{key: getattr(whole, key) for key in ("modules", "components", "wiring", "diagram", "description")},
            path=design.name,
            functions=functions,
            causes=tuple(groups.causes),
            groups=groups.groups,
            depends_on={path: expand.needs(path) for path in self.depends_on},
            usage=self._usage(),
            clocks=clocks,
            powered=self._powered(),
            max_gap=round(design.max_gap * SECOND),
            thresholds=build_thresholds(("thresholds",), design.thresholds, self._signal_units()),
            warnings=tuple(warnings),
            notes=(*self.notes, *notes),
            design_hash=hashlib.sha256(content(design, self.contents.__getitem__).encode()).hexdigest(),
            identity=design.identity or design.name,
            design_name=design.name,
        )
        return replace(robot, task=build_task(design.task, robot, ("task",))) if design.task else robot

    def _used(self, expand: DiagramBuilder, diagrams: Sequence[blocks.Block]) -> set[str]:
        """The units that the diagrams draw, groups and their members too. Raises LocatedError for what none can be."""
        for diagram in diagrams:
            if blocks.drawn(diagram) > MOST_DRAWN:
                raise LocatedError((), f"its diagrams unfold to more than {MOST_DRAWN:,} parts")
        used = set(chain.from_iterable(map(blocks.units, diagrams)))
        expand.check_groups(used)
        members_of = {
            unit: name for name, group in expand.groups.items() for member in group.members for unit in member
        }
        for unit, name in members_of.items():
            if self.components[path := unit.partition("[")[0]].unknown:
                raise LocatedError(
                    (*self.places[path], "rate"),
                    f"{path} is of unknown rate, and {name} depends on how long it lives; expected a rate",
                )
        return used.union(members_of)

    def _remarks(self, used: set[str]) -> tuple[list[str], list[str]]:
        """The warnings on what is odd in the design, and the notes on what was assumed."""
        drawn = {name.partition("[")[0] for name in used}
        warnings = [f"{path}: used in no diagram" for path in self.components if path not in drawn]
        members = (unit for part in self.components.values() if part.path in drawn for unit in part.units)
        warnings += [f"{unit}: used in no diagram" for unit in members if unit not in used]
        warnings += [
            f"{'/'.join(place)}: has no range: whatever a broken sensor says would count"
            for place in self.drivers
            if place[-2] == "signals" and self._binding(place).range is None
        ]
        warnings += [
            f"{'/'.join(place)}: {UNTAKEN}"
            for place in self._signal_places((), self.design)
            if place not in self.drivers
        ]
        rises = list(assumed(self.covered))
        warnings += [text for known, text in rises if not known]
        return warnings, [*(text for known, text in rises if known), *undriven(self.covered, self.drivers)]

    def _module(
        self, path: Path, place: Path, level: schema._Group, above: Scope, around: LevelKey, said: Mapping[str, Any]
    ) -> Module:
        scope = above.within(place, level)
        known = self.parts.level(around, place, said, scope)
        self.modules["/".join(path)] = level
        self.identities["/".join(path)] = scope.identity
        self.places["/".join(path)] = place
        if isinstance(level, schema.Module) and level.depends_on is not None:
            self.depends_on["/".join(path)] = level.depends_on
        for name in level.modules.keys() & level.components.keys():
            raise LocatedError((*place, "components", name), f"duplicate name '{name}': a module here has it too")
        if not level.modules and not level.components:
            raise LocatedError(place, "has no parts; expected modules or components")
        modules = tuple(
            self._module((*path, name), (*place, "modules", name), module, scope, known.key, said["modules"][name])
            for name, module in level.modules.items()
        )
        components = tuple(
            self._component((*path, name), (*place, "components", name), component, scope, known)
            for name, component in level.components.items()
        )
        placeholder = blocks.Unit("")
        thresholds = NO_LIMITS
        if isinstance(level, schema.Module):
            thresholds = build_thresholds((*place, "thresholds"), level.thresholds)
        text = level.description or ""
        return Module("/".join(path), modules, components, placeholder, placeholder, text, thresholds)

    def _component(self, path: Path, place: Path, part: schema.Component, above: Scope, level: KnownLevel) -> Component:
        built = level.part(path[-1], path[-1] in self.told_apart, lambda: self._built(path, place, part, above))
        component = built.component
        self._know(place, part, component)
        name = component.path
        self.components[name] = component
        self.contents[path] = built.content
        self.drivers |= dict.fromkeys(built.drivers)
        self.notes += built.notes
        if built.cover:
            self.covered.append((component, built.cover))
        self.places[name] = place
        if part.depends_on is not None:
            self.depends_on[name] = part.depends_on
        return component

    def _built(self, path: Path, place: Path, part: schema.Component, above: Scope) -> BuiltPart:
        """A part with what else is to be known of it. Raises LocatedError where its design contradicts itself."""
        scope = replace(above.within(place, part), acceleration=above.acceleration)
        if part.part and scope.environment is None:  # that of the library is only where the robot states none
            scope = replace(scope, environment=library_part(part.part).part.get("environment"))
        required = part.quantity if part.required is None else part.required
        if required > part.quantity:
            raise LocatedError(
                (*place, "required"),
                f"required {required} of quantity {part.quantity}; expected at most that",
            )
        modes, notes = self._modes(path, place, part, scope)
        for name in part.offsets:
            if name not in scope.signals:
                raise LocatedError(
                    (*place, "offsets", name),
                    f"no signal '{name}' is bound here or above{nearest(name, scope.signals)}",
                )
        name = "/".join(path)
        apart = part.quantity > 1 and (required < part.quantity or path[-1] in self.told_apart)
        if apart and part.quantity > MOST_PARTS:
            raise LocatedError((*place, "quantity"), f"{part.quantity} parts told apart; expected at most {MOST_PARTS}")
        names = tuple(f"{name}[{i}]" for i in range(1, part.quantity + 1)) if apart else (name,)
        component = Component(
            name, part.quantity, required, part.monitored, modes, names, scope.duty, part.description or "",
            identity=scope.identity, identified=part.identity is not None,
            thresholds=build_thresholds((*place, "thresholds"), part.thresholds) if part.thresholds else NO_LIMITS,
            repair=scope.repair,
        )  # fmt: skip
        accelerated = any(mode.acceleration != "none" for mode in part.failure_modes.values() or [part])
        cover = scope.cover(part) if accelerated else None
        return BuiltPart(component, cover, tuple(_drivers(modes, scope)), notes, content_of(part))

    def _modes(
        self, path: Path, place: Path, part: schema.Component, scope: Scope
    ) -> tuple[tuple[FailureMode, ...], tuple[str, ...]]:
        """The failure modes of a part, with their identities, and the notes on what was assumed of them."""
        notes: list[str] = []
        if not part.failure_modes:
            return (self.modes.mode(path, place, part, part, scope, scope.identity, notes),), tuple(notes)
        inline = part.model_fields_set & _OF_ONE_MODE
        if inline or part.acceleration is not None:
            raise LocatedError(
                place,
                f"has failure_modes and its own {min(inline or {'acceleration'})}; expected one of the two",
            )
        modes = tuple(
            self.modes.mode(
                (*path, name), (*place, "failure_modes", name), mode, part, scope,
                mode.identity or f"{scope.identity}/{name}", notes,
            )
            for name, mode in part.failure_modes.items()
        )  # fmt: skip
        return modes, tuple(notes)

    def _know(self, place: Path, part: schema.Component, component: Component) -> None:
        """Take note of the identities of a part. Raises LocatedError where another part has one of them."""
        for one in dict.fromkeys((component.identity, *(mode.identity for mode in component.modes))):
            owner = self.known.setdefault(one, component.path)
            if owner != component.path:
                at = (*place, "identity") if part.identity else place
                raise LocatedError(
                    at, f"its past would be that of {owner}, whose identity is '{one}'; expected an identity of its own"
                )

    def _powered(self) -> str | None:
        powered = self.design.powered
        try:
            return signal_name(powered.topic, powered.field) if powered else None
        except RobophmError as error:
            raise LocatedError(("powered",), str(error)) from None

    def _usage(self) -> Usage:
        usage = self.design.usage
        return Usage(usage.operating, usage.kilometres or 0.0, usage.cycles or 0.0, usage.starts or 0.0)

    def _binding(self, place: Path) -> schema.SignalBinding:
        level: Any = self.design
        for step in place:
            level = level[step] if isinstance(level, dict) else getattr(level, step)
        binding: schema.SignalBinding = level
        return binding

    def _signal_units(self) -> dict[str, str]:
        """The units of the signals that drive a stress of a part, by their names."""
        stresses = chain.from_iterable(mode.stresses for part in self.components.values() for mode in part.modes)
        return {one.signal: one.unit for stress in stresses for one in stress.channels.values()}

    def _signal_places(self, place: Path, level: schema._Group) -> Iterator[Path]:
        yield from _bound(place, level)
        for name, module in level.modules.items():
            yield from self._signal_places((*place, "modules", name), module)
        for name, part in level.components.items():
            if part.signals or part.clocks:
                yield from _bound((*place, "components", name), part)


def _bound(place: Path, level: schema._Group | schema.Component) -> Iterator[Path]:
    """The places of the signals and clocks that a level or part binds."""
    yield from ((*place, "signals", name) for name in level.signals)
    yield from ((*place, "clocks", name) for name in level.clocks)


def _drivers(modes: Iterable[FailureMode], scope: Scope) -> Iterator[Path]:
    """The places of the signals that drive failure modes, as a scope binds them."""
    for mode in modes:
        for stress in mode.stresses:
            yield from (scope.signals[channel.stress][0] for channel in stress.channels.values())
        if mode.measured_clock:
            yield scope.clocks[mode.clock][0]
