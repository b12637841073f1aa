"""The interface of all that tells others of a robot's health while it runs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Self

from robophm.health.alarms import Alarm
from robophm.health.mission import Completion
from robophm.health.outlooks import View
from robophm.health.report import HealthReport
from robophm.health.unknown_rates import PartsOfUnknownRate


@dataclass(frozen=True)
class JudgedTask:
    """A task that arrived, judged as the robot then was, or one that is done, judged by what it took."""

    done: bool
    time: int
    """Time when it arrived, or was done [ns since the epoch]."""
    topic: str
    """Topic that told of it."""
    duration: float
    """Duration of the task [h]."""
    distance: float
    """Distance of the task [m]."""
    completion: Mapping[View, Completion]
    unknown: PartsOfUnknownRate | None = None
    """The effect of parts of unknown rate on its completion."""
    goal: str = ""
    """Name by which the robot knows its goal; empty where it told none."""
    outcome: Literal["succeeded", "failed", "cancelled"] = "succeeded"
    """The way in which a done task ended; of what was driven of it until then the figures tell."""


class ReportSink(ABC):
    """Takes reports and tasks as they come; a context manager. None of its methods may wait for others."""

    @abstractmethod
    def publish(self, report: HealthReport) -> None:
        """Take a report of health now; its remaining lives and completions are of an earlier look, or none yet."""

    @abstractmethod
    def judged(self, task: JudgedTask) -> None:
        """Take a task and the probability that it is or was completed."""

    def noted(self, notes: Mapping[str, int]) -> None:  # noqa: B027  most sinks tell of health alone
        """Take what was lost, silent, refused or made anew: all counts so far, told when one has changed."""

    def repeat(self) -> None:  # noqa: B027  most sinks tell what they have once
        """Tell again what others expect to hear all the time; called at least twice a second, also in silence."""

    def alarmed(self, changed: Sequence[Alarm], going_on: Sequence[Alarm]) -> None:  # noqa: B027  most tell of health
        """Take alarms that have begun, ended or changed, and all that go on now."""

    @property
    def notes(self) -> Mapping[str, int]:
        """Return counts of what befell the sink itself."""
        return {}

    def close(self) -> None:  # noqa: B027  most sinks hold nothing open
        """Let go of connections; closing twice does no harm."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
