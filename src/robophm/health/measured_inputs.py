"""Inputs of models that the channels of a design measure, and the parts that they belong to."""

from __future__ import annotations

from typing import NamedTuple

from robophm.design.robot import Robot
from robophm.health.stress_groups import channel_key


class MeasuredInput(NamedTuple):
    """A model input that a channel measures, and the part that it belongs to."""

    part: str
    """Path of the part."""
    model: str
    name: str
    unit: str
    rise: float | None
    """Kelvin by which it is warmer than its sensor, which tells how warm it is around the part; None for all else."""

    @property
    def own(self) -> bool:
        """Whether it is a temperature of the part itself, by a sensor at the part."""
        return self.unit == "degC" and self.rise is None

    @property
    def level(self) -> str:
        """Path of the module that the part lies in; empty for the robot."""
        return self.part.rpartition("/")[0]


def measured_inputs(robot: Robot) -> dict[str, list[MeasuredInput]]:
    """Return what each channel, by its key, measures."""
    found: dict[str, list[MeasuredInput]] = {}
    for component in robot.all_components():
        for mode in component.modes:
            for stress in mode.measured:
                for name, channel in stress.channels.items():
                    unit = stress.model.numbers[name].unit
                    one = MeasuredInput(component.path, stress.model.name, name, unit, channel.rise)
                    found.setdefault(channel_key(channel), []).append(one)
    return found
