"""A failure that the robot's software tells of, as a design binds it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ToldFailure:
    """A signal that tells of a failure by its value or its silence, and perhaps that the part works again."""

    signal: str
    failed: tuple[float, ...]
    """Values that tell of a failure."""
    works: tuple[float, ...] = ()
    """Values that tell that the part works again; none: a person says so."""
    silent: int | None = None
    """Nanoseconds of silence that tell of a failure, while the robot is heard otherwise; None: no silence does."""
    said: str = ""
    """Words for people on who tells of it: ``error of /lidar on /rosout``."""
