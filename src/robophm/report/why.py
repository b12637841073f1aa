"""Why a robot's health is as it is, in sentences: one that everybody reads, then what lies behind it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from robophm.health.report import HealthReport
from robophm.health.unknown_rates import marked, marks
from robophm.health.why import DecidingPart, Explanation, ObservedStress
from robophm.health.worn import moment
from robophm.report.words import duration_text, number_text, percent_text, share_text

NOTABLE = 0.1
"""How far from 1 a pace must be to be told in the first sentence."""

DECIDES = 0.5
"""The share of the failures to come from which on a part is said to decide."""


def sentence(report: HealthReport, found: Explanation) -> str:
    """How long it works on, and what decides that: "Works on for 13 days with 90 %. The casters decide it: …"."""
    if not found.works_for > 0:
        return "It has failed, by what is known."
    left_out = report.system.unknown
    if left_out and math.isinf(found.works_for):
        return f"How long it works on is unknown, as is the rate of all that can fail: {left_out.words}."
    ahead = marks(left_out)[2]
    works_for, if_exact = (
        marked(ahead, duration_text(time)) for time in (found.works_for, found.works_for_at_stated_rates)
    )
    unsure = f" ({if_exact} if its rates were exactly as stated)" if if_exact != works_for else ""
    said = f"Works on for {works_for} with {percent_text(found.chance)}{unsure}."
    if not found.parts:
        return f"{said} As far as is known nothing is left to fail."
    first = found.parts[0]
    leads = "decides it" if first.share >= DECIDES else "comes first"
    return f"{said} {first.path} {leads}{_of_share(first)}{_because(first)}."


def _of_share(part: DecidingPart) -> str:
    return f" ({share_text(part.share)} of the failures to come)"


def _because(part: DecidingPart) -> str:
    if part.silent:
        return ": its sensor is silent"
    if part.wear:
        return ": it is seen to wear"
    if math.isnan(part.pace) or abs(part.pace - 1) < NOTABLE:
        return ""
    seen = ", ".join(_value(one.observed, one) for one in part.stresses)
    return f": {seen + ', ' if seen else ''}{pace_text(part.pace)}"


def pace_text(pace: float) -> str:
    """How fast a part ages: "2.3 times as fast as designed"."""
    return f"{number_text(pace, 2)} times as fast as designed"


def _value(value: float, of: ObservedStress) -> str:
    return f"{number_text(value, 3)} {of.unit.replace('degC', '°C')}".rstrip()


def _since(stress: ObservedStress) -> str:
    if stress.since is None:
        return ""
    time, after = stress.since
    if time is None:
        return "; since when is not known"
    side = "above" if stress.observed > stress.designed else "below"
    if after is None:
        return f"; {side} that since {moment(time)} at least, the first time that is kept"
    return f"; {side} that since {moment(time)}, not yet at {moment(after)}"


def reasons(found: Explanation) -> Iterator[str]:
    """Say what lies behind it, a line each: the parts that decide, their stress, what would help."""
    for part in found.parts:
        yield f"{part.path}{f' ×{part.quantity}' if part.quantity > 1 else ''}{_of_share(part)}"
        for one in part.stresses:
            name = one.name.replace("_", " ")
            beside = f"designed for {_value(one.designed, one)} ({one.signal})"
            yield f"  {name} {_value(one.observed, one)}, {beside}{_since(one)}"
        yield from (f"  {one}" for one in part.wear)
        if part.silent:
            yield "  a sensor of it is silent: its figures rest on that"
        if part.relieved is not None:
            change = f"{duration_text(part.relieved)} instead of {duration_text(found.median)}"
            gains = part.relieved > found.median and duration_text(part.relieved) != duration_text(found.median)
            helps = f"; back at its design stress, median remaining life {change}" if gains else ""
            yield f"  it ages {pace_text(part.pace)}{helps}"
