"""Whether what a robot's kept figures promised has come true: over the last month, and over all that is known."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from typing import Any

from robophm.blocks.single_points import single_points_of_failure
from robophm.calibration.promised_failures import LEVEL, CountedFailures, promised_failures
from robophm.core.signal import DAY
from robophm.health.ledger import Ledger
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.service import failures
from robophm.health.unknown_rates import unknown
from robophm.stores.figures import FigureSeries
from robophm.stores.store import History

MONTH = 30 * DAY

MOST_POINTS = 2000
"""Points of the figures over time that are looked at: of more reports, their means over spans of time."""


@dataclass(frozen=True)
class HonestSpan:
    """Failures that were promised and noted over a stretch of a robot's past."""

    since: int
    """Time of its first report [ns since the epoch]."""
    until: int
    """Time of its last one [ns since the epoch]."""
    counted: CountedFailures
    """Failures that the sensor-based figures promised, against those of parts without which the robot does not work."""
    designed: float | None
    """The mean number that the nominal figures promised; None where these do not tell."""

    @property
    def rejected(self) -> bool:
        """Whether the count speaks against what was promised."""
        return self.counted.chance < LEVEL

    def to_json(self) -> dict[str, Any]:
        """Return the span as plain values, its moments and its verdict in words too."""
        return {
            "since": self.since, "until": self.until,
            "from": datetime.fromtimestamp(self.since // 10**9, UTC).isoformat(),
            "to": datetime.fromtimestamp(self.until // 10**9, UTC).isoformat(),
            **asdict(self.counted), "designed": self.designed, "chance": self.counted.chance,
            "says": self.counted.says,
        }  # fmt: skip


@dataclass(frozen=True)
class HonestPast:
    """The verdicts of a robot's past on how honest its figures were."""

    spans: tuple[HonestSpan, ...]
    """The last 30 days, then all that is known; without those of which the figures do not tell."""
    of_others: int
    """Failures that were noted of parts without which the robot goes on; they are not counted."""


class Noted:
    """Failures and services of a robot that its ledger knows of, for comparison with what its figures promised."""

    def __init__(self, plant: Plant, ledger: Ledger) -> None:
        """Find those of parts without which the robot does not work, and of others."""
        units = single_points_of_failure(plant.robot.diagram)
        needed = units | {unit.partition("[")[0] for unit in units}
        parts = {mode.key: part.path for part in plant.robot.all_components() for mode in part.modes}
        failed = {(one.time, parts.get(one.mode, "")) for one in failures(ledger)}
        self.served = [one.time for one in ledger.services]
        """Times at which parts were served [ns]."""
        self.alone = [at for at, part in failed if part in needed]
        """Times at which parts failed without which the robot does not work [ns]."""
        self.of_others = len(failed) - len(self.alone)
        """Number of failures of parts without which it goes on."""

    def span(self, series: FigureSeries, last: int) -> HonestSpan | None:
        """Return what figures promised, against failures until before a time [ns]; None where they do not tell."""
        promised = promised_failures(series, self.served, "sensor_based")
        if promised is None:
            return None
        begin = int(series.times[0])
        counted = CountedFailures(promised, sum(begin <= at < last for at in self.alone))
        return HonestSpan(begin, last - 1, counted, promised_failures(series, self.served, "nominal"))


def tells_nothing(plant: Plant) -> bool:
    """Return whether parts of unknown rate are in a robot's figures, so that they promise no number of failures."""
    return unknown(as_designed(plant), plant.robot.diagram) is not None


def honest_past(plant: Plant, history: History, ledger: Ledger) -> HonestPast:
    """Count the failures that a robot's kept figures promised, against those that its ledger knows of.

    Nothing is told where parts of unknown rate are in the robot's figures.
    """
    newest = history.report_at(2**62)
    if newest is None or tells_nothing(plant):
        return HonestPast((), 0)
    last, noted = newest["time"] + 1, Noted(plant, ledger)
    spans = [noted.span(history.figures(start, last, MOST_POINTS), last) for start in (last - MONTH, None)]
    return HonestPast(tuple(filter(None, spans)), noted.of_others)
