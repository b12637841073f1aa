"""Numbers as people read them: probabilities, rates, durations."""

from __future__ import annotations

import math
from datetime import UTC, datetime, timedelta
from decimal import Decimal

from robophm.core.errors import UnitError, nearest
from robophm.core.signal import SECOND

MTBF = "MTBF"
"""The unit of rates by their reciprocal, the mean time between failures [h] while the rate is as it is."""

_RATE_UNITS = {"1/h": (1.0, "/h"), "FIT": (1e9, "FIT"), "FPMH": (1e6, "FPMH"), MTBF: (1.0, "/h")}
_SPANS = (
    ("s", 1 / 3600, 60),
    ("min", 1 / 60, 60),
    ("h", 1.0, 48),
    ("days", 24.0, 730),
    ("years", 8766.0, math.inf),
)


def number_text(value: float, digits: int = 4) -> str:
    """A number to ``digits`` significant digits: "0.5", "10,250", "5.8e-6", "∞", "–" for NaN."""
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    rounded = float(f"{value:.{digits - 1}e}")
    if rounded == 0:
        return "0"
    if 1e-3 <= abs(rounded) < 1e6:
        decimals = max(0, digits - 1 - math.floor(math.log10(abs(rounded))))
        text = f"{rounded:,.{decimals}f}"
        return text.rstrip("0").rstrip(".") if "." in text else text
    mantissa, exponent = f"{rounded:.{digits - 1}e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.')}e{int(exponent)}"


def count_text(count: int) -> str:
    """A whole number of any size: "12,345"; from 10¹⁵ on three digits of it, "1.23e45"."""
    if count < 10**15:
        return f"{count:,}"
    digits, power = f"{Decimal(count):.2e}".split("e+")
    return f"{digits.rstrip('0').rstrip('.')}e{power}"


def many_text(count: int, what: str) -> str:
    """A number of things: "1 part", "1,200 parts"."""
    return f"{count_text(count)} {what}{'s' * (count != 1)}"


def task_text(distance: float, hours: float) -> str:
    """A task by its distance [m] and duration [h]: "250 m in 10 min", or of a duration alone "1 h of work"."""
    lasts = duration_text(hours)
    return f"{number_text(distance)} m in {lasts}" if distance else f"{lasts} of work"


def more_text(count: int, what: str) -> str:
    """A note on what a list leaves out: "1 more is not listed", "3 more are not listed"."""
    return f"{count_text(count)} more {'is' if count == 1 else 'are'} not {what}"


def percent_text(p: float, failure: float | None = None, beside: float | None = None) -> str:
    """A probability in percent with as many nines as it has: "99.98 %", "> 99.9999999999 %".

    ``failure`` is the complement 1 − p; give it where it is known better than by subtraction. ``beside`` is the failure
    of another probability that stands beside it: up to two more decimals tell the two apart.
    """
    q = 1 - p if failure is None else failure
    if math.isnan(p) or math.isnan(q):
        return "–"
    if q <= 0 or q > 0.1:
        return f"{number_text(100 * p)} %"
    if q < 1e-12:
        return "> 99.9999999999 %"
    more = 0
    if beside is not None and 1e-12 <= beside <= 0.1:
        while more < 2 and _percent(q, more) == _percent(beside, more):
            more += 1
    return f"{_percent(q, more)} %"


def percent_texts(one: tuple[float, float], other: tuple[float, float]) -> tuple[str, str]:
    """Two probabilities side by side, each with its complement, as ``percent_text``: what differs reads so."""
    return percent_text(*one, beside=other[1]), percent_text(*other, beside=one[1])


def _percent(failure: float, more: int) -> str:
    """The complement in percent, with as many decimals as keep a failure that can happen from reading as 100 %."""
    percent = f"{100 - 100 * failure:.{max(2, math.ceil(-2 - math.log10(failure))) + more}f}"
    return percent.rstrip("0").rstrip(".")


def share_text(share: float, digits: int = 3) -> str:
    """A share in percent to so many digits, "0.123 %"; as ``percent_text`` where one below 1 would read as all."""
    short = "–" if math.isnan(share) else f"{number_text(100 * share, digits)} %"
    return percent_text(share) if short == "100 %" and share < 1 else short


def odds_text(failure: float) -> str:
    """The odds of failing: "fails 1 in 4,700"; "" where a percentage says more, above a tenth and at zero."""
    if not 0 < failure <= 0.1:
        return ""
    odds = float(f"{1 / failure:.1e}")
    return f"fails 1 in {f'{odds:,.0f}' if odds < 1e12 else number_text(odds)}"


def failure_text(failure: float) -> str:
    """Return how often something fails: "1 in 4,700"; in percent above a tenth and at zero."""
    return odds_text(failure).removeprefix("fails ") or percent_text(failure)


def probability_text(p: float, failure: float | None = None) -> str:
    """A probability in percent, and the odds of failing: "99.98 % (fails 1 in 4,700)"; as ``percent_text``."""
    odds = "" if math.isnan(p) else odds_text(1 - p if failure is None else failure)
    return percent_text(p, failure) + (f" ({odds})" if odds else "")


def rate_text(rate_per_hour: float, unit: str = "1/h") -> str:
    """A hazard rate in "1/h", "FIT" (per 10⁹ h) or "FPMH" (per 10⁶ h): "5.8e-6 /h", "5,800 FIT".

    By "MTBF" it is one in so many hours, "1 in 172,400 h". Raises ``UnitError`` for any other unit.
    """
    if unit == MTBF and rate_per_hour > 0:
        return f"1 in {number_text(1 / rate_per_hour)} h"
    if unit not in _RATE_UNITS:
        raise UnitError(f"unknown unit of rate '{unit}'{nearest(unit, _RATE_UNITS)}")
    factor, name = _RATE_UNITS[unit]
    text = number_text(rate_per_hour * factor)
    return text if text == "–" else f"{text} {name}"


def moment_text(time: int) -> str:
    """A time [ns since the epoch] to the millisecond: "2024-03-04 12:00:00.250 UTC"."""
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(microseconds=time // 1000)
    return f"{moment:%Y-%m-%d %H:%M:%S}.{moment.microsecond // 1000:03d} UTC"


def past_moment_text(time: int) -> str:
    """A time in a robot's past, as of ``moment_text``; of what was noted of a robot that had not been heard yet, so."""
    return moment_text(time) if time > SECOND else "before its first recording"


def duration_text(hours: float) -> str:
    """A time to three significant digits, in the unit that fits: "45 min", "11.6 days", "3.2 years", "∞"."""
    if not math.isfinite(hours):
        return number_text(hours)
    if hours == 0:
        return "0 h"
    # rounded first: 59.99 s is 1 min, not 60 s
    unit, length = next((u, n) for u, n, limit in _SPANS if float(f"{abs(hours) / n:.3g}") < limit)
    return f"{number_text(hours / length, 3)} {unit}"
