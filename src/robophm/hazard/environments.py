"""The environments of MIL-HDBK-217F Table 3-2 in which parts work, with their meaning for robots and usual words.

This is the one table of them: designs, commands and every model that asks for an environment take its words.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from typing import NamedTuple

from robophm.core.errors import ModelError, nearest
from robophm.core.table import Source, Table
from robophm.hazard.model import Choice

SOURCE = Source("MIL-HDBK-217F Notice 2", "3", "3-3 (Table 3-2)", "two sources agree")


class Environment(NamedTuple):
    """A row of Table 3-2."""

    name: str
    """The handbook's name of the environment: Ground, Benign."""
    meaning: str
    """A description in plain words, for robots."""
    words: tuple[str, ...]
    """Words by which people call this environment; each is taken for its symbol."""


ENVIRONMENTS: Mapping[str, Environment] = {
    "GB": Environment(
        "Ground, Benign",
        "stands still in a room of even temperature; what drives or is carried is GM, indoors too",
        ("indoor", "indoors", "laboratory", "lab", "office", "home", "hospital"),
    ),
    "GF": Environment(
        "Ground, Fixed",
        "stands still, cooled well enough, perhaps in a building without heating",
        ("fixed", "stationary", "factory", "workshop", "warehouse", "industrial", "unheated building"),
    ),
    "GM": Environment(
        "Ground, Mobile",
        "on wheels, tracks or legs, or carried by hand, and whatever else is out of doors on the ground",
        (
            "vehicle", "mobile", "mobile robot", "indoor robot", "outdoor robot", "rover", "ground vehicle", "ground",
            "outdoor", "outdoors", "outdoor ground", "field", "handheld", "car", "truck", "tractor",
        ),
    ),
    "NS": Environment(
        "Naval, Sheltered", "below deck of a ship, or within a submarine", ("ship", "below deck", "boat", "submarine")
    ),
    "NU": Environment(
        "Naval, Unsheltered",
        "on deck in the weather, or in salt water",
        ("underwater", "subsea", "on deck", "deck", "sea", "sailing", "buoy"),
    ),
    "AIC": Environment(
        "Airborne, Inhabited Cargo",
        "in the cabin or hold of an aircraft, where crew could be",
        ("aircraft cabin", "cargo aircraft", "airliner"),
    ),
    "AIF": Environment("Airborne, Inhabited Fighter", "in the cockpit of a fighter", ("fighter cockpit", "cockpit")),
    "AUC": Environment(
        "Airborne, Uninhabited Cargo",
        "in an aircraft with fixed wings, where no crew could be",
        ("fixed wing", "fixed wing drone", "aeroplane", "airplane", "aircraft", "glider", "airship"),
    ),
    "AUF": Environment("Airborne, Uninhabited Fighter", "in a fighter, where no crew could be", ("unmanned fighter",)),
    "ARW": Environment(
        "Airborne, Rotary Wing",
        "in or on a helicopter or multicopter",
        ("flying", "drone", "multicopter", "multirotor", "quadcopter", "quadrotor", "helicopter", "uav"),
    ),
    "SF": Environment("Space, Flight", "in orbit, not under power", ("space", "orbit", "satellite", "spacecraft")),
    "MF": Environment("Missile, Flight", "in a missile that flies", ("missile", "cruise missile", "missile flight")),
    "ML": Environment(
        "Missile, Launch",
        "in a rocket that starts, or in what comes back from orbit",
        ("launch", "rocket", "rocket launch", "missile launch", "reentry"),
    ),
    "CL": Environment("Cannon, Launch", "in a shell that is shot", ("cannon", "cannon launch", "shell")),
}  # fmt: skip
"""The environments by symbol. A mobile robot is GM by the handbook's definition: wheeled, tracked or carried."""

_NAMES = {option: re.sub(r"[^a-z]+", " ", entry.name.lower()) for option, entry in ENVIRONMENTS.items()}

WORDS: Mapping[str, str] = {word: symbol for symbol, entry in ENVIRONMENTS.items() for word in entry.words} | {
    name: symbol for symbol, name in _NAMES.items()
}
"""The symbol by each word, the handbook's own names among them."""

_ANY = Choice(tuple(ENVIRONMENTS), aliases=WORDS, shared=True)


def environment(said: str) -> str:
    """The symbol of what somebody calls an environment. Raises ModelError with all that there are."""
    if symbol := _ANY.option(said):
        return symbol
    hint = nearest(said, (*ENVIRONMENTS, *WORDS), _ANY.listed)
    raise ModelError(f"'{said:.60}' is no environment of MIL-HDBK-217F Table 3-2{hint}")


def explained(symbol: str) -> str:
    """A symbol with its meaning in brackets, as part of a sentence: "GM (Ground, Mobile: on wheels …)"."""
    entry = ENVIRONMENTS[symbol]
    return f"{symbol} ({entry.name}: {entry.meaning})"


def rows() -> Iterator[tuple[str, str, str, str]]:
    """Symbol, the handbook's name, what it means, what it is also called."""
    for symbol, entry in ENVIRONMENTS.items():
        yield symbol, entry.name, entry.meaning, ", ".join(entry.words)


def environment_choice(options: Table | Collection[str], but: str = "") -> Choice:
    """The input of a model that knows these environments; ``but`` says which it has no row for."""
    known = options if isinstance(options, Table) else tuple(options)
    words = {word: symbol for word, symbol in WORDS.items() if symbol in known}
    described = "where it works, by Table 3-2 or in words"
    return Choice(known, f"{described}; {but}" if but else described, aliases=words, shared=True)
