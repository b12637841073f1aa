"""The upkeep of a store: whether all of it is what was written, a copy of it, and its space."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path


class Upkeep(ABC):
    """The upkeep of one store as a whole, whichever robots it knows."""

    @abstractmethod
    def faults(self) -> list[str]:
        """Return what is not what was written, each as a sentence without its point. Raises StoreError."""

    @abstractmethod
    def copy_to(self, path: Path) -> None:
        """Copy all of it, as it is at one moment, into a new file.

        Raises StoreError where that is there, or cannot be written.
        """

    @abstractmethod
    def compact(self) -> None:
        """Give back space that became free. Raises StoreError, also where somebody goes on with a past."""
