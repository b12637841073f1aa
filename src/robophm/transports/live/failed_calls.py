"""Calls of our services that could not be answered, the same over all transports."""

from __future__ import annotations

import logging

from robophm.transports.signals.incidents import Incidents

_log = logging.getLogger(__name__)


def note_failed_call(notes: Incidents, service: str, error: Exception) -> None:
    """Count a call of a service that failed, and say why in the log."""
    notes.add(f"call of {service} failed")
    _log.warning("call of %s: %s: %s", service, type(error).__name__, error)
