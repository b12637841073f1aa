"""Analysis of failure modes and the field: FMEA, what alarms mean, learned rates, fitted lives; nothing is changed."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Query

from robophm.core.errors import DataError, DesignError, RobophmError
from robophm.drafting.received import file_name
from robophm.health.effects import effects
from robophm.interface.faults import diagnose
from robophm.interface.field import learn
from robophm.interface.lives import fit
from robophm.learning.diagnosis.coverage_matrix import coverage, detection_probabilities
from robophm.learning.life_data.distribution_fitting import as_good_as_best
from robophm.learning.life_data.observed_lives import read_life_data
from robophm.learning.rates.evidence import with_evidence
from robophm.report.fit_page import fit_rows
from robophm.report.fmeca_page import fmeca_table, unknown_words
from robophm.report.learned_rates import contradictions, learned_rows, unstated_text
from robophm.report.suspects import coverage_rows, nothing_failed, suspect_rows, unknown_suspects
from robophm.report.words import number_text
from robophm.web.access.roles import needs
from robophm.web.routes.analysis import Hours, few_enough
from robophm.web.routes.data import FileName, Upload
from robophm.web.routes.design import REFUSED
from robophm.web.service import Served
from robophm.web.shapes import Shape
from robophm.web.workspace import changed_lines

router = APIRouter(prefix="/api/analysis", tags=["analysis"])

MOST_ROWS = 2000
"""The most rows of a table in an answer."""

MOST_LIVES = 20_000
"""The most lives that are fitted while somebody waits."""


class FoundTable(Shape):
    """A table of texts."""

    title: str
    columns: list[str]
    figures: list[int]
    """Places of the columns of figures."""
    rows: list[list[str]]
    more: int
    """Number of rows that are left out."""


class FoundTables(Shape):
    """Tables, and what is to be said of them."""

    tables: list[FoundTable]
    notes: list[str]
    sensors: list[str] = []
    """Names of the sensors of an uploaded table, any of which may be on."""


class LearnedTables(FoundTables):
    """Learned rates, and the design with them."""

    text: str
    """The text of the design with them; "" where nothing would change."""
    known: bool
    """Whether the design has them already."""
    changes: list[str]
    """Lines of a unified diff from the text of the design now, the first of many."""
    revision: int
    """The revision of the design that it was made of."""


def table_of(title: str, columns: list[str], rows: list[list[str]], figures: Iterable[int]) -> FoundTable:
    """Return a table, of many rows the first."""
    return FoundTable(
        title=title, columns=columns, figures=[*figures], rows=rows[:MOST_ROWS], more=max(len(rows) - MOST_ROWS, 0)
    )


@contextmanager
def uploaded(name: str, body: bytes, *suffixes: str, expected: str = "a table in .csv or .yaml") -> Iterator[Path]:
    """A file that was uploaded, of its own name; the folder in which it is read is in no error."""
    with tempfile.TemporaryDirectory(prefix="robophm-") as folder:
        path = Path(folder) / file_name(name)
        if path.suffix.lower() not in (suffixes or (".csv", ".yaml", ".yml")):
            raise DataError(f"{name}: expected {expected}")
        path.write_bytes(body)
        try:
            yield path
        except RobophmError as error:
            raise DataError(str(error).replace(f"{folder}/", "")) from None


@router.get("/fmea", responses=REFUSED)
def get_fmea(service: Served, hours: Hours = 1000.0) -> FoundTables:
    """Failure modes, effects and criticality of the new robot within hours of operation, the most critical first."""
    prepared = service.prepared()
    few_enough(prepared, "fmeca")
    robot = prepared.robot
    found = effects(prepared.new, hours, detection_probabilities(robot, []))
    columns, rows = fmeca_table(found, coverage(robot, []))
    title = f"What failures do within {number_text(hours)} h of operation of a new robot"
    return FoundTables(
        tables=[table_of(title, columns, [list(row) for row in rows], range(3, len(columns) - 1))],
        notes=[*unknown_words(found)],
    )


@router.post("/diagnosis", responses=REFUSED)
@needs("viewer")
def get_diagnosis(
    body: Upload,
    service: Served,
    name: FileName,
    alarms: Annotated[list[str] | None, Query(max_length=200)] = None,
    quiet: bool = False,
    hours: Hours = 100.0,
) -> FoundTables:
    """Say what the sensors of a table see, and which faults ``alarms`` that are on mean, or none (``quiet``)."""
    robot = service.prepared().robot
    on = alarms or ([] if quiet else None)
    with uploaded(name, body) as path:
        done = diagnose(robot, path, on, hours=hours)
    columns, rows = coverage_rows(done.sensors, done.coverage)
    seen = table_of("What sees what: P(alarm | failure)", columns, rows, range(1, len(columns)))
    notes = [f"Nothing fitted sees {one}" for one in done.unseen[:10]]
    tables = [seen]
    if done.diagnosis and on is not None:
        title = f"Suspects, {', '.join(on) or 'no alarm'} being on and all others off"
        tables.insert(0, table_of(title, *suspect_rows(robot, done.diagnosis, hours), range(1, 4)))
        notes = [
            nothing_failed(robot, done.diagnosis, alarmed=bool(on)),
            *unknown_suspects(robot, done.diagnosis),
            *notes,
        ]
    return FoundTables(tables=tables, notes=notes, sensors=[one.name for one in done.sensors])


@router.post("/learned", responses=REFUSED)
@needs("viewer")
def get_learned(body: Upload, service: Served, name: FileName) -> LearnedTables:
    """Say what a log of failures in the field says of the design's rates, and the design with them."""
    draft = service.workspace.draft()
    robot = service.prepared_text(draft.text).robot
    with uploaded(name, body) as path:
        done = learn(robot, [path])
    columns, rows = learned_rows(done.rates, done.unknown)
    notes = [*contradictions(done.rates), *map(unstated_text, done.unknown), *done.notes]
    text, known = draft.text, False
    try:
        text = with_evidence(text, service.workspace.path.name, done.rates)
        known = bool(done.rates) and text == draft.text
    except DesignError as error:
        notes.append(f"They cannot be put into the design here: {error}")
    table = table_of("What the field says of its rates", columns, rows, range(1, len(columns)))
    return LearnedTables(
        tables=[table], notes=notes, text="" if text == draft.text else text, known=known,
        changes=[*changed_lines(draft.text, text)], revision=draft.revision,
    )  # fmt: skip


@router.post("/fits", responses=REFUSED)
@needs("viewer")
def get_fits(body: Upload, name: FileName) -> FoundTables:
    """Life distributions fitted to a table of lives, the best first."""
    with uploaded(name, body) as path:
        data = read_life_data(path)
        if data.parts > MOST_LIVES:
            raise DataError(
                f"{name}: {data.parts:,} lives; expected at most {MOST_LIVES:,}: `robophm fit` has the time"
            )
        found = fit(data)
    columns, rows = fit_rows(found)
    close = ", ".join(one.name for one in as_good_as_best(found))
    notes = [f"{close} cannot be told from it"] if close else []
    notes += [f"{one.name}: {note}" for one in found for note in one.notes]
    title = f"{data.described()}; in brackets 90 % intervals".replace(f"{path.parent}/", "")
    return FoundTables(tables=[table_of(title, columns, rows, range(2, len(columns)))], notes=notes)
