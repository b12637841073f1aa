"""The simulator's own reader of a design file; what it does not understand, it refuses."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from robophm.core.errors import DesignError, RobophmError, nearest
from robophm.core.yaml_nodes import TooMuchError, bounded_reader
from robophm.simulation.design import CLOCKS, INPUTS, Design, Mode, Signal, Stress
from robophm.simulation.design_keys import (
    FIGURES,
    MAX_DEPTH,
    MODE_KEYS,
    LocatedError,
    Place,
    known_keys,
    read_conversion,
    read_difference,
    read_mapping,
    read_quantity,
    read_signal_name,
    read_whole,
)
from robophm.simulation.lives import LIVES, Life
from robophm.simulation.structure import Group
from robophm.simulation.wiring import Wiring

MAX_BYTES = 20_000_000
"""A larger design is refused before it is parsed."""

MOST_PARTS = 10_000
"""Parts of a robot, each of which lives for itself."""

_ACCELERATIONS: Mapping[str, tuple[str, str, str, float | None]] = {
    "q10": ("temperature", "q", "", 2.0),
    "arrhenius": ("temperature", "activation_energy", "eV", None),
    "cubic_load": ("load", "", "", 3.0),
    "inverse_power": ("voltage", "exponent", "", None),
}
"""Accelerations by name: what drives each, its parameter with unit and default."""
_REFERENCES: Mapping[str, float | None] = {"temperature": 25.0, "load": 1.0, "voltage": None}


_OF_A_LIBRARY = "library: "
"""The beginning of the source of a rate that is an entry's."""

Library = Callable[[Mapping[str, Any]], Mapping[str, Any]]
"""A function that completes a component that names a library part with all said of it; it may raise RobophmError."""


def read_design(path: Path, library: Library | None = None) -> Design:
    """Read a robot's design. Raises DesignError, one line with file and line, for what is wrong or not simulated."""
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        with path.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)
        text = content.decode("utf-8-sig")
    except OSError as error:
        raise DesignError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise DesignError(f"{path}: is not UTF-8 text") from None
    if len(content) > MAX_BYTES:
        raise DesignError(f"{path}: is more than {MAX_BYTES / 1e6:.0f} MB")
    try:
        data = bounded_reader("rt").load(io.StringIO(text))
    except MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise DesignError(f"{path}:{line}: is not YAML: {error.problem}") from None
    except TooMuchError as error:
        raise DesignError(f"{path}:{error.line + 1}: {error}") from None
    except RecursionError:
        raise DesignError(f"{path}: is nested too deeply; expected at most {MAX_DEPTH} levels") from None
    except (YAMLError, ValueError) as error:
        raise DesignError(f"{path}: is not YAML: {str(error).splitlines()[0]}") from None
    if not isinstance(data, dict):
        raise DesignError(f"{path}: holds no design")
    try:
        return _Reader(data, library).design()
    except LocatedError as fault:
        where = "/".join(fault.place) + ": " if fault.place else ""
        raise DesignError(f"{path}:{_line(data, fault.place)}: {where}{fault}") from None


def _line(data: Any, place: Place) -> int:
    """The line of the innermost key of a place that the file has."""
    line = 1
    for step in place:
        if not isinstance(data, dict) or step not in data or not hasattr(data, "lc"):
            break
        line = data.lc.key(step)[0] + 1
        data = data[step]
    return line


def _origin(name: Place, path: Place, mode: Mapping[str, Any]) -> str:
    """A key of the true rate of a mode: of parts of one entry of a library it is the same many times as stated."""
    source = str(mode.get("source", ""))
    if source.startswith(_OF_A_LIBRARY) and not mode.get("learned"):
        return " ".join((source, str(mode.get("clock")), *name))
    return "/".join(path)


@dataclass(frozen=True)
class _Scope:
    """The settings that a level inherits."""

    signals: Mapping[str, tuple[int, float]] = field(default_factory=dict)
    """Number of the signal, and what its binding adds, by input."""
    kilometres: bool = False
    acceleration: Any = None
    duty: float = 1.0
    uncertainty: tuple[Place, Any] | None = None


class _Reader:
    def __init__(self, data: dict[str, Any], library: Library | None) -> None:
        self.data = data
        self.library = library
        self.parts: list[str] = []
        self.modes: list[Mode] = []
        self.levels: dict[str, dict[str, Any]] = {}
        self.components: dict[str, Group] = {}
        self.signals: list[Signal] = []
        self.speed: dict[str, float] = {}
        self.max_age = math.inf

    def design(self) -> Design:
        data = self.data
        if data.get("schema_version") != 1:
            raise LocatedError(("schema_version",), f"{data.get('schema_version')!r:.60}; expected 1")
        if not isinstance(data.get("name"), str):
            raise LocatedError((), "needs 'name'")
        self.usage = self._usage()
        if "powered" not in data:
            raise LocatedError(
                (), "needs 'powered': a simulated robot is off between its tasks, and its recording says so"
            )
        powered = known_keys(("powered",), data["powered"], "powered")
        self._level((), (), data, _Scope())
        functions = data.get("functions") or {}
        read_mapping(("functions",), functions)
        if bad := next((name for name in functions if ";" in name), None):
            raise LocatedError(("functions", bad), "a function's name holds ';', which parts names in a task list")
        power = read_signal_name(("powered",), powered.get("topic"), powered.get("field"))
        names = [power, *self.speed, *(signal.name for signal in self.signals)]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise LocatedError((), f"{twice} is bound to different things")
        wiring = Wiring(self.levels, self.components)
        return Design(
            data["name"],
            tuple(self.parts),
            tuple(self.modes),
            wiring.module("", ("diagram",)),
            {name: wiring.block("", diagram, ("functions", name), 0) for name, diagram in functions.items()},
            tuple(self.signals),
            tuple(self.speed.items()),
            power,
            self.usage,
            self.max_age,
        )

    # What is there.

    def _level(self, path: Place, place: Place, level: dict[str, Any], above: _Scope) -> None:
        if len(path) > MAX_DEPTH:
            raise LocatedError(place, f"is nested deeper than {MAX_DEPTH} levels")
        known_keys(place, level, "module" if path else "robot")
        scope = self._scope(path, place, level, above)
        self.levels["/".join(path)] = level
        modules, components = (level.get(kind) or {} for kind in ("modules", "components"))
        read_mapping((*place, "modules"), modules)
        read_mapping((*place, "components"), components)
        if not modules and not components:
            raise LocatedError(place, "has no parts; expected modules or components")
        for name, module in modules.items():
            self._level((*path, str(name)), (*place, "modules", str(name)), module, scope)
        for name, component in components.items():
            self._component((*path, str(name)), (*place, "components", str(name)), component, scope)

    def _component(self, path: Place, place: Place, part: dict[str, Any], above: _Scope) -> None:
        if "part" in read_mapping(place, part):
            part = self._of_the_library(place, part)
        known_keys(place, part, "component")
        scope = replace(self._scope(path, place, part, above), acceleration=above.acceleration)
        count = read_whole((*place, "quantity"), part.get("quantity", 1), MOST_PARTS)
        required = read_whole((*place, "required"), part.get("required", count), count)
        offsets = read_mapping((*place, "offsets"), part.get("offsets") or {})
        for name in offsets:
            if name not in scope.signals:
                raise LocatedError(
                    (*place, "offsets", name), f"no signal '{name}' is bound{nearest(name, scope.signals)}"
                )
        written = read_mapping((*place, "failure_modes"), part.get("failure_modes") or {})
        if written and (inline := (MODE_KEYS - {"uncertainty"}) & part.keys()):
            raise LocatedError(place, f"has failure_modes and its own {min(inline)}; expected one of the two")
        places = [(path, place, part)]
        if written:
            places = [((*path, n), (*place, "failure_modes", n), one) for n, one in written.items()]
            for _, at, one in places:
                known_keys(at, one, "mode")
        first = len(self.parts)
        name = "/".join(path)
        if first + count > MOST_PARTS:
            raise LocatedError(place, f"the robot has more than {MOST_PARTS:,} parts")
        self.parts += [name] if count == 1 else [f"{name}[{i}]" for i in range(1, count + 1)]
        modes = [self._mode(key[len(path) :], path, at, one, offsets, scope) for key, at, one in places]
        self.modes += [replace(mode, part=first + i) for i in range(count) for mode in modes]
        self.components[name] = Group(required, tuple(range(first, first + count)))

    def _mode(self, name: Place, path: Place, place: Place, mode: dict[str, Any], offsets: Any, scope: _Scope) -> Mode:
        origin = _origin(name, (*path, *name), mode)
        clock = mode.get("clock", "operating")
        if clock not in CLOCKS:
            raise LocatedError((*place, "clock"), f"no clock '{clock}'{nearest(str(clock), CLOCKS)}")
        if clock == "kilometres" and not scope.kilometres:
            raise LocatedError(
                (*place, "clock"), "kilometres are not measured; expected clocks: {kilometres: {speed: …}}"
            )
        if clock in ("cycles", "starts") and clock not in self.usage:
            raise LocatedError(("usage",), f"says nothing of '{clock}', on which {origin} ages")
        if mode.get("rate") == "unknown":
            raise LocatedError((*place, "rate"), "is unknown; what has no rate is not simulated")
        unit = CLOCKS[clock]
        life = known_keys((*place, "life"), mode.get("life") or {}, "life")
        distribution = life.get("distribution", "exponential")
        if distribution not in LIVES:
            raise LocatedError(
                (*place, "life"), f"distribution '{distribution}' is not simulated{nearest(str(distribution), LIVES)}"
            )
        make, parameter = LIVES[distribution]
        if odd := life.keys() - {"distribution", parameter}:
            raise LocatedError((*place, "life", min(odd)), f"is no parameter of {distribution}")
        values = []
        if parameter:
            inside = unit if parameter == "deviation" else ""
            values = [read_quantity((*place, "life", parameter), life.get(parameter), inside, above=0.0)]
        rate = self._rate(place, mode, make(*values), unit)
        learned = read_mapping((*place, "learned"), mode.get("learned") or {})
        if learned:
            rate *= read_quantity((*place, "learned", "factor"), learned.get("factor"), "", above=0.0)
        scaling = mode.get("scaling", "age")
        if scaling not in ("age", "hazard"):
            raise LocatedError((*place, "scaling"), f"'{scaling}'; expected age or hazard")
        stresses = self._stresses(place, mode.get("acceleration") or scope.acceleration, offsets, scope)
        if clock == "calendar" and stresses:
            raise LocatedError(
                place, "a calendar clock is not accelerated here: no sensor speaks while the robot is off"
            )
        initial = mode.get("initial_exposure")
        return Mode(
            0,
            "/".join(name),
            rate,
            make(*values),
            clock,
            scaling == "hazard" and distribution != "exponential",  # of the exponential the two are the same
            0.0 if initial is None else read_quantity((*place, "initial_exposure"), initial, unit, least=0.0),
            scope.duty,
            stresses,
            origin,
            self._uncertainty(place, mode, scope, rate, unit),
        )

    def _of_the_library(self, place: Place, part: dict[str, Any]) -> dict[str, Any]:
        if self.library is None:
            raise LocatedError(
                (*place, "part"), "is of a library, and none is given; expected what it says of the part"
            )
        try:
            return dict(self.library(part))
        except RobophmError as error:
            raise LocatedError((*place, "part"), str(error)) from None

    @staticmethod
    def _rate(place: Place, mode: dict[str, Any], life: Life, unit: str) -> float:
        """The rate, one over the mean life, from whatever says how often a part fails."""
        stated = [key for key in FIGURES if mode.get(key) is not None]
        if len(stated) != 1:
            raise LocatedError(
                place, f"has {' and '.join(stated) or 'no rate'}; what has not one rate is not simulated"
            )
        key = stated[0]
        at, said = (*place, key), mode[key]
        if key == "rate":
            return read_quantity(at, said, f"1/{unit}", above=0.0)
        age = read_quantity(at, said, unit, above=0.0)
        if key in ("l10", "b10"):  # by which ln S has fallen to ln 0.9; an age grows with the mean in a straight line
            none, one = (float(life.age_at(np.log(0.9), np.asarray(mean))) for mean in (0.0, 1.0))
            age = (age - none) / (one - none)
            if not age > 0:
                raise LocatedError(at, f"{said} is too small for its life")
        return 1 / age

    def _stresses(self, place: Place, chosen: Any, offsets: Any, scope: _Scope) -> tuple[Stress, ...]:
        place = (*place, "acceleration")
        stresses = []
        for written in [] if chosen in (None, "none") else chosen if isinstance(chosen, list) else [chosen]:
            read_mapping(place, written)
            model = written.get("model")
            if model not in _ACCELERATIONS:
                raise LocatedError(
                    place, f"acceleration '{model}' is not simulated{nearest(str(model), _ACCELERATIONS)}"
                )
            driven_by, name, unit, default = _ACCELERATIONS[model]
            reference = f"reference_{driven_by}"
            if odd := written.keys() - {"model", name, reference}:
                raise LocatedError((*place, min(odd)), f"is no parameter of {model}")
            first = default if name not in written else read_quantity((*place, name), written[name], unit)
            at = _REFERENCES[driven_by]
            if reference in written:
                at = read_quantity((*place, reference), written[reference], INPUTS[driven_by])
            if first is None or at is None:
                raise LocatedError(place, f"{model} needs '{name if first is None else reference}'")
            if driven_by in scope.signals:
                signal, shift = scope.signals[driven_by]
                if driven_by in offsets:
                    shift += read_difference((*place, "offsets"), offsets[driven_by], driven_by)
                stresses.append(Stress(model, (first, at), signal, shift))
                if self.signals[signal].reference is None:
                    self.signals[signal] = replace(self.signals[signal], reference=at - shift)
        return tuple(stresses)

    def _uncertainty(
        self, place: Place, mode: dict[str, Any], scope: _Scope, rate: float, unit: str
    ) -> tuple[str, tuple[float, ...]] | None:
        """The kind, and its error factor, failures, or rates as shares of the stated one."""
        if mode.get("learned"):
            return "failures", (
                read_quantity((*place, "learned", "shape"), mode["learned"].get("shape"), "", above=0.0),
            )
        found = (place, mode["uncertainty"]) if "uncertainty" in mode else scope.uncertainty
        if not found or found[1] is None:
            return None
        at, written = (*found[0], "uncertainty"), found[1]
        read_mapping(at, written)
        kinds = list(written)
        if len(kinds) != 1 or kinds[0] not in ("error_factor", "failures", "samples"):
            raise LocatedError(at, "expected exactly one of error_factor, failures, samples")
        kind, value = kinds[0], written[kinds[0]]
        if kind == "samples":
            if not isinstance(value, list) or not value:
                raise LocatedError(at, "expected samples: a list of rates")
            return kind, tuple(read_quantity(at, one, f"1/{unit}", above=0.0) / rate for one in value)
        return kind, (read_quantity(at, value, "", above=1.0 if kind == "error_factor" else 0.0),)

    def _scope(self, path: Place, place: Place, level: dict[str, Any], above: _Scope) -> _Scope:
        signals, kilometres = dict(above.signals), above.kilometres
        for name, binding in read_mapping((*place, "signals"), level.get("signals") or {}).items():
            signals[name] = self._signal((*place, "signals", name), "/".join((*path, name)), name, binding)
        for name, binding in read_mapping((*place, "clocks"), level.get("clocks") or {}).items():
            at = (*place, "clocks", name)
            if name != "kilometres" or not isinstance(binding, dict) or "speed" not in binding:
                raise LocatedError(at, "only kilometres by a 'speed' are simulated")
            known_keys(at, binding, "clock")
            signal = read_signal_name(at, binding.get("topic"), binding["speed"])
            self.speed[signal] = read_conversion(at, binding.get("unit", "m/s"), "m/s")[0]
            self._ages(at, binding)
            kilometres = True
        duty = above.duty
        if "duty" in level:
            duty = read_quantity((*place, "duty"), level["duty"], "", least=0.0)
            if duty > 1:
                raise LocatedError((*place, "duty"), f"{duty:g}; expected 0 … 1")
        uncertainty = (place, level["uncertainty"]) if "uncertainty" in level else above.uncertainty
        return _Scope(signals, kilometres, level.get("acceleration") or above.acceleration, duty, uncertainty)

    def _signal(self, place: Place, key: str, name: str, binding: Any) -> tuple[int, float]:
        """The number of a signal, and what its binding adds."""
        if name not in INPUTS:
            raise LocatedError(place, f"input '{name}' is not simulated{nearest(name, INPUTS)}")
        known_keys(place, binding, "binding")
        topic = read_signal_name(place, binding.get("topic"), binding.get("field"))
        scale, offset = read_conversion(place, binding.get("unit", INPUTS[name]), INPUTS[name])
        low, high = -math.inf, math.inf
        if "range" in binding:
            try:
                low, high = sorted(scale * float(end) + offset for end in binding["range"])
            except (TypeError, ValueError):
                raise LocatedError((*place, "range"), "expected two numbers") from None
        shift = read_difference((*place, "offset"), binding["offset"], name) if "offset" in binding else 0.0
        self._ages(place, binding)
        number = next((i for i, known in enumerate(self.signals) if known.name == topic), None)
        if number is None:
            self.signals.append(Signal(topic, name, scale, offset, low, high, (key,)))
            return len(self.signals) - 1, shift
        known = self.signals[number]
        if (known.input, known.scale, known.offset) != (name, scale, offset):
            raise LocatedError(place, f"{topic} is bound to '{known.input}' too, or in another unit")
        low, high = max(known.low, low), min(known.high, high)
        if not low < high:
            raise LocatedError(place, f"the ranges of {topic} have nothing in common")
        self.signals[number] = replace(known, keys=(*known.keys, key), low=low, high=high)
        return number, shift

    def _ages(self, place: Place, binding: dict[str, Any]) -> None:
        age = read_quantity((*place, "max_age"), binding.get("max_age", "5 s"), "s")
        if age < 0.1:
            raise LocatedError((*place, "max_age"), f"{age:g} s; a simulated sensor speaks ten times a second at most")
        self.max_age = min(self.max_age, age)

    def _usage(self) -> dict[str, float]:
        written = known_keys(("usage",), self.data.get("usage") or {}, "usage")
        usage = {"operating": 1.0}
        for name, value in written.items():
            unit = f"{CLOCKS[name]}/h" if name != "operating" else ""
            usage[name] = read_quantity(("usage", name), value, unit, least=0.0)
        return usage
