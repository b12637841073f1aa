"""Inputs of models that the channels of a design measure, and the parts that they belong to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from robophm.design.robot import Channel, Robot
from robophm.health.ledger import Step
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


def recent_signals(channels: Mapping[str, Channel], steps: Sequence[Step]) -> dict[str, float]:
    """Return the mean of every signal of stress over steps of the past, as its messages have it, while it was valid.

    ``channels`` by their keys; one that was never valid is left out.
    """
    found: dict[str, float] = {}
    for key, channel in channels.items():
        said = [step.inputs[key] for step in steps if key in step.inputs]
        time = sum(one for _, one in said)
        if time > 0:
            mean = sum(value for value, _ in said) / time
            found.setdefault(channel.signal, (mean - channel.offset) / channel.scale)
    return found
