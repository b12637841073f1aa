"""Measured stress of failure modes, in groups that share clock and stresses, and the signals that drive them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from robophm.design.robot import Channel, Stress
from robophm.health.clock import Clock
from robophm.health.sample_stretch import Flags, Observed
from robophm.health.window import Array


@dataclass
class StressGroups:
    """Groups, and the channels and measured clocks that drive them."""

    groups: tuple[StressGroup, ...]
    channels: Mapping[str, Channel]
    clocks: tuple[Clock, ...]

    @cached_property
    def _alike(self) -> tuple[list[int], ...]:
        alike: dict[tuple[object, ...], list[int]] = {}
        for i, group in enumerate(self.groups):
            if group.stresses:
                alike.setdefault(group.law, []).append(i)
        return tuple(alike.values())

    def factors(
        self, observed: Sequence[Mapping[str, Observed]], on: Sequence[Flags]
    ) -> list[tuple[Array | None, Flags, list[Array]]]:
        """Return for each group: ψ in each interval (None where nothing is measured), where its range is left, its
        inputs.

        ``on``: whether the robot was on then. Groups whose stresses differ in nothing but their sensors are asked about
        together.
        """
        found: list[tuple[Array | None, Flags, list[Array]]] = [(None, np.zeros((), dtype=bool), [])] * len(self.groups)
        for alike in self._alike:
            lines = [(i, self.groups[i].lines(observed[i], on[i])) for i in alike]
            asked = [(i, own) for i, own in lines if len(own[0].values)]  # no model is asked about no time at all
            if not asked:
                continue
            together = [InputValues.joined(column) for column in zip(*(own for _, own in asked), strict=True)]
            factor, outside, values = self.groups[alike[0]].worst(together)
            begin = 0
            for i, own in asked:
                part = slice(begin, begin := begin + len(own[0].values))
                found[i] = factor[part], outside[part], [one[part] for one in values]
        return found

    def apart(self) -> Iterator[StressGroups]:
        """Return bundles of groups that have no signal in common."""
        of_groups, of_clocks = [group.signals for group in self.groups], [clock.signals for clock in self.clocks]
        place = _joined([*of_groups, *of_clocks])
        some: dict[int, tuple[list[StressGroup], dict[str, Channel], list[Clock]]] = {}

        def at(own: Iterable[str]) -> tuple[list[StressGroup], dict[str, Channel], list[Clock]]:
            return some.setdefault(next((place[signal] for signal in own), -1), ([], {}, []))

        for group, own in zip(self.groups, of_groups, strict=True):
            at(own)[0].append(group)
        for key, channel in self.channels.items():
            at([channel.signal])[1][key] = channel
        for clock, own in zip(self.clocks, of_clocks, strict=True):
            at(own)[2].append(clock)
        for groups, channels, clocks in some.values():
            yield StressGroups(tuple(groups), channels, tuple(clocks))


def _joined(sets: Iterable[set[str]]) -> dict[str, int]:
    """A number for each member of the sets, equal where sets that share something join them."""
    found: dict[str, set[str]] = {}
    for one in sets:
        together = one.union(*(found[each] for each in one if each in found))
        found.update(dict.fromkeys(together, together))
    return {each: id(together) for each, together in found.items()}


class InputValues(NamedTuple):
    """The value of one input in each interval."""

    values: Array
    other: Array | None = None
    """The value that may be assumed instead where that ages a part faster, else the value itself; None: nothing is
    assumed."""

    @classmethod
    def joined(cls, lines: Sequence[InputValues]) -> InputValues:
        """Join lines one behind the other."""
        if len(lines) == 1:
            return lines[0]
        other = None
        if any(line.other is not None for line in lines):
            other = np.concatenate([line.values if line.other is None else line.other for line in lines])
        return cls(np.concatenate([line.values for line in lines]), other)


@dataclass(frozen=True)
class Input:
    """One measured input of one stress, with its nominal value and the value that ages a part fastest."""

    name: str
    key: str
    stale: str
    nominal: float
    worst: float

    @classmethod
    def of(cls, stress: Stress, name: str, channel: Channel) -> Input:
        """Make the input of a stress that a channel measures."""
        worst = nominal = float(stress.design[name])
        if channel.stale == "worst":
            candidates = np.linspace(channel.low, channel.high, 257)
            worst = float(candidates[np.argmax(stress.factor({name: candidates}).value)])
        return cls(name, channel_key(channel), channel.stale, nominal, worst)

    def line(self, observed: Observed, on: Flags) -> InputValues:
        """Return the input's value in each interval, also where none is known."""
        values, fresh = observed
        if fresh is None:
            return InputValues(values)
        heard = ~np.isnan(values)
        if self.stale == "conservative":  # of a robot that is off, nobody expects a word: that is no dead sensor
            silent = ~fresh & heard & on
            held = np.where(fresh | silent, values, self.nominal)
            return InputValues(held, np.where(silent, self.nominal, held) if silent.any() else None)
        kept = heard if self.stale == "hold" else fresh
        return InputValues(np.where(kept, values, self.worst if self.stale == "worst" else self.nominal))


@dataclass
class StressGroup:
    """Failure modes that share clock and stresses: their factor is evaluated once."""

    clock: Clock
    stresses: tuple[tuple[Stress, tuple[Input, ...]], ...]
    members: list[int]

    @classmethod
    def of(cls, clock: Clock, stresses: Iterable[Stress]) -> StressGroup:
        """Make a group that has no failure modes yet."""
        inputs = (
            (stress, tuple(Input.of(stress, name, channel) for name, channel in stress.channels.items()))
            for stress in stresses
        )
        return cls(clock, tuple(inputs), [])

    @property
    def signals(self) -> set[str]:
        """Return the names of the signals that drive the group."""
        channels = {channel.signal for stress, _ in self.stresses for channel in stress.channels.values()}
        return channels | self.clock.signals

    @cached_property
    def channel_keys(self) -> tuple[str, ...]:
        """Return the keys of the channels of all its inputs."""
        return tuple(one.key for one in self.inputs)

    @cached_property
    def inputs(self) -> tuple[Input, ...]:
        """Return all measured inputs of the group."""
        return tuple(one for _, inputs in self.stresses for one in inputs)

    @cached_property
    def law(self) -> tuple[object, ...]:
        """A key that two groups share if they have the same factor for the same inputs."""
        return tuple((stress.law, *(one.name for one in inputs)) for stress, inputs in self.stresses)

    def lines(self, observed: Mapping[str, Observed], on: Flags) -> list[InputValues]:
        """Return every measured input in each interval."""
        return [one.line(observed[one.key], on) for one in self.inputs]

    def factor(self, values: Sequence[Array]) -> tuple[Array, Flags]:
        """Return ψ for measured inputs, and where a model's range is left."""
        some = iter(values)
        (product, outside), *others = [
            stress.factor({one.name: next(some) for one in inputs}) for stress, inputs in self.stresses
        ]
        for value, beyond in others:
            product, outside = product * value, outside | beyond
        return product, outside

    def worst(self, lines: Sequence[InputValues]) -> tuple[Array, Flags, list[Array]]:
        """Return ψ as of ``factor``, each assumed input as it ages fastest; and the inputs as they were taken.

        One after the other, from the last values on: the greatest factor that there is wherever an input makes it grow,
        or fall, whatever the others are; and never less than that of the last values.
        """
        values = [line.values for line in lines]
        factor, outside = self.factor(values)
        for place, (_, other) in enumerate(lines):
            rows = np.flatnonzero(other != values[place]) if other is not None else ()
            if other is None or not len(rows):
                continue
            tried = [one[rows] for one in values]
            tried[place] = other[rows]
            assumed, beyond = self.factor(tried)
            worse = assumed > factor[rows]
            rows = rows[worse]
            factor, outside, values[place] = factor.copy(), np.array(outside), values[place].copy()
            factor[rows], outside[rows], values[place][rows] = assumed[worse], beyond[worse], other[rows]
        return factor, outside, values

    def named(self, values: Sequence[Array]) -> dict[str, Array]:
        """Return every measured input by its name."""
        return dict(zip((one.name for one in self.inputs), values, strict=True))


def channel_key(channel: Channel) -> str:
    """Return the key of a channel's last value: a signal, its scale and offset, and the range that is valid."""
    return f"{channel.signal} {channel.scale!r} {channel.offset!r} {channel.low!r} {channel.high!r}"
