"""Designs that a fleet proposes by what it has seen: with their evidence, taken and rolled back by people."""

from __future__ import annotations

import difflib
import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from robophm.core.errors import DataError, RobophmError, StoreError, nearest
from robophm.design.file import read, rewrite
from robophm.fleet.cohorts import KINDS
from robophm.fleet.experience import Experience
from robophm.fleet.store import FleetStore
from robophm.fleet.tables import DECISION, PROPOSAL
from robophm.learning.rates.evidence import with_evidence
from robophm.learning.rates.rate_update import LearnedRate

MOST_PERSON = 100
"""Letters of the name of who decides, at most."""

ACCEPTED, ROLLED_BACK = "accepted", "rolled back"


class Decision(NamedTuple):
    """A decision of a person on a proposal."""

    time: int
    """Time of it by the clock of whoever decided [ns since the epoch]."""
    person: str
    decided: str
    """Either ACCEPTED or ROLLED_BACK."""


class Proposal(NamedTuple):
    """A design with rates as the fleet has seen them, beside the one that it was learned for."""

    number: int
    time: int
    """Time at which it was made [ns since the epoch]."""
    design: str
    cohort: str
    """The cohort whose robots it was learned of, as KIND=NAME; empty: all robots of the design."""
    before: str
    """Text of the design that it is for."""
    after: str
    """Text of the design that is proposed."""
    evidence: Mapping[str, Any]
    """Counts, exposures, intervals and priors of each rate, and what was found of cohorts, as plain values."""
    decisions: tuple[Decision, ...]

    @property
    def state(self) -> str:
        """Return what was decided last, or that it is proposed."""
        return self.decisions[-1].decided if self.decisions else "proposed"

    @property
    def diff(self) -> str:
        """Return the lines that differ between both texts, as a unified diff."""
        lines = self.before.splitlines(), self.after.splitlines()
        names = f"{self.design} as it is", f"{self.design} as proposed"
        return "\n".join(difflib.unified_diff(*lines, *names, n=1, lineterm=""))


def of_cohort(found: Experience, cohort: str) -> Experience:
    """Return the experience of the robots of one cohort, given as KIND=NAME. Raises DataError where there is none."""
    kind, _, name = cohort.partition("=")
    if kind not in KINDS or not name:
        raise DataError(f"cohort {cohort!r:.60}: expected KIND=NAME, of {', '.join(KINDS)}{nearest(kind, KINDS)}")
    names = [KINDS[kind](robot.origin) for robot in found.robots]
    if name not in names:
        known = sorted({each for each in names if each is not None})
        raise DataError(f"cohort {cohort!r:.60}: no robot of {found.design.name} is of it{nearest(name, known)}")
    return found._replace(robots=tuple(one for one, each in zip(found.robots, names, strict=True) if each == name))


def propose(
    store: FleetStore, design: Path, name: str, cohort: str, learned: Sequence[LearnedRate], evidence: Mapping[str, Any]
) -> Proposal:
    """Keep a new proposal: a design with the evidence beside each rate. Raises RobophmError.

    ``name``: the design's; ``cohort``: of whom it was learned, as KIND=NAME, or empty. An earlier proposal for the same
    on which nobody has decided gives way to it.
    """
    before = read(design)
    after = with_evidence(before, str(design), learned)
    if after == before:
        raise DataError(f"{design}: says already what the fleet has seen; there is nothing to propose")
    with store.writing() as engine:
        ((last,),) = engine.ask("SELECT coalesce(max(number), 0) FROM proposal")
        engine.ask("DELETE FROM proposal WHERE design = ? AND cohort = ? AND number NOT IN "
                   "(SELECT proposal FROM decision) RETURNING number", (name, cohort))  # fmt: skip
        made = Proposal(last + 1, time.time_ns(), name, cohort, before, after, evidence, ())
        if not engine.insert_new(PROPOSAL, [(*made[:-2], json.dumps(evidence))]):
            raise StoreError(f"{store.place}: another proposal is made at this moment; expected one at a time")
    return made


def proposals(store: FleetStore) -> list[Proposal]:
    """Return all proposals of a fleet, the latest first. Raises StoreError."""
    decided: dict[int, list[Decision]] = {}
    for number, *decision in store.rows(
        "SELECT proposal, time, person, decided FROM decision ORDER BY proposal, place"
    ):
        decided.setdefault(number, []).append(Decision._make(decision))
    rows = store.rows("SELECT number, time, design, cohort, text_before, text_after, evidence FROM proposal "
                      "ORDER BY number DESC")  # fmt: skip
    return [Proposal._make((*row[:-1], json.loads(row[-1]), tuple(decided.get(row[0], ())))) for row in rows]


def proposal(store: FleetStore, number: int) -> Proposal:
    """Return one proposal. Raises RobophmError where there is none of that number."""
    found = proposals(store)
    for one in found:
        if one.number == number:
            return one
    raise RobophmError(f"{store.place}: no proposal {number}; expected one of 1 to {found[0].number}" if found else
                       f"{store.place}: no proposal {number}: none was made yet")  # fmt: skip


def decide(store: FleetStore, number: int, design: Path, person: str, decided: str) -> Proposal:
    """Accept a proposal or roll it back: put its design into a file, or the one before, and keep who decided.

    The file must hold, letter for letter, what the proposal replaces. Where one ends between the two steps, asking
    again goes on. Raises RobophmError, file and decisions as they were.
    """
    if not person.strip() or len(person) > MOST_PERSON or not person.isprintable():
        raise RobophmError(f"by {person!r:.120}: expected the name of who decides, 1 to {MOST_PERSON} letters")
    with store.writing() as engine:
        one = proposal(store, number)
        if (one.state == ACCEPTED) == (decided == ACCEPTED):
            raise RobophmError(f"proposal {number} is {one.state}; expected one that is "
                               f"{'not accepted' if decided == ACCEPTED else ACCEPTED}")  # fmt: skip
        old, new = (one.before, one.after) if decided == ACCEPTED else (one.after, one.before)
        text = read(design)
        if text not in (old, new):
            was = "proposal was made" if decided == ACCEPTED else "proposal was accepted"
            raise RobophmError(f"{design}: has changed since the {was}; expected that design, or a new proposal")
        made = Decision(time.time_ns(), person, decided)
        if not engine.insert_new(DECISION, [(number, len(one.decisions), *made)]):
            raise StoreError(f"{store.place}: somebody else decides at this moment; expected one at a time")
        if text != new:
            rewrite(design, new)
    return one._replace(decisions=(*one.decisions, made))
