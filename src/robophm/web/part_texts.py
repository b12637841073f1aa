"""The text of one place of a design, bounded: who may only look can ask for it, again and again."""

from __future__ import annotations

import threading
from typing import Any

from robophm.design.located_error import LocatedError
from robophm.web.documents import dump, load

MOST_OF_TEXT = 1_000_000
"""Characters of a design beyond which its places are not written by themselves: to read one with its remarks takes
seconds, and a hundred times its size."""


class PartTexts:
    """The places of the latest design that was asked about, which is read once; for any number of threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._read: tuple[str, Any] = "", None

    def of(self, text: str, path: tuple[str, ...]) -> str:
        """Return the value at a place of a design as YAML, with its remarks. Raises LocatedError."""
        if len(text) > MOST_OF_TEXT:
            raise LocatedError(
                path,
                f"a design of more than {MOST_OF_TEXT / 1e6:g} MB is not written by its places; expected all of it",
            )
        with self._lock:  # one at a time, also to be written
            if self._read[0] != text:
                self._read = text, load(text)
            here = self._read[1]
            for key in path:
                try:
                    here = here[int(key)] if isinstance(here, list) else here[key]
                except (KeyError, ValueError, IndexError, TypeError):
                    raise LocatedError(path, "there is nothing at this place") from None
            return dump(here).removesuffix("...\n")
