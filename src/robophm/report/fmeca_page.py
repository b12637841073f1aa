"""A functional FMECA as a page and as a table for a spreadsheet."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence

from robophm.health.effects import Effect
from robophm.report.markup import Html
from robophm.report.page import page, section, table_html
from robophm.report.words import number_text, share_text

COLUMNS = (
    "function", "failure mode", "local effect", "end effect", "rate", "occurs", "α", "β", "detected by", "severity",
    "occurrence", "detection", "RPN", "criticality",
)  # fmt: skip


def effect_text(one: Effect) -> tuple[str, str]:
    """The local effect and the end effect in words."""
    local = f"{one.part} fails"
    if one.effect == "robot":
        others = [name for name in one.lost if name]
        return local, "the robot fails" + (f", and {', '.join(others)}" if others else "")
    if one.effect == "function":
        return local, f"loses {', '.join(one.lost)}"
    if one.effect == "redundancy":
        return local, "redundancy is lost"
    return local, "none alone"


def fmeca_rows(found: Sequence[Effect], coverage: Mapping[str, Mapping[str, float]]) -> list[tuple[str, ...]]:
    """The rows of the table as texts, in the order of COLUMNS."""
    rows: list[tuple[str, ...]] = []
    for one in found:
        sees = ", ".join(f"{name} {share_text(p)}" for name, p in coverage.get(one.mode, {}).items())
        rows.append((
            ", ".join(one.functions) or "the robot", one.mode, *effect_text(one),
            "unknown" if one.unknown else f"{number_text(one.rate)} /{one.unit}",
            number_text(one.probability), number_text(one.ratio), number_text(one.beta), sees or "nothing",
            str(one.severity), str(one.occurrence), str(one.detection), str(one.rpn), number_text(one.criticality),
        ))  # fmt: skip
    return rows


def fmeca_table(
    found: Sequence[Effect], coverage: Mapping[str, Mapping[str, float]]
) -> tuple[list[str], list[tuple[str, ...]]]:
    """Return headings and rows for people to read: texts first, then figures from the third column to the last but one.

    What the part itself does is in its name here; a spreadsheet has it in full.
    """
    order = [COLUMNS.index(name) for name in ("failure mode", "function", "end effect", *COLUMNS[9:], *COLUMNS[4:9])]
    short = {"severity": "S", "occurrence": "O", "detection": "D"}
    rows = [tuple(row[i] for i in order) for row in fmeca_rows(found, coverage)]
    return [short.get(COLUMNS[i], COLUMNS[i]) for i in order], rows


def unknown_words(found: Sequence[Effect]) -> Iterable[str]:
    """A note on failure modes of unknown rate; empty where there are none."""
    if count := sum(one.unknown for one in found):
        yield (
            f"{count:,} failure mode{'s' * (count != 1)} of unknown rate: how likely is not stated, occurrence "
            "counts as 10, the highest, until it is known, and every β is at least what is stated."
        )


def fmeca_csv(found: Sequence[Effect], coverage: Mapping[str, Mapping[str, float]]) -> str:
    """Comma-separated, with a heading; a cell that a spreadsheet would take for a formula begins with a blank."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in fmeca_rows(found, coverage):
        writer.writerow([f" {cell}" if cell[:1] in "=+-@" else cell for cell in row])
    return stream.getvalue()


def fmeca_page(name: str, found: Sequence[Effect], coverage: Mapping[str, Mapping[str, float]], hours: float) -> Html:
    """The whole page as HTML."""
    return page(f"FMECA of {name}", _sections(found, coverage, hours))


def _sections(
    found: Sequence[Effect], coverage: Mapping[str, Mapping[str, float]], hours: float
) -> Iterable[Html | str]:
    yield f"Failure modes, effects and criticality within {number_text(hours)} h of operation of a new robot."
    yield from unknown_words(found)
    caption = "The highest risk priority number first"
    yield section("Failure modes", table_html(*fmeca_table(found, coverage), caption, "lllrrrrrrrrrl"))
    sensors = list(dict.fromkeys(sensor for sees in coverage.values() for sensor in sees))
    if sensors:
        matrix = [(mode, *(sees.get(sensor) for sensor in sensors)) for mode, sees in coverage.items()]
        yield section("What sees what", table_html(("failure mode", *sensors), matrix, "P(alarm | failure)"))
    yield section(
        "How to read this",
        "Effects follow from the robot's diagrams: what fails when this part alone has failed. Severity 8: the robot "
        "fails, 6: a function, 3: redundancy is lost, 1: nothing, unless said otherwise. Occurrence from the "
        "probability within the hours, detection from how surely a sensor sees it (1 always, 10 never). RPN is their "
        "product. Criticality: β·α·λt, β the probability that the robot fails within the hours once this has happened.",
    )
