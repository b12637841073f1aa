"""Which recorded signal each input of a design could follow, by their names, with the values that were seen.

A part and a signal belong together by the words that they share: those of the part's own path (elbow, left, battery)
count twice those of its kind (cpu of a computer), and words that are another part's speak against it. Where two signals
fit alike, none is proposed, and both are said.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robophm.design.importers.urdf import read_urdf
from robophm.design.importers.urdf.drives import words_of
from robophm.design.robot import Component, Robot
from robophm.drafting.seen import KINDS, Seen, SeenSignal
from robophm.parts import graded, library

RATED_SHARE = 0.5
"""The share of the largest effort of a joint that its gear is taken to be rated for.

A limit is a peak, and strain wave gears are rated for two to three fifths of the peak that they bear again and again
(Harmonic Drive, catalogues of CSG and CSF).
"""

RATED_SHARES = (0.4, 0.6)
"""The ends within which that share lies, by the same catalogues."""

STALL_SHARE = 0.2
"""The same of a servo's stall torque, as its maker wants it (entry smart_servo)."""

OF_KIND: Mapping[str, frozenset[str]] = {
    "computers": frozenset({"cpu", "soc", "gpu", "core", "computer", "board", "processor", "pi", "mcu", "fmu"}),
    "batteries": frozenset({"battery", "batteries", "bms", "cell", "pack"}),
    "motors": frozenset({"motor", "winding", "coil"}),
    "servos": frozenset({"servo", "motor", "actuator", "dynamixel"}),
    "gears": frozenset({"gear", "gearbox"}),
    "motor_drives": frozenset({"driver", "drive", "esc", "escs", "controller", "inverter"}),
    "power": frozenset({"converter", "supply", "charger"}),
    "storage": frozenset({"ssd", "nvme", "disk"}),
}
"""Words by which kinds of parts are called in topics and diagnostics."""

_OF_ENTRY = {
    "flight_controller": frozenset({"imu", "baro", "fmu", "autopilot", "px4", "pixhawk"}),
    "microcontroller_board": frozenset({"board", "mcu", "opencr", "arduino", "firmware"}),
}
"""The same of entries that are called otherwise than others of their kind."""

_CALLED = frozenset().union(*OF_KIND.values(), *_OF_ENTRY.values())

_VAGUE = frozenset({
    "joint", "link", "states", "state", "status", "values", "value", "data", "module", "sensing", "drive", "joints",
    "power", "computing", "interface", "effort", "position", "robot",
})  # fmt: skip
_RANGES = {"temperature": [-40, 150]}


@dataclass(frozen=True)
class Proposal:
    """A binding of a design that is not there yet, with what speaks for it."""

    place: tuple[str, ...]
    """The keys that lead to it in the design: ("modules", "elbow", "components", "gear", "signals", "load")."""
    binding: Mapping[str, Any]
    """The topic, field and further keys of the binding as a design writes them."""
    seen: str
    """The values that were seen."""
    assumed: str = ""
    """The assumption that the binding rests on, in words; "" where it rests on none."""

    @property
    def part(self) -> str:
        """The path of the part or level that it is of; "" for the robot."""
        return "/".join(name for key, name in zip(self.place[::2], self.place[1::2], strict=False)
                        if key in ("modules", "components"))  # fmt: skip

    @property
    def input(self) -> str:
        """The stress or clock that is bound: temperature, load, kilometres …"""
        return self.place[-1]

    @property
    def signals(self) -> tuple[str, ...]:
        """The signals that it listens to."""
        fields = self.binding.get("position") or [self.binding.get("field") or self.binding.get("edge")]
        return tuple(f"{self.binding['topic']}.{field}" for field in fields)


def proposals(robot: Robot, seen: Seen, efforts: Mapping[str, float] | None = None) -> tuple[list[Proposal], list[str]]:
    """Bindings for the inputs of a design that nothing is bound to, and why others have none.

    ``efforts``: the most that joints may be driven with [N·m or N], by their names: without it no load is proposed, for
    nothing says what counts as 1.
    """
    found: list[Proposal] = []
    notes: list[str] = []
    parts = list(robot.all_components())
    fits = _Fits(parts, seen.signals)
    for part, name in [(one, name) for one in parts for name in _open_inputs(one)]:
        best = fits.best(part, name)
        if len(best) > 1:
            notes.append(f"{part.path}: {name}: {' and '.join(one.name for one in best[:3])} fit alike; none is bound")
        elif best:
            made = _binding(part, name, best[0], efforts or {})
            if isinstance(made, str):
                notes.append(made)
            else:
                found.append(made)
    found += _clocks(robot, parts, seen)
    return found, list(dict.fromkeys(notes))


def limits_of(urdf: Path | None) -> dict[str, float]:
    """The most that each joint of a description may be driven with [N·m or N]; of none nothing. Raises DesignError."""
    efforts = {joint.name: joint.effort for joint in read_urdf(urdf).joints} if urdf else {}
    return {name: effort for name, effort in efforts.items() if effort > 0}


def place_of(part: Component) -> tuple[str, ...]:
    """The keys that lead to a part in a design: ("modules", "elbow", "components", "gear")."""
    *modules, name = part.path.split("/")
    return (*(step for module in modules for step in ("modules", module)), "components", name)


def _open_inputs(part: Component) -> list[str]:
    """The stresses that a part answers to and has no sensor of."""
    return [name for name, bound in inputs_of(part).items() if not bound]


def inputs_of(part: Component) -> dict[str, bool]:
    """The stresses that a part answers to, and whether it has a sensor of them."""
    names: dict[str, bool] = {}
    for stress in (stress for mode in part.modes for stress in mode.stresses):
        for own, drivers in stress.drivers.items():
            if drivers and (name := drivers[-1].name) in KINDS:
                names[name] = names.get(name, False) or own in stress.channels
    return names


def _entry_of(part: Component) -> str:
    return graded(part.modes[0].source).partition(",")[0]


def _kind_of(part: Component) -> str:
    entry = _entry_of(part)
    return library()[entry].kind if entry in library() else ""


def _own_words(part: Component) -> frozenset[str]:
    return frozenset(words_of(part.path)) - _VAGUE


class _Fits:
    """How well each signal fits each part that answers to its kind of stress."""

    def __init__(self, parts: Sequence[Component], signals: Sequence[SeenSignal]) -> None:
        self.signals = [one for one in signals if _is_alive(one)]
        own = {part.path: _own_words(part) for part in parts}
        every = frozenset().union(*own.values())
        self._scores: dict[str, dict[str, float]] = {one.name: {} for one in self.signals}
        for part in parts:
            kind = _OF_ENTRY.get(_entry_of(part)) or OF_KIND.get(_kind_of(part), frozenset())
            mine, asked = own[part.path], inputs_of(part)
            for one in self.signals:
                if one.kind in asked:
                    self._scores[one.name][part.path] = _score(one, mine, kind, every - mine - kind)

    def best(self, part: Component, name: str) -> list[SeenSignal]:
        """The signals that fit an input best: one, several that fit alike, or none.

        One that fits another part better is that part's.
        """
        found: dict[float, list[SeenSignal]] = defaultdict(list)
        for one in self.signals:
            scores = self._scores[one.name]
            if one.kind == name and (score := scores[part.path]) > 0 and score >= max(scores.values()):
                found[score].append(one)
        return found[max(found)] if found else []


def _score(one: SeenSignal, own: frozenset[str], kind: frozenset[str], foreign: frozenset[str]) -> float:
    words = one.words - _VAGUE
    if (called := words & _CALLED) and not called & (own | kind):
        return 0.0  # it is of another kind of part
    shared = own & words
    if (one.kind != "temperature" and not shared) or (not shared and any(word.isdigit() for word in words)):
        return 0.0  # a load is of one part alone, and so is what has a number
    unsaid = (own & _CALLED) - words  # a motor's temperature is its driver's less than its own
    return 2.0 * len(shared) + len((kind - own) & words) - 2.0 * len(foreign & words) - 0.5 * len(unsaid)


def _is_alive(one: SeenSignal) -> bool:
    """Whether it was heard, and says something: many drivers fill a field with zeros that they do not measure."""
    plausible = one.kind != "temperature" or (one.lowest > -60 and one.highest < 200)
    return one.samples > 0 and plausible and not one.lowest == one.highest == 0


def _binding(part: Component, name: str, signal: SeenSignal, efforts: Mapping[str, float]) -> Proposal | str:
    binding: dict[str, Any] = {"topic": signal.topic, "field": signal.field}
    assumed = ""
    if signal.unit:
        binding["unit"] = signal.unit
    if name == "load":
        limit = efforts.get(signal.element)
        if limit is None:
            return (
                f"{part.path}: load: {signal.name} has {signal.values}, but nothing says what counts as 1; "
                "expected the limit of the joint in a URDF, or a binding with rated"
            )
        share = STALL_SHARE if _kind_of(part) == "servos" else RATED_SHARE
        rated = share * limit
        binding |= {"rated": rated, "range": [-2 * limit, 2 * limit]}
        assumed = f"{rated:g} {signal.unit} counts as 1: {share:g} of the limit {limit:g}"
    elif name in _RANGES:
        binding["range"] = _RANGES[name]
    return Proposal((*place_of(part), "signals", name), binding, signal.values, assumed)


def _clocks(robot: Robot, parts: Sequence[Component], seen: Seen) -> Iterator[Proposal]:
    """Kilometres of a robot by its odometry, cycles of a part by the joint that it is named after."""
    used = {(mode.clock, mode.measured_clock is not None) for mode in robot.modes}
    if ("kilometres", False) in used and "kilometres" not in robot.clocks:
        odometry = sorted(seen.of_type("nav_msgs/Odometry"), key=lambda one: (len(one.words), one.name))
        if odometry:
            fields = ["pose.pose.position.x", "pose.pose.position.y"]
            rate = odometry[0].per_second
            heard = "odometry" + (f", {rate:.3g} a second" if rate else "")
            yield Proposal(("clocks", "kilometres"), {"topic": odometry[0].name, "position": fields}, heard)
    for part in parts:
        if any(mode.clock == "cycles" and mode.measured_clock is None for mode in part.modes):
            wanted = _own_words(part)
            for one in seen.signals:
                words = frozenset(words_of(one.element)) - _VAGUE
                if one.kind == "position" and words and words <= wanted and one.lowest < one.highest:
                    middle = round((one.lowest + one.highest) / 2, 6)
                    yield Proposal(
                        (*place_of(part), "clocks", "cycles"),
                        {"topic": one.topic, "edge": one.field, "threshold": middle}, one.values,
                        "a cycle is counted as the joint rises through the middle of what was seen",
                    )  # fmt: skip
                    break
