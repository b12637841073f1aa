"""A group of parts that depend on each other, as one unit of a robot with a past: where it stands and how it goes on.

The past is told by the ages of its members, as far as they have come, as one straight line: that is exact where their
ages have kept their proportions, as they do on one clock under one stress, and else an approximation of when each aged.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from robophm.groups.member import Member, Mode
from robophm.groups.path import Path
from robophm.groups.solve import Way, fewest_failed, left, solve
from robophm.groups.solved_group import SolvedGroup
from robophm.health.dependent_group import DependentGroup

if TYPE_CHECKING:
    from robophm.health.future import Future

Array = npt.NDArray[np.float64]


_MOMENT = 1e-9
"""A stretch of any clock, short enough to count as a moment, in which a member is taken to have failed."""


def _without_location(member: Member) -> list[Mode]:
    return [replace(mode, life=mode.life.without_location()) for mode in member]


class GroupState:
    """A group now, and ahead.

    ``new``: ages of its modes when it began, ``seen``: what each would have had, had it worked all the time, when all
    were last known to work, ``now``: and now; ``status`` of each member: True works, False has failed, None; all of
    whom work begin anew.
    """

    def __init__(
        self, held: DependentGroup, new: Array, seen: Array, now: Array, status: Sequence[bool | None]
    ) -> None:
        self._told = any(one is not None for one in status)
        past, nothing = np.maximum(now - seen, 0.0), np.zeros(len(new))
        begun = held.members(new, np.maximum(seen - new, 0.0))
        self.failed = False
        """Whether the group has failed, by what is known of its members."""
        anew = partial(solve, held.group)
        if all(status):  # then nothing of what was matters but the ages
            self._begin(anew, held.members(new, np.maximum(now - new, 0.0)), nothing)
            return
        if False in status and not past.any() and not held.ages:
            past = np.full(len(new), _MOMENT)  # in which it has failed, whichever of them did
        if False not in status or past.any():
            self._begin(anew, begun, past, status)
            if self._told and not self._works():
                # What has failed in a time in which it never should had no such time.
                believed = [_without_location(one) if said is False else one
                            for one, said in zip(begun, status, strict=True)]  # fmt: skip
                self._begin(anew, believed, past, status)
                self.failed = not self._works()
            return
        failed = fewest_failed(held.group, begun, status)  # in a new robot, at once
        self.failed = failed is None
        rest = [one for i, one in enumerate(begun) if i not in (failed or ())]
        self._begin(left(held.group, failed or frozenset()), rest, nothing)

    def _begin(
        self, way: Way, members: Sequence[Member], past: Array, status: Sequence[bool | None] | None = None
    ) -> None:
        self._way, self._members, self._past, self._status = way, members, past, status
        self._path, self._now = self._begun()
        self._ahead: Array | None = None  # where it has no past
        self._straight: SolvedGroup | None = None

    def _begun(self) -> tuple[Path, float]:
        path = Path(len(self._past))
        path.add(self._past)
        return path, path.end

    def _solved(self, path: Path) -> SolvedGroup:
        return self._way(self._members, path, self._now, self._status)

    def _works(self) -> bool:
        """Whether the group may still work, by what is known of its members."""
        return bool(self._solved(self._path).log_works(np.array([self._now]))[0] > -np.inf)

    def until_now(self) -> float:
        """Cumulative hazard till now: 0 where something is known of a member, as then it is known whether it works."""
        if self._told:
            return np.inf if self.failed else 0.0
        return float(self._solved(self._path).gathered(np.zeros(1), np.array([self._now]))[0])

    def to(self, aged: Array) -> Array:
        """Return the cumulative hazard that one step adds, shape (modes, n) → (n,)."""
        result: Array = self.steps(aged[:, None])[0]
        return result

    def steps(self, aged: Array) -> Array:
        """Return the cumulative hazard that successive steps add; shape (modes, steps, ...) → (steps, ...)."""
        shape = aged.shape[1:]
        aged = aged.reshape(*aged.shape[:2], -1)
        lengths = self._lengths(aged)
        if lengths is not None:
            solved = self._along_line(aged)
            begin = np.zeros_like(lengths)
            np.cumsum(lengths[:-1], axis=0, out=begin[1:])
            return solved.lived(self._now + begin.ravel(), lengths.ravel()).reshape(shape)
        found = np.empty(aged.shape[1:])
        for column in range(aged.shape[2]):
            path, _ = self._begun()
            begins, length = path.steps(aged[:, :, column].T)
            found[:, column] = self._solved(path).lived(begins, length)
        return found.reshape(shape)

    def _line(self, aged: Array) -> Array:
        """The direction in which the path goes on: that of the past, or else of the first step that there is."""
        if self._past.any():
            line: Array = self._path.speed[-1]
            return line
        flat = aged.reshape(len(aged), -1)
        some = flat.any(axis=0)
        if not some.any():
            return np.zeros(len(flat))
        step = flat[:, int(np.argmax(some))]
        step = step / (float(step.max()) if np.isfinite(step).all() else 1.0)
        if self._ahead is None or not np.allclose(step, self._ahead, rtol=1e-12, atol=0.0):
            self._ahead, self._straight = step, None
        return self._ahead

    def _lengths(self, aged: Array) -> Array | None:
        """Lengths of the steps where all go straight on along the path; None where they do not."""
        line = self._line(aged)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            lengths = np.tensordot(line / (line @ line), aged, 1) if line.any() else np.zeros(aged.shape[1:])
            straight = np.allclose(aged, np.multiply.outer(line, lengths), rtol=1e-12, atol=0.0)
        return np.asarray(lengths) if straight else None

    def _along_line(self, aged: Array) -> SolvedGroup:
        line = self._line(aged)
        if self._straight is None:
            path, _ = self._begun()
            path.add(line)
            self._straight = self._solved(path)
        return self._straight

    def along(self, future: Future, modes: npt.NDArray[np.intp]) -> Callable[[Array], Array]:
        """Return a function of hours: the cumulative hazard that a future adds to the group.

        Where the ages of its members do not keep their proportions, the future's stretches are followed one by one as
        far as it is drawn out, and then their mean.
        """
        knots = future.effective[modes]
        lengths = self._lengths(np.diff(knots, axis=1))
        if lengths is not None:
            solved = self._along_line(np.diff(knots, axis=1))
            line = self._line(np.diff(knots, axis=1))
            scale = line / (line @ line) if line.any() else line

            def straight(hours: Array) -> Array:
                length = scale @ future.at(hours)[1][modes]
                return solved.lived(np.full(len(hours), self._now), length)

            return straight
        path, _ = self._begun()
        begins, length = path.steps(np.diff(knots, axis=1).T)
        rest = path.add(knots[:, -1])  # from then on
        begins, length = np.append(begins, rest[0]), np.append(length, rest[1])
        solved = self._solved(path)
        ends = np.append(future.hours, 2 * future.hours[-1])
        gathered = np.append(0.0, np.cumsum(solved.lived(begins[:-1], length[:-1])))

        def added(hours: Array) -> Array:
            k = np.minimum(np.searchsorted(ends, hours, side="right") - 1, len(begins) - 1)
            into = (hours - ends[k]) / np.maximum(ends[k + 1] - ends[k], 1e-300)
            return gathered[k] + solved.lived(begins[k], into * length[k])

        return added

    def rate(self, aged: Array, speed: Array) -> Array:
        """Hazard rate after going on so far in one step, (modes, n), at a speed then, (modes,); shape (n,)."""
        found = np.zeros(aged.shape[1])
        if not speed.any():
            return found
        lengths = self._lengths(np.column_stack((aged, speed)))
        if lengths is not None:
            solved = self._along_line(np.column_stack((aged, speed)))
            rates: Array = solved.rate(self._now + lengths[:-1]) * lengths[-1]
            return rates
        for i in range(len(found)):
            path, _ = self._begun()
            path.add(aged[:, i])
            begin, length = path.add(speed)
            found[i] = self._solved(path).rate(np.array([begin]))[0] * length
        return found
