"""How a page that is served begins to watch a source."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from robophm.web.service import Service


def started(service: Service, source: str, speed: float) -> None:
    """Begin monitoring at once. Raises RobophmError."""
    from robophm.web.sources import chosen

    choice = chosen(dict(service.sources), source)
    service.monitoring.start(service.prepared().robot, choice, speed, service.workspace.draft().state)
