"""A part fails, is replaced or repaired: what its failure modes have behind them from then on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Self

from robophm.core.argument_checks import number
from robophm.core.errors import RobophmError, nearest
from robophm.design.robot import Component, FailureMode, Robot
from robophm.health.ledger import Ledger, Service


@dataclass(frozen=True)
class ExposureBetweenServices:
    """The exposure of a failure mode from one service to the next, or till now; ages include the initial exposure."""

    mode: FailureMode
    parts: int
    """Number of equal parts that went through it."""
    start: float
    """Effective age of its part when the stretch began [unit of its clock]."""
    end: float
    hours: float
    """Advance of the mode's clock [its unit]."""
    hazard: float
    """Cumulative hazard of one of the parts in it, at the stated rate."""
    failed: bool


SOFTWARE = "software"
"""The name under which a ledger keeps who said so, where no person did."""

MOST_WORDS = 1000
"""Characters of what is said of a service, at most; and of a name a tenth of them."""


@dataclass(frozen=True)
class ServiceNote:
    """A person, or the robot itself, says that a part, or one failure mode of it, was served or has failed, or had
    not."""

    part: str
    """Path of the component, or of its failure mode."""
    remaining: float | None = None
    """The share of its age that remains after a repair, 0 as new; None: a new one was put in."""
    failed: bool = False
    """Whether it had failed; else it was served in time."""
    by: str = ""
    note: str = ""
    waits: bool = False
    """Whether nothing was done yet: it has ``failed``, and waits to be replaced or repaired."""
    none: bool = False
    """Whether the last failure that was told of was none, so that it is struck out."""

    def __post_init__(self) -> None:
        """Raise RobophmError for a share that is none, or words that are too long or no text."""
        if self.waits and (not self.failed or self.remaining is not None):
            raise RobophmError("what waits to be replaced or repaired is neither yet; expected that it has failed")
        if self.none and (self.failed or self.waits or self.remaining is not None):
            raise RobophmError("what is struck out was neither a failure nor a service; expected that alone")
        if self.remaining is not None:
            number(self.remaining, "the share of its age that remains", high=1.0)
        for name, said, most in (("by", self.by, MOST_WORDS // 10), ("note", self.note, MOST_WORDS)):
            if len(said) > most or not said.isprintable():
                raise RobophmError(f"{name} {said!r:.60}: expected one line of at most {most} characters")

    def to_json(self) -> dict[str, Any]:
        """Return the note as plain values for JSON; who never heard of parts that wait reads all others."""
        return {name: value for name, value in asdict(self).items() if name not in ("waits", "none") or value}

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Self:
        """Return a note that was kept as plain values."""
        return cls(**data)


def take_note(robot: Robot, ledger: Ledger, said: ServiceNote) -> list[Service]:
    """Let a ledger know of a service, now; return what it did to each failure mode.

    Raises RobophmError, and leaves the ledger as it was, where there is no such part, or it is not said which mode of
    it failed.
    """
    before = len(ledger.services)
    if said.none:
        return strike_out(robot, ledger, said)
    if said.waits:
        fail(robot, ledger, said.part)
    elif said.remaining is None:
        replace(robot, ledger, said.part, failed=said.failed)
    else:
        repair(robot, ledger, said.part, said.remaining, failed=said.failed)
    ledger.services[before:] = [one._replace(by=said.by, note=said.note) for one in ledger.services[before:]]
    return ledger.services[before:]


def find(robot: Robot, path: str) -> tuple[Component, tuple[FailureMode, ...]]:
    """The component that a path names, or one of whose failure modes it names; and the modes named.

    Raises RobophmError, also for a common cause, which is no part, and for one of several equal parts.
    """
    parts = [part for part in robot.all_components() if part not in robot.causes]
    for part in parts:
        if part.path == path:
            return part, part.modes
        for mode in part.modes:
            if mode.path == path:
                return part, (mode,)
        if {path, path.rpartition("/")[0]} & {*part.units} - {part.path}:  # a unit, or a mode of one
            raise RobophmError(
                f"'{path}': a ledger keeps one age for the {part.quantity} equal parts of '{part.path}'; expected "
                "that name, for all of them, or a design that has them as components of their own"
            )
    known = [one for part in parts for one in (part.path, *(mode.path for mode in part.modes))]
    raise RobophmError(f"no part '{path}'{nearest(path, known)}")


def services_of(robot: Robot, ledger: Ledger, path: str) -> list[Service]:
    """Return failures and services so far of a component, or one of its failure modes, by its path; or RobophmError."""
    keys = {mode.key for mode in find(robot, path)[1]}
    return [service for service in ledger.services if service.mode in keys]


def fail(robot: Robot, ledger: Ledger, path: str) -> None:
    """Note that a component, or one failure mode of it, has failed, and waits to be replaced or repaired.

    Raises RobophmError, also where it has failed already, and for several equal parts, of which it is not known which.
    """
    part, modes = find(robot, path)
    if part.quantity > 1:
        raise RobophmError(
            f"'{path}': a ledger does not tell the {part.quantity} equal parts of '{part.path}' apart; expected a "
            "design that has them as components of their own, or that one was replaced or repaired"
        )
    if any(mode.key in ledger.failed for mode in part.modes):
        raise RobophmError(f"'{part.path}' has failed already; expected that it is replaced or repaired first")
    for mode in _failed(part, modes, ledger, failed=True):
        ledger.fail(mode.key)


def strike_out(robot: Robot, ledger: Ledger, said: ServiceNote) -> list[Service]:
    """Strike out the last failure of a component or of one of its failure modes, which was none; return what it is now.

    What passed until software said that the part works again counts then. Raises RobophmError where none was
    noted as it happened, or a person has replaced or repaired the part since.
    """
    keys = [mode.key for mode in find(robot, said.part)[1]]
    own = [one for one in ledger.services if one.mode in keys]
    noted = [i for i, one in enumerate(own) if one.kind == "failed"]
    since = [one for one in own[noted[-1] + 1 :] if one.kind != "struck out"] if noted else []
    if not noted:
        raise RobophmError(f"'{said.part}': no failure of it was told of; expected one, to strike it out")
    if any(one.by != SOFTWARE for one in since):
        raise RobophmError(
            f"'{said.part}' was {since[-1].kind} since it failed, and counts from then on; expected a failure that "
            "nobody has done anything about"
        )
    mode = own[noted[-1]].mode
    ledger.strike_out(mode, said.by, said.note)
    return [next(one for one in reversed(ledger.services) if one.mode == mode and one.kind == "struck out")]


def failures(ledger: Ledger) -> list[Service]:
    """Return the failures that a ledger knows of, each once: as it was noted, else with the service that followed."""
    found, waits = [], set[str]()
    for one in ledger.services:
        if one.failed and one.mode not in waits:
            found.append(one)
        waits = waits | {one.mode} if one.kind == "failed" else waits - {one.mode}
    return found


def replace(robot: Robot, ledger: Ledger, path: str, *, failed: bool) -> None:
    """Replace a component; ``failed``: that it, or the failure mode named, had failed. Raises RobophmError."""
    part, modes = find(robot, path)
    broken = _failed(part, modes, ledger, failed=failed)
    ledger.replace([mode.key for mode in part.modes], [mode.key for mode in broken])


def repair(robot: Robot, ledger: Ledger, path: str, remaining: float, *, failed: bool) -> None:
    """Leave a share of the effective age of a component, or of one failure mode: 0 as new, 1 as before the repair.

    Kijima's second model (1989): V ← q·V, its age when it failed, where that was noted. Raises RobophmError where the
    share is none, or the part is not there.
    """
    if not 0 <= remaining <= 1:
        raise RobophmError(f"{remaining:g} of the age remains; expected 0 (as good as new) to 1 (as before)")
    part, modes = find(robot, path)
    broken = _failed(part, modes, ledger, failed=failed)
    last = {one.mode: one for one in ledger.services if one.kind == "failed"}
    for mode in modes:
        i = ledger.modes.index(mode.key)
        initial = 0.0 if mode.key in ledger.replaced else mode.initial_exposure
        age, effective, hazard = (float(total.value[i]) for total in (ledger.age, ledger.effective, ledger.hazard))
        if mode.key in ledger.failed:
            age, effective, hazard = last[mode.key].before
        left = remaining * (initial + age)
        if mode.scaling == "hazard":  # what its stress has gathered shrinks as its hazard by design does
            past, designed = (float(mode.life.increment(0.0, one)) for one in (initial, initial + age))
            hazard = (past + hazard) * float(mode.life.increment(0.0, left)) / designed if designed > 0 else 0.0
        ledger.repair(mode.key, (left, remaining * (initial + effective), hazard), failed=mode in broken)


def _failed(
    part: Component, modes: tuple[FailureMode, ...], ledger: Ledger, *, failed: bool
) -> tuple[FailureMode, ...]:
    """The modes by which it failed, as is said now or was noted before. Raises RobophmError where that is not known."""
    if noted := tuple(mode for mode in modes if mode.key in ledger.failed):
        return noted
    if failed and len(modes) > 1:
        names = ", ".join(f"'{mode.path}'" for mode in part.modes)
        raise RobophmError(f"'{part.path}' failed, but by which of its modes is not said; expected one of {names}")
    return modes if failed else ()


def service_intervals(robot: Robot, ledger: Ledger) -> Iterator[ExposureBetweenServices]:
    """Return the exposure of every failure mode, service by service, and since the last one.

    What passes from a failure to its repair is lived by nobody.
    """
    of: dict[str, list[Service]] = {}
    for service in (one for one in ledger.services if one.kind != "struck out"):
        of.setdefault(service.mode, []).append(service)
    for part in robot.all_components():
        for mode in () if part in robot.causes else part.modes:
            i = ledger.modes.index(mode.key)
            last = float(ledger.age.value[i]), float(ledger.effective.value[i]), float(ledger.hazard.value[i])
            initial, begun = mode.initial_exposure, (0.0, 0.0, 0.0)
            ends = [(one.before, one.failed, one.after, one.kind) for one in of.get(mode.key, [])]
            waits = False
            for end, failed, after, kind in [*ends, (last, False, last, "")]:
                waited, waits = waits, kind == "failed"
                if waited:
                    initial, begun = 0.0, after
                    continue
                start, until = initial + begun[1], initial + end[1]
                hazard = end[2] - begun[2]
                if mode.scaling == "age":
                    hazard = float(mode.life.increment(start, max(until - start, 0.0)))
                yield ExposureBetweenServices(mode, part.quantity, start, until, end[0] - begun[0], hazard, failed)
                initial, begun = 0.0, after
