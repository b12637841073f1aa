"""The first look at a drafted robot in words: its figures as ranges, and whom to ask for what."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from robophm.drafting.first_look import FirstLook, PartFigures
from robophm.health.rate_sensitivity import LargestUnknown
from robophm.health.uncertainty import Interval
from robophm.parts import library
from robophm.report.words import duration_text, number_text, percent_text, rate_text, task_text

_ASKED = {"mtbf": "MTBF", "mttf": "mean life", "l10": "L10", "b10": "B10", "rate": "failure rate"}


def figure_rows(look: FirstLook) -> list[tuple[str, str, str, str]]:
    """Rows of the figures of a robot: name, 5 % quantile, median and 95 % quantile, as texts."""
    life, median, fails = look.ranges.remaining_life, look.ranges.median_life, look.ranges.failure

    def row(what: str, interval: Interval, text: Callable[[float], str]) -> tuple[str, str, str, str]:
        return what, text(interval.low), text(interval.median), text(interval.high)

    done = Interval(fails.high, fails.median, fails.low)
    return [
        row("hazard rate λ, over the next hour", look.ranges.hazard_rate, rate_text),
        row("remaining life: the median", median, duration_text),
        row("remaining life: of one robot", life, duration_text),
        row(f"PoTC: {task_text(look.task.distance, look.task.duration)}", done, lambda one: percent_text(1 - one, one)),
    ]


def advice(look: FirstLook) -> Iterator[str]:
    """Yield sentences that say whom to ask for which figure; the one that would narrow the ranges most comes first."""
    if look.left_out:
        yield f"{look.left_out.words}: nobody knows how often they fail; any figure of their makers helps"
    for one in look.unknowns:
        names = [part.path for part in one.parts]
        some = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
        asked = f"ask {_whom(one)} ({some})" if one.quality_of is None else _quality_asked(one, one.quality_of)
        yield f"{asked}: it would narrow the ranges to {100 * one.left:.0f} % of what they are"


def _quality_asked(one: LargestUnknown, level: str) -> str:
    board = level or "the robot"
    return f"find out how the {len(one.parts)} kinds of parts of {board} were bought and state its quality"


def _whom(one: LargestUnknown) -> str:
    if one.model and len(one.parts) > 1:
        return f"the makers for failure rates of what {one.model} rates"
    entry = library().get(one.entry.partition(",")[0])
    if entry is None:
        return "the maker for a failure rate"
    modes = [entry.part, *entry.part.get("failure_modes", {}).values()]
    asked = next((_ASKED[key] for mode in modes for key in _ASKED if key in mode), "failure rate")
    what = one.parts[0].path.rpartition("/")[2] if len(one.parts) == 1 else entry.words[0]
    return f"the maker of the {what} for its {asked}"


def part_rows(figures: list[PartFigures]) -> Iterator[tuple[str, str, str, str, str, str]]:
    """Part, entry, rate with its range, source and grade, stress, and the signal that it listens to."""
    for one in figures:
        name = one.path + (f" ×{one.quantity}" if one.quantity > 1 else "")
        low, _, high = one.rate
        exact = not low < high
        rate = "unknown" if one.stated == 0 else rate_text(one.stated, "FPMH")
        rate += "" if exact else f" ({number_text(low * 1e6, 2)} … {number_text(high * 1e6, 2)})"
        source = one.entry or one.source.partition(";")[0] or "stated"
        topics = dict.fromkeys(signal.partition(".")[0] for signal in one.signals)
        yield name, source, rate, one.grade or "–", ", ".join(one.stresses) or "–", "\n".join(topics) or "–"
