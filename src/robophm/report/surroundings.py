"""Sentences on the environments and qualities that the parts of a design are rated for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from robophm.core.spread import Spread
from robophm.design.robot import FailureMode, Robot, UnknownQuality
from robophm.hazard.environments import ENVIRONMENTS, explained
from robophm.report.words import number_text, rate_text


def environments(robot: Robot) -> Counter[str]:
    """How many parts are rated for which environment, by its symbol; parts whose rate asks for none are in none."""
    found: Counter[str] = Counter()
    for part in robot.all_components():
        stated = {stress.design.get("environment") for mode in part.modes for stress in mode.stresses}
        for symbol in ENVIRONMENTS:
            if symbol in stated:
                found[symbol] += part.quantity
    return found


def qualities(robot: Robot) -> Counter[str]:
    """How many parts are rated for which quality level of their models, without those whose level nobody knows."""
    found: Counter[str] = Counter()
    for part in robot.all_components():
        stated = {
            str(stress.design["quality"])
            for mode in part.modes
            for stress in mode.stresses
            if "quality" in stress.design and not (mode.uncertainty and mode.uncertainty.quality)
        }
        found.update(dict.fromkeys(stated, part.quantity))
    return found


def qualities_in_words(robot: Robot) -> Iterator[str]:
    """Lines on each level of unknown quality, then one of all levels that are stated; none where no part has one."""
    yield from unknown_qualities_in_words(robot)
    if found := qualities(robot):
        said = ", ".join(f"{level} ({parts})" for level, parts in found.most_common())
        yield f"quality levels of parts: {said}; for a whole board quality: … says it once (robophm models quality)"


def unknown_qualities_in_words(robot: Robot) -> Iterator[str]:
    """One line for each level whose quality nobody has said: how many parts, and what their rates add up to."""
    found: dict[str, list[tuple[int, FailureMode, UnknownQuality]]] = {}
    for part in robot.all_components():
        for mode in part.modes:
            if mode.uncertainty and (quality := mode.uncertainty.quality):
                found.setdefault(quality.level, []).append((part.quantity, mode, quality))
    for level, modes in found.items():
        low = high = 0.0
        for parts, mode, quality in modes:
            spread = Spread(1 / quality.error_factor, quality.error_factor)
            low += parts * mode.rate * spread.low / spread.mean
            high += parts * mode.rate * spread.high / spread.mean
        parts = sum(one[0] for one in modes)
        yield (
            f"nobody has said the quality of {level or robot.name}: the λ of the {parts} parts that it matters to is "
            f"{rates_by_quality(low, high)}"
        )


def rates_by_quality(low: float, high: float) -> str:
    """The range that an unknown quality leaves for a rate [1/h], and what narrows it."""
    return (
        f"{number_text(low)} (known pedigree, 5 %) … {rate_text(high)} (commercial, 95 %); quality: says which "
        "(robophm models quality)"
    )


def environments_in_words(robot: Robot) -> Iterator[str]:
    """One line for each environment: "environment GM (Ground, Mobile: …), of 12 parts"."""
    found = environments(robot)
    for symbol in ENVIRONMENTS:
        parts = found[symbol]
        if parts:
            yield f"environment {explained(symbol)}, of {parts} part{'s' * (parts != 1)}"
