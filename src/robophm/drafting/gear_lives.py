"""The lives of a joint's gear and motor at the work that the joint does, as ranges where that is not known.

Catalogues state a gear's life at rated speed and torque all the time. It goes with 1 / mean speed and with
1 / torque³ (Harmonic Drive, engineering data HFUC and CSD-2A, equation 20.2; ball bearings under changing load by
ISO 281). The mean speed is taken from the recording and the joint's limit, the torque from the bound effort; that one
is large while the other is small is not seen. What neither tells is a range, whose ends are taken as 5 and 95 % of a
lognormal distribution.

Of a servo motor makers state the life at its highest speed. Bearings last so many revolutions (ISO 281), and their
grease so many hours, by its temperature above all; which of the two ends first is not stated. So a joint whose mean
speed is recorded has a motor that fails between as often as stated, and as many times less as it turns slower.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from robophm.core.spread import Spread
from robophm.core.units import quantity
from robophm.design.draft import DraftPart
from robophm.drafting.bindings import RATED_SHARE, RATED_SHARES
from robophm.drafting.seen import Seen
from robophm.parts import Entry
from robophm.parts import part as entry_of

LIMIT_OVER_RATED = (1.0, 4.25)
"""The limit of a joint's speed as a multiple of the rated speed of its gear.

It is at most what the gear bears: strain wave gears are rated at 2000 rpm and bear 4000 to 8500 rpm by their size (HD
Systems, series SHD, in Machine Design: Flat and compact harmonic drive gearheads). That it is not below the rated speed
is an assumption, on the safe side.
"""

MEAN_SPEED = (0.1, 1.0)
"""Mean speed of a joint as a share of its gear's rated speed where nothing tells it: an estimate.

A gear is chosen so that the mean of its duty is not above what it is rated for. Movements from point to point have a
mean of half their peak, and pauses take the rest: a tenth is left where a joint moves a fifth of the time.
"""

MEAN_TORQUE = (0.5, 1.0)
"""Cubic mean of the torque as a share of the rated one where nothing tells it: an estimate, for the same reason.

Half of it is left where the gear was chosen with a safety factor of two.
"""

OF_HIGHEST_SPEED = ("servo_motor",)
"""Motors whose statement is of their highest speed."""

STANDS_STILL = 0.01
"""The share of its limit below which the mean speed of a joint says that it hardly worked while it was recorded."""


def at_work(parts: Sequence[DraftPart], seen: Seen) -> list[DraftPart]:
    """The parts of a draft, with their bindings, in which gears have the life of their joint's mean speed and torque.

    ``seen``: the recordings, whose joint states tell the mean speeds.
    """
    found = []
    for one in parts:
        entry = entry_of(one.entry)
        if _has_gear_life(entry):
            found.append(_gear_at_work(one, entry, seen))
        elif entry.name in OF_HIGHEST_SPEED and (share := recorded_share(one, seen)):
            said = f"its bearings turn at {share:.1%} of the joint's limit, as recorded: fewer turns, or old grease"
            found.append(_with_life(one, entry, [Spread(share, 1.0)], [said], "B", {}))
        else:
            found.append(one)
    return found


def _has_gear_life(entry: Entry) -> bool:
    """Whether it is a gear with a life in hours at rated speed."""
    return entry.kind == "gears" and "l10" in entry.part and "clock" not in entry.part


def _gear_at_work(one: DraftPart, entry: Entry, seen: Seen) -> DraftPart:
    speed, recorded, of_speed = _speed(one, seen)
    spreads, said = [speed], [of_speed]
    keys: dict[str, Any] = {}
    if entry.part.get("acceleration") == {"model": "cubic_load"}:
        if "load" in one.keys.get("signals", {}):
            least, most = RATED_SHARES
            spreads.append(Spread((RATED_SHARE / most) ** 3, (RATED_SHARE / least) ** 3))
            said.append(f"its rated torque {least:.0%} to {most:.0%} of the limit")
        else:
            torque = Spread(MEAN_TORQUE[0] ** 3, MEAN_TORQUE[1] ** 3)
            spreads.append(torque)
            # A load that somebody binds later is compared with the one that is assumed now.
            keys["acceleration"] = {"model": "cubic_load", "reference_load": round(torque.mean ** (1 / 3), 4)}
            said.append(f"its cubic mean torque {MEAN_TORQUE[0]:.0%} to {MEAN_TORQUE[1]:.0%} of the rated one")
    return _with_life(one, entry, spreads, said, "B" if recorded else "C", keys)


def _with_life(
    one: DraftPart, entry: Entry, spreads: Sequence[Spread], said: Sequence[str], grade: str, keys: Mapping[str, Any]
) -> DraftPart:
    """A part with the life of its entry under further factors of its rate, and with why; its own keys win."""
    factor = math.prod(spread.mean for spread in spreads)
    own = _error_factor(entry.part)
    error = math.exp(math.hypot(math.log(own), *(math.log(spread.error_factor) for spread in spreads)))
    life = {
        "l10": f"{round(quantity(entry.part['l10'], 'h') / factor)} h",
        "uncertainty": {"error_factor": round(error, 2)},
        "source": entry.graded_origin(max(entry.grade, grade)),
    }
    assumed = "; ".join([*([one.assumed] if one.assumed else []), *said])
    return replace(one, keys={**life, **keys, **one.keys}, assumed=assumed)


def _error_factor(part: Mapping[str, Any]) -> float:
    return float(part.get("uncertainty", {}).get("error_factor", 1.0))


def _speed(one: DraftPart, seen: Seen) -> tuple[Spread, bool, str]:
    """Mean speed as a multiple of the rated one, whether that is of a recording, and how it was found, in words."""
    mean = mean_speed(one.joint, seen)
    least, most = MEAN_SPEED
    usual = f"its mean speed {least:.0%} to {most:.0%} of the rated one"
    if one.velocity is None or math.isnan(mean):
        return Spread(least, most), False, usual
    share = recorded_share(one, seen)
    if share is None:
        why = "the joint hardly moved" if mean < one.velocity else "the joint moved faster than its limit"
        return Spread(least, most), False, f"{usual}: as recorded {why}"
    least, most = LIMIT_OVER_RATED
    said = (
        f"its mean speed as recorded, {share:.1%} of the joint's limit, which is {least:g} to {most:g} times the rated"
    )
    return Spread(least * share, most * share), True, said


def recorded_share(one: DraftPart, seen: Seen) -> float | None:
    """The mean speed of a part's joint as a share of its limit; None where no recording tells it."""
    share = mean_speed(one.joint, seen) / one.velocity if one.velocity else math.nan
    return share if STANDS_STILL <= share <= 1 else None


def mean_speed(joint: str, seen: Seen) -> float:
    """The mean speed of a joint, whatever its direction [rad/s or m/s], as recorded; NaN where nothing tells it.

    It is that of the velocity, or, where a driver fills that with zeros or nothing, of the changes of the position.
    """
    speeds = {one.kind: one.speed for one in seen.signals if one.element == joint and one.speed > 0}
    return speeds.get("velocity", speeds.get("position", math.nan))
