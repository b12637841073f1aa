"""Probabilities of systems ahead, given that they work now, however unlikely that was.

A redundant pair may have outlived all that was expected of it: with a cumulative hazard of 745 the probability that it
works is less than any float, and what is known to work must not be declared dead for that. Where it is too small,
blocks in series are asked one by one, each given that it works; what is still too small is done anew with decimals,
whose exponents have room for cumulative hazards up to 10¹⁷. An infinite one is that of what has failed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, localcontext
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.blocks.decision_diagram import Array
from robophm.blocks.diagram import Block
from robophm.blocks.folding import in_series
from robophm.blocks.merging import independent
from robophm.blocks.reliability import Structure

FAINTEST = 1e-100
"""P(works now), below which a part of it may be too small for all digits of a float."""

_CONTEXT = Context(prec=25, Emin=MIN_EMIN, Emax=MAX_EMAX, traps=[])


@contextmanager
def decimals() -> Iterator[None]:
    """Within this context decimals have 25 digits, and every exponent there is."""
    with localcontext(_CONTEXT):
        yield


as_decimals: Callable[[Array], Array] = np.frompyfunc(Decimal, 1, 1)
"""Converts an array of floats to decimals."""

_survival: Callable[[Array], Array] = np.frompyfunc(lambda hazard: Decimal(-hazard).exp(), 1, 1)


def survival(hazard: Array) -> Array:
    """Return P(works) from cumulative hazards, floats or, in ``decimals()``, decimals."""
    return _survival(hazard) if hazard.dtype == object else np.exp(-hazard)


def likely_failed(hazard: Array) -> Array:
    """Return P(failed) from cumulative hazards; where failure is next to certain a float has digits enough."""
    failed = -np.expm1(-hazard.astype(float))
    return as_decimals(failed) if hazard.dtype == object else failed


_share: Callable[..., Array] = np.frompyfunc(lambda a, b, other: a / b if b else Decimal(other), 3, 1)
_log: Callable[[Array], Array] = np.frompyfunc(lambda p: float(p.ln()) if p else -np.inf, 1, 1)


def share(part: Array, whole: Array, otherwise: float) -> Array:
    """Return a part over a whole, floats or decimals, as floats; ``otherwise`` where the whole is 0."""
    if whole.dtype == object:
        return _share(part, whole, otherwise).astype(float)
    return np.divide(part, whole, out=np.full_like(whole, otherwise), where=whole > 0)


def log(chance: Array) -> Array:
    """Return ln of probabilities, floats or decimals, as floats."""
    if chance.dtype == object:
        return _log(chance).astype(float)
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(chance))


class StructureGivenItWorks:
    """One or more diagrams, prepared as ``Structure``, and asked about each given that it works now.

    ``known`` is everywhere the cumulative hazard of each unit till now, shape (units, ...), in the order of
    ``structure.names``: 0 where it is known to work, infinite where it has failed. Of several diagrams, which share no
    parts, every result has one more axis, the first.
    """

    def __init__(self, *diagrams: Block, structure: Structure | None = None) -> None:
        self.structure = structure or Structure(*diagrams)
        self._diagrams = diagrams

    def ahead(self, known: Array, more: Array) -> tuple[Array, Array]:
        """Return P(fails meanwhile) and P(survives it), given that it works now; 1 and 0 where it cannot. Shape (...).

        ``more``: what is added to the cumulative hazard of each unit, shape (units, ...).
        """
        return self.given(known)(more)

    def given(self, known: Array) -> Callable[[Array], tuple[Array, Array]]:
        """Return ``ahead`` as a function of ``more``, for many questions about the same ``known``."""
        if not known.any():  # what fails is what fails from now on
            return partial(self._from_new, known.shape[1:])
        of_units = _chances_given(known)

        def ahead(more: Array) -> tuple[Array, Array]:
            found = self.structure.transition(*of_units(more))
            given = np.stack(found.given_works())
            self._repair(given, found.fails + found.survives, _ahead_anew, known, more)
            fails, survives = given
            return fails, survives

        return ahead

    def _from_new(self, known: tuple[int, ...], more: Array) -> tuple[Array, Array]:
        """``ahead`` where nothing has been lived, which broadcasts to the shape of what is ``known``."""
        shape = np.broadcast_shapes(known, more.shape[1:])
        rows = np.broadcast_to(more, (len(more), *shape)).reshape(len(more), -1)
        found = self.structure.lived(rows[self.structure.leaves])
        fails, survives = found.reshape(*found.shape[:-1], *shape)
        return fails, survives

    def rate(self, known: Array, hazard: Array) -> Array:
        """Return the hazard rate now [1/h], given that it works, shape (...), from each unit's; infinite if it cannot.

        ``hazard`` is finite, shape (units, ...).
        """
        alive = survival(known)
        state = self.structure.state(alive, likely_failed(known), hazard * alive)
        with np.errstate(over="ignore"):
            rate = share(state.density, np.asarray(state.works), np.inf)

        def anew(one: _One, known: Array, hazard: Array) -> Array:
            if one.apart:
                rates: Array = one.solver.rate(known, hazard).sum(axis=0, keepdims=True)
                return rates
            with decimals():
                known = as_decimals(known)
                alive = survival(known)
                state = one.solver.structure.state(alive, likely_failed(known), as_decimals(hazard) * alive)
                return share(state.density, state.works, np.inf)[None]

        self._repair(rate[None], state.works, anew, known, hazard)
        return rate

    def hangs(self, known: Array, more: Array) -> Array:
        """Return P(each unit works then, and the system with it alone | it works now), shape (units, ...).

        Of one diagram. ``more``: what is added to the cumulative hazard of each unit, shape (units, ...). Times the
        unit's hazard rate it is how often its failure fails the system: Iᵢ·fᵢ/P(it works now).
        """
        exactly = bool(np.any(self.log_works(known) <= math.log(FAINTEST)))
        with decimals():
            if exactly:
                known, more = as_decimals(known), as_decimals(more)
            alive, _ = self.structure.probability(survival(known), likely_failed(known))
            left, then = survival(known + more), likely_failed(known + more)
            return np.asarray(self.structure.birnbaum(left, then) * left / alive, dtype=float)

    def log_works(self, known: Array) -> Array:
        """Return ln P(works now), shape (...): how likely what is known was."""
        works, _ = self.structure.probability(survival(known), likely_failed(known))
        logs = log(works)

        def anew(one: _One, known: Array) -> Array:
            if one.apart:
                sums: Array = one.solver.log_works(known).sum(axis=0, keepdims=True)
                return sums
            with decimals():
                known = as_decimals(known)
                return log(one.solver.structure.probability(survival(known), likely_failed(known))[0])[None]

        self._repair(logs[None], works, anew, known)
        return logs

    def exactly(self, known: Array, more: Array) -> tuple[Array, Array]:
        """Return ``ahead`` of decimals, and in decimals; only within ``decimals()``."""
        _, fails, survives = self.structure.transition(*chances(known, more))
        works = fails + survives
        return _share(fails, works, 1.0), _share(survives, works, 0.0)

    @cached_property
    def _each(self) -> list[_One]:
        place = {name: i for i, name in enumerate(self.structure.names)}
        found = []
        for diagram in self._diagrams:
            blocks = independent(diagram)
            solver = self if len(blocks) == len(self._diagrams) == 1 else StructureGivenItWorks(*blocks)
            found.append(_One(np.array([place[name] for name in solver.structure.names]), solver, len(blocks) > 1))
        return found

    def _repair(self, found: Array, works: Array, anew: Callable[..., Array], *of_units: Array) -> None:
        """Do those columns of each diagram anew where next to nothing speaks for it and it may work all the same.

        ``found``: numbers of shape (numbers, [diagrams,] ...), which are written; ``works``: P(works now).
        """
        if not np.any(works < FAINTEST):
            return
        wide = np.broadcast(*of_units).shape
        columns = [np.broadcast_to(one, wide).reshape(wide[0], -1) for one in of_units]
        flat = found.reshape(len(found), len(self._diagrams), -1)
        faint = np.reshape(works, flat.shape[1:]) < FAINTEST
        for d, one in enumerate(self._each):
            if not faint[d].any():
                continue
            arrays = [array[one.rows][:, faint[d]] for array in columns]
            may = (arrays[0] < np.inf).astype(float)
            chance, _ = one.solver.structure.probability(may, 1 - may)
            possible = np.all(np.reshape(chance > 0, (-1, may.shape[1])), axis=0)
            which = np.flatnonzero(faint[d])[possible]
            if len(which):
                flat[:, d, which] = anew(one, *(array[:, possible] for array in arrays))
        found[...] = flat.reshape(found.shape)


class _One(NamedTuple):
    """One of several diagrams: the rows of its units, and the solver of the blocks in series that it consists of."""

    rows: NDArray[np.intp]
    solver: StructureGivenItWorks
    apart: bool
    """Whether there are several such blocks."""


def _ahead_anew(one: _One, known: Array, more: Array) -> Array:
    """``ahead`` of one diagram where floats have too few digits; shape (2, columns)."""
    if one.apart:
        fails, survives = one.solver.ahead(known, more)
        return in_series(np.stack((np.zeros_like(fails), survives, fails)))[:0:-1]
    with decimals():
        return np.stack(one.solver.exactly(as_decimals(known), as_decimals(more))).astype(float)


def chances(known: Array, more: Array) -> tuple[Array, Array, Array]:
    """Return P(failed by now), P(fails in the task), P(survives it) of each unit, from cumulative hazards.

    Floats or, in ``decimals()``, decimals.
    """
    return _chances_given(known)(more)


def _chances_given(known: Array) -> Callable[[Array], tuple[Array, Array, Array]]:
    """The same as a function of ``more``."""
    works, failed = survival(known), likely_failed(known)
    return lambda more: (failed, works * likely_failed(more), works * survival(more))
