"""A history of predictions and what happened: the file ``predictions.csv``.

::

    robot,model,kind,time,probability,failure,outcome
    r1,robophm,task,1709553600.0,0.987,0.013,1

A row of kind ``task`` has ``probability`` of completion, if known with its own digits ``failure``, and ``outcome``
(1 completed, 0 failed). One of kind ``life`` has the quantiles ``q0.025`` … ``q0.975`` of the remaining life [h],
``fraction`` = P(life ≤ observed) as predicted, ``observed`` [h] and ``censored`` (1: it still worked then). Columns
that the rows of a kind do not need may be missing or empty; other columns are not read.
"""

from __future__ import annotations

import csv
import io
from array import array
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import ModelError, SourceError, nearest
from robophm.core.files import stream_of
from robophm.transports.recordings.files import existing, reading
from robophm.transports.recordings.text import LONGEST_LINE

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

LEVELS = (0.025, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.975)
"""Probabilities of the quantiles that a prediction of remaining life states."""

OWN = "robophm"
"""Name of the tool's own model."""

MOST_ROWS = 1_000_000
"""Rows beyond which a file is refused."""

MOST_MODELS = 100
"""Models beyond which a file is refused: then the column names something else."""

LONGEST_CELL = 1000
"""Characters of a name or number beyond which a file is refused."""

_QUANTILES = tuple(f"q{level:g}" for level in LEVELS)
_NEEDED = {
    "task": ("probability", "outcome"),
    "life": (*_QUANTILES, "fraction", "observed", "censored"),
}
_ONLY = "the predictions"  # what a model is called in a file that names none
_CONTRADICTION = 1e-4  # between probability and failure: more than four printed digits explain
_SLACK = 0.02  # between fraction and quantiles: more than a prediction by samples explains


@dataclass(frozen=True)
class Tasks:
    """Predicted probabilities that tasks fail, shape (n,), their complements, and whether they did."""

    failure: Array
    completion: Array
    failed: Flags

    def __post_init__(self) -> None:
        """Raise ModelError where they are no such predictions."""
        shape = (self.failure.size,)
        _expect(self.failure.size > 0, "at least one task")
        _expect(self.failure.shape == self.completion.shape == self.failed.shape == shape, "shape (n,) of each")
        _expect(_within(self.failure, 0, 1) and _within(self.completion, 0, 1), "probabilities in 0 … 1")
        _expect(_within(self.failure + self.completion - 1, -_CONTRADICTION, _CONTRADICTION), "complements")


@dataclass(frozen=True)
class Lives:
    """Predicted remaining lives and what was seen of them; one row for each prediction."""

    robot: NDArray[np.intp]
    """Rows of one robot have the same number; shape (n,)."""
    time: Array
    """Time of each prediction [h]."""
    quantiles: Array
    """Quantiles at ``LEVELS``, ascending [h]; shape (n, 9)."""
    fraction: Array
    """Predicted P(life ≤ observed)."""
    observed: Array
    """Hours lived after ``time``."""
    censored: Flags
    """Whether the robot still worked then."""

    def __post_init__(self) -> None:
        """Raise ModelError where they are no such predictions."""
        n = self.time.size
        each = (self.robot, self.time, self.fraction, self.observed, self.censored)
        _expect(n > 0, "at least one life")
        _expect(all(one.shape == (n,) for one in each), "shape (n,) of each")
        _expect(self.quantiles.shape == (n, len(LEVELS)), f"quantiles of shape (n, {len(LEVELS)})")
        _expect(_within(self.fraction, 0, 1) and _within(self.observed, 0), "fractions in 0 … 1, observed ≥ 0")
        _expect(_within(self.quantiles, 0) and _within(np.diff(self.quantiles), 0), "quantiles ≥ 0 that ascend")
        _expect(_within(self.time, -np.inf), "finite times")


@dataclass(frozen=True)
class Predictions:
    """Predictions by the name of the model that made them."""

    tasks: dict[str, Tasks] = field(default_factory=dict)
    lives: dict[str, Lives] = field(default_factory=dict)


def _expect(holds: bool, what: str) -> None:
    if not holds:
        raise ModelError(f"predictions: expected {what}")


def _within(values: Array, low: float, high: float = np.inf) -> bool:
    return bool(np.all(np.isfinite(values) & (values >= low) & (values <= high)))


def lives_text(robots: Sequence[str], lives: Lives, model: str = OWN) -> str:
    """Return a file of predictions of remaining lives, as ``read_predictions`` reads it; ``robots``: names by
    number."""
    stream = io.StringIO()
    rows = csv.writer(stream, lineterminator="\n")
    rows.writerow(("robot", "model", "kind", "time", *_NEEDED["life"]))
    columns = (lives.robot, lives.time, lives.quantiles, lives.fraction, lives.observed, lives.censored)
    for robot, time, quantiles, fraction, observed, censored in zip(*columns, strict=True):
        said = (float(time) * 3600, *map(float, quantiles), float(fraction), float(observed), int(censored))
        rows.writerow((robots[int(robot)], model, "life", *said))
    return stream.getvalue()


def read_predictions(path: str | Path) -> Predictions:
    """Read the predictions in a CSV file. Raises SourceError, with line and column, for none or a wrong one."""
    path = existing(Path(path))
    rows = _rows(path)
    _, header = next(rows, (0, []))
    if not header:
        raise SourceError(f"{path}: is empty; expected a header with robot,kind,time and what was predicted")
    for number, name in enumerate(header, 1):
        if name and name in header[: number - 1]:
            raise SourceError(f"{path}, line 1, column {number}: '{name}' is there twice")
    for name in ("robot", "kind", "time"):
        if name not in header:
            raise SourceError(f"{path}, line 1: no column '{name}'{nearest(name, header)}")
    at = {name: number for number, name in enumerate(header)}
    robots: dict[str, int] = {}
    found: dict[tuple[str, str], array[float]] = {}
    for count, (line, cells) in enumerate(rows, 1):
        if count > MOST_ROWS:
            raise SourceError(f"{path}, line {line}: more than {MOST_ROWS:,} predictions")
        if len(cells) != len(header):
            raise SourceError(f"{path}, line {line}: {len(cells)} cells; expected {len(header)}")
        row = _Row(path, line, at, cells)
        kind = row.word("kind")
        if kind not in _NEEDED:
            raise SourceError(f"{path}, line {line}: kind '{kind}'{nearest(kind, _NEEDED)}")
        for name in _NEEDED[kind]:
            if name not in at:
                raise SourceError(f"{path}, line {line}: kind {kind}, but no column '{name}'{nearest(name, header)}")
        model = row.word("model") if "model" in at else _ONLY
        robot = robots.setdefault(row.word("robot"), len(robots))
        values = row.task() if kind == "task" else row.life()
        found.setdefault((kind, model), array("d")).extend((line, robot, row.number("time"), *values))
        if len(found) > len(_NEEDED) * MOST_MODELS:
            raise SourceError(f"{path}, line {line}: more than {MOST_MODELS} models in column 'model'")
    if not found:
        raise SourceError(f"{path}: holds no predictions")
    predictions = Predictions()
    for (kind, model), listed in found.items():
        table = np.frombuffer(listed).reshape(-1, 6 if kind == "task" else 6 + len(LEVELS))
        _once(path, kind, table)
        if kind == "task":
            predictions.tasks[model] = Tasks(table[:, 3], table[:, 4], table[:, 5] == 0)
        else:
            predictions.lives[model] = Lives(
                table[:, 1].astype(np.intp),
                table[:, 2] / 3600,
                table[:, 6:],
                table[:, 3],
                table[:, 4],
                table[:, 5] == 1,
            )
    return predictions


@dataclass(frozen=True)
class _Row:
    path: Path
    line: int
    at: dict[str, int]
    cells: list[str]

    def word(self, name: str) -> str:
        if not (word := self.cells[self.at[name]]):
            raise self.wrong(name, "is empty")
        if len(word) > LONGEST_CELL:
            raise self.wrong(name, f"is longer than {LONGEST_CELL} characters")
        if not word.isprintable():  # names are printed as they are
            raise self.wrong(name, f"{word!r:.60} has control characters")
        return word

    def number(self, name: str, low: float = -np.inf, high: float = np.inf) -> float:
        word = self.word(name)
        try:
            value = float(word)
        except ValueError:
            raise self.wrong(name, f"'{word}' is not a number") from None
        if not (np.isfinite(value) and low <= value <= high):
            within = "a finite number" if np.isinf(low) else f"{low:g} … {high:g}" if high < np.inf else f"≥ {low:g}"
            raise self.wrong(name, f"{word} is out of range; expected {within}")
        return value

    def either(self, name: str) -> float:
        value = self.number(name)
        if value not in (0, 1):
            raise self.wrong(name, f"{self.word(name)} is neither 0 nor 1")
        return value

    def task(self) -> tuple[float, ...]:
        """Return failure, completion and outcome of a task."""
        completion = self.number("probability", 0, 1)
        if "failure" not in self.at or not self.cells[self.at["failure"]]:
            return 1 - completion, completion, self.either("outcome")
        failure = self.number("failure", 0, 1)
        if abs(completion + failure - 1) > _CONTRADICTION:
            raise self.wrong("failure", f"{failure:g} and probability {completion:g} do not add up to 1")
        if failure <= 0.5:  # the smaller one has the digits
            return failure, 1 - failure, self.either("outcome")
        return 1 - completion, completion, self.either("outcome")

    def life(self) -> tuple[float, ...]:
        """Fraction, observed, censored, quantiles."""
        quantiles = [self.number(name, 0) for name in _QUANTILES]
        fraction, observed = self.number("fraction", 0, 1), self.number("observed", 0)
        for name, low, high in zip(_QUANTILES[1:], quantiles, quantiles[1:], strict=False):
            if high < low:
                raise self.wrong(name, f"{high:g} is below the quantile before it, {low:g}")
        for name, level, quantile in zip(_QUANTILES, LEVELS, quantiles, strict=True):
            below = observed < quantile and fraction > level + _SLACK
            if below or (observed > quantile and fraction < level - _SLACK):
                side = "below" if below else "above"
                raise self.wrong(
                    "fraction", f"{fraction:g} contradicts {observed:g} h observed, {side} {name} = {quantile:g}"
                )
        return fraction, observed, self.either("censored"), *quantiles

    def wrong(self, name: str, says: str) -> SourceError:
        return SourceError(f"{self.path}, line {self.line}, column {self.at[name] + 1} ({name}): {says}")


def _rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Number and cells of every line that is not empty."""

    def lines() -> Iterator[str]:
        with stream_of(path) as file:
            for number, line in enumerate(iter(lambda: file.readline(LONGEST_LINE + 1), b""), 1):
                if len(line) > LONGEST_LINE:
                    raise SourceError(f"{path}, line {number}: longer than {LONGEST_LINE} bytes")
                try:
                    yield line.decode("utf-8-sig" if number == 1 else "utf-8")
                except UnicodeDecodeError:
                    raise SourceError(f"{path}, line {number}: not UTF-8 text") from None

    rows = csv.reader(lines(), strict=True)
    with reading(path):
        try:
            for cells in rows:
                if cells:
                    yield rows.line_num, [cell.strip() for cell in cells]
        except csv.Error as error:
            raise SourceError(f"{path}, line {rows.line_num}: {error}") from None


def _once(path: Path, kind: str, table: Array) -> None:
    """Raise SourceError where a robot is predicted again at the same time: nothing counts twice."""
    order = np.lexsort((table[:, 0], table[:, 2], table[:, 1]))
    again = np.flatnonzero(np.all(table[order[1:], 1:3] == table[order[:-1], 1:3], axis=1))
    if again.size:
        first, second = (int(table[order[again[0] + i], 0]) for i in (0, 1))
        raise SourceError(f"{path}, line {second}: kind {kind}, robot and time are those of line {first}")
