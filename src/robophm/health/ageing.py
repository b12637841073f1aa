"""The cumulative hazard that time and stress to come add to a robot's failure modes and dependent parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from robophm.health.condition import Condition
from robophm.health.future import Future
from robophm.health.group_state import GroupState
from robophm.health.plant import Modes, Parts, column, finite

Array = npt.NDArray[np.float64]

_MOST_KNOTS = 256
"""The most changes of a repeated future that are followed one by one; from then on its mean pace holds."""

_AT_ONCE = 8_000_000  # numbers that one array may hold


class Ageing(Condition):
    """A view of a robot now, asked what steps and futures add to it."""

    def gathered(self, parts: Parts, advance: Array, effective: Array) -> Array:
        """Return the cumulative hazard that successive steps add to each unit; shape (units, steps, ...).

        Arguments as of ``increments``.
        """
        return parts.of_units(self.increments(parts, advance, effective))

    def increments(self, modes: Modes, advance: Array, effective: Array, ratios: Array | None = None) -> Array:
        """Return the cumulative hazard that successive steps add to failure modes; shape (modes, steps, ...).

        ``advance`` of each clock, and the same times its stress, have shape (modes of the robot, steps, ...). Rates
        are as stated unless ``ratios`` to them are given, shape (these modes, draws): the axis after the steps.
        """
        parts = self._with_wear(modes, self._increments(modes, advance, effective, ratios), advance, effective)
        return np.concatenate((parts, self.groups_steps(modes, effective))) if len(modes.groups) else parts

    def _with_wear(self, modes: Modes, own: Array, advance: Array, effective: Array) -> Array:
        """What steps add by the modes' own hazards, with the wear that is seen in its place."""
        for row, wear in self._wear_of(modes):
            i = modes.modes[row]
            step = (effective if self.plant.by_age[i] else advance)[i]
            begun = np.zeros_like(step)
            np.cumsum(step[:-1], axis=0, out=begun[1:])
            own[row] = wear.added(own[row], begun, step)
        return own

    def groups_steps(self, parts: Modes, effective: Array) -> Array:
        """Return the cumulative hazard that successive steps add to dependent groups; shape (groups, steps, ...).

        Argument as of ``increments``.
        """
        own = [self._as_known[i].steps(effective[self.plant.groups[i].modes]) for i in parts.groups]
        return np.array(own).reshape(-1, *effective.shape[1:])

    def _increments(self, modes: Modes, advance: Array, effective: Array, ratios: Array | None = None) -> Array:
        m = modes.modes
        gone, aged = advance[m], effective[m]
        by_age = column(self.plant.by_age[m], aged.ndim)
        start, step, weight = aged, aged, np.ones(1)
        if not by_age.all():  # what stress multiplies: the advance of the age, or the hazard gathered over it
            start = step = np.where(by_age, aged, gone)
            stressed = np.divide(aged, gone, out=np.ones_like(aged), where=gone > 0)
            weight = np.where(by_age, 1.0, stressed)
        before = np.zeros_like(start)
        np.cumsum(start[:, :-1], axis=1, out=before[:, 1:])
        age = column(self.age[m], aged.ndim) + before
        if ratios is not None:
            drawn = ratios.reshape(len(m), 1, ratios.shape[1], *[1] * (aged.ndim - 3))
            age, step = drawn * age, drawn * step
        return weight * modes.lives.increment(age, step)

    def along(self, modes: Modes, future: Future, ratios: Array | None = None) -> Callable[[Array], Array]:
        """Return a function of hours: the cumulative hazard a future adds to modes; shape (modes, hours, draws).

        Rates are as stated, in one draw, unless ``ratios`` to them are given, shape (modes, draws). Where changing
        stress weighs a hazard, the first _MOST_KNOTS changes are followed one by one, fewer of very many modes or
        draws; from then on the mean stress holds.
        """
        ratios = np.ones((len(modes.modes), 1)) if ratios is None else ratios
        if not len(ratios):
            return lambda hours: np.empty((0, len(hours), ratios.shape[1]))
        own = self._own_along(modes, future, ratios)
        if not self._wear_of(modes):
            return own

        def with_wear(hours: Array) -> Array:
            steps = (one[:, None, :, None] for one in future.at(hours))
            return self._with_wear(modes, own(hours)[:, None], *steps)[:, 0]

        return with_wear

    def _own_along(self, modes: Modes, future: Future, ratios: Array) -> Callable[[Array], Array]:
        """The same by the modes' own hazards."""
        if future.changeless:
            return self._along_steady(modes, future, ratios)
        weighing = ~self.plant.by_age[modes.modes]
        steady, weighed = (Modes(self.plant, modes.modes[which]) for which in (~weighing, weighing))
        m, drawn = weighed.modes, drawn_out(future)
        most = np.clip(_AT_ONCE // max(len(m) * ratios.shape[1], 1), 1, _MOST_KNOTS + 1)
        knots, gone, stressed = (one[..., :most] for one in (drawn.hours, drawn.advance, drawn.effective))
        gathered = np.zeros((len(m), len(knots), ratios.shape[1]))
        advance, effective = (np.diff(one)[..., None] for one in (gone, stressed))
        gathered[:, 1:] = np.cumsum(self._increments(weighed, advance, effective, ratios[weighing]), axis=1)

        def added(hours: Array) -> Array:
            advance, effective = future.at(hours)
            found = np.empty((len(weighing), len(hours), ratios.shape[1]))
            once = self._increments(steady, advance[:, None, None], effective[:, None, None], ratios[~weighing])
            found[~weighing] = np.moveaxis(once[:, 0], 1, 2)
            if len(m):
                k = np.searchsorted(knots, hours, side="right") - 1
                step = np.maximum(advance[m] - gone[m][:, k], 0.0)
                aged = effective[m] - stressed[m][:, k]
                factor = np.divide(aged, step, out=np.ones_like(step), where=step > 0)
                age = self.age[m, None] + gone[m][:, k]
                drawn_age, drawn_step = (ratios[weighing][:, None] * one[..., None] for one in (age, step))
                rest = weighed.lives.increment(drawn_age, drawn_step)
                found[weighing] = gathered[:, k] + factor[..., None] * rest
            return found

        return added

    def _along_steady(self, modes: Modes, future: Future, ratios: Array) -> Callable[[Array], Array]:
        """The same as ``along`` where nothing changes: a mode ages at one pace, and its stress weighs what it
        gathers."""
        m, hours = modes.modes, future.hours[-1]
        advance, effective = future.advance[m, -1:] / hours, future.effective[m, -1:] / hours
        pace, weight = steady_pace(modes.by_age, advance, effective)
        more = modes.lives.at_pace(ratios * self.age[m, None], ratios * pace)
        if weight is None:
            return more
        weighing = weight[:, None]
        return lambda hours: weighing * more(hours)

    def groups_along(self, parts: Parts, future: Future) -> Callable[[Array], Array]:
        """Return a function of hours: the cumulative hazard a future adds to dependent groups; shape (groups,
        hours)."""
        along = [self._as_known[i].along(drawn_out(future), self.plant.groups[i].modes) for i in parts.groups]

        def added(hours: Array) -> Array:
            return np.array([group(hours) for group in along]).reshape(-1, len(hours))

        return added

    def paced(self, hours: Array) -> tuple[Array, Array]:
        """Advance and effective advance of every mode in operating hours at the future's mean pace; (modes, hours)."""
        advance = self.future.usage[:, None] * hours
        return advance, self.future.factor[:, None] * advance

    def _since_new_steps(self, parts: Parts, advance: Array, effective: Array) -> Array:
        """The cumulative hazard added to modes and to groups of whose members nothing is known."""
        steps = advance[:, None], effective[:, None]
        more = self._with_wear(parts, self._increments(parts, *steps), *steps)[:, 0]
        for i in parts.groups:
            more = np.vstack((more, self._since_new[i].to(effective[self.plant.groups[i].modes])))
        return more

    def hazard_then(self, parts: Parts, advance: Array, effective: Array) -> Array:
        """Hazard rate of each unit [1/h] after that at the mean pace, given what is known now; shape (units, hours)."""
        return finite(self._hazard_then(parts, advance, effective, self._as_known))

    def _hazard_then(self, parts: Parts, advance: Array, effective: Array, groups: Sequence[GroupState]) -> Array:
        m = parts.modes
        pace = self.future.factor * self.future.usage
        age = self.age[m, None] + np.where(self.plant.by_age[m, None], effective[m], advance[m])
        speed = pace[m, None]
        hazard = np.where(speed > 0, finite(parts.lives.hazard(age)) * speed, 0.0)
        if wears := self._wear_of(parts):
            lived = self._increments(parts, advance[:, None], effective[:, None])[:, 0]
        for row, wear in wears:
            i = m[row]
            gone, at = (effective[i], pace[i]) if self.plant.by_age[i] else (advance[i], self.future.usage[i])
            hazard[row] = wear.hazard(hazard[row], lived[row], gone, np.asarray(at))
        for i in parts.groups:
            modes = self.plant.groups[i].modes
            hazard = np.vstack((hazard, finite(groups[int(i)].rate(effective[modes], pace[modes]))))
        return parts.of_units(hazard)


def drawn_out(future: Future) -> Future:
    """A future with as many of its rounds drawn out as are looked at one by one."""
    return future if future.changeless else future.rounds(max(1, _MOST_KNOTS // (len(future.hours) - 1)))


def steady_pace(by_age: npt.NDArray[np.bool_], advance: Array, effective: Array) -> tuple[Array, Array | None]:
    """How fast modes age where nothing changes, and what weighs their hazard, None where nothing does."""
    if by_age.all():
        return effective, None
    weight = np.divide(effective, advance, out=np.ones_like(advance), where=~by_age & (advance > 0))
    return np.where(by_age, effective, advance), weight if np.any(weight != 1.0) else None
