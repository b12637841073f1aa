"""The fleet's page as HTML: the list of robots with its groups, and one robot with its past."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple
from urllib.parse import urlencode

import numpy as np

from robophm.core.signal import HOUR
from robophm.fleet.commit import BELIEVED
from robophm.fleet.page.listing import ORDERS, Asked, Group, Line, Totals
from robophm.fleet.payload import Ahead
from robophm.fleet.questions import RobotStatus
from robophm.fleet.robot_history import RobotHistory
from robophm.fleet.trend import MEDIAN, QUANTILES, FleetDay
from robophm.report.curve import Line as Curve
from robophm.report.curve import curve_svg
from robophm.report.history_page import series_text
from robophm.report.markup import Html, element
from robophm.report.page import figure, page, section, side_by_side, table_html
from robophm.report.past_curves import past_curves
from robophm.report.words import count_text, duration_text, failure_text, moment_text, percent_text
from robophm.stores.outbox import COLUMNS, HORIZONS

SILENT = 1.0
"""Hours after which a robot that was not heard is called silent."""

BY = "design", "site"
"""Names of what robots are grouped by."""

AT_ONCE = 100
"""Robots on one page of the list."""

HORIZON_WORDS = {24.0: "1 day", 168.0: "1 week", 720.0: "30 days"}
STYLE = Html(
    "<style>form,nav{display:flex;flex-wrap:wrap;gap:8px 14px;align-items:end;margin:1rem 0}"
    "label{display:grid;gap:2px;font-size:.85rem;color:var(--quiet)}a{color:var(--c0)}"
    "input,select,button{font:inherit;color:inherit;background:var(--card);border:1px solid var(--line);"
    "border-radius:5px;padding:5px 8px;min-height:34px}main{max-width:1560px}tbody th{white-space:nowrap}"
    ".off{color:var(--error);font-weight:600}pre{overflow-x:auto}</style>"
)
"""The style of the fleet's pages beyond that of reports."""


def way_back(name: str = "Fleet", to: str = "./") -> Html:
    """Return the link to the page that this one was come to from."""
    return element("nav", element("a", name, href=to), aria_label="Way back")


class Fleet(NamedTuple):
    """The robots that the list shows, and all that it says beside them."""

    asked: Asked
    start: int
    """Place of the first line in all that are asked for."""
    lines: Sequence[Line]
    of: int
    """Number of robots that are asked for."""
    totals: Totals
    refused: Mapping[str, int]
    """Numbers of what was refused without being known whose it was, by reason."""
    now: int


def fleet_page(shown: Fleet) -> Html:
    """The list, as a whole page."""
    return page("Fleet", _fleet_sections(shown))


def _fleet_sections(shown: Fleet) -> Iterator[Html | str]:
    asked, horizon = shown.asked, HORIZON_WORDS[shown.asked.horizon]
    yield STYLE
    yield from _known(shown, horizon)
    yield element("nav", *(element("a", f"By {by}", href=f"./groups?by={by}&horizon={asked.horizon:g}") for by in BY),
                  element("a", "Day by day", href=f"./days?horizon={asked.horizon:g}"),
                  element("a", "Proposals", href="./proposals"), aria_label="Groups")  # fmt: skip
    yield _form(asked)
    last = shown.start + len(shown.lines)
    where = [f"{name} {value or 'unknown'}" for name, value in (("design", asked.design), ("site", asked.site))
             if value is not None]  # fmt: skip
    title = f"{count_text(shown.of)} robots{''.join(f', {one}' for one in where)}: {ORDERS[asked.order]}"
    yield section(
        title,
        _table(shown.lines, horizon, shown.now) if shown.lines else "There is none.",
        *([_steps(shown, last)] if shown.of > AT_ONCE else []),
    )


def _known(shown: Fleet, horizon: str) -> Iterator[str | Html]:
    """What is known of the fleet, and what is not."""
    robots, known, silent = shown.totals
    yield (
        f"{moment_text(shown.now)[:16]} UTC. {count_text(robots)} robots; of {count_text(known)} the probability of "
        f"failing within {horizon} is known, by the newest report of each."
    )
    if robots > known:
        yield _p("Of ", _link(f"{count_text(robots - known)} it is not known", Asked(shown.asked.horizon, "unknown")),
                 ": they are in no sum and no order.")  # fmt: skip
    if silent:
        yield _p(
            element("span", f"{count_text(silent)} are silent", class_="off"),
            f": not heard for {duration_text(SILENT)} or more, or never. All that is said of them is as of then.",
        )
    if shown.refused:
        yield f"Refused, without being known whose it was: {_refusals(shown.refused)}."


def _refusals(refused: Mapping[str, int]) -> str:
    return "; ".join(f"{why} ({count_text(number)} times)" for why, number in refused.items())


def _p(*parts: str) -> Html:
    return element("p", *parts)


def _said(asked: Asked, start: int) -> dict[str, str | int | None]:
    return {**asked._asdict(), "horizon": f"{asked.horizon:g}", "start": start}


def _query(asked: Asked, start: int = 0) -> str:
    """The address of a list, with what is not as usual."""
    usual = _said(Asked(), 0)
    found = urlencode({name: value for name, value in _said(asked, start).items() if value != usual[name]})
    return f"./?{found}" if found else "./"


def _link(words: str, asked: Asked, start: int = 0) -> Html:
    return element("a", words, href=_query(asked, start))


def _form(asked: Asked) -> Html:
    def choice(name: str, label: str, values: Mapping[str, str], chosen: str) -> Html:
        options = [element("option", words, value=value, selected="selected" if value == chosen else None)
                   for value, words in values.items()]  # fmt: skip
        return element("label", label, element("select", *options, name_=name))

    kept = [
        element("input", type="hidden", name_=name, value=value)
        for name, value in (("design", asked.design), ("site", asked.site))
        if value is not None
    ]
    search = element("input", type="search", name_="search", value=asked.search)
    return element(
        "form",
        *kept,
        element("label", "Robot’s name has", search),
        choice("horizon", "Fails within", {f"{one:g}": HORIZON_WORDS[one] for one in HORIZONS}, f"{asked.horizon:g}"),
        choice("order", "Order", ORDERS, asked.order),
        element("button", "Show"),
        element("a", "All robots", href="./"),
        method="get",
        action="./",
        role="search",
    )  # fmt: skip


def _steps(shown: Fleet, last: int) -> Html:
    steps = [f"{count_text(shown.start + 1)} to {count_text(last)} of {count_text(shown.of)}"]
    ends = (shown.of - 1) // AT_ONCE * AT_ONCE
    for words, start, there in (
        ("First", 0, shown.start > 0), ("Before", max(shown.start - AT_ONCE, 0), shown.start > 0),
        ("Next", shown.start + AT_ONCE, last < shown.of), ("Last", ends, last < shown.of),
    ):  # fmt: skip
        if there:
            steps.append(_link(words, shown.asked, start))
    return element("nav", *(element("span", one) for one in steps), aria_label="Pages of the list")


def _table(lines: Sequence[Line], horizon: str, now: int) -> Html:
    rows = [
        (
            element("a", one.robot, href=f"./robot?{urlencode({'name': one.robot})}"),
            chance_text(one.chance, one.bound),
            "not known" if one.before is None or one.before_time is None else
            f"{failure_text(one.before)} ({moment_text(one.before_time)[:10]})",
            one.first if one.first is None or one.share is None else f"{one.first} ({percent_text(one.share)})",
            duration_text(one.remaining_life),
            one.state,
            one.design,
            one.site,
            _heard(one.heard, now),
            _report_time(one.time, one.clock_ahead),
        )
        for one in lines
    ]  # fmt: skip
    columns = ("robot", f"fails within {horizon}", "a week before", "mostly by", "RUL, median", "state", "design",
               "site", "heard", "newest report")  # fmt: skip
    return table_html(columns, rows, "", "l" * len(columns))


def chance_text(chance: float | None, bound: str | None) -> str:
    """Return a probability of failing, with its relation to the true one."""
    if chance is None:
        return "not known"
    said = failure_text(chance)
    return f"{bound} {said}" if bound == "at least" else ", ".join(filter(None, (said, bound)))


def _heard(heard: int | None, now: int) -> Html:
    if heard is None:
        return element("span", "never", class_="off")
    hours = max(now - heard, 0) / HOUR
    said = f"{duration_text(hours)} ago"
    return element("span", f"silent: {said}" if hours >= SILENT else said, class_="off" if hours >= SILENT else "")


def _report_time(time: int | None, ahead: float | None) -> str:
    if time is None:
        return "none"
    said = f"{moment_text(time)[:16]} UTC"
    return said if ahead is None or abs(ahead) <= BELIEVED else f"{said}; its clock is not believed"


def groups_page(by: str, groups: Sequence[Group], horizon: float, now: int) -> Html:
    """All robots in groups, as a whole page."""
    back = way_back()
    table = _groups(by, groups, Asked(horizon), HORIZON_WORDS[horizon])
    return page(f"Fleet by {by}", [STYLE, back, f"{moment_text(now)[:16]} UTC.", table])


def _groups(by: str, groups: Sequence[Group], asked: Asked, horizon: str) -> Html:
    rows = [
        (
            _link(one.name or "unknown", _of_group(asked, by, one.name or "")),
            count_text(one.robots),
            count_text(one.robots - one.known),
            f"{one.expected:.3g}" if one.known else "not known",
            "not known" if one.worst is None else failure_text(one.worst),
            count_text(one.silent),
        )
        for one in groups
    ]
    caption = (
        f"Expected failures are the sum of the probabilities of failing within {horizon} that are known, each as its "
        "robot states it: where rates of parts are unknown that is a bound, as the robot's own line says."
    )
    columns = (by, "robots", "not known", f"expected to fail within {horizon}", "worst", "silent")
    return table_html(columns, rows, caption, "lrrrrr")


def _of_group(asked: Asked, by: str, name: str) -> Asked:
    return asked._replace(design=name) if by == "design" else asked._replace(site=name)


def days_page(days: Sequence[FleetDay], horizon: float, now: int) -> Html:
    """The last days of all robots together, as a whole page; newest day first."""
    return page("Fleet day by day", [STYLE, way_back(), f"{moment_text(now)[:16]} UTC.", *_days(days, horizon)])


def _days(days: Sequence[FleetDay], horizon: float) -> Iterator[Html | str]:
    if not days:
        yield "No robot has told of the last thirty days."
        return
    words = HORIZON_WORDS[horizon]
    since = [(one.begin - days[0].begin) / (24 * HOUR) for one in days]
    label = f"days since {moment_text(days[0].begin)[:10]}"
    if len(days) > 1:
        of = np.array([one.quantiles for one in days]).T
        drawn = [Curve(f"{percent_text(share)} of robots", since, each, share != MEDIAN)
                 for share, each in zip(QUANTILES, of, strict=True)]  # fmt: skip
        expected = [Curve("expected to fail", since, [one.expected for one in days])]
        yield side_by_side(
            figure(curve_svg(drawn, title=f"P of failing within {words}", x_label=label, y_label="P"),
                   "Probabilities that so many of the robots do not exceed"),
            figure(curve_svg(expected, title=f"Expected to fail within {words}", x_label=label, y_label="robots"),
                   "The sum of the probabilities of those that told"),
        )  # fmt: skip
    rows = [
        (moment_text(one.begin)[:10], count_text(one.robots), f"{one.expected:.3g}",
         *map(failure_text, (*one.quantiles, one.worst)))
        for one in reversed(days)
    ]  # fmt: skip
    caption = (
        f"By each robot's first report of the day, in UTC: P of failing within {words}. A robot that told nothing that "
        "day is in no figure of it. Where rates of parts are unknown a probability is a bound, as the robot's own line "
        "says."
    )
    columns = ("day", "robots", "expected to fail", *map(percent_text, QUANTILES), "worst")
    yield table_html(columns, rows, caption, "lrrrrrr")


class Epoch(NamedTuple):
    """A stretch of watching of a robot."""

    number: int
    name: str
    reports: int
    thinned: int
    missing: int


class Robot(NamedTuple):
    """One robot, and all that is shown of it."""

    status: RobotStatus
    site: str | None
    ahead: Sequence[Ahead]
    """Probabilities of failing by its newest whole report."""
    ahead_time: int | None
    epochs: Sequence[Epoch]
    """The newest stretches, newest first."""
    history: RobotHistory
    now: int


def robot_page(shown: Robot) -> Html:
    """One robot, as a whole page."""
    return page(shown.status.robot, _robot_sections(shown))


def _robot_sections(shown: Robot) -> Iterator[Html | str]:
    one = shown.status
    yield STYLE
    yield way_back()
    facts = [
        ("design", one.design or "not told"), ("site", shown.site or "not told"), ("state", one.state or "not known"),
        ("heard", _heard(one.heard, shown.now)), ("newest report", _report_time(one.time, one.clock_ahead)),
        ("reports", count_text(one.reports)), ("let go of by the robot, as too many waited", count_text(one.thinned)),
        ("missing", count_text(one.missing)),
        ("waited at the robot then", "–" if one.waiting is None else count_text(one.waiting)),
        ("refused", _refusals(one.refused) or "nothing"),
    ]  # fmt: skip
    yield table_html(("what", "is"), facts, "", "ll")
    if shown.ahead:
        rows = [
            (
                HORIZON_WORDS.get(each.horizon, duration_text(each.horizon)), failure_text(each.sensor_based_failure),
                each.first, None if each.share is None else percent_text(each.share),
            )
            for each in shown.ahead
        ]  # fmt: skip
        at = moment_text(shown.ahead_time)[:16] if shown.ahead_time else "a time that is not told"
        told = f"By its newest whole report, of {at} UTC"
        yield section("Failures to come", table_html(("within", "fails", "mostly by", "share"), rows, told, "llll"))
    else:
        yield section("Failures to come", "Not known: it has sent no whole report.")
    yield section("Past", series_text(shown.history.series), *_left_out(shown.history), side_by_side(*_curves(shown)))
    stretches = [
        (count_text(one.number), one.name, *map(count_text, (one.reports, one.thinned, one.missing)))
        for one in shown.epochs
    ]
    yield section("Stretches of watching", table_html(("number", "name", "reports", "let go of", "missing"), stretches,
                                                      "Newest first, twenty at most", "rlrrr"))  # fmt: skip


def _left_out(history: RobotHistory) -> list[str]:
    return (
        [f"{count_text(history.ahead)} reports of a time ahead of the fleet's clock are left out."]
        if history.ahead
        else []
    )


def _curves(shown: Robot) -> Iterator[Html]:
    series = shown.history.series
    if len(series.times) < 2:
        return
    hours, off = (series.times - series.times[0]) / HOUR, series.broken
    curves = []
    for horizon in HORIZONS:
        values = series.mean[:, COLUMNS.index(f"failure_within.{horizon:g}")]
        if not np.isnan(values).all():
            x, y = np.insert(hours, off, hours[off - 1]), np.insert(values, off, np.nan)
            curves.append(Curve(HORIZON_WORDS[horizon], x, y))
    if curves:
        since = moment_text(int(series.times[0]))[:16]
        drawn = curve_svg(
            curves, title="Probability of failing within", x_label=f"hours since {since} UTC", y_label="P"
        )
        yield figure(drawn, f"P of {shown.status.robot}, as it reported it")
    yield from past_curves(shown.status.robot, series)


def silent_since(now: int) -> int:
    """Return the time [ns since the epoch] since which a robot must have been heard not to be silent."""
    return now - round(SILENT * HOUR)
