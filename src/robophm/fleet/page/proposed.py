"""Proposals of a fleet as HTML: all of them, and one with its evidence, its diff, and what was decided."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from robophm.fleet.page.views import STYLE, way_back
from robophm.fleet.proposals import Proposal
from robophm.report.markup import Html, element
from robophm.report.page import page, section, table_html
from robophm.report.words import moment_text, number_text


def proposals_page(found: Sequence[Proposal]) -> Html:
    """Return all proposals, the latest first, as a whole page."""
    rows = [
        (element("a", str(one.number), href=f"./proposal?number={one.number}"), one.design, one.cohort or "all robots",
         _time(one.time), one.state, one.decisions[-1].person if one.decisions else None)
        for one in found
    ]  # fmt: skip
    columns = ("", "design", "learned of", "made", "state", "by")
    return page(
        "Proposals", [STYLE, way_back(), table_html(columns, rows, "", "llllll") if rows else "None was made yet."]
    )


def proposal_page(one: Proposal) -> Html:
    """Return one proposal as a whole page."""
    return page(f"Proposal {one.number} for {one.design}", _sections(one))


def _sections(one: Proposal) -> Iterator[Html | str]:
    yield STYLE
    yield way_back("Proposals", "./proposals")
    robots = one.evidence["robots"]
    yield (
        f"Made {_time(one.time)}, learned of {len(robots)} robots{f' of {one.cohort}' if one.cohort else ''}. "
        f"It is {one.state}; robophm fleet accept or roll-back, run beside the design, changes that."
    )
    rows = [
        (rate["mode"], number_text(rate["failures"]), number_text(rate["expected"], 3),
         f"{number_text(rate['exposure'])} {rate['unit']}", number_text(rate["factor"], 3),
         f"{number_text(rate['low'], 3)} … {number_text(rate['high'], 3)}", number_text(rate["prior_failures"], 3),
         number_text(rate["surprise"], 2))
        for rate in one.evidence["rates"]
    ]  # fmt: skip
    columns = ("part", "failures", "expected", "exposure", "times the stated rate", "90 %", "stated rate counts as",
               "P(so far off by it)")  # fmt: skip
    yield section("Evidence", table_html(columns, rows, "Failures are counts; expected by the stated rate", "lrrrrrrr"))
    differ = [
        (each["mode"], f"{each['kind']} {each['cohort']}", number_text(each["failures"]),
         number_text(each["by_the_others"], 3), f"{number_text(each['low'], 3)} … {number_text(each['high'], 3)}",
         number_text(each["chance"], 2))
        for each in one.evidence["cohorts"]
    ]  # fmt: skip
    if differ:
        names = ("part", "cohort", "failures", "by the others", "times the others, 90 %", "chance")
        yield section("Cohorts that differ", "One rate for all is wrong for these.",
                      table_html(names, differ, "", "llrrrr"))  # fmt: skip
    promises = [
        (each["cohort"], str(each["robots"]), number_text(each["promised"], 3), str(each["noted"]),
         number_text(each["chance"], 2), "does not hold" if each["rejected"] else "nothing against it")
        for each in one.evidence["promises"]
    ]  # fmt: skip
    if promises:
        names = ("site", "robots", "failures promised", "noted", "chance", "what was promised")
        yield section("Promises of the last 30 days, by the design as it was",
                      table_html(names, promises, "", "lrrrrl"))  # fmt: skip
    yield section("Changes", element("pre", one.diff, tabindex="0"))
    if one.decisions:
        decided = [(_time(each.time), each.decided, each.person) for each in one.decisions]
        yield section("Decisions", table_html(("when", "decided", "by"), decided, "", "lll"))


def _time(time: int) -> str:
    return f"{moment_text(time)[:16]} UTC"
