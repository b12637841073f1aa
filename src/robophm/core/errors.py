"""Every error that robophm raises on purpose. One root, so that one ``except`` is enough.

RobophmError
├── DesignError        the robot's design file: unreadable, unknown key, wrong value, contradiction
├── UnitError          a quantity that cannot be read, or a unit of the wrong kind
├── ModelError         an input that a hazard model, acceleration or life distribution does not take
├── StructureError     a block diagram that is not one: k > n, empty group, cycle, unknown part
├── SourceError        a recording, topic or field that cannot be read
├── DataError          failures, life data or wear that cannot be read, or cannot support what is asked of them
├── StoreError         a ledger or history that cannot be read or written
└── PlugError          a plug (model, distribution, transport, store) that does not exist

The text of every error is one line: what is wrong, where, what was expected, the nearest known name.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

LONGEST_TEXT = 1000
"""Characters of an error's text; of a longer one the middle is left out."""

_UNPRINTABLE = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029]+")


class RobophmError(Exception):
    """Root of all errors raised on purpose; its text is fit to be shown to a user as it is."""

    def __str__(self) -> str:
        """One line, whatever line breaks, terminal codes or megabytes the names in it have."""
        text = _UNPRINTABLE.sub(" ", super().__str__())
        half = LONGEST_TEXT // 2
        return text if len(text) <= LONGEST_TEXT else f"{text[:half]} … {text[-half:]}"


class DesignError(RobophmError):
    """The robot's design cannot be read or contradicts itself."""


class UnitError(RobophmError):
    """A quantity cannot be read, or has a unit of the wrong kind."""


class ModelError(RobophmError):
    """A hazard model, acceleration or life distribution was given an input that it does not take."""


class StructureError(RobophmError):
    """A block diagram is not a valid structure."""


class SourceError(RobophmError):
    """A recording, topic or field cannot be read."""


class DataError(RobophmError):
    """Failures, life data or a wear signal cannot be read, or do not support what is asked of them."""


class StoreError(RobophmError):
    """A ledger or history cannot be read or written."""


class PlugError(RobophmError):
    """A plug of that name does not exist."""


def nearest(name: str, known: Iterable[str]) -> str:
    """The hint that ends an error about an unknown name: the nearest known one, or all of a few.

    Returns "; did you mean 'x'?", "; known: a, b, c", or "" where nothing is known.
    """
    from difflib import get_close_matches  # only on the way to an error: it is slow to import

    names = sorted(set(known))
    folded = {other.casefold(): other for other in names}
    close = get_close_matches(name.casefold(), folded, n=1, cutoff=0.6)
    if close:
        return f"; did you mean '{folded[close[0]]}'?"
    if 0 < len(names) <= 12:
        return "; known: " + ", ".join(names)
    return ""
