"""Importance of each unit to a system: over a time that begins while it works, and over its whole life.

All of it follows from one sweep back over the system, because R is linear in what becomes of each unit: whether a unit
survives changes P(the system works) by Iᵢ = ∂R/∂pᵢ, its Birnbaum importance. Given that the system works now, the
system's chance to survive is linear in the unit's chance to survive from now on, by (c + s)ᵢ·Iᵢ / P(works now): what is
stated here is that. For a new system, which surely works, it is Birnbaum's own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robophm.blocks.decision_diagram import numbers
from robophm.blocks.reliability import Structure, Transition
from robophm.core.waiting_time import NODES, Curve, panel_areas, time_at

Array = NDArray[np.float64]

AT_ONCE = 2_000_000
"""Numbers that one array may hold; more columns take turns."""

TOLERANCE = 1e-10
"""Tolerance of Barlow–Proschan importances, as a share of the sum of them all, unless another is asked for."""


class Importance(NamedTuple):
    """Importances of each unit over a time, given that the system works when it begins; shapes (units, ...).

    Not a number where it says nothing: of a system that has failed, or shares of a failure that cannot come.
    """

    birnbaum: Array
    """Birnbaum's: how much the system's chance to survive grows with the unit's, P(it hangs on the unit)."""
    criticality: Array
    """P(the unit fails, and the system would work if it did not | the system fails)."""
    achievement: Array
    """Risk achievement worth (RAW): how many times as likely the system fails where the unit surely does."""
    reduction: Array
    """Risk reduction worth (RRW): how many times as likely the system fails as where the unit cannot; infinite where
    all hangs on it.
    """
    improvement: Array
    """Improvement potential: the fall of the probability of failure if the unit could not fail."""


def importance(structure: Structure, before: ArrayLike, during: ArrayLike, after: ArrayLike) -> Importance:
    """Return the importances of each unit, shape (units, ...); arguments as of ``Structure.transition``.

    Units fail ``before`` the time begins, ``during`` it, or ``after`` it if at all; without a past, ``before`` is 0.
    Rausand and Høyland, System Reliability Theory (2nd ed.), chapter 5. Raises StructureError as ``transition``.
    """
    b, c, s = np.broadcast_arrays(*(numbers(one) for one in (before, during, after)))
    system = structure.transition(b, c, s)
    hangs = structure.birnbaum(s, b + c)
    works = np.asarray(system.fails + system.survives)
    fails = np.asarray(system.fails)
    caused = c * hangs
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # beside next to nothing all is infinite
        return Importance(
            birnbaum=(c + s) * hangs / works,
            criticality=caused / fails,
            achievement=(fails + s * hangs) / fails,
            reduction=fails / _without(structure, (b, c, s), system, caused),
            improvement=caused / works,
        )


def _without(structure: Structure, units: tuple[Array, ...], system: Transition, caused: Array) -> Array:
    """P(the system fails) if one unit did not; solved anew for each unit that most of it hangs on, as digits ask."""
    found = np.asarray(system.fails - caused)
    flat = found.reshape(len(found), -1)
    b, c, s = (one.reshape(flat.shape) for one in units)
    most = np.argwhere(caused.reshape(flat.shape) > np.ravel(system.fails) / 2)
    turn = max(1, AT_ONCE // len(flat))
    for start in range(0, len(most), turn):
        unit, column = most[start : start + turn].T
        here = unit, np.arange(len(unit))
        before, during, after = b[:, column], c[:, column], s[:, column]
        after[here] += during[here]
        during[here] = 0
        flat[unit, column] = structure.transition(before, during, after).fails
    return found


def barlow_proschan(
    intensity: Callable[[Array], Array], curve: Curve, until: float = math.inf, tolerance: float = TOLERANCE
) -> Array:
    """Return P(this unit's failure fails the system, by a time), shape (units,): ∫ Iᵢ fᵢ dt, to a tolerance.

    ``intensity`` takes times, shape (n,), and gives Iᵢ·fᵢ, shape (units, n); ``curve`` is the system's. Over all units
    it adds up to P(the system fails by then). Barlow and Proschan, Stoch. Proc. Appl. 3 (1975).
    """
    edges = _edges(curve, until, tolerance)
    if not len(edges):
        return np.zeros(len(intensity(np.ones(1))))
    low, high = edges[:-1], edges[1:]
    settled = np.zeros(1)
    for _ in range(_DEEPEST):
        area, error = _panels(intensity, low, high)
        rough = np.max(error, axis=0) > tolerance / 100 * (settled.sum() + area.sum())
        settled = settled + area[:, ~rough].sum(axis=1)
        if not rough.any():
            break
        middle = (low + high)[rough] / 2
        low, high = np.append(low[rough], middle), np.append(middle, high[rough])
    found: Array = settled + area[:, rough].sum(axis=1)
    return found


_DEEPEST = 30
_LONGEST = 1e250  # a time beyond which nothing is asked
_STEP = 8.0
_ROUGHLY = 1e-3  # of ln time: panels may begin and end nearly anywhere


def _edges(curve: Curve, until: float, tolerance: float) -> Array:
    """ln of times, each with about _STEP times the system's cumulative hazard of the one before: smooth between."""
    end = min(until, _LONGEST)
    (fails,), (survives,) = curve(np.array([end]))
    if not fails > 0:
        return np.empty(0)
    most = -math.log1p(-fails) if fails < 0.5 else -math.log(max(survives, 1e-300))
    steps = math.ceil(math.log(1e3 / tolerance, _STEP))
    levels = min(most, 64.0) * _STEP ** np.arange(-steps, 1.0)
    if until == math.inf and most < 64.0:  # what may never fail gets there only at the end
        levels = np.sort(np.append(levels, most * (1 - 2.0 ** -np.arange(2.0, 44.0))))
    times = time_at(curve, -np.expm1(-levels), np.exp(-levels), tolerance=_ROUGHLY)
    times = np.unique(np.maximum.accumulate(times[(times > 0) & (times < end)]))
    if until < math.inf and most <= 64.0:
        times = np.append(times, end)
    if not len(times):
        return np.empty(0)
    edges = np.log(times)
    return np.append(edges[0] - 40, edges)  # e⁻⁴⁰ of the first time is below every digit


def _panels(intensity: Callable[[Array], Array], low: Array, high: Array) -> tuple[Array, Array]:
    """∫ over panels in x = ln t, and about how far off each is; shapes (units, panels)."""
    half = (high - low) / 2
    times = np.exp(low[:, None] + half[:, None] * (NODES + 1))
    units, found = len(intensity(times[0, :1])), []
    turn = max(1, AT_ONCE // (units * len(NODES)))
    for start in range(0, len(times), turn):
        some = times[start : start + turn]
        values = (intensity(some.ravel()) * some.ravel()).reshape(units, *some.shape)
        found.append(panel_areas(values * half[start : start + turn, None]))
    area, error = (np.concatenate(each, axis=1) for each in zip(*found, strict=True))
    return area, error
