"""The limits of a design held against values: which are broken, and which nobody can tell as a sensor is silent."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.design.thresholds import Level, Limits, Thresholds

Severity = Literal["error", "warn"]
SEVERITIES: tuple[Severity, ...] = ("error", "warn")


@dataclass(frozen=True)
class LimitedValue:
    """A value that the design limits, as it is now."""

    path: str
    """Path of a module or a part, or the name of a signal; empty for the robot."""
    figure: str
    """Name of the figure: hazard_rate, reliability, remaining_life, completion or signal."""
    severity: Severity
    level: Level
    above: bool
    """Whether the value must not be above the limit; else it must not be below it."""
    value: float | None
    """The value; None where it is not known."""
    unit: str
    silence: str = ""
    """The note that the value rests on silent sensors; empty where it does not."""

    @property
    def key(self) -> str:
        """Return the name that no other limit of the design has."""
        side = ("above" if self.above else "below") if self.figure == "signal" else self.figure
        return f"{self.path or 'robot'} {side} ({self.severity})"

    @property
    def series(self) -> str:
        """The name under which the page draws the course of the value."""
        return self.path if self.figure == "signal" else f"{self.figure}.sensor_based:{self.path}"

    @property
    def broken(self) -> bool:
        """Whether the value is beyond its limit; one that is not known is not."""
        return self.value is not None and not self._good(self.value, self.level.limit)

    @property
    def clear(self) -> bool:
        """Whether the value is where an alarm on it ends."""
        return self.value is not None and self._good(self.value, self.level.clear)

    def _good(self, value: float, bound: float) -> bool:
        return value <= bound if self.above else value >= bound

    @property
    def beyond(self) -> str:
        """Say where the value must not be: "above 40 °C"."""
        limit = f"{self.level.limit:.4g}" if self.figure == "hazard_rate" else f"{self.level.limit:g}"
        return f"{'above' if self.above else 'below'} {limit}{self._unit}"

    @property
    def rule(self) -> str:
        """Say what begins an alarm: "hazard rate above 2e-05 /h for 10 s"."""
        lasting = f" for {self.level.delay / SECOND:g} s" if self.level.delay else ""
        return f"{_NAMES.get(self.figure, '')} {self.beyond}{lasting}".lstrip()

    @property
    def words(self) -> str:
        """Say how the value stands to its limit: "hazard rate 2e-05 /h is above 1e-05 /h"."""
        name = _NAMES.get(self.figure, "")
        if self.value is None:
            return f"{name or 'its value'} is not known, nor whether it is {self.beyond}"
        value = f"{self.value:.6g}" if self.figure in ("reliability", "completion") else f"{self.value:.4g}"
        return f"{name} {value}{self._unit} is {'' if self.broken else 'not '}{self.beyond}".lstrip()

    @property
    def _unit(self) -> str:
        return f" {self.unit.replace('degC', '°C')}" if self.unit else ""

    @property
    def said(self) -> str:
        """Say it with its path before it, unless it is of the robot."""
        return f"{self.path}: {self.words}" if self.path else self.words


_NAMES = {
    "hazard_rate": "hazard rate", "reliability": "reliability", "remaining_life": "median remaining life",
    "completion": "probability of task completion",
}  # fmt: skip
_UNITS = {"hazard_rate": "/h", "remaining_life": "h"}


def limited_values(
    path: str, thresholds: Thresholds, values: Mapping[str, float | None], silence: str = ""
) -> Iterator[LimitedValue]:
    """Yield the figures that thresholds limit, errors first; a figure that is not among ``values`` is not known."""
    for severity, limits in _by_severity(thresholds):
        for figure in _NAMES:
            if (level := getattr(limits, figure)) is not None:
                above, unit = figure == "hazard_rate", _UNITS.get(figure, "")
                yield LimitedValue(path, figure, severity, level, above, values.get(figure), unit, silence)


def limited_signals(robot: Robot, heard: Mapping[str, float]) -> Iterator[LimitedValue]:
    """Yield the signals that a design limits, errors first; ``heard``: the last values that still hold."""
    units = robot.signals
    for severity, limits in _by_severity(robot.thresholds):
        for signal, both in limits.signals.items():
            for above, level in ((True, both.above), (False, both.below)):
                if level is not None:
                    unit = units.get(signal) or ""
                    yield LimitedValue(signal, "signal", severity, level, above, heard.get(signal), unit)


def _by_severity(thresholds: Thresholds) -> tuple[tuple[Severity, Limits], ...]:
    return ("error", thresholds), ("warn", thresholds.warning)


def limits_of(robot: Robot) -> list[LimitedValue]:
    """Return all limits that a design states, without the values that they limit."""
    levels = [("", robot.thresholds), *((one.path, one.thresholds) for one in robot.all_modules())]
    levels += [(one.path, one.thresholds) for one in robot.limited_parts.values()]
    figures = (one for path, thresholds in levels for one in limited_values(path, thresholds, {}))
    return [*figures, *limited_signals(robot, {})]
