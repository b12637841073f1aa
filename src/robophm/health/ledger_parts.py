"""A kept ledger brought to a design that has changed since: what becomes of the past of each of its parts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np

from robophm.core.errors import StoreError
from robophm.design.identities import TRAITS, PartIdentity
from robophm.design.identity_edits import Lived

TOTALS = ("age", "effective", "hazard")
"""The sums of each failure mode, as a kept ledger names them."""

MOST_CHANGES = 1000
"""Changes of the design that a ledger remembers, the latest."""

_OF_MODES = ("replaced", "seen", "wear", "begun")
"""The names under which a kept ledger has more of single failure modes, by their keys."""

_MOST_NAMED = 5

Kind = Literal["same", "changed", "renamed", "split", "new", "removed", "back", "asked", "refused"]


class Fate(NamedTuple):
    """The fate of the past of one part under another design."""

    path: str
    """Path in the design now; of a part that is removed, the one that it had."""
    kind: Kind
    """``changed``: what it is, while its past goes on; ``split``: of equal parts; ``back``: it was removed before;
    ``asked``: whether it is a part that was there before is not known; ``refused``: its past cannot be known."""
    before: str = ""
    """Path that it had before, or of the equal parts that it was one of."""
    candidates: tuple[str, ...] = ()
    """Identities of parts that it may be, the likeliest first; of one that is asked about."""
    words: str = ""
    """The question, why it is refused, or the names of the traits that have changed."""

    @property
    def said(self) -> str:
        """Return what becomes of the past, in a sentence about the part."""
        return {
            "same": "goes on",
            "changed": f"goes on; changed: {self.words}",
            "renamed": f"goes on; was {self.before}",
            "split": f"has the past of {self.before}, of which it was one",
            "new": "begins new",
            "removed": "is kept aside, and goes on if it comes back",
            "back": "goes on where it was when it was removed",
            "asked": f"is not known: {self.words}",
            "refused": f"is not known: {self.words}",
        }[self.kind]


class DesignChange(NamedTuple):
    """A change of the design that a ledger went through."""

    time: int
    """Time to which the ledger was integrated then [ns]."""
    part: str
    kind: str
    before: str


def fates(data: Mapping[str, Any], parts: Sequence[PartIdentity]) -> list[Fate]:
    """Return what becomes of a kept ledger's parts under a design with these parts, in its order, the removed last.

    Parts are told by their identities. Where the design states none, a part of another name is never taken for one
    that is gone, and a part that is now as another one was is asked about, for then their names may have changed.
    """
    return list(_Comparison(data, parts).fates())


class _Comparison:
    """A kept ledger beside the parts of a design."""

    def __init__(self, data: Mapping[str, Any], parts: Sequence[PartIdentity]) -> None:
        self.parts = parts
        self.kept, self.archived = set(data["modes"]), set(data.get("archived", ()))
        self.known: Mapping[str, tuple[str, str]] = {key: tuple(said) for key, said in data.get("parts", {}).items()}
        self.there = {part.identity for part in parts}
        self.split = {part.identity: whole for part in parts if (whole := self._whole(part))}
        here = {key for part in parts for key in part.modes}
        self.gone = self._gone(sorted(self.kept - here))
        self.changed = [part for part in parts if not part.members and self._was(part) not in ("", _joined(part))]
        self.impostors = self._impostors()

    def fates(self) -> Iterator[Fate]:
        for part in self.parts:
            if not part.members:
                yield self._fate(part)
        for identity in self.gone:
            yield Fate(self._path(identity), "removed")

    def _fate(self, part: PartIdentity) -> Fate:
        lived = [key for key in part.modes if key in self.kept]
        before, traits = self.known.get(part.identity, (part.path, ""))
        if not self._lived(part):
            return self._unknown(part)
        if strange := [key for key in part.modes if key not in self.kept and key not in self.archived]:
            return Fate(part.path, "refused", words=f"'{strange[0]}' is new in a part that has lived already, and what "
                        "that way to fail has behind it is not known")  # fmt: skip
        other = bool(traits) and traits != _joined(part)
        if not lived and other and not part.identified:
            return Fate(part.path, "asked", candidates=(part.identity,), words=f"'{part.path}' is not as the part of "
                        "this name was that was removed before: whether it is the same part is not known")  # fmt: skip
        if one := self.impostors.get(part.identity):
            return Fate(part.path, "asked", candidates=tuple(dict.fromkeys((one, part.identity))),
                        words=f"'{part.path}' is not as it was, and {self._double(part, one)}: whether names have "
                        "changed is not known")  # fmt: skip
        if not lived:
            return Fate(part.path, "back", before if before != part.path else "")
        if before != part.path:
            return Fate(part.path, "renamed", before)
        return Fate(part.path, "changed", words=_changed(traits, part)) if other else Fate(part.path, "same")

    def _unknown(self, part: PartIdentity) -> Fate:
        """A part whose identity the ledger has never heard of."""
        if part.identity in self.split:
            return Fate(part.path, "split", self._path(self.split[part.identity]))
        mine = _joined(part).split()
        candidates = [one for one in self.gone if one not in self.split.values()]
        removed = [one for one, said in self.known.items() if one not in self.there and said[1] == _joined(part)]
        candidates += [one for one in removed if one not in self.gone]
        candidates += [one.identity for one in self.changed if self._was(one) == _joined(part)]
        if part.identified or not candidates:
            return Fate(part.path, "new")
        alike = {one: _likeness(self.known.get(one, ("", ""))[1].split(), mine) for one in candidates}
        ranked = sorted(candidates, key=lambda one: -alike[one])
        state = "not as it was" if ranked[0] in self.there else "gone"
        return Fate(part.path, "asked", candidates=tuple(ranked), words=f"'{part.path}' has no past, and "
                    f"'{self._path(ranked[0])}' has one, but is {state}: whether that is the same part is "
                    "not known")  # fmt: skip

    def _whole(self, part: PartIdentity) -> str:
        """The identity of the equal parts that a part was one of; "" where it was none."""
        match = re.fullmatch(r"(.+)\[\d+\]", part.identity)
        if not match or self._lived(part):
            return ""
        whole = match[1]
        keys = [_of_whole(key, part.identity, whole) for key in part.modes]
        return whole if all(key in self.kept or key in self.archived for key in keys) else ""

    def _gone(self, keys: Sequence[str]) -> list[str]:
        """The identities of parts that are in the ledger alone, of these failure modes that are."""
        found: dict[str, None] = {}
        for key in keys:
            steps = _identity(key).split("/")
            above = ["/".join(steps[:n]) for n in range(len(steps), 0, -1)]
            owner = next((one for one in above if one in self.known or one in self.there), above[0])
            if owner not in self.there and (owner in self.known or not self.known):  # else of a common cause
                found[owner] = None
        return list(found)

    def _impostors(self) -> dict[str, str]:
        """The parts that are more like another part was than like themselves; and that one, which is so no more."""
        changed = self.changed
        others = [*(part.identity for part in changed), *(one for one in self.gone if one in self.known)]
        if not changed or not others:
            return {}
        codes: dict[str, int] = {}

        def coded(texts: Sequence[str]) -> Any:
            return np.array([[codes.setdefault(one, len(codes)) for one in text.split()] for text in texts])

        now = coded([_joined(part) for part in changed])
        was = coded([self.known[one][1] for one in others])
        if now.ndim != 2 or was.ndim != 2 or now.shape[1] != was.shape[1]:
            return {}  # kept by a version that looks at other traits
        unknown = {_joined(part) for part in self.parts if not part.identified and not self._lived(part)}
        found = {part.identity: part.identity for part in changed if self._was(part) in unknown}
        for i, part in enumerate(changed):
            alike = (was == now[i]).sum(axis=1)
            best = int(alike.argmax())
            if alike[best] > alike[i]:
                found[part.identity] = others[best]
                found.setdefault(others[best], part.identity)
        return {one.identity: found[one.identity] for one in changed if one.identity in found and not one.identified}

    def _double(self, part: PartIdentity, one: str) -> str:
        if one == part.identity:
            return "a part that has no past is as it was"
        return f"is now rather as '{self._path(one)}' was"

    def _was(self, part: PartIdentity) -> str:
        """The traits that a part had; "" where none are known."""
        return self.known.get(part.identity, ("", ""))[1]

    def _lived(self, part: PartIdentity) -> bool:
        return any(key in self.kept or key in self.archived for key in part.modes)

    def _path(self, identity: str) -> str:
        return self.known.get(identity, (identity, ""))[0]


def brought_to(data: Mapping[str, Any], parts: Sequence[PartIdentity]) -> Mapping[str, Any]:
    """Return a kept ledger as it is for these parts of a design.

    A part that is new begins new, now, and the ledger remembers since when; what a failure mode has behind it that is
    gone is kept aside, and goes on where it comes back. What was one of several equal parts has their past, and a
    common cause that is new has that of its members. Raises StoreError where what becomes of a past is not known.
    """
    found, has_lived = fates(data, parts), data["integrated_to"] is not None or data.get("services")
    for fate in found:
        if has_lived and fate.kind in ("asked", "refused"):
            others = sum(other.kind in ("asked", "refused") for other in found) - 1
            more = f" (and {others} more)" if others else ""
            raise StoreError(f"{fate.words}{more}; `robophm store parts` says what becomes of each past, takes answers")
    known = dict(data.get("parts", {})) | known_parts(parts)
    now, changes = data["integrated_to"], list(data.get("changes", ()))
    if has_lived:
        changes += [[now or 0, fate.path, fate.kind, fate.before] for fate in found if fate.kind != "same"]
        changes = changes[-MOST_CHANGES:]
    return _carried(data, parts) | {"parts": known, **({"changes": changes} if changes else {})}


def known_parts(parts: Sequence[PartIdentity]) -> dict[str, Any]:
    """Return path and traits of the parts, by identity, as a ledger keeps them."""
    return {part.identity: [part.path, _joined(part)] for part in parts if not part.members}


def identity_of(data: Mapping[str, Any], name: str) -> str | None:
    """Return the identity of a part or module that was last known by this path, or is by this identity; or None."""
    known = data.get("parts", {})
    every = {*known, *(_identity(key) for key in (*data["modes"], *data.get("archived", ())))}
    for identity, (path, _) in known.items():
        if path == name:
            return str(identity)
        if path.startswith(f"{name}/") and identity.endswith(path[len(name) :]):
            return str(identity.removesuffix(path[len(name) :]))
    whole = re.sub(r"\[\d+\]$", "", name)
    return name if any(f"{one}/".startswith((f"{name}/", f"{whole}/")) for one in every) else None


def lived(data: Mapping[str, Any], parts: Sequence[PartIdentity]) -> Lived:
    """Return what has a past in a kept ledger, gone or not, and what of it is asked about under this design."""
    every = {_identity(key) for key in (*data["modes"], *data.get("archived", ()))}
    open_questions = [one for one in fates(data, parts) if one.kind == "asked"]
    asked = {one.path for one in open_questions}
    doubted = {name for one in open_questions for name in one.candidates}
    doubted |= {part.identity for part in parts if part.path in asked}
    return Lived(every, doubted)


def _carried(data: Mapping[str, Any], parts: Sequence[PartIdentity]) -> dict[str, Any]:
    """A kept ledger with the failure modes of these parts, each with its own past, or that which it was part of."""
    kept, archived = list(data["modes"]), dict(data.get("archived", {}))
    modes = [key for part in parts for key in part.modes]
    here = set(modes)
    if here == set(kept):
        return dict(data)
    found = {name: dict(data.get(name, {})) for name in _OF_MODES}
    pasts = dict(archived)
    for i, key in enumerate(kept):
        sums = {name: [part[i] for part in data["totals"][name]] for name in TOTALS}
        pasts[key] = {"sums": sums, **{name: of[key] for name, of in found.items() if key in of}}
        if key not in here:
            archived[key] = pasts[key]
            for of in found.values():
                of.pop(key, None)
    origins = _origins(parts, pasts)
    at = {key: i for i, key in enumerate(kept)}
    stay, new = [key for key in kept if key in here], [key for key in modes if key not in at]
    totals = {name: [[part[at[key]] for key in stay] for part in data["totals"][name]] for name in TOTALS}
    for key in new:
        before = pasts.get(origins.get(key, ""))
        archived.pop(key, None)
        for name in TOTALS:
            for part, value in zip(totals[name], before["sums"][name] if before else (0.0, 0.0), strict=True):
                part.append(value)
        if before:
            for name, of in found.items():
                of |= {key: before[name]} if name in before else {}
        elif data["integrated_to"] is not None:
            found["begun"][key] = data["integrated_to"]
    places = [at.get(origins.get(key, "")) for key in [*stay, *new]]
    steps = {name: _of(data[name], places) for name in ("recent", "history")}
    modes = [*stay, *new]
    return {**data, **found, **steps, "modes": modes, "totals": {**data["totals"], **totals}, "archived": archived}


def _origins(parts: Sequence[PartIdentity], pasts: Mapping[str, Any]) -> dict[str, str]:
    """By the key of each failure mode that has a past the one whose past that is: mostly its own."""
    found: dict[str, str] = {}
    for part in parts:
        whole = re.sub(r"\[\d+\]$", "", part.identity)
        for key, member in zip(part.modes, part.members or part.modes, strict=True):
            other = found.get(member, "") if part.members else _of_whole(key, part.identity, whole)
            if key in pasts or other in pasts:
                found[key] = key if key in pasts else other
    return found


def _of_whole(key: str, identity: str, whole: str) -> str:
    """The key of a failure mode of equal parts, of that of one of them."""
    return whole + key.removeprefix(identity) if key.startswith(identity) else key


def _identity(key: str) -> str:
    """The identity that the key of a failure mode begins with."""
    return re.sub(r" \(\w+, (age|hazard) scaling( of .*)?\)$", "", key, flags=re.DOTALL)


def _joined(part: PartIdentity) -> str:
    return " ".join(part.traits)


def _changed(before: str, part: PartIdentity) -> str:
    was = before.split()
    if len(was) != len(TRAITS):
        return "what cannot be compared any more"
    return ", ".join(name for name, one, now in zip(TRAITS, was, part.traits, strict=True) if one != now)


def _likeness(one: Sequence[str], other: Sequence[str]) -> int:
    return sum(a == b for a, b in zip(one, other, strict=False))


def _of(steps: Mapping[str, Any], places: Sequence[int | None]) -> Mapping[str, Any]:
    """Steps of the past with the modes at these places; one that has none gained nothing in them."""
    if not steps["steps"]:
        return steps
    kinds = [[*row, 0.0] for row in steps["kinds"]]
    return {**steps, "kinds": kinds, "of": [len(kinds[0]) - 1 if i is None else steps["of"][i] for i in places]}
