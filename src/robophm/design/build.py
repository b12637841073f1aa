"""From what a design file says to the robot that it describes, with every contradiction named."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from robophm.blocks import diagram as blocks
from robophm.core.errors import (
    ModelError,
    PlugError,
    RobophmError,
    UnitError,
    nearest,
)
from robophm.core.signal import SECOND, signal_name
from robophm.core.units import conversion
from robophm.design import schema
from robophm.design.build_task import build_task
from robophm.design.build_wear import build_wear
from robophm.design.common_cause import CommonCauses
from robophm.design.driving import Ambient, Cover, Driving, ambient_of, assumed, drivers, undriven
from robophm.design.fault import Fault, Path, written
from robophm.design.robot import (
    CLOCK_UNITS,
    UNKNOWN,
    Component,
    Evidence,
    FailureMode,
    Limits,
    MeasuredClock,
    Module,
    Robot,
    Stress,
    Thresholds,
    Uncertainty,
    Usage,
)
from robophm.design.wiring import Wiring, told_apart
from robophm.hazard.acceleration import PER_CYCLE, acceleration_model, stress_inputs
from robophm.hazard.formula import formula_model
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import Model, Range
from robophm.life import life_distribution
from robophm.life._never import Never
from robophm.life.distribution import LifeDistribution

MOST_PARTS = 1000
"""Equal parts of a component that can be told apart; n equal parts in series may be many more."""


MOST_DRAWN = 1_000_000
"""Parts in a diagram when all modules, and all that they depend on, are drawn in their places."""


@dataclass(frozen=True)
class _Scope:
    """What a level inherits from those above it."""

    environment: str | None = None
    signals: Mapping[str, tuple[Path, schema.SignalBinding]] = field(default_factory=dict)
    clocks: Mapping[str, tuple[Path, schema.ClockBinding]] = field(default_factory=dict)
    acceleration: schema.Accelerations | None = None
    uncertainty: tuple[Path, schema.Uncertainty] | None = None
    duty: float = 1.0
    ambient: Ambient | None = None

    def within(self, place: Path, level: Any) -> _Scope:
        return _Scope(
            level.environment or self.environment,
            {**self.signals, **{name: ((*place, "signals", name), b) for name, b in level.signals.items()}},
            {**self.clocks, **{name: ((*place, "clocks", name), b) for name, b in level.clocks.items()}},
            level.acceleration if level.acceleration is not None else self.acceleration,
            ((*place, "uncertainty"), level.uncertainty) if level.uncertainty else self.uncertainty,
            self.duty if level.duty is None else level.duty,
            self.ambient if isinstance(level, schema.Component) else ambient_of(place, level, self.ambient),
        )

    def cover(self, part: schema.Component) -> Cover:
        """What of stresses a part in it has sensors of."""
        return Cover(self.signals, frozenset(part.signals), part.offsets, self.ambient)


def build(design: schema.RobotFile) -> Robot:
    """Put a robot together. Raises Fault (a DesignError with its place) at the first contradiction."""
    try:
        return _Builder(design).robot()
    except RecursionError:
        raise Fault((), "what contains or depends on one another is nested too deeply") from None


class _Builder:
    def __init__(self, design: schema.RobotFile) -> None:
        self.design = design
        self.components: dict[str, Component] = {}
        self.modules: dict[str, schema._Group] = {}
        self.places: dict[str, Path] = {}
        self.depends_on: dict[str, Any] = {}
        self.driving = Driving()
        self.covered: list[tuple[Component, Cover]] = []
        self.stresses: dict[str, Stress] = {}
        self.told_apart = {
            name.partition("[")[0].rpartition("/")[2] for name in told_apart(design)
        }  # last steps of names drawn as 'motor[2]', of members of a group, and of those that may fail together

    def robot(self) -> Robot:
        design = self.design
        root = self._module((), (), design, _Scope())
        groups = CommonCauses(self.components, self.modules)
        expand = Wiring(self.modules, self.components, self.places, self.depends_on, groups.of)
        for level, said in self.modules.items():
            for name, group in said.common_causes.items():
                place = (*self.places[level], "common_causes", name)
                groups.add(level, name, place, group, expand.parts(level, group.of, (*place, "of")))
        functions = {name: expand.block((), diagram, ("functions", name)) for name, diagram in design.functions.items()}
        whole = expand.module(root)
        for diagram in (whole.diagram, *functions.values()):
            if blocks.drawn(diagram) > MOST_DRAWN:
                raise Fault((), f"its diagrams unfold to more than {MOST_DRAWN:,} parts")
        used = set(blocks.units(whole.diagram)).union(*(blocks.units(diagram) for diagram in functions.values()))
        expand.check_groups(used)
        members_of = {
            unit: name for name, group in expand.groups.items() for member in group.members for unit in member
        }
        for unit, name in members_of.items():
            if self.components[path := unit.partition("[")[0]].unknown:
                raise Fault(
                    (*self.places[path], "rate"),
                    f"{path} is of unknown rate, and {name} depends on how long it lives; expected a rate",
                )
        used.update(members_of)
        drawn = {name.partition("[")[0] for name in used}
        clocks: dict[str, MeasuredClock] = {
            name: self._measured_clock(name, ("clocks", name), b) for name, b in design.clocks.items()
        }
        warnings = [f"{path}: used in no diagram" for path in self.components if path not in drawn]
        members = (unit for part in self.components.values() if part.path in drawn for unit in part.units)
        warnings += [f"{unit}: used in no diagram" for unit in members if unit not in used]
        warnings += [
            f"{'/'.join(place)}: has no range: whatever a broken sensor says would count"
            for place in self.driving.used
            if place[-2] == "signals" and self._binding(place).range is None
        ]
        warnings += [
            f"{'/'.join(place)}: no part below takes this input"
            for place in self._signal_places((), design)
            if place not in self.driving.used
        ]
        rises = list(assumed(self.covered))
        warnings += [text for known, text in rises if not known]
        notes = [*(text for known, text in rises if known), *undriven(self.covered, self.driving.used)]
        content = json.dumps(design.model_dump(mode="json"), sort_keys=True, ensure_ascii=False)
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
            thresholds=_thresholds(design.thresholds),
            warnings=tuple(warnings),
            notes=tuple(notes),
            design_hash=hashlib.sha256(content.encode()).hexdigest(),
        )
        return replace(robot, task=build_task(design.task, robot, ("task",))) if design.task else robot

    def _module(self, path: Path, place: Path, level: schema._Group, above: _Scope) -> Module:
        scope = above.within(place, level)
        self.modules["/".join(path)] = level
        self.places["/".join(path)] = place
        if isinstance(level, schema.Module) and level.depends_on is not None:
            self.depends_on["/".join(path)] = level.depends_on
        for name in level.modules.keys() & level.components.keys():
            raise Fault((*place, "components", name), f"duplicate name '{name}': a module here has it too")
        if not level.modules and not level.components:
            raise Fault(place, "has no parts; expected modules or components")
        modules = tuple(
            self._module((*path, name), (*place, "modules", name), module, scope)
            for name, module in level.modules.items()
        )
        components = tuple(
            self._component((*path, name), (*place, "components", name), component, scope)
            for name, component in level.components.items()
        )
        placeholder = blocks.Unit("")
        thresholds = _thresholds(level.thresholds) if isinstance(level, schema.Module) else Thresholds()
        text = level.description or ""
        return Module("/".join(path), modules, components, placeholder, placeholder, text, thresholds)

    def _component(self, path: Path, place: Path, part: schema.Component, above: _Scope) -> Component:
        own_acceleration = part.acceleration
        scope = replace(above.within(place, part), acceleration=above.acceleration)
        required = part.quantity if part.required is None else part.required
        if required > part.quantity:
            raise Fault(
                (*place, "required"),
                f"required {required} of quantity {part.quantity}; expected at most that",
            )
        if part.failure_modes:
            inline = part.model_fields_set & {
                "rate",
                "hazard",
                "life",
                "clock",
                "scaling",
                "initial_exposure",
                "learned",
                "wear",
            }
            if inline or own_acceleration is not None:
                raise Fault(
                    place,
                    f"has failure_modes and its own {min(inline or {'acceleration'})}; expected one of the two",
                )
            modes = tuple(
                self._mode((*path, name), (*place, "failure_modes", name), mode, part, scope)
                for name, mode in part.failure_modes.items()
            )
        else:
            modes = (self._mode(path, place, part, part, scope),)
        for name in part.offsets:
            if name not in scope.signals:
                raise Fault(
                    (*place, "offsets", name),
                    f"no signal '{name}' is bound here or above{nearest(name, scope.signals)}",
                )
        name = "/".join(path)
        apart = part.quantity > 1 and (required < part.quantity or path[-1] in self.told_apart)
        if apart and part.quantity > MOST_PARTS:
            raise Fault((*place, "quantity"), f"{part.quantity} parts told apart; expected at most {MOST_PARTS}")
        names = tuple(f"{name}[{i}]" for i in range(1, part.quantity + 1)) if apart else (name,)
        component = Component(
            name, part.quantity, required, part.monitored, modes, names, scope.duty, part.description or ""
        )
        self.components[name] = component
        if any(mode.acceleration != "none" for mode in part.failure_modes.values() or [part]):
            self.covered.append((component, scope.cover(part)))
        self.places[name] = place
        if part.depends_on is not None:
            self.depends_on[name] = part.depends_on
        return component

    def _mode(
        self, path: Path, place: Path, mode: schema.FailureMode, part: schema.Component, scope: _Scope
    ) -> FailureMode:
        clock_unit = CLOCK_UNITS[mode.clock]
        if mode.rate is not None and mode.hazard is not None:
            raise Fault((*place, "rate"), "both 'rate' and 'hazard' are given; expected one of the two")
        if mode.rate == UNKNOWN:
            return self._unknown_mode(path, place, mode)
        hazard = self._hazard(place, mode.hazard, part, scope, clock_unit) if mode.hazard else None
        if hazard and hazard.model.unit != f"1/{clock_unit}":
            raise Fault(
                place,
                f"{hazard.model.name} gives {hazard.model.unit}, but its clock '{mode.clock}' counts {clock_unit}",
            )
        rate: float | None = None
        if mode.rate is not None:
            rate = written((*place, "rate"), mode.rate, f"1/{clock_unit}")
        elif hazard:
            rate = hazard.reference
        if rate is not None and not math.isfinite(rate):
            raise Fault((*place, "hazard"), f"hazard rate {rate:g}; expected a number: the formula has none here")
        if rate is not None and not rate > 0:
            at, said = ("hazard", f"{rate:g}") if hazard else ("rate", mode.rate)
            raise Fault((*place, at), f"hazard rate {said}; expected above zero: a part that never fails is no part")
        factor = mode.learned.factor if mode.learned else 1.0
        life, rate = self._life((*place, "life"), mode.life, rate, clock_unit, place, factor)
        if hazard and "b10" in hazard.design and getattr(life, "shape", 1.0) != hazard.design["shape"]:
            raise Fault(
                (*place, "life"),
                f"{mode.life.distribution} has not the shape {hazard.design['shape']:g} by which the mean follows "
                "from the B10; expected e.g. {distribution: weibull, shape: 2}, the same in both",
            )
        stresses = self._accelerations(place, mode, part, hazard, scope)
        if mode.clock in ("kilometres", "cycles", "starts") and getattr(self.design.usage, mode.clock) is None:
            raise Fault(
                ("usage",),
                f"says nothing of '{mode.clock}', on which {'/'.join(path)} ages; expected e.g. "
                f"{mode.clock}: 1 {clock_unit}/h",
            )
        initial = 0.0
        if mode.initial_exposure is not None:
            initial = written((*place, "initial_exposure"), mode.initial_exposure, clock_unit)
            if not initial >= 0:
                raise Fault(
                    (*place, "initial_exposure"),
                    f"{mode.initial_exposure} is negative; expected at least zero",
                )
        measured = scope.clocks.get(mode.clock)
        stated = self._uncertainty(place, mode, rate / factor, f"1/{clock_unit}", scope)
        return FailureMode(
            "/".join(path), rate, life, mode.clock, self._measured_clock(mode.clock, *measured) if measured else None,
            mode.scaling, initial, (hazard, *stresses) if hazard else stresses, mode.source or self._said_source(mode),
            Uncertainty(failures=mode.learned.shape) if mode.learned else stated,
            evidence=Evidence(factor, stated) if mode.learned else None,
            wear=build_wear((*place, "wear"), mode.wear, part.quantity) if mode.wear else None,
        )  # fmt: skip

    @staticmethod
    def _unknown_mode(path: Path, place: Path, mode: schema.FailureMode) -> FailureMode:
        """One of whose rate nothing is known: it is there, and never comes."""
        for key in ("life", "acceleration", "uncertainty", "learned", "wear", "scaling"):
            if key in mode.model_fields_set:
                raise Fault((*place, key), f"its rate is unknown, and '{key}' says nothing then; expected a rate")
        initial = 0.0
        if mode.initial_exposure is not None:
            initial = max(written((*place, "initial_exposure"), mode.initial_exposure, CLOCK_UNITS[mode.clock]), 0.0)
        return FailureMode(
            "/".join(path), 0.0, Never(), mode.clock, None, mode.scaling, initial, (), mode.source or ""
        )  # fmt: skip

    @staticmethod
    def _said_source(mode: schema.FailureMode) -> str:
        """Where the hazard itself says its rate is from."""
        return str(mode.hazard.source or mode.hazard.inputs.get("source", "")) if mode.hazard else ""

    @staticmethod
    def _uncertainty(
        place: Path, mode: schema.FailureMode, rate: float, unit: str, scope: _Scope
    ) -> Uncertainty | None:
        own = ((*place, "uncertainty"), mode.uncertainty) if mode.uncertainty else scope.uncertainty
        if own is None:
            return None
        place, said = own
        samples = tuple(written((*place, "samples"), one, unit) / rate for one in said.samples or ())
        if not all(one > 0 for one in samples):
            raise Fault((*place, "samples"), "a sample is not above zero; expected hazard rates")
        return Uncertainty(said.error_factor, said.failures, samples or None)

    def _hazard(
        self, place: Path, hazard: schema.Hazard, part: schema.Component, scope: _Scope, clock_unit: str
    ) -> Stress:
        place = (*place, "hazard")
        if hazard.formula is not None:
            model = self._formula(place, hazard, clock_unit)
            values = {name: variable.value for name, variable in hazard.variables.items()}
            return self._stress((*place, "variables"), model, values, part, scope)
        model = _plug((*place, "model"), handbook_model, str(hazard.model))
        inputs: dict[str, object] = dict(hazard.inputs)
        if "environment" in model.inputs and scope.environment and "environment" not in inputs:
            inputs["environment"] = scope.environment
        # a board has hundreds of equal parts: what is stated and measured alike is one stress; as it is written,
        # since 1 and True are equal and the second is no number
        key = repr((model.name, inputs, [at for at, _ in scope.signals.values()], part.offsets, scope.ambient))
        if key not in self.stresses:
            self.stresses[key] = self._stress((*place, "inputs"), model, inputs, part, scope)
        return self.stresses[key]

    @staticmethod
    def _formula(place: Path, hazard: schema.Hazard, clock_unit: str) -> Model:
        ranges = {}
        for name, said in hazard.variables.items():
            try:
                conversion(said.unit, said.unit)
            except UnitError as error:
                raise Fault((*place, "variables", name, "unit"), str(error)) from None
            low, high = said.range or (-math.inf, math.inf)
            ranges[name] = Range(low, high, said.unit, said.description or name)
        try:
            return formula_model(
                str(hazard.formula), str(hazard.unit), ranges, str(hazard.source), inside=f"1/{clock_unit}"
            )
        except UnitError as error:
            raise Fault((*place, "unit"), str(error)) from None
        except ModelError as error:
            raise Fault((*place, "formula"), str(error)) from None

    def _accelerations(
        self,
        place: Path,
        mode: schema.FailureMode,
        part: schema.Component,
        hazard: Stress | None,
        scope: _Scope,
    ) -> tuple[Stress, ...]:
        chosen = mode.acceleration
        if chosen is None and not hazard:
            chosen = scope.acceleration  # inherited: of constant-rate parts alone
        if chosen is None or chosen == "none":
            return ()
        stresses: list[Stress] = []
        for said in chosen if isinstance(chosen, list) else [chosen]:
            at = (*place, "acceleration")
            model = _plug((*at, "model"), acceleration_model, said.model)
            parameters = dict(said.model_extra or {})
            if model.name in PER_CYCLE and mode.clock not in ("cycles", "starts"):
                raise Fault(
                    at, f"{model.name} is of cycles, but its clock is '{mode.clock}'; expected cycles or starts"
                )
            for stress_input in stress_inputs(model):
                if stress_input in parameters:
                    raise Fault(
                        (*at, stress_input),
                        f"'{stress_input}' is what is measured; expected reference_{stress_input} here",
                    )
                reference = f"reference_{stress_input}"
                if (at_design := parameters.get(reference, _default(model, reference))) is None:
                    raise Fault(at, f"{model.name} needs '{reference}', at which the stated rate holds")
                parameters[stress_input] = at_design
                if hazard and (hazard.channels or hazard.model.answers_by(stress_input)):
                    raise Fault(
                        at,
                        f"double acceleration: {hazard.model.name} answers to '{stress_input}' itself; expected one",
                    )
                if any(stress_input in earlier.design for earlier in stresses):
                    raise Fault(at, f"double acceleration: two factors of '{stress_input}'")
            stresses.append(self._stress(at, model, parameters, part, scope))
        return tuple(stresses)

    def _stress(
        self, place: Path, model: Model, inputs: Mapping[str, object], part: schema.Component, scope: _Scope
    ) -> Stress:
        try:
            design = model.settle(inputs)
        except (ModelError, UnitError) as error:
            named = next((name for name in inputs if re.search(rf"\b{re.escape(name)}\b", str(error))), None)
            raise Fault((*place, named) if named else place, str(error)) from None
        cover = scope.cover(part)
        for name, entry in model.numbers.items():
            stated = name in inputs or (name in design and not entry.otherwise)
            if name in scope.signals and not stated and model.answers_to(name, design):
                signal = "/".join(scope.signals[name][0])
                raise Fault(
                    place,
                    f"'{name}' is measured ({signal}), but its value as designed is not stated, and {model.name} "
                    f"answers to it; expected {name}: {model.expected(name)}",
                )
        channels = self.driving.channels(model, design, cover)
        return Stress(model, design, channels, drivers(model, design, channels, cover))

    def _measured_clock(self, clock: str, place: Path, binding: schema.ClockBinding) -> MeasuredClock:
        self.driving.used[place] = None
        if clock in ("operating", "calendar"):
            raise Fault(place, f"the {clock} clock is time itself and takes no signal")
        kind: Literal["position", "speed", "edge"]
        if binding.position is not None:
            kind, fields = "position", binding.position
        elif binding.speed is not None:
            kind, fields = "speed", (binding.speed,)
        else:
            kind, fields = "edge", (str(binding.edge),)
        if (kind == "edge") != (clock in ("cycles", "starts")):
            wanted = "edge" if clock in ("cycles", "starts") else "position or speed"
            raise Fault(place, f"the {clock} clock is driven by {wanted}, not by {kind}")
        inside = {"position": "m", "speed": "m/s", "edge": ""}[kind]
        written = binding.unit or inside
        try:
            scale = 1.0 if kind == "edge" else conversion(written, inside).scale
            signals = tuple(signal_name(binding.topic, name) for name in fields)
        except RobophmError as error:
            raise Fault(place, str(error)) from None
        return MeasuredClock(clock, kind, signals, written, scale, binding.threshold, round(binding.max_age * SECOND))

    def _life(
        self, place: Path, life: schema.Life, rate: float | None, unit: str, mode_place: Path, factor: float
    ) -> tuple[LifeDistribution, float]:
        distribution: type[LifeDistribution] = _plug((*place, "distribution"), life_distribution, life.distribution)
        parameters: dict[str, Any] = {}
        for name, value in (life.model_extra or {}).items():
            if name not in distribution.dimensions:
                raise Fault(
                    (*place, name),
                    f"{life.distribution} has no parameter '{name}'{nearest(name, distribution.dimensions)}",
                )
            power = distribution.dimensions[name]
            inside = {1: unit, 0: "", -1: f"1/{unit}"}[power]
            listed = isinstance(value, list)
            numbers = [written((*place, name), one, inside) for one in (value if listed else [value])]
            parameters[name] = numbers if listed else numbers[0]
        try:
            if rate is None:
                if not parameters:
                    raise Fault(
                        mode_place,
                        "has no rate; expected rate, hazard, failure_modes, or a life with its scale",
                    )
                whole = distribution(**parameters)
                if factor == 1:
                    return whole, 1 / whole.mean()
                parameters.pop(str(distribution.scale_parameter), None)
                rate = 1 / whole.mean()
            elif distribution.scale_parameter in parameters:
                raise Fault(
                    (*place, str(distribution.scale_parameter)),
                    f"a rate and the life's own {distribution.scale_parameter} are given; expected one of the two",
                )
            return distribution.with_rate(rate * factor, **parameters), rate * factor
        except (ModelError, TypeError) as error:
            raise Fault(place, str(error)) from None

    def _powered(self) -> str | None:
        powered = self.design.powered
        try:
            return signal_name(powered.topic, powered.field) if powered else None
        except RobophmError as error:
            raise Fault(("powered",), str(error)) from None

    def _usage(self) -> Usage:
        usage = self.design.usage
        return Usage(usage.operating, usage.kilometres or 0.0, usage.cycles or 0.0, usage.starts or 0.0)

    def _binding(self, place: Path) -> schema.SignalBinding:
        level: Any = self.design
        for step in place:
            level = level[step] if isinstance(level, dict) else getattr(level, step)
        binding: schema.SignalBinding = level
        return binding

    def _signal_places(self, place: Path, level: Any) -> Iterable[Path]:
        yield from ((*place, "signals", name) for name in level.signals)
        yield from ((*place, "clocks", name) for name in level.clocks)
        for kind in ("modules", "components"):
            for name, child in getattr(level, kind, {}).items():
                yield from self._signal_places((*place, kind, name), child)


def _thresholds(stated: schema.ModuleThresholds) -> Thresholds:
    limits = stated.model_dump()
    return Thresholds(**{**limits, "warning": Limits(**limits["warning"])})


def _plug(place: Path, find: Any, name: str) -> Any:
    try:
        return find(name)
    except PlugError as error:
        raise Fault(place, str(error)) from None


def _default(model: Model, name: str) -> str | None:
    """The default of a number as a user would write it."""
    entry = model.numbers[name]
    return None if entry.default is None else f"{entry.default!r} {entry.unit}"
