"""Entries by what people type: words compared with words, whatever their case, number and hyphens, and a slip of a key.

How well a phrase of an entry fits what is asked is Dice's coefficient of their words, 2·|both|/(|phrase| + |asked|).
Source: Dice, Measures of the amount of ecologic association between species, Ecology 26 (1945).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cache
from itertools import islice, product, takewhile
from typing import NamedTuple

from robophm.core.errors import slips
from robophm.parts.entries import Entry, library

ENOUGH = 0.6
"""Least coefficient of Dice that fits: two words of three, or one where two are asked for; one of two each is too
little.
"""

_STRANGE = 0.5
"""Weight of a word that no entry has: it may be a maker's name, or the very thing that is not there."""

_VERSION = 0.2
"""Weight of a number of one or two digits, which says which one it is: 4, of a Raspberry Pi and of a 4-in-1 ESC."""

_FAMILY = 4
"""Letters and digits that codes of one maker's family begin with alike: TB6612 and TB6600."""

_SLIPPED = 0.6
"""Weight of a word with a letter put right, for an entry that has no other: it may have meant another."""

_LATER = 0.01
"""Deduction for each place further back in an entry's list of words."""

_KIND = 0.05
"""Bonus where the last word fits: a wheel encoder is an encoder."""

_ASIDE = 0.8
"""Weight of a query's words that do not say what the thing is: raspberry, for a raspberry pi."""

_OFTEN = 3
"""Phrases of an entry with a word that then names it by itself: raspberry, but of a bearing not wheel."""

_LONGEST = 12
"""Words of what is asked for."""

_TRIED = 8
"""Ways to put slips right."""

_SMALL = frozenset(["a", "an", "and", "by", "for", "from", "in", "my", "of", "on", "or", "the", "to", "with"])
_BEHIND = re.compile(r"\b(?:with|for|of|in|on|from)\b|[,(]")
"""Words behind which a name ends, and what is said of the thing begins."""


class _Phrase(NamedTuple):
    words: frozenset[str]
    size: float
    """What its words count together."""
    head: str
    """Word that says what the thing is: bearing, for a wheel bearing."""
    trust: float


class _Indexed(NamedTuple):
    """An entry's words, name and title, as words of one form."""

    phrases: tuple[_Phrase, ...]
    often: frozenset[str]
    all: frozenset[str]


def search(words: str) -> list[Entry]:
    """Return the entries that fit what somebody calls a part, the best first; none where nothing fits.

    >>> [entry.name for entry in search("Ball-Bearings")][:1]
    ['ball_bearing']
    """
    asked = _readings(_tokens(words)[:_LONGEST])
    found = {name: max((_fit(one, entry) for one in asked), default=_Fit(0.0, 0.0)) for name, entry in _index().items()}
    most = max((fit.covers for fit in found.values()), default=0.0)
    names = [name for name, fit in found.items() if fit.covers and fit.covers >= 0.99 * most]
    return [library()[name] for name in sorted(names, key=lambda name: -found[name].closeness)]


class _Fit(NamedTuple):
    covers: float
    """Share of the words asked for that the entry has somewhere; 0 where no phrase of it fits enough."""
    closeness: float


def _fit(weight: Mapping[str, float], entry: _Indexed) -> _Fit:
    if any(weight[word] == 1 for word in entry.all & weight.keys()):
        weight = {word: 1.0 if one == _SLIPPED else one for word, one in weight.items()}
    total, best, all_known = sum(weight.values()), 0.0, weight.keys() <= entry.all
    for phrase in entry.phrases:
        if phrase.head in weight or entry.often & weight.keys():
            fit = 2 * sum(weight[word] for word in phrase.words & weight.keys()) / (phrase.size + total)
            if all_known and phrase.words <= weight.keys():  # m.2, nvme and drive are all of them words of an SSD
                fit = max(fit, ENOUGH)
            if fit >= ENOUGH:
                called = 1.0 if phrase.head in weight else _ASIDE
                best = max(best, fit * phrase.trust * called + _KIND * ([*weight][-1] in phrase.words))
    return _Fit(sum(weight[word] for word in entry.all & weight.keys()) / total if best else 0.0, best)


@cache
def _index() -> dict[str, _Indexed]:
    found = {}
    for name, entry in library().items():
        said = [(word, 1 - _LATER * place) for place, word in enumerate(entry.words)]
        said += [(name.replace("_", " "), 1.0), (entry.title, 0.9)]
        phrases = tuple(_phrase(text, trust) for text, trust in said)
        count = Counter(word for phrase in phrases for word in phrase.words)
        found[name] = _Indexed(phrases, frozenset(word for word in count if count[word] >= _OFTEN), frozenset(count))
    return found


def _phrase(text: str, trust: float) -> _Phrase:
    words = frozenset(_tokens(text))
    return _Phrase(words, sum(map(_counts, words)), _head(text), trust)


def _counts(word: str) -> float:
    """What a word that entries have counts: a version or a size less than what the thing is called."""
    return _VERSION if word.isdigit() and len(word) < 3 else 1.0


def _head(text: str) -> str:
    words = _tokens(_BEHIND.split(text.casefold())[0]) or _tokens(text) or [""]
    return next((word for word in reversed(words) if word.isalpha()), words[-1])


@cache
def _known() -> frozenset[str]:
    """Every word that an entry has."""
    return frozenset().union(*(entry.all for entry in _index().values()))


def _tokens(text: str) -> list[str]:
    """The words of a text in one form: small letters, no hyphens, singular; each once."""
    return list(dict.fromkeys(map(_singular, (w for w in re.findall(r"[^\W_]+", text.casefold()) if w not in _SMALL))))


def _singular(word: str) -> str:
    """Without the ending of a plural; what is none loses it on both sides and is found all the same."""
    if len(word) > 4 and word.endswith("ies"):
        return word[:-3] + "y"
    if re.search(r"(?:ch|sh|s|x|z)es$", word):
        return word[:-2]
    return word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith("ss") else word


def _readings(asked: Sequence[str]) -> list[dict[str, float]]:
    """The words asked for as entries may write them, with what each counts: apart, or two run together as one."""
    known = _known()
    joined, place = [], 0
    while place < len(asked):
        pair = "".join(asked[place : place + 2])  # li-po, gear box
        joined.append(pair if pair in known else asked[place])
        place += 2 if pair in known and place + 1 < len(asked) else 1
    tried = (choice for said in (asked, joined) for choice in islice(product(*map(_as_known, said)), _TRIED))
    return [{word: weight for one in choice for word, weight in one.items()} for choice in tried if choice]


def _as_known(word: str) -> list[dict[str, float]]:
    """A word as entries may write it: as two, as in servomotor, or with a slip of one letter put right."""
    known = _known()
    if word in known:
        return [{word: _counts(word)}]
    if family := _of_family(word):
        return [dict.fromkeys(family, 1.0)]
    apart = ((word[:i], word[i:]) for i in range(2, len(word) - 1))
    two = [dict.fromkeys(pair, 1.0) for pair in apart if known.issuperset(pair)]
    return [*two[:1], *({one: _SLIPPED} for one in sorted(known) if slips(word, one) == 1), {word: _STRANGE}]


_CODE = re.compile(r"[a-z]{2,}\d[a-z\d]*")
"""A maker's code: letters, then digits."""


def _of_family(word: str) -> list[str]:
    """The known codes that begin as a code does, where it is none of them: the longest beginning in common, alike."""
    if not _CODE.fullmatch(word):
        return []
    alike = {one: _shared(one, word) for one in _known() if _CODE.fullmatch(one)}
    most = max(alike.values(), default=0)
    return [one for one, shared in alike.items() if shared == most] if most >= _FAMILY else []


def _shared(one: str, other: str) -> int:
    """How many letters and digits two codes begin with alike."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False)))
