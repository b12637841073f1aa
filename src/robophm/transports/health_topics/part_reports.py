"""The services by which a robot tells what became of its parts: phm_msgs/ReportFailure and ReportService."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from robophm.core.errors import RobophmError
from robophm.design.robot import Robot
from robophm.health.ledger import Service
from robophm.health.service import ServiceNote
from robophm.transports.health_topics.definitions import PACKAGE
from robophm.transports.health_topics.outlet import Outlet
from robophm.transports.health_topics.report_fields import Fields, stamp
from robophm.transports.health_topics.sink import HAZARD_RATE_NODE
from robophm.transports.signals.incidents import UnknownTypeError

NoteTaker = Callable[[ServiceNote, str | None], Sequence[Service]]
"""Notes what is said, once for each key, and returns what it did to each failure mode. Raises RobophmError."""


class PartReports:
    """Takes ``phm/report_failure`` and ``phm/report_service`` below a namespace, from the node of hazard rates."""

    def __init__(self, outlet: Outlet, robot: Robot, note: NoteTaker, namespace: str = "/") -> None:
        """Begin to serve both. Raises SourceError where that cannot be."""
        self._note = note
        self._paths = {mode.key: mode.path for mode in robot.modes}
        self.unknown = ""
        """The reason why they are not served, where this ROS does not know their types; else empty."""
        root = namespace.rstrip("/")
        try:
            for name, type_, answer in (
                ("report_failure", "ReportFailure", self.failed),
                ("report_service", "ReportService", self.served),
            ):
                outlet.serve(f"{root}/{HAZARD_RATE_NODE}", f"{root}/phm/{name}", f"{PACKAGE}/srv/{type_}", answer)
        except UnknownTypeError as error:
            self.unknown = str(error)

    def failed(self, request: Any) -> Fields:
        """Return the fields of the response to a report that a part has failed."""
        said = {"failed": True, "waits": True}
        return self._answered(request, said)[0]

    def served(self, request: Any) -> Fields:
        """Return the fields of the response to a report that a part was replaced or repaired."""
        said = {"remaining": request.remaining if request.repaired else None, "failed": bool(request.failed)}
        fields, done = self._answered(request, said)
        ages = {"ages_before": [one.before[1] for one in done], "ages_after": [one.after[1] for one in done]}
        return {**fields, **ages}

    def _answered(self, request: Any, said: dict[str, Any]) -> tuple[Fields, Sequence[Service]]:
        """What both responses have, and what was done; what cannot be noted is refused in words."""
        try:
            note = ServiceNote(request.part, by=request.by, note=request.note, **said)
            done = self._note(note, request.key or None)
        except RobophmError as error:
            return {"noted": False, "refused": str(error)}, ()
        time = done[0].time if done else None
        modes = [self._paths.get(one.mode, one.mode) for one in done]
        return {"header": {"stamp": stamp(time)}, "noted": True, "modes": modes}, done
