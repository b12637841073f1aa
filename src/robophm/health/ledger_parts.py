"""A kept ledger brought to a design that has changed since: parts that are new in it, and parts that are gone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from robophm.core.errors import StoreError

TOTALS = ("age", "effective", "hazard")
"""The sums of each failure mode, as a kept ledger names them."""

_OF_MODES = ("replaced", "seen", "wear", "begun")
"""What else a kept ledger has of single failure modes, by their keys."""


def brought_to(data: Mapping[str, Any], modes: Sequence[str]) -> Mapping[str, Any]:
    """Return a kept ledger as it is for these failure modes, by their keys.

    A mode that is new begins new, now, and the ledger remembers since when; what a mode has behind it that is gone is
    kept aside, and goes on where the mode comes back. Raises StoreError where some are new and others gone: then a
    part may have got another name, and its past would be lost.
    """
    kept, archived = list(data["modes"]), dict(data.get("archived", {}))
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
    found = {name: dict(data.get(name, {})) for name in _OF_MODES}
    for key in gone:
        i = kept.index(key)
        sums = {name: [part[i] for part in data["totals"][name]] for name in TOTALS}
        archived[key] = {"sums": sums, **{name: of.pop(key) for name, of in found.items() if key in of}}
    totals = {name: [[*part] for part in data["totals"][name]] for name in TOTALS}
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
    steps = {name: _with_zeros(data[name], len(new)) for name in ("recent", "history")}
    return {
        **data, **found, **steps, "modes": [*kept, *new], "totals": {**data["totals"], **totals}, "archived": archived,
    }  # fmt: skip


def _with_zeros(steps: Mapping[str, Any], count: int) -> Mapping[str, Any]:
    """Steps of the past in which so many modes more, the last ones, gained nothing."""
    if not steps["steps"] or not count:
        return steps
    kinds = [[*row, 0.0] for row in steps["kinds"]]
    return {**steps, "kinds": kinds, "of": [*steps["of"], *[len(kinds[0]) - 1] * count]}
