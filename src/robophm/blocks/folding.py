"""The arithmetic of independent inputs: pairs in series and in parallel, and counts of a k-of-n.

Arrays hold (failed by now, works at the end, change) along their first axis. The change is the probability to fail
in a task, or the failure density; for a density, and for nothing but probabilities, now and the end are one moment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from robophm.blocks.decision_diagram import Array

FAILED, WORKS, CHANGE = 0, 1, 2


Call = Callable[[], object]
"""One piece of arithmetic on arrays that stay where they are."""


def merging(one: Array, other: Array, out: Array, scratch: Array, lost: int, held: int, task: bool) -> Iterator[Call]:
    """Yield the arithmetic that merges two inputs to one: in series, ``lost`` FAILED and ``held`` WORKS; else in
    parallel.

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
    """Return the outcome of a task for units in series; shape (numbers, n, columns) → (numbers, columns)."""
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
    """Return (works now, failed at the end)."""
    if not task:
        return units[WORKS], units[FAILED]
    return units[WORKS] + units[CHANGE], units[FAILED] + units[CHANGE]


FEW = 8
"""The most inputs that are counted one by one, all gates and columns at once; more by products of polynomials."""


def counting(k: int, inputs: Array, out: Array, task: bool) -> Iterator[Call]:
    """Yield the arithmetic of k of n inputs, shape (numbers, n, columns), into ``out``, shape (numbers, columns)."""
    numbers, n, columns = inputs.shape
    if n > FEW:
        yield partial(_by_products, k, inputs, out, task)
        return
    end = now = inputs[:CHANGE]  # (failed, works) of each
    if task:
        end, now = np.empty((2, *end.shape), inputs.dtype)
        yield partial(np.add, inputs[FAILED], inputs[CHANGE], end[FAILED])
        yield partial(np.copyto, end[WORKS], inputs[WORKS])
        yield partial(np.copyto, now[FAILED], inputs[FAILED])
        yield partial(np.add, inputs[WORKS], inputs[CHANGE], now[WORKS])
    # P(j of the inputs so far work), and P(j others work and one changes), those before it now, those after at the end
    counts = end[:, 0]
    if numbers > CHANGE:
        counts = np.zeros((2, 2, columns), inputs.dtype)
        yield partial(np.copyto, counts[0], end[:, 0])
        yield partial(np.copyto, counts[1, 0], inputs[CHANGE, 0])
        changed = np.empty((n, columns), inputs.dtype)
    before = now[:, 0]
    place = _Counts(counts.shape[:-2], n, columns, inputs.dtype)
    place_now = _Counts((), n if task else 0, columns, inputs.dtype)
    for i in range(1, n):
        calls, counts = place.one_more(counts, end[:, i])
        yield from calls
        if numbers > CHANGE:
            changing = counts[1, : i + 1]
            yield partial(np.multiply, before, inputs[CHANGE, i], changed[: i + 1])
            yield partial(np.add, changing, changed[: i + 1], changing)
        held = counts[0] if numbers > CHANGE else counts
        if task:
            calls, before = place_now.one_more(before, now[:, i])
            yield from calls
        else:
            before = held
    for number, terms in ((FAILED, before[:k]), (WORKS, held[k:])):
        if len(terms) == 1:
            yield partial(np.copyto, out[number], terms[0])
        for i in range(1, len(terms)):  # one by one: the order of a sum's additions depends on the number of columns
            yield partial(np.add, out[number] if i > 1 else terms[0], terms[i], out[number])
    if numbers > CHANGE:
        yield partial(np.copyto, out[CHANGE], counts[1, k - 1])


class _Counts:
    """Arrays for counts of shape (..., up to n + 1, columns), each made from the one before, which stays."""

    def __init__(self, shape: tuple[int, ...], n: int, columns: int, kind: np.dtype[Any]) -> None:
        self._turns = np.empty((2, *shape, n + 1, columns), kind)
        self._apart = np.zeros((2, *shape, n + 1, columns), kind)  # if one more has failed, and if it works
        self._n = n

    def one_more(self, counts: Array, chance: Array) -> tuple[list[Call], Array]:
        """Return the arithmetic of counts with one more input, which has failed or works by ``chance``.

        What has failed leaves the count, what works moves it by one: beyond either there is always nothing.
        """
        known = counts.shape[-2]
        failed, works = self._apart[0, ..., self._n - known :, :], self._apart[1, ..., : known + 1, :]
        made = self._turns[known % 2, ..., : known + 1, :]
        return [
            partial(np.multiply, counts, chance[FAILED], failed[..., :known, :]),
            partial(np.multiply, counts, chance[WORKS], works[..., 1:, :]),
            partial(np.add, failed, works, made),
        ], made


def counted(k: int, units: list[list[float]]) -> tuple[float, float, float]:
    """Return k of n for one column of a few units, each (failed, works, density), by plain numbers: to the last bit."""
    failed, works, density = units[0]
    count, changing = [failed, works], [density]
    for failed, works, density in units[1:]:
        changed = [one * density for one in count]
        count = _with(count, failed, works)
        changing = [one + other for one, other in zip(_with(changing, failed, works), changed, strict=True)]
    lost, held = count[0], count[k]
    for one in count[1:k]:
        lost += one
    for one in count[k + 1 :]:
        held += one
    return lost, held, changing[k - 1]


def _with(counts: list[float], failed: float, works: float) -> list[float]:
    """The probabilities of how many work, with one more input that may."""
    more = [one * works for one in counts]
    rest = [one * failed for one in counts]
    return [rest[0], *(one + other for one, other in zip(rest[1:], more[:-1], strict=True)), more[-1]]


def _by_products(k: int, inputs: Array, out: Array, task: bool) -> None:
    """Count of many inputs those that work up to k − 1, or those that have failed up to n − k, whatever is fewer."""
    most = min(k - 1, inputs.shape[1] - k)
    failures = most < k - 1
    up_to, beyond = (WORKS, FAILED) if failures else (FAILED, WORKS)
    for column in range(inputs.shape[2]):
        units = inputs[:, :, column]
        works, lost = sides(units, task)
        now, end = np.stack((units[FAILED], works)), np.stack((lost, units[WORKS]))
        if failures:
            now, end = now[::-1], end[::-1]
        change = units[CHANGE:]
        counted_now, counted_end, changing = _multiplied(_in_few(now), _in_few(end), _in_few(change), most, task)
        of = {FAILED: counted_now, WORKS: counted_end}
        out[up_to, column], out[beyond, column] = of[up_to].up_to.sum(), of[beyond].beyond
        if len(out) > CHANGE:
            out[CHANGE, column] = changing[most]


class _Count(NamedTuple):
    """The probabilities of 0, 1, … inputs up to a most, along the first axis, and of more."""

    up_to: Array
    beyond: Array | float

    def with_others(self, other: _Count, most: int) -> _Count:
        """Return the count of these inputs and others; every term is positive."""
        whole = _product(self.up_to, other.up_to)
        if len(whole) <= most + 1:
            return _Count(whole, 0.0)
        both = self.beyond * (other.up_to.sum(axis=0) + other.beyond) + other.beyond * self.up_to.sum(axis=0)
        return _Count(whole[: most + 1], whole[most + 1 :].sum(axis=0) + both)


_Counted = tuple[_Count, _Count, Array]
"""How many count now, and how many at the end, and P(j others count and one changes)."""


def _counted(now: Array, end: Array, change: Array, most: int, task: bool) -> _Counted:
    if now.shape[1] == 1:
        return _Count(now[:, 0], 0.0), _Count(end[:, 0], 0.0), change[:, 0]
    half = now.shape[1] // 2
    one, other = (_counted(now[:, side], end[:, side], change[:, side], most, task)
                  for side in (slice(half), slice(half, None)))  # fmt: skip
    return _joined(one, other, most, task)


def _joined(one: _Counted, other: _Counted, most: int, task: bool) -> _Counted:
    now = one[0].with_others(other[0], most)
    end = one[1].with_others(other[1], most) if task else now
    change = one[2]
    if len(change):
        first, second = _product(one[2], other[1].up_to), _product(one[0].up_to, other[2])
        change = first[: most + 1] + second[: most + 1]
    return now, end, change


def _product(one: Array, other: Array) -> Array:
    """The product of two polynomials, their coefficients along the first axis."""
    if one.ndim == 1:
        return np.convolve(one, other)
    if len(one) > len(other):
        one, other = other, one
    product = np.zeros((len(one) + len(other) - 1, *other.shape[1:]), other.dtype)
    for power, coefficient in enumerate(one):
        product[power : power + len(other)] += coefficient * other
    return product


def _in_few(units: Array) -> Array:
    """Inputs of shape (numbers, n) in columns of a few; what is missing there does not count."""
    columns = -(-units.shape[1] // FEW)
    filled = np.zeros((len(units), columns * FEW), units.dtype)
    filled[:, : units.shape[1]] = units
    if len(units) > 1:
        filled[0, units.shape[1] :] = 1
    return np.ascontiguousarray(filled.reshape(len(units), columns, FEW).transpose(0, 2, 1))


def _multiplied(now: Array, end: Array, change: Array, most: int, task: bool) -> _Counted:
    """The results of ``_counted`` for one column, given as columns of a few."""
    counted_now, counted_end, changing = _counted(now, end, change, most, task)
    parts = [
        (_of_column(counted_now, i), _of_column(counted_end, i), np.ascontiguousarray(changing[:, i]))
        for i in range(now.shape[2])
    ]
    while len(parts) > 1:
        parts = [
            _joined(parts[i], parts[i + 1], most, task) if i + 1 < len(parts) else parts[i]
            for i in range(0, len(parts), 2)
        ]
    return parts[0]


def _of_column(count: _Count, i: int) -> _Count:
    beyond = count.beyond if isinstance(count.beyond, float) else float(count.beyond[i])
    return _Count(np.ascontiguousarray(count.up_to[:, i]), beyond)


def exactly(k: int, inputs: Array) -> Array:
    """Return P(k of the other inputs work) for each of n independent ones, (numbers, n, columns) → (n, columns)."""
    n = inputs.shape[1]
    one = [np.ones((1, inputs.shape[2]), inputs.dtype)]
    before, after = one.copy(), one.copy()  # counts of the inputs before each, and after each
    for i in range(n - 1):
        before.append(_product(inputs[: WORKS + 1, i], before[-1])[: k + 1])
        after.append(_product(inputs[: WORKS + 1, n - 1 - i], after[-1])[: k + 1])
    found = np.zeros(inputs.shape[1:], inputs.dtype)
    for i, (first, last) in enumerate(zip(before, reversed(after), strict=True)):
        for j in range(max(0, k + 1 - len(last)), min(k + 1, len(first))):
            found[i] += first[j] * last[k - j]
    return found
