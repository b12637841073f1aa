"""The samples of a robot that were not taken into its past, and why, in words."""

from __future__ import annotations

from robophm.core.signal import NOT_FINITE, REORDERED, SECOND, no_number
from robophm.health.clock_jumps import waiting
from robophm.health.ledger import Ledger


def rejected_samples(ledger: Ledger) -> tuple[str, ...]:
    """Return in words which samples were dropped or wait, and how long which signals had no valid value."""
    dropped = [_dropped(reason, count) for reason, count in sorted(ledger.counts.items())]
    silent: dict[int, list[str]] = {}
    for key, nanoseconds in sorted(ledger.stale.items()):
        signal = key.rsplit(" ", 4)[0] if "[" in key else key.partition(" ")[0]  # a name may have blanks
        if signal not in silent.setdefault(nanoseconds, []):
            silent[nanoseconds].append(signal)
    if ledger.aside and ledger.newest is not None:
        dropped.insert(0, waiting(ledger.newest, ledger.aside))
    return (
        *dropped,
        *(f"no valid value for {t / SECOND:.6g} s of operation: {', '.join(signals)}" for t, signals in silent.items()),
    )


def _dropped(reason: str, count: int) -> str:
    if reason.startswith(REORDERED):
        return f"{reason} in {count} messages; expected it bound by the element's name"
    said = no_number(reason.removeprefix(NOT_FINITE)) if reason.startswith(NOT_FINITE) else reason
    return f"{count} samples not taken: {said}"
