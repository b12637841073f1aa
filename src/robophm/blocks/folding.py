"""The arithmetic of independent inputs: pairs in series and in parallel, and counts of a k-of-n.

Arrays hold (failed by now, works at the end, change) along their first axis. The change is the probability to fail
in a task, or the failure density; for a density, and for nothing but probabilities, now and the end are one moment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from robophm.blocks.decision_diagram import Array

FAILED, WORKS, CHANGE = 0, 1, 2


Call = Callable[[], object]
"""One piece of arithmetic on arrays that stay where they are."""


def merging(one: Array, other: Array, out: Array, scratch: Array, lost: int, held: int, task: bool) -> Iterator[Call]:
    """Two inputs as one: in series with ``lost`` FAILED and ``held`` WORKS, in parallel the other way round.

    What the first has lost or, while the first holds, the second has lost is lost. A change of the system is one of
    the first while the second holds now, or one of the second while the first holds at the end. ``scratch`` is an
    array like one of the numbers.
    """
    if task:
        yield partial(np.add, one[held], one[CHANGE], scratch)
        yield partial(np.multiply, scratch, other[lost], out[lost])
        yield partial(np.multiply, one[held], other[held], out[held])
        yield partial(np.multiply, one[held], other[CHANGE], out[CHANGE])
        yield partial(np.add, other[held], other[CHANGE], scratch)
        yield partial(np.multiply, one[CHANGE], scratch, scratch)
        yield partial(np.add, out[CHANGE], scratch, out[CHANGE])
    else:
        yield partial(np.multiply, one[held], other, out)
        if len(out) > CHANGE:
            yield partial(np.multiply, one[CHANGE], other[held], scratch)
            yield partial(np.add, out[CHANGE], scratch, out[CHANGE])
    yield partial(np.add, out[lost], one[lost], out[lost])


def in_series(units: Array) -> Array:
    """What a task makes of all of them together; shape (numbers, n, columns) → (numbers, columns)."""
    while units.shape[1] > 1:
        half = units.shape[1] // 2
        merged = np.empty_like(units, shape=(len(units), half, units.shape[2]))
        for call in merging(
            units[:, :half], units[:, half : 2 * half], merged, np.empty_like(merged[0]), FAILED, WORKS, task=True
        ):
            call()
        units = np.concatenate((units[:, 2 * half :], merged), axis=1)
    return units[:, 0]


def sides(units: Array, task: bool) -> tuple[Array, Array]:
    """(works now, failed at the end)."""
    if not task:
        return units[WORKS], units[FAILED]
    return units[WORKS] + units[CHANGE], units[FAILED] + units[CHANGE]


_FEW = 8
"""So many inputs are counted one by one, all gates and columns at once; more by products of their polynomials."""


def at_least(k: int, inputs: Array, out: Array, task: bool) -> None:
    """k of n independent inputs, shape (numbers, n, columns), into ``out``, shape (numbers, columns)."""
    if inputs.shape[1] <= _FEW:
        _decide(k, _counted(inputs, task), out)
        return
    for column in range(inputs.shape[2]):
        _decide(k, _multiplied(_in_few(inputs[:, :, column]), task), out[:, column])


def _decide(k: int, counts: tuple[Array, Array, Array], out: Array) -> None:
    now, end, change = counts
    out[FAILED] = _total(now[:k])
    out[WORKS] = _total(end[k:])
    if len(out) > CHANGE:
        out[CHANGE] = change[k - 1]


def _total(terms: Array) -> Array:
    total: Array = terms.sum() if terms.ndim == 1 else terms[0]
    if terms.ndim == 1:
        return total
    for term in terms[1:]:  # not sum(): the order of its additions depends on the number of columns
        total = total + term
    return total


def _counted(inputs: Array, task: bool) -> tuple[Array, Array, Array]:
    """Along the first axis: P(j work now), P(j work at the end), and P(j others work and one changes)."""
    if inputs.shape[1] == 1:
        works, lost = sides(inputs[:, 0], task)
        end = inputs[: WORKS + 1, 0]
        now = end
        if task:
            now, end = np.stack((end[FAILED], works)), np.stack((lost, end[WORKS]))
        return now, end, inputs[CHANGE:, 0]
    half = inputs.shape[1] // 2
    return _joined(_counted(inputs[:, :half], task), _counted(inputs[:, half:], task), task)


def _joined(
    one: tuple[Array, Array, Array], other: tuple[Array, Array, Array], task: bool
) -> tuple[Array, Array, Array]:
    now = _product(one[0], other[0])
    end = _product(one[1], other[1]) if task else now
    change = _product(one[2], other[1]) + _product(one[0], other[2]) if len(one[2]) else one[2]
    return now, end, change


def _product(one: Array, other: Array) -> Array:
    """Of two polynomials, their coefficients along the first axis."""
    if one.ndim == 1:
        return np.convolve(one, other)
    if len(one) > len(other):
        one, other = other, one
    product = np.zeros((len(one) + len(other) - 1, *other.shape[1:]))
    for power, coefficient in enumerate(one):
        product[power : power + len(other)] += coefficient * other
    return product


def _in_few(units: Array) -> Array:
    """Inputs of shape (numbers, n) in columns of a few; what is missing there has failed."""
    columns = -(-units.shape[1] // _FEW)
    filled = np.zeros((len(units), columns * _FEW))
    filled[:, : units.shape[1]] = units
    filled[FAILED, units.shape[1] :] = 1.0
    return np.ascontiguousarray(filled.reshape(len(units), columns, _FEW).transpose(0, 2, 1))


def _multiplied(few: Array, task: bool) -> tuple[Array, Array, Array]:
    """As ``_counted``, of one column given as columns of a few."""
    now, end, change = (np.ascontiguousarray(one.T) for one in _counted(few, task))
    parts = list(zip(now, end, change, strict=True))
    while len(parts) > 1:
        parts = [
            _joined(parts[i], parts[i + 1], task) if i + 1 < len(parts) else parts[i] for i in range(0, len(parts), 2)
        ]
    return parts[0]


def exactly(k: int, inputs: Array) -> Array:
    """P(k of the other inputs work) of each of n independent ones, shapes (numbers, n, columns) → (n, columns)."""
    n = inputs.shape[1]
    one = [np.ones((1, inputs.shape[2]))]
    before, after = one.copy(), one.copy()  # counts of the inputs before each, and after each
    for i in range(n - 1):
        before.append(_product(inputs[: WORKS + 1, i], before[-1])[: k + 1])
        after.append(_product(inputs[: WORKS + 1, n - 1 - i], after[-1])[: k + 1])
    found = np.zeros(inputs.shape[1:])
    for i, (first, last) in enumerate(zip(before, reversed(after), strict=True)):
        for j in range(max(0, k + 1 - len(last)), min(k + 1, len(first))):
            found[i] += first[j] * last[k - j]
    return found
