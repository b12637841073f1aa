"""Entries by what people type: words compared with words, in any case, number and spelling, and a slip of a key.

The last word in front of "with", "for" or a comma says what a thing is; of what, how large and with what it is says
little, and counts only for phrases that say so too. How well a phrase of an entry fits what is asked is Dice's
coefficient of their words, 2·|both|/(|phrase| + |asked|).
Source: Dice, Measures of the amount of ecologic association between species, Ecology 26 (1945).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence, Set
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
_OTHERS = re.compile(r"\b(?:with|for)\b")
"""Words behind which other things are named: what it has, and what it is for."""

_OF_WHAT = frozenset(
    """
    alloy aluminum brass carbon fiber metal nylon plastic rubber silicone stainless steel titanium wood wooden
    big cheap compact heavy large light lightweight little micro mini miniature new slim small spare tiny
    black blue green red white amp bit channel degree dof gigabit inch port volt watt
    """.split()  # noqa: SIM905
)
"""Words that say of what a thing is, how large, or of which unit a number is."""

_SIZE = re.compile(
    r"\d+(?:[munk]?[mgvawsfh]|[ckd]m|[munk]?(?:ah|wh|hz)|[gmtk]b|[gm]hz|in|inch|ft|lb|oz|nm|kv|rpm|mp|bit|dof|ch|p|deg)?"
)
"""A number with a unit or none: 5000mAh, 10mm, 2300."""

_AMERICAN = {
    "aluminium": "aluminum",
    "castor": "caster",
    "disc": "disk",
    "gage": "gauge",
    "grey": "gray",
    "tyre": "tire",
}
_ENDINGS = (
    (re.compile(r"(?<=\w{2})our$"), "or"),
    (re.compile(r"(?<=\w[tb])re$"), "er"),
    (re.compile(r"iser$"), "izer"),
)
"""Words and endings of British spelling, and what they are in the other: colour, metre, fibre, stabiliser."""


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
    asked = _readings(words)
    found = {name: max((_fit(one, entry) for one in asked), default=_Fit(0.0, 0.0)) for name, entry in _index().items()}
    most = max((fit.covers for fit in found.values()), default=0.0)
    names = [name for name, fit in found.items() if fit.covers and fit.covers >= 0.99 * most]
    return [library()[name] for name in sorted(names, key=lambda name: -found[name].closeness)]


class _Fit(NamedTuple):
    covers: float
    """Share of the words asked for that the entry has somewhere; 0 where no phrase of it fits enough."""
    closeness: float


class _Asked(NamedTuple):
    """What is asked for, in words that entries may have."""

    weight: Mapping[str, float]
    aside: frozenset[str]
    """Those that do not say what the thing is: of what, how large, with what."""
    head: frozenset[str]
    """Those of the word that says what it is."""

    others: frozenset[str]
    """Those of other things: what it has, or is for."""

    def counted(self, words: frozenset[str], of: Set[str] | None = None) -> float:
        """What the words asked for, or some of them, count beside a phrase of these words."""
        light, said = self.aside - words, self.weight
        return sum(min(said[word], _VERSION) if word in light else said[word] for word in (said if of is None else of))


def _fit(asked: _Asked, entry: _Indexed) -> _Fit:
    weight = asked.weight
    if any(weight[word] == 1 for word in entry.all & weight.keys()):
        weight = {word: 1.0 if one == _SLIPPED else one for word, one in weight.items()}
        asked = asked._replace(weight=weight)
    best, all_known = 0.0, weight.keys() <= entry.all
    for phrase in entry.phrases:
        if phrase.head in asked.others:
            continue  # a motor with encoder is no encoder
        if phrase.head in weight or entry.often & weight.keys():
            shared = sum(weight[word] for word in phrase.words & weight.keys())
            fit = 2 * shared / (phrase.size + asked.counted(phrase.words))
            named = phrase.words <= asked.head and shared >= 1  # a tilt rotor servo is a servo
            if named or (all_known and (phrase.words <= weight.keys() or phrase.head in asked.head)):
                fit = max(fit, ENOUGH)  # m.2, nvme and drive are all of them words of an SSD
            if fit >= ENOUGH:
                called = 1.0 if phrase.head in weight else _ASIDE
                best = max(best, fit * phrase.trust * called + _KIND * bool(asked.head & phrase.words))
    own = weight.keys() - asked.others
    known = sum(min(weight[word], _VERSION) if word in asked.aside else weight[word] for word in own & entry.all)
    return _Fit(known / asked.counted(frozenset(), own) if best else 0.0, best)


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
    """The words of a text in one form: small letters, no hyphens, singular, American; each once."""
    words = (word for word in re.findall(r"[^\W_]+", text.casefold()) if word not in _SMALL)
    return list(dict.fromkeys(_american(_singular(word)) for word in words))


def _american(word: str) -> str:
    """In American spelling; what is no British one loses nothing by it, as both sides are taken so."""
    for ending, other in _ENDINGS:
        word = ending.sub(other, word)
    return _AMERICAN.get(word, word)


def _singular(word: str) -> str:
    """Without the ending of a plural; what is none loses it on both sides and is found all the same.

    Fuses may be of a fuse or of a fus, lenses of a lense or a lens: both lose what tells them apart.
    """
    if len(word) > 4 and word.endswith("ies"):
        return word[:-3] + "y"
    one = _without_s(word)
    bare = re.sub(r"(ch|sh|s|x|z)e$", r"\1", one)
    return one if bare == one else _without_s(bare)


def _without_s(word: str) -> str:
    return word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith("ss") else word


def _readings(text: str) -> list[_Asked]:
    """What is asked for as entries may write it: each word apart, or two run together as one."""
    known, said = _known(), _tokens(text)[:_LONGEST]
    naming = {*_tokens(_BEHIND.split(text.casefold())[0])} - _OF_WHAT
    aside = {*said} - naming if naming & {*said} else set()
    others = {*_tokens(" ".join(_OTHERS.split(text.casefold())[1:]))} & aside
    joined, place = [], 0
    while place < len(said):
        pair = "".join(said[place : place + 2])  # li-po, gear box
        joined.append(pair if pair in known else said[place])
        place += 2 if pair in known and place + 1 < len(said) else 1
    return [
        _asked(words, choice, aside, others)
        for words in (said, joined)
        for choice in islice(product(*map(_as_known, words)), _TRIED)
        if choice
    ]


def _asked(words: Sequence[str], choice: Sequence[Mapping[str, float]], aside: set[str], others: set[str]) -> _Asked:
    """One reading: for each word what entries may write, with what it counts."""
    weight = {word: said for one in choice for word, said in one.items()}
    naming = [frozenset(one) for word, one in zip(words, choice, strict=True) if word not in aside]
    head = naming[-1] if naming else frozenset()
    beside = frozenset(weight.keys() - frozenset().union(*naming))
    return _Asked(weight, beside, head, frozenset(others) if head & _known() else frozenset())


def _as_known(word: str) -> list[dict[str, float]]:
    """A word as entries may write it: as two, as in servomotor, or with a slip of one letter put right."""
    known = _known()
    if word in known:
        return [{word: _counts(word)}]
    if _SIZE.fullmatch(word):
        return [{word: _VERSION}]
    if (plain := word.rstrip("abcdefghijklmnopqrstuvwxyz")) in known and len(plain) > 2:  # 608zz is a 608
        return [{plain: 1.0}]
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
