"""The page on measured data: figures, curves, time at level; and the levels at which parts of a robot lived."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from importlib.metadata import version
from itertools import takewhile

import numpy as np

from robophm.core.signal import HOUR, SECOND
from robophm.measured.levels import Levels, marginal, shares
from robophm.measured.profile import Profile, StressProfiles
from robophm.measured.series import Series
from robophm.measured.statistics import Look, Seen
from robophm.report.bars import bars_svg
from robophm.report.curve import Line, curve_svg
from robophm.report.markup import Html
from robophm.report.page import figure, page, section, side_by_side, table_html
from robophm.report.words import duration_text, moment_text, number_text, percent_text

MOST_NAMED = 8
"""Parts that are named one by one."""


def statistics_page(seen: Sequence[Seen], max_age: int, notes: Sequence[str]) -> Html:
    """The whole page as HTML: each signal of each recording, whose values held ``max_age`` [ns] at most."""
    return page("Measured data", _statistics(seen, max_age, notes))


def profile_page(lived: StressProfiles, source: str, notes: Sequence[str]) -> Html:
    """The whole page as HTML: the levels at which the parts of a robot lived; ``source`` names the recordings."""
    return page(f"Stress profile of {lived.robot.name}", _profile(lived, source, notes))


def level_rows(levels: Levels, signal: int, unit: str) -> dict[str, float]:
    """Shares of the levels of one signal by their names, "20 – 22 degC"."""
    begins, sums = marginal(levels, signal)
    width = float(levels.widths[signal])
    names = [f"{number_text(low, 6)} – {number_text(low + width, 6)} {unit}".rstrip() for low in begins.tolist()]
    return dict(zip(names, shares(sums).tolist(), strict=True))


def where(profile: Profile) -> str:
    """The part of a profile, or the module that all its parts are in, else the first of them."""
    if len(profile.parts) == 1:
        return profile.parts[0]
    levels = zip(*(path.split("/")[:-1] for path in profile.parts), strict=False)
    module = "/".join(names[0] for names in takewhile(lambda names: len(set(names)) == 1, levels))
    count = len(profile.parts)
    return f"{module}, {count} parts" if module else f"{profile.parts[0]} and {count - 1} more"


def parts_text(profile: Profile) -> str:
    """The parts of a profile, the first by name."""
    more = len(profile.parts) - MOST_NAMED
    return ", ".join(profile.parts[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def aged_text(profile: Profile) -> str:
    """Return in words how far the clock of a profile went, and how fast its parts aged on it."""
    gone = f"{number_text(profile.gone)} {profile.unit} on the {profile.clock} clock"
    return f"{gone}, mean stress factor {number_text(profile.factor)}"


def _statistics(seen: Sequence[Seen], max_age: int, notes: Sequence[str]) -> Iterator[Html | str]:
    yield f"A value holds until the next sample, and for {max_age / SECOND:g} s at most."
    several = len({one.recording for one in seen}) > 1
    columns = (*(["recording"] if several else []), "signal", "from", "known", "samples", "lowest", "mean", "highest",
               "deviation")  # fmt: skip
    rows = []
    for one in seen:
        window = one.whole
        known = duration_text(window.held / HOUR)
        figures = (window.lowest, window.mean, window.highest, window.deviation)
        named = (*([one.recording] if several else []), one.signal.label)
        rows.append((*named, moment_text(window.begin), known, f"{window.samples:,}", *figures))
    yield section("In figures", table_html(columns, rows, align="l" * (len(columns) - 6) + "r" * 6))
    for one in seen:
        unit = one.signal.unit or ""
        title = f"{one.signal.name} in {one.recording}" if several else one.signal.name
        at = side_by_side(_course(one.look.series, unit), _at_level(one.look, unit))
        yield section(title, at)
    yield from _notes(notes)


def _course(series: Series, unit: str) -> Html:
    """Lowest and highest value of every stretch, in the order of time; nothing where nothing is known."""
    begins, lowest, highest = series.columns
    if not len(begins):
        return figure(curve_svg([Line("", [], [])], title="Course", x_label="h", y_label=unit or "value"))
    hours = (np.maximum(begins, series.begin) - series.begin) / HOUR
    x, y = np.repeat(hours, 2), np.column_stack((lowest, highest)).ravel()
    silent = np.flatnonzero(np.diff(begins) > series.width) + 1
    between = (hours[silent - 1] + hours[silent]) / 2
    x, y = np.insert(x, 2 * silent, between), np.insert(y, 2 * silent, np.nan)
    drawn = curve_svg(
        [Line("", x, y)], title="Course", x_label=f"h after {moment_text(series.begin)}", y_label=unit or "value",
        width=520,
    )  # fmt: skip
    return figure(drawn, "The lowest and the highest value at every point; gaps are where nothing is known.")


def _at_level(look: Look, unit: str) -> Html:
    rows = level_rows(look.levels, 0, unit)
    return figure(bars_svg({name: [share] for name, share in rows.items()}, ["time"], title="Time at level"))


def _profile(lived: StressProfiles, source: str, notes: Sequence[str]) -> Iterator[Html | str]:
    on, whole = duration_text(lived.operating), duration_text(lived.calendar)
    yield f"{lived.robot.name} in {source}: on for {on} of {whole}."
    for profile in lived.profiles:
        yield section(where(profile), *_levels(profile))
    yield from _notes(notes)


def _levels(profile: Profile) -> Iterator[Html | str]:
    if len(profile.parts) > 1:
        yield parts_text(profile)
    yield f"{aged_text(profile)}."
    drawings = []
    for i, one in enumerate(profile.inputs):
        bars = level_rows(profile.levels, i, one.unit)
        drawing = bars_svg({name: [share] for name, share in bars.items()}, ["share"], title=one.name)
        drawings.append(figure(drawing, f"From {one.signal}; designed for {number_text(one.designed)} {one.unit}."))
    yield side_by_side(*drawings)
    columns = (*(f"{one.name} [{one.unit or 1}]" for one in profile.inputs), profile.unit, "share", "stress factor")
    rows = [
        (*typical, gone, percent_text(share), factor)
        for typical, gone, share, factor in zip(
            profile.typical.tolist(),
            profile.levels.sums[:, 0].tolist(),
            profile.share.tolist(),
            profile.factors.tolist(),
            strict=True,
        )
    ]
    yield table_html(columns, rows, "The values that stand for each level in a load to come", "r" * len(columns))


def _notes(notes: Iterable[str]) -> Iterator[Html]:
    taken = (*notes, f"robophm {version('robophm')}.")
    yield section("How it was taken", *(taken if notes else ("Every sample was taken.", *taken)))
