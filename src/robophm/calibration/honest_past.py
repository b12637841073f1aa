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
from robophm.stores.store import History

MONTH = 30 * DAY

_MOST_POINTS = 2000


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


def honest_past(plant: Plant, history: History, ledger: Ledger) -> HonestPast:
    """Count the failures that a robot's kept figures promised, against those that its ledger knows of.

    Nothing is told where parts of unknown rate are in the robot's figures.
    """
    robot = plant.robot
    newest = history.report_at(2**62)
    if newest is None or unknown(as_designed(plant), robot.diagram):
        return HonestPast((), 0)
    last = newest["time"] + 1
    units = single_points_of_failure(robot.diagram)
    needed = units | {unit.partition("[")[0] for unit in units}
    parts = {mode.key: part.path for part in robot.all_components() for mode in part.modes}
    served = [one.time for one in ledger.services]
    failed = {(one.time, parts.get(one.mode, "")) for one in failures(ledger)}
    alone = [at for at, part in failed if part in needed]
    spans = []
    for start in (last - MONTH, None):
        series = history.figures(start, last, _MOST_POINTS)
        if (promised := promised_failures(series, served, "sensor_based")) is not None:
            begin = int(series.times[0])
            counted = CountedFailures(promised, sum(begin <= at < last for at in alone))
            spans.append(HonestSpan(begin, last - 1, counted, promised_failures(series, served, "nominal")))
    return HonestPast(tuple(spans), len(failed) - len(alone))
