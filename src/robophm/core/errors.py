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
        """Return one line, whatever line breaks, terminal codes or megabytes the names in it have."""
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


LONGEST_LIST = 400
"""Characters of the names that a hint lists, where nothing is near."""

MOST_MEANT = 3
"""Names that a hint may mean; of more it would say nothing."""


def nearest(name: str, known: Iterable[str], listed: Iterable[str] | None = None) -> str:
    """The hint that ends an error about an unknown name: what is really near, or else what there is.

    Returns "; did you mean 'x'?", "; known: a, b, c", of many "; 20 of 70 known: a, b …", or "" where nothing is
    known. ``listed`` is what there is, where that is not all that may be meant.
    """
    names = [one for one in known if one]
    if meant := _meant(name, names):
        return f"; did you mean {' or '.join(map(repr, meant))}?"
    names = sorted(set(names if listed is None else listed))
    some: list[str] = []
    for other in sorted(names, key=lambda other: -_alike(name, other)) if len(names) > 12 else names:
        if len(names) > 12 and (len(some) == 30 or sum(map(len, some)) + 2 * len(some) + len(other) > LONGEST_LIST):
            break
        some.append(other)
    if len(some) < len(names):
        return f"; {len(some)} of {len(names)} known: {', '.join(sorted(some))}" if some else ""
    return "; known: " + ", ".join(sorted(some)) if some else ""


def nearest_file(name: str, beside: Iterable[str]) -> str:
    """The same hint about a file, of the names beside it; a hidden one, which begins with a dot, is none that is meant.

    Where the name itself begins with a dot, hidden ones are.
    """
    return nearest(name, [other for other in beside if name.startswith(".") or not other.startswith(".")])


def _alike(name: str, other: str) -> float:
    """The share of letters that both have, as difflib's ``quick_ratio``, which is much slower."""
    name, other = name.casefold()[:100], other.casefold()[:100]
    return 2.0 * _shared(name, other) / ((len(name) + len(other)) or 1)


def _shared(one: str, other: str) -> int:
    return sum(min(one.count(letter), other.count(letter)) for letter in {*one})


def _meant(name: str, names: list[str]) -> list[str]:
    """The known names that this one may mean: a slip away from it, from its last step or from a word of it; or one
    begins the other."""
    said = _folded(name)
    folded = {_folded(other): other for other in reversed(names)}  # of two spellings the first
    whole = {other: form for form, other in reversed(folded.items())}
    steps = {other: _last_step(other) for other in whole}
    for forms, its in ((whole, said), (steps, said), (steps, _last_step(name))):
        found = {other: count for other, form in forms.items() if (count := slips(its, form)) is not None}
        if found:
            fewest = min(found.values())
            meant = [other for other, count in found.items() if count == fewest]
            return sorted(meant) if len(meant) <= MOST_MEANT else []
    begun = [other for other, form in whole.items() if _begins(said, form) or _begins(form, said)]
    if len(begun) == 1:
        return begun
    near = [other for other, form in whole.items() if any(_is_word(said, word) for word in form.split())]
    return sorted(near) if len(near) <= MOST_MEANT else []


def _is_word(said: str, word: str) -> bool:
    return len(said) > 3 and len(word) > 3 and slips(said, word) is not None


def _folded(name: str) -> str:
    return re.sub(r"[\s_-]+", " ", name.casefold()).strip()


def _last_step(name: str) -> str:
    return _folded(re.split(r"[./]", name)[-1])


def _begins(one: str, other: str) -> bool:
    return len(one) > 5 and other.startswith(one)


def slips(one: str, other: str) -> int | None:
    """Return how many letters are wrong, missing, too many or exchanged with the next; None: these are two words.

    A letter doubled or a last s is always a slip, and numbers that differ never. Of a short word one letter makes
    another word: another first one up to seven letters (lamp for clamp), a wrong one up to four (belt for bolt), one
    too many where three are meant (lead for led). Of more letters one slip may be for every four, and more than one
    not in the first.
    """
    if one == other:
        return 0
    first, length, longer = one[:1] == other[:1], min(len(one), len(other)), abs(len(one) - len(other))
    if longer > length + 1 or (not first and (length < 8 or longer > 1)):
        return None  # at once, of most of many names: nothing below takes these for one another
    numbers = [re.findall(r"\d+", text) for text in (one, other)]
    if all(numbers) and numbers[0] != numbers[1]:
        return None
    if re.sub(r"(.)\1|(?<=..)s$", r"\1", one) == re.sub(r"(.)\1|(?<=..)s$", r"\1", other):
        return 1
    most = min(max(length // 4, length // 3 == 1), 3 if first else 1)
    if not most or longer > most:
        return None
    if length < 5 and len(one) == len(other) and sorted(one) != sorted(other):
        return None
    if length < 4 and len(one) > len(other):
        return None
    if max(len(one), len(other)) - _shared(one, other) > most:  # each slip spoils one letter at most
        return None
    found = _distance(one, other)
    return found if found <= most else None


def _distance(one: str, other: str) -> int:
    """Damerau's and Levenshtein's, neighbours exchanged once."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, letter in enumerate(one, 1):
        before, above, row = row, before, [i]
        for j, its in enumerate(other, 1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (letter != its))
            if i > 1 and j > 1 and letter == other[j - 2] and one[i - 2] == its:
                cost = min(cost, above[j - 2] + 1)
            row.append(cost)
    return row[-1]
