"""A kept ledger brought to a design that has changed since: parts that are new in it, and parts that are gone."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from robophm.core.errors import StoreError

TOTALS = ("age", "effective", "hazard")
"""The sums of each failure mode, as a kept ledger names them."""

_OF_MODES = ("replaced", "seen", "wear", "begun")
"""The names under which a kept ledger has more of single failure modes, by their keys."""


def brought_to(
    data: Mapping[str, Any], parts: Mapping[str, Sequence[str]], causes: Collection[str] = ()
) -> Mapping[str, Any]:
    """Return a kept ledger as it is for these parts: the keys of the failure modes of each, by its path.

    A part that is new begins new, now, and the ledger remembers since when; what a failure mode has behind it that is
    gone is kept aside, and goes on where it comes back. Raises StoreError where some are new and others gone, for then
    a part may have got another name, and its past would be lost; and where a part that has lived already has a failure
    mode more, or ``causes``, common to several parts, are new: what these have behind them is not known.
    """
    kept, archived = list(data["modes"]), dict(data.get("archived", {}))
    modes = {key: path for path, keys in parts.items() for key in keys}
    gone, new = [key for key in kept if key not in modes], [key for key in modes if key not in kept]
    if not gone and not new:
        return data
    strange = [key for key in new if key not in archived]
    if gone and strange:
        raise StoreError(
            f"ledger was kept for other parts: '{gone[0]}' is in it alone, '{strange[0]}' in the design alone "
            f"({len(gone) + len(strange)} in all), and whether they are the same under another name is not known; "
            "expected parts that are new, or parts that are gone, or another store"
        )
    for key in strange:
        if modes[key] in causes or any(other in kept for other in parts[modes[key]]):
            raise StoreError(
                f"ledger was kept without '{key}', by which what has lived already can fail too; expected the failure "
                "modes that it was kept for, or another store"
            )
    found = {name: dict(data.get(name, {})) for name in _OF_MODES}
    for key in gone:
        i = kept.index(key)
        sums = {name: [part[i] for part in data["totals"][name]] for name in TOTALS}
        archived[key] = {"sums": sums, **{name: of.pop(key) for name, of in found.items() if key in of}}
    stay = [i for i, key in enumerate(kept) if key in modes]
    totals = {name: [[part[i] for i in stay] for part in data["totals"][name]] for name in TOTALS}
    for key in new:
        before = archived.pop(key, None)
        for name in TOTALS:
            for part, value in zip(totals[name], before["sums"][name] if before else (0.0, 0.0), strict=True):
                part.append(value)
        if before:
            for name, of in found.items():
                of |= {key: before[name]} if name in before else {}
        elif data["integrated_to"] is not None:
            found["begun"][key] = data["integrated_to"]
    steps = {name: _of(data[name], stay, len(new)) for name in ("recent", "history")}
    there = [*(kept[i] for i in stay), *new]
    return {**data, **found, **steps, "modes": there, "totals": {**data["totals"], **totals}, "archived": archived}


def _of(steps: Mapping[str, Any], stay: Sequence[int], count: int) -> Mapping[str, Any]:
    """Steps of the past with the modes that stay, by their places, and so many more that gained nothing in them."""
    if not steps["steps"]:
        return steps
    kinds = [[*row, 0.0] for row in steps["kinds"]]
    return {**steps, "kinds": kinds, "of": [*(steps["of"][i] for i in stay), *[len(kinds[0]) - 1] * count]}
