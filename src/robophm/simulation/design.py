"""What the simulator understands of a design file, read by itself; what it does not, it refuses."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DesignError, RobophmError, nearest
from robophm.core.signal import signal_name
from robophm.core.units import conversion, quantity
from robophm.simulation.lives import LIVES, Life
from robophm.simulation.structure import Block, Group, Route

Array = npt.NDArray[np.float64]
Place = tuple[str, ...]

MAX_BYTES = 20_000_000
"""A larger design is refused before it is parsed."""

MOST_PARTS = 10_000
"""Parts of a robot, each of which lives for itself."""

MOST_BLOCKS = 1_000_000
MAX_DEPTH = 50

CLOCKS: Mapping[str, str] = {
    "operating": "h",
    "calendar": "h",
    "kilometres": "km",
    "cycles": "cycle",
    "starts": "start",
}
"""What parts age on, and the unit in which it counts."""

INPUTS: Mapping[str, str] = {"temperature": "degC", "load": "", "voltage": "V"}
"""What can be measured, and the unit in which it is meant."""

BOLTZMANN = 8.617333e-5
"""eV/K."""


@dataclass(frozen=True)
class Stress:
    """One acceleration of a mode by one signal."""

    model: str
    parameters: tuple[float, ...]
    signal: int
    shift: float
    """Added to what the sensor reads."""

    def factor(self, reading: Array) -> Array:
        """AF at what the sensor reads; 1 at the reference."""
        x = reading + self.shift
        first, reference = self.parameters
        result: Array
        if self.model == "q10":
            result = first ** ((x - reference) / 10)
        elif self.model == "arrhenius":
            result = np.exp(first / BOLTZMANN * (1 / (reference + 273.15) - 1 / (x + 273.15)))
        else:  # cubic_load, inverse_power
            result = np.abs(x / reference) ** first
        return result


@dataclass(frozen=True)
class Signal:
    """One number that a sensor reads: the truth plus nothing."""

    name: str
    input: str
    scale: float
    """The model input is scale · message + offset."""
    offset: float
    low: float
    high: float
    """What it reads at least and at most, in the unit of the model input."""
    keys: tuple[str, ...]
    """As what a task file states it: ``temperature``, ``Power/temperature``."""
    reference: float | None = None
    """Of the first acceleration that it drives."""


@dataclass(frozen=True)
class Mode:
    """One way in which one part fails."""

    part: int
    rate: float
    """[1/clock], at reference stress."""
    life: Life
    clock: str
    by_hazard: bool
    """Stress scales the hazard, not the age."""
    initial: float
    duty: float
    stresses: tuple[Stress, ...]
    origin: str
    """Path of the component's mode: its equal parts share one draw of the rate."""
    uncertainty: tuple[str, tuple[float, ...]] | None


@dataclass(frozen=True)
class Design:
    """A robot as the simulator sees it."""

    name: str
    parts: tuple[str, ...]
    modes: tuple[Mode, ...]
    """In the order of their parts; every part has one at least."""
    whole: Block
    functions: Mapping[str, Block]
    signals: tuple[Signal, ...]
    speed: tuple[tuple[str, float], ...]
    """Signals that say the robot's speed, and the unit of each in m/s."""
    powered: str
    usage: Mapping[str, float]
    """``operating`` share of the time; cycles and starts per operating hour."""
    max_age: float
    """How often each sensor must speak [s]."""


class _Fault(Exception):  # noqa: N818
    def __init__(self, place: Place, message: str) -> None:
        super().__init__(message)
        self.place = place


def read_design(path: Path) -> Design:
    """A robot's design. Raises DesignError, one line with file and line, for what is wrong or not simulated."""
    from ruamel.yaml import YAML
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
        data = YAML(typ="rt", pure=True).load(io.StringIO(text))
    except MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise DesignError(f"{path}:{line}: is not YAML: {error.problem}") from None
    except RecursionError:
        raise DesignError(f"{path}: is nested too deeply; expected at most {MAX_DEPTH} levels") from None
    except (YAMLError, ValueError) as error:
        raise DesignError(f"{path}: is not YAML: {str(error).splitlines()[0]}") from None
    if not isinstance(data, dict):
        raise DesignError(f"{path}: holds no design")
    try:
        return _Reader(data).design()
    except _Fault as fault:
        where = "/".join(fault.place) + ": " if fault.place else ""
        raise DesignError(f"{path}:{_line(data, fault.place)}: {where}{fault}") from None


def _line(data: Any, place: Place) -> int:
    """Of the innermost key of a place that the file has."""
    line = 1
    for step in place:
        if not isinstance(data, dict) or step not in data or not hasattr(data, "lc"):
            break
        line = data.lc.key(step)[0] + 1
        data = data[step]
    return line


_GROUP = {"modules", "components", "diagram", "signals", "clocks", "acceleration", "duty", "uncertainty"}
_MODE = {"rate", "life", "clock", "scaling", "acceleration", "initial_exposure", "uncertainty", "learned"}
_SILENT = {"description", "environment", "source"}
"""Keys that say nothing about how a robot with stated rates fails."""
_KEYS: Mapping[str, set[str]] = {
    "robot": _GROUP | {"schema_version", "name", "functions", "usage", "powered", "max_gap", "task", "thresholds"},
    "module": _GROUP | {"thresholds"},
    "component": _MODE | {"quantity", "required", "monitored", "signals", "clocks", "offsets", "duty", "failure_modes"},
    "mode": _MODE,
    "binding": {"topic", "field", "unit", "range", "offset", "max_age", "stale"},
    "clock": {"topic", "speed", "unit", "max_age"},
    "life": {"distribution", "shape", "log_deviation", "deviation"},
    "powered": {"topic", "field"},
    "usage": {"operating", "kilometres", "cycles", "starts"},
    "k_of_n": {"k", "of"},
    "network": {"from", "to", "links", "junctions"},
    "link": {"between", "from", "to", "through"},
}
_ACCELERATIONS: Mapping[str, tuple[str, str, str, float | None]] = {
    "q10": ("temperature", "q", "", 2.0),
    "arrhenius": ("temperature", "activation_energy", "eV", None),
    "cubic_load": ("load", "", "", 3.0),
    "inverse_power": ("voltage", "exponent", "", None),
}
"""By name: what drives it, its parameter with unit and default."""
_REFERENCES: Mapping[str, float | None] = {"temperature": 25.0, "load": 1.0, "voltage": None}


@dataclass(frozen=True)
class _Scope:
    """What a level inherits."""

    signals: Mapping[str, tuple[int, float]] = field(default_factory=dict)
    """By input: the number of the signal, and what its binding adds."""
    kilometres: bool = False
    acceleration: Any = None
    duty: float = 1.0
    uncertainty: tuple[Place, Any] | None = None


class _Reader:
    def __init__(self, data: dict[str, Any]) -> None:
        self.data = data
        self.parts: list[str] = []
        self.modes: list[Mode] = []
        self.levels: dict[str, dict[str, Any]] = {}
        self.components: dict[str, Group] = {}
        self.signals: list[Signal] = []
        self.speed: dict[str, float] = {}
        self.max_age = math.inf
        self.expanded: dict[str, Block] = {}
        self.under_way: list[str] = []
        self.blocks = 0

    def design(self) -> Design:
        data = self.data
        if data.get("schema_version") != 1:
            raise _Fault(("schema_version",), f"{data.get('schema_version')!r:.60}; expected 1")
        if not isinstance(data.get("name"), str):
            raise _Fault((), "needs 'name'")
        self.usage = self._usage()
        if "powered" not in data:
            raise _Fault((), "needs 'powered': a simulated robot is off between its tasks, and its recording says so")
        powered = self._keys(("powered",), data["powered"], "powered")
        self._level((), (), data, _Scope())
        functions = data.get("functions") or {}
        self._mapping(("functions",), functions)
        if bad := next((name for name in functions if ";" in name), None):
            raise _Fault(("functions", bad), "a function's name holds ';', which parts names in a task list")
        power = self._signal_name(("powered",), powered.get("topic"), powered.get("field"))
        names = [power, *self.speed, *(signal.name for signal in self.signals)]
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise _Fault((), f"{twice} is bound to different things")
        return Design(
            data["name"],
            tuple(self.parts),
            tuple(self.modes),
            self._module("", ("diagram",)),
            {name: self._block("", diagram, ("functions", name), 0) for name, diagram in functions.items()},
            tuple(self.signals),
            tuple(self.speed.items()),
            power,
            self.usage,
            self.max_age,
        )

    # What is there.

    def _level(self, path: Place, place: Place, level: dict[str, Any], above: _Scope) -> None:
        if len(path) > MAX_DEPTH:
            raise _Fault(place, f"is nested deeper than {MAX_DEPTH} levels")
        self._keys(place, level, "module" if path else "robot")
        scope = self._scope(path, place, level, above)
        self.levels["/".join(path)] = level
        modules, components = (level.get(kind) or {} for kind in ("modules", "components"))
        self._mapping((*place, "modules"), modules)
        self._mapping((*place, "components"), components)
        if not modules and not components:
            raise _Fault(place, "has no parts; expected modules or components")
        for name, module in modules.items():
            self._level((*path, str(name)), (*place, "modules", str(name)), module, scope)
        for name, component in components.items():
            self._component((*path, str(name)), (*place, "components", str(name)), component, scope)

    def _component(self, path: Place, place: Place, part: dict[str, Any], above: _Scope) -> None:
        self._keys(place, part, "component")
        scope = replace(self._scope(path, place, part, above), acceleration=above.acceleration)
        count = self._whole((*place, "quantity"), part.get("quantity", 1), MOST_PARTS)
        required = self._whole((*place, "required"), part.get("required", count), count)
        offsets = self._mapping((*place, "offsets"), part.get("offsets") or {})
        for name in offsets:
            if name not in scope.signals:
                raise _Fault((*place, "offsets", name), f"no signal '{name}' is bound{nearest(name, scope.signals)}")
        written = self._mapping((*place, "failure_modes"), part.get("failure_modes") or {})
        if written and (inline := (_MODE - {"uncertainty"}) & part.keys()):
            raise _Fault(place, f"has failure_modes and its own {min(inline)}; expected one of the two")
        places = [(path, place, part)]
        if written:
            places = [((*path, n), (*place, "failure_modes", n), one) for n, one in written.items()]
            for _, at, one in places:
                self._keys(at, one, "mode")
        first = len(self.parts)
        name = "/".join(path)
        if first + count > MOST_PARTS:
            raise _Fault(place, f"the robot has more than {MOST_PARTS:,} parts")
        self.parts += [name] if count == 1 else [f"{name}[{i}]" for i in range(1, count + 1)]
        modes = [self._mode(at, one, offsets, scope, "/".join(key)) for key, at, one in places]
        self.modes += [replace(mode, part=first + i) for i in range(count) for mode in modes]
        self.components[name] = Group(required, tuple(range(first, first + count)))

    def _mode(self, place: Place, mode: dict[str, Any], offsets: Any, scope: _Scope, origin: str) -> Mode:
        clock = mode.get("clock", "operating")
        if clock not in CLOCKS:
            raise _Fault((*place, "clock"), f"no clock '{clock}'{nearest(str(clock), CLOCKS)}")
        if clock == "kilometres" and not scope.kilometres:
            raise _Fault((*place, "clock"), "kilometres are not measured; expected clocks: {kilometres: {speed: …}}")
        if clock in ("cycles", "starts") and clock not in self.usage:
            raise _Fault(("usage",), f"says nothing of '{clock}', on which {origin} ages")
        if "rate" not in mode:
            raise _Fault(place, "has no rate; what has none is not simulated")
        if mode["rate"] == "unknown":
            raise _Fault((*place, "rate"), "is unknown; what has no rate is not simulated")
        unit = CLOCKS[clock]
        rate = self._quantity((*place, "rate"), mode["rate"], f"1/{unit}", above=0.0)
        learned = self._mapping((*place, "learned"), mode.get("learned") or {})
        if learned:
            rate *= self._quantity((*place, "learned", "factor"), learned.get("factor"), "", above=0.0)
        life = self._keys((*place, "life"), mode.get("life") or {}, "life")
        name = life.get("distribution", "exponential")
        if name not in LIVES:
            raise _Fault((*place, "life"), f"distribution '{name}' is not simulated{nearest(str(name), LIVES)}")
        make, parameter = LIVES[name]
        if odd := life.keys() - {"distribution", parameter}:
            raise _Fault((*place, "life", min(odd)), f"is no parameter of {name}")
        values = []
        if parameter:
            inside = unit if parameter == "deviation" else ""
            values = [self._quantity((*place, "life", parameter), life.get(parameter), inside, above=0.0)]
        scaling = mode.get("scaling", "age")
        if scaling not in ("age", "hazard"):
            raise _Fault((*place, "scaling"), f"'{scaling}'; expected age or hazard")
        stresses = self._stresses(place, mode.get("acceleration") or scope.acceleration, offsets, scope)
        if clock == "calendar" and stresses:
            raise _Fault(place, "a calendar clock is not accelerated here: no sensor speaks while the robot is off")
        initial = mode.get("initial_exposure")
        return Mode(
            0,
            rate,
            make(*values),
            clock,
            scaling == "hazard" and name != "exponential",  # of the exponential the two are the same
            0.0 if initial is None else self._quantity((*place, "initial_exposure"), initial, unit, least=0.0),
            scope.duty,
            stresses,
            origin,
            self._uncertainty(place, mode, scope, rate, unit),
        )

    def _stresses(self, place: Place, chosen: Any, offsets: Any, scope: _Scope) -> tuple[Stress, ...]:
        place = (*place, "acceleration")
        stresses = []
        for written in [] if chosen in (None, "none") else chosen if isinstance(chosen, list) else [chosen]:
            self._mapping(place, written)
            model = written.get("model")
            if model not in _ACCELERATIONS:
                raise _Fault(place, f"acceleration '{model}' is not simulated{nearest(str(model), _ACCELERATIONS)}")
            driven_by, name, unit, default = _ACCELERATIONS[model]
            reference = f"reference_{driven_by}"
            if odd := written.keys() - {"model", name, reference}:
                raise _Fault((*place, min(odd)), f"is no parameter of {model}")
            first = default if name not in written else self._quantity((*place, name), written[name], unit)
            at = _REFERENCES[driven_by]
            if reference in written:
                at = self._quantity((*place, reference), written[reference], INPUTS[driven_by])
            if first is None or at is None:
                raise _Fault(place, f"{model} needs '{name if first is None else reference}'")
            if driven_by in scope.signals:
                signal, shift = scope.signals[driven_by]
                if driven_by in offsets:
                    shift += self._difference((*place, "offsets"), offsets[driven_by], driven_by)
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
                self._quantity((*place, "learned", "shape"), mode["learned"].get("shape"), "", above=0.0),
            )
        found = (place, mode["uncertainty"]) if "uncertainty" in mode else scope.uncertainty
        if not found or found[1] is None:
            return None
        at, written = (*found[0], "uncertainty"), found[1]
        self._mapping(at, written)
        kinds = list(written)
        if len(kinds) != 1 or kinds[0] not in ("error_factor", "failures", "samples"):
            raise _Fault(at, "expected exactly one of error_factor, failures, samples")
        kind, value = kinds[0], written[kinds[0]]
        if kind == "samples":
            if not isinstance(value, list) or not value:
                raise _Fault(at, "expected samples: a list of rates")
            return kind, tuple(self._quantity(at, one, f"1/{unit}", above=0.0) / rate for one in value)
        return kind, (self._quantity(at, value, "", above=1.0 if kind == "error_factor" else 0.0),)

    def _scope(self, path: Place, place: Place, level: dict[str, Any], above: _Scope) -> _Scope:
        signals, kilometres = dict(above.signals), above.kilometres
        for name, binding in self._mapping((*place, "signals"), level.get("signals") or {}).items():
            signals[name] = self._signal((*place, "signals", name), "/".join((*path, name)), name, binding)
        for name, binding in self._mapping((*place, "clocks"), level.get("clocks") or {}).items():
            at = (*place, "clocks", name)
            if name != "kilometres" or not isinstance(binding, dict) or "speed" not in binding:
                raise _Fault(at, "only kilometres by a 'speed' are simulated")
            self._keys(at, binding, "clock")
            signal = self._signal_name(at, binding.get("topic"), binding["speed"])
            self.speed[signal] = self._conversion(at, binding.get("unit", "m/s"), "m/s")[0]
            self._ages(at, binding)
            kilometres = True
        duty = above.duty
        if "duty" in level:
            duty = self._quantity((*place, "duty"), level["duty"], "", least=0.0)
            if duty > 1:
                raise _Fault((*place, "duty"), f"{duty:g}; expected 0 … 1")
        uncertainty = (place, level["uncertainty"]) if "uncertainty" in level else above.uncertainty
        return _Scope(signals, kilometres, level.get("acceleration") or above.acceleration, duty, uncertainty)

    def _signal(self, place: Place, key: str, name: str, binding: Any) -> tuple[int, float]:
        """The number of a signal, and what its binding adds."""
        if name not in INPUTS:
            raise _Fault(place, f"input '{name}' is not simulated{nearest(name, INPUTS)}")
        self._keys(place, binding, "binding")
        topic = self._signal_name(place, binding.get("topic"), binding.get("field"))
        scale, offset = self._conversion(place, binding.get("unit", INPUTS[name]), INPUTS[name])
        low, high = -math.inf, math.inf
        if "range" in binding:
            try:
                low, high = sorted(scale * float(end) + offset for end in binding["range"])
            except (TypeError, ValueError):
                raise _Fault((*place, "range"), "expected two numbers") from None
        shift = self._difference((*place, "offset"), binding["offset"], name) if "offset" in binding else 0.0
        self._ages(place, binding)
        number = next((i for i, known in enumerate(self.signals) if known.name == topic), None)
        if number is None:
            self.signals.append(Signal(topic, name, scale, offset, low, high, (key,)))
            return len(self.signals) - 1, shift
        known = self.signals[number]
        if (known.input, known.scale, known.offset) != (name, scale, offset):
            raise _Fault(place, f"{topic} is bound to '{known.input}' too, or in another unit")
        low, high = max(known.low, low), min(known.high, high)
        if not low < high:
            raise _Fault(place, f"the ranges of {topic} have nothing in common")
        self.signals[number] = replace(known, keys=(*known.keys, key), low=low, high=high)
        return number, shift

    def _ages(self, place: Place, binding: dict[str, Any]) -> None:
        age = self._quantity((*place, "max_age"), binding.get("max_age", "5 s"), "s")
        if age < 0.1:
            raise _Fault((*place, "max_age"), f"{age:g} s; a simulated sensor speaks ten times a second at most")
        self.max_age = min(self.max_age, age)

    def _usage(self) -> dict[str, float]:
        written = self._keys(("usage",), self.data.get("usage") or {}, "usage")
        usage = {"operating": 1.0}
        for name, value in written.items():
            unit = f"{CLOCKS[name]}/h" if name != "operating" else ""
            usage[name] = self._quantity(("usage", name), value, unit, least=0.0)
        return usage

    # How it is wired.

    def _module(self, path: str, place: Place) -> Block:
        """The block of a module, or of the robot."""
        if path in self.under_way:
            raise _Fault(place, f"cycle: '{path or 'the robot'}' contains itself")
        if path not in self.expanded:
            self.under_way.append(path)
            level = self.levels[path]
            names = [*(level.get("modules") or {}), *(level.get("components") or {})]
            diagram = level.get("diagram")
            if diagram is None:
                diagram = {"series": [str(name) for name in names]}
            self.expanded[path] = self._block(path, diagram, (*self._place(path), "diagram"), 0)
            self.under_way.pop()
        return self.expanded[path]

    def _block(self, level: str, diagram: Any, place: Place, depth: int) -> Block:
        self.blocks += 1
        if self.blocks > MOST_BLOCKS or depth > MAX_DEPTH:
            raise _Fault(place, f"a diagram of more than {MOST_BLOCKS:,} blocks, or more than {MAX_DEPTH} deep")
        if isinstance(diagram, str):
            return self._named(level, diagram, place)
        kinds = list(diagram) if isinstance(diagram, dict) else []
        if kinds and kinds[0] in ("standby", "load_sharing"):
            raise _Fault(place, f"{kinds[0]}: parts that depend on each other are not simulated; expected other blocks")
        if len(kinds) != 1 or kinds[0] not in ("series", "parallel", "k_of_n", "network"):
            raise _Fault(place, "not a block; expected a part's name, or one of series, parallel, k_of_n, network")
        kind, inside = kinds[0], diagram[kinds[0]]
        if kind == "network":
            return self._network(level, inside, place, depth)
        k: Any = 1
        if kind == "k_of_n":
            self._keys(place, inside, "k_of_n")
            k, inside = inside.get("k"), inside.get("of")
        if not isinstance(inside, list) or not inside:
            raise _Fault(place, f"{kind} of nothing; expected a list of blocks")
        blocks = tuple(self._block(level, one, place, depth + 1) for one in inside)
        return Group(len(blocks) if kind == "series" else self._whole(place, k, len(blocks)), blocks)

    def _network(self, level: str, said: Any, place: Place, depth: int) -> Block:
        self._keys(place, said, "network")
        start, end = str(said.get("from")), str(said.get("to"))
        lists = [said.get(name) or [] for name in ("links", "junctions")]
        if not all(isinstance(one, list) for one in lists):
            raise _Fault(place, "expected lists of links and junctions")
        links: list[tuple[str, str, Block | None]] = []
        for link in lists[0]:
            if isinstance(link, list):
                links += [way for a, b in pairwise(map(str, link)) for way in ((a, b, None), (b, a, None))]
                continue
            self._keys((*place, "links"), link, "link")
            block = link.get("through")
            through = None if block is None else self._block(level, block, (*place, "links"), depth + 1)
            joined = link.get("between", [link.get("from"), link.get("to")])
            if not isinstance(joined, list) or len(joined) != 2:
                raise _Fault((*place, "links"), f"{joined!r:.60} joins no two nodes")
            a, b = map(str, joined)
            links += [(a, b, through)] + [(b, a, through)] * ("between" in link)
        named = dict.fromkeys(name for a, b, _ in links for name in (a, b))
        perfect = {name for name in (start, end) if not self._is_part(level, name)} | set(map(str, lists[1]))
        nodes = {name: self._named(level, name, (*place, "links")) for name in named if name not in perfect}
        ends = {str(start)}
        for _ in named:
            ends |= {b for a, b, _ in links if a in ends}
        if end not in ends or start == end:
            raise _Fault(place, f"no path leads from '{start}' to '{end}'")
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
            raise _Fault(place, f"'{name}': expected [1] … [{len(members)}]")
        if path not in self.levels or not path:
            raise _Fault(place, f"unknown part '{name}'{nearest(path, [*self.components, *filter(None, self.levels)])}")
        return self._module(path, place)

    def _place(self, path: str) -> Place:
        return tuple(step for name in path.split("/") if name for step in ("modules", name))

    # What is written, checked.

    def _mapping(self, place: Place, value: Any) -> dict[str, Any]:
        if not isinstance(value, dict):
            raise _Fault(place, f"expected keys with values, not {value!r:.60}")
        if bad := next((key for key in value if not isinstance(key, str)), None):
            raise _Fault(place, f"{bad!r:.60} is not a name")
        return value

    def _keys(self, place: Place, value: Any, kind: str) -> dict[str, Any]:
        """A mapping with no key but the known ones. What is unknown is refused: it might change how things fail."""
        allowed = _KEYS[kind] | _SILENT
        for key in self._mapping(place, value):
            if key not in allowed:
                raise _Fault((*place, key), f"'{key}' is not simulated{nearest(key, allowed)}")
        return value  # type: ignore[no-any-return]

    def _quantity(
        self, place: Place, value: Any, unit: str, *, above: float = -math.inf, least: float = -math.inf
    ) -> float:
        try:
            number = quantity(value, unit)
        except RobophmError as error:
            raise _Fault(place, str(error)) from None
        if not (number > above and number >= least):
            raise _Fault(place, f"{value} is too small")
        return number

    def _difference(self, place: Place, value: Any, name: str) -> float:
        return self._quantity(place, value, "delta_degC" if name == "temperature" else INPUTS[name])

    def _whole(self, place: Place, value: Any, most: int) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
            raise _Fault(place, f"{value!r:.60}; expected a whole number, 1 … {most}")
        return int(value)

    def _conversion(self, place: Place, written: Any, inside: str) -> tuple[float, float]:
        try:
            return conversion(str(written), inside)
        except RobophmError as error:
            raise _Fault(place, str(error)) from None

    def _signal_name(self, place: Place, topic: Any, name: Any) -> str:
        try:
            return signal_name(str(topic), str(name))
        except RobophmError as error:
            raise _Fault(place, str(error)) from None
