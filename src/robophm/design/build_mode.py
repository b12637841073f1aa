"""Construction of a failure mode from a design file: its rate, life, stresses and clock."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from robophm.core.errors import ModelError, RobophmError, UnitError
from robophm.core.signal import SECOND, signal_name
from robophm.core.spread import Spread
from robophm.core.units import conversion
from robophm.design import schema
from robophm.design.build_life import ABOVE_ZERO, TENTHS, build_life, figure_of, key_of_figure, plug
from robophm.design.build_told_failures import build_told_failures
from robophm.design.build_wear import build_wear
from robophm.design.located_error import LocatedError, Path, quantity_at
from robophm.design.references import place_of
from robophm.design.robot import (
    CLOCK_UNITS,
    UNKNOWN,
    Evidence,
    FailureMode,
    MeasuredClock,
    Stress,
    Uncertainty,
    UnknownQuality,
)
from robophm.design.scope import Scope
from robophm.design.sensor_inputs import channels_of, drivers
from robophm.hazard import qualities
from robophm.hazard.acceleration import PER_CYCLE, acceleration_model, stress_inputs
from robophm.hazard.formula import formula_model
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import Model, Range
from robophm.life._never import Never


class ModeBuilder:
    """Builds the failure modes of one design: what is stated and measured alike is one stress."""

    def __init__(self, usage: schema.Usage) -> None:
        self.usage = usage
        self.stresses: dict[str, Stress] = {}
        self.spreads: dict[int, Spread | None] = {}  # by the identity of a stress

    def mode(
        self, path: Path, place: Path, mode: schema.FailureMode, part: schema.Component, scope: Scope,
        identity: str, notes: list[str],
    ) -> FailureMode:  # fmt: skip
        """Build a failure mode of a part in a scope; what was assumed is added to the notes.

        Raises LocatedError where the design contradicts itself.
        """
        clock_unit = CLOCK_UNITS[mode.clock]
        key = key_of_figure(place, mode)
        if mode.rate == UNKNOWN:
            return self._unknown_mode(path, place, mode, identity, part.quantity)
        hazard = self._hazard(place, mode.hazard, part, scope, clock_unit) if mode.hazard else None
        if hazard and hazard.model.unit != f"1/{clock_unit}":
            raise LocatedError(
                place,
                f"{hazard.model.name} gives {hazard.model.unit}, but its clock '{mode.clock}' counts {clock_unit}",
            )
        figure: tuple[str, float] | None = None
        quality = self._unknown_quality(mode.hazard, hazard, scope) if mode.hazard and hazard else None
        if hazard:
            figure = "hazard", self._rate_of(place, hazard) * (quality.mean if quality else 1.0)
        elif key:
            figure = key, figure_of(place, mode, key, clock_unit)
        factor = mode.learned.factor if mode.learned else 1.0
        life, rate = build_life(place, mode.life, figure, clock_unit, factor)
        if key in TENTHS and "life" not in mode.model_fields_set:
            notes.append(f"{'/'.join(path)}: its {key} is by an exponential life, as none is stated")
        if hazard and "b10" in hazard.design and getattr(life, "shape", 1.0) != hazard.design["shape"]:
            raise LocatedError(
                (*place, "life"),
                f"{mode.life.distribution} has not the shape {hazard.design['shape']:g} by which the mean follows "
                "from the B10; expected e.g. {distribution: weibull, shape: 2}, the same in both",
            )
        stresses = self._accelerations(place, mode, part, hazard, scope)
        if mode.clock in ("kilometres", "cycles", "starts") and getattr(self.usage, mode.clock) is None:
            raise LocatedError(
                ("usage",),
                f"says nothing of '{mode.clock}', on which {'/'.join(path)} ages; expected e.g. "
                f"{mode.clock}: 1 {clock_unit}/h",
            )
        initial = 0.0
        if mode.initial_exposure is not None:
            initial = quantity_at((*place, "initial_exposure"), mode.initial_exposure, clock_unit)
            if not initial >= 0:
                raise LocatedError(
                    (*place, "initial_exposure"),
                    f"{mode.initial_exposure} is negative; expected at least zero",
                )
        measured = scope.clocks.get(mode.clock)
        stated = self._uncertainty(place, mode, rate / factor, f"1/{clock_unit}", scope)
        if quality and scope.quality:
            unknown = UnknownQuality(place_of(scope.quality[0]), quality.error_factor)
            stated = replace(stated or Uncertainty(), quality=unknown)
        return FailureMode(
            "/".join(path), rate, life, mode.clock, self.measured_clock(mode.clock, *measured) if measured else None,
            mode.scaling, initial, (hazard, *stresses) if hazard else stresses, mode.source or self._said_source(mode),
            Uncertainty(failures=mode.learned.shape) if mode.learned else stated,
            evidence=Evidence(factor, stated) if mode.learned else None,
            wear=build_wear((*place, "wear"), mode.wear, part.quantity) if mode.wear else None,
            identity=identity, failed_when=build_told_failures(place, mode, part.quantity),
        )  # fmt: skip

    @staticmethod
    def _rate_of(place: Path, hazard: Stress) -> float:
        rate = hazard.reference
        if not math.isfinite(rate):
            raise LocatedError(
                (*place, "hazard"), f"hazard rate {rate:g}; expected a number: the formula has none here"
            )
        if not rate > 0:
            raise LocatedError((*place, "hazard"), f"hazard rate {rate:g}; {ABOVE_ZERO}")
        return rate

    @staticmethod
    def _unknown_mode(path: Path, place: Path, mode: schema.FailureMode, identity: str, quantity: int) -> FailureMode:
        """A failure mode of unknown rate, which is carried as if it never came."""
        for key in ("life", "acceleration", "uncertainty", "learned", "wear", "scaling"):
            if key in mode.model_fields_set:
                raise LocatedError(
                    (*place, key), f"its rate is unknown, and '{key}' says nothing then; expected a rate"
                )
        initial = 0.0
        if mode.initial_exposure is not None:
            initial = max(
                quantity_at((*place, "initial_exposure"), mode.initial_exposure, CLOCK_UNITS[mode.clock]), 0.0
            )
        return FailureMode(
            "/".join(path), 0.0, Never(), mode.clock, None, mode.scaling, initial, (), mode.source or "",
            identity=identity, failed_when=build_told_failures(place, mode, quantity),
        )  # fmt: skip

    @staticmethod
    def _said_source(mode: schema.FailureMode) -> str:
        """The source of the rate that the hazard itself states; "" where it states none."""
        return str(mode.hazard.source or mode.hazard.inputs.get("source", "")) if mode.hazard else ""

    @staticmethod
    def _uncertainty(place: Path, mode: schema.FailureMode, rate: float, unit: str, scope: Scope) -> Uncertainty | None:
        own = ((*place, "uncertainty"), mode.uncertainty) if mode.uncertainty else scope.uncertainty
        if own is None:
            return None
        place, said = own
        samples = tuple(quantity_at((*place, "samples"), one, unit) / rate for one in said.samples or ())
        if not all(one > 0 for one in samples):
            raise LocatedError((*place, "samples"), "a sample is not above zero; expected hazard rates")
        return Uncertainty(said.error_factor, said.failures, samples or None)

    def _hazard(
        self, place: Path, hazard: schema.Hazard, part: schema.Component, scope: Scope, clock_unit: str
    ) -> Stress:
        place = (*place, "hazard")
        if hazard.formula is not None:
            model = self._formula(place, hazard, clock_unit)
            values = {name: variable.value for name, variable in hazard.variables.items()}
            return self._stress((*place, "variables"), model, values, part, scope)
        model = plug((*place, "model"), handbook_model, str(hazard.model))
        inputs: dict[str, object] = dict(hazard.inputs)
        if "environment" in model.inputs and scope.environment and "environment" not in inputs:
            inputs["environment"] = scope.environment
        said = inputs.get("quality", scope.quality[1] if scope.quality else None)
        if said is not None and (known := qualities.level(model, str(said), inputs)):
            inputs["quality"] = known
        # a board has hundreds of equal parts: what is stated and measured alike is one stress; as it is written,
        # since 1 and True are equal and the second is no number
        key = repr((model.name, inputs, [at for at, _ in scope.signals.values()], part.offsets, scope.ambient))
        if key not in self.stresses:
            self.stresses[key] = self._stress((*place, "inputs"), model, inputs, part, scope)
        return self.stresses[key]

    def _unknown_quality(self, said: schema.Hazard, hazard: Stress, scope: Scope) -> Spread | None:
        """The factor that an unknown quality leaves open; None where the quality is stated, or none is asked for."""
        stated = said.formula is not None or "quality" in said.inputs
        if stated or scope.quality is None or scope.quality[1] != qualities.UNKNOWN:
            return None
        if id(hazard) not in self.spreads:
            self.spreads[id(hazard)] = qualities.spread_of_unknown(hazard.model, hazard.design)
        return self.spreads[id(hazard)]

    @staticmethod
    def _formula(place: Path, hazard: schema.Hazard, clock_unit: str) -> Model:
        ranges = {}
        for name, said in hazard.variables.items():
            try:
                conversion(said.unit, said.unit)
            except UnitError as error:
                raise LocatedError((*place, "variables", name, "unit"), str(error)) from None
            low, high = said.range or (-math.inf, math.inf)
            ranges[name] = Range(low, high, said.unit, said.description or name)
        try:
            return formula_model(
                str(hazard.formula), str(hazard.unit), ranges, str(hazard.source), inside=f"1/{clock_unit}"
            )
        except UnitError as error:
            raise LocatedError((*place, "unit"), str(error)) from None
        except ModelError as error:
            raise LocatedError((*place, "formula"), str(error)) from None

    def _accelerations(
        self,
        place: Path,
        mode: schema.FailureMode,
        part: schema.Component,
        hazard: Stress | None,
        scope: Scope,
    ) -> tuple[Stress, ...]:
        chosen = mode.acceleration
        if chosen is None and not hazard:
            chosen = scope.acceleration  # inherited: of constant-rate parts alone
        if chosen is None or chosen == "none":
            return ()
        stresses: list[Stress] = []
        for said in chosen if isinstance(chosen, list) else [chosen]:
            at = (*place, "acceleration")
            model = plug((*at, "model"), acceleration_model, said.model)
            parameters = dict(said.model_extra or {})
            if model.name in PER_CYCLE and mode.clock not in ("cycles", "starts"):
                raise LocatedError(
                    at, f"{model.name} is of cycles, but its clock is '{mode.clock}'; expected cycles or starts"
                )
            for stress_input in stress_inputs(model):
                if stress_input in parameters:
                    raise LocatedError(
                        (*at, stress_input),
                        f"'{stress_input}' is what is measured; expected reference_{stress_input} here",
                    )
                reference = f"reference_{stress_input}"
                if (at_design := parameters.get(reference, _default(model, reference))) is None:
                    raise LocatedError(at, f"{model.name} needs '{reference}', at which the stated rate holds")
                parameters[stress_input] = at_design
                if hazard and (hazard.channels or hazard.model.answers_by(stress_input)):
                    raise LocatedError(
                        at,
                        f"double acceleration: {hazard.model.name} answers to '{stress_input}' itself; expected one",
                    )
                if any(stress_input in earlier.design for earlier in stresses):
                    raise LocatedError(at, f"double acceleration: two factors of '{stress_input}'")
            stresses.append(self._stress(at, model, parameters, part, scope))
        return tuple(stresses)

    def _stress(
        self, place: Path, model: Model, inputs: Mapping[str, object], part: schema.Component, scope: Scope
    ) -> Stress:
        try:
            design = model.settle(inputs)
        except (ModelError, UnitError) as error:
            named = next((name for name in inputs if re.search(rf"\b{re.escape(name)}\b", str(error))), None)
            raise LocatedError((*place, named) if named else place, str(error)) from None
        cover = scope.cover(part)
        for name, entry in model.numbers.items():
            stated = name in inputs or (name in design and not entry.otherwise)
            if name in scope.signals and not stated and model.answers_to(name, design):
                signal = "/".join(scope.signals[name][0])
                raise LocatedError(
                    place,
                    f"'{name}' is measured ({signal}), but its value as designed is not stated, and {model.name} "
                    f"answers to it; expected {name}: {model.expected(name)}",
                )
        channels = channels_of(model, design, cover)
        return Stress(model, design, channels, drivers(model, design, channels, cover))

    def measured_clock(self, clock: str, place: Path, binding: schema.ClockBinding) -> MeasuredClock:
        """Build a clock that signals drive. Raises LocatedError where they cannot."""
        if clock in ("operating", "calendar"):
            raise LocatedError(place, f"the {clock} clock is time itself and takes no signal")
        kind: Literal["position", "speed", "edge"]
        if binding.position is not None:
            kind, fields = "position", binding.position
        elif binding.speed is not None:
            kind, fields = "speed", (binding.speed,)
        else:
            kind, fields = "edge", (str(binding.edge),)
        if (kind == "edge") != (clock in ("cycles", "starts")):
            wanted = "edge" if clock in ("cycles", "starts") else "position or speed"
            raise LocatedError(place, f"the {clock} clock is driven by {wanted}, not by {kind}")
        inside = {"position": "m", "speed": "m/s", "edge": ""}[kind]
        written = binding.unit or inside
        try:
            scale = 1.0 if kind == "edge" else conversion(written, inside).scale
            signals = tuple(signal_name(binding.topic, name) for name in fields)
        except RobophmError as error:
            raise LocatedError(place, str(error)) from None
        return MeasuredClock(
            clock, kind, signals, written, scale, binding.threshold, round(binding.max_age * SECOND), binding.becomes
        )


def _default(model: Model, name: str) -> str | None:
    """The default of a number as a user would write it."""
    entry = model.numbers[name]
    return None if entry.default is None else f"{entry.default!r} {entry.unit}"
