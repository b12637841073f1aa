"""Sudden falls of wear: a rest, after which it goes on as before, or maintenance, after which it is as if new."""

from __future__ import annotations

import math

import numpy as np

from robophm.learning.wear.models.candidates import Array

EVENT, RENEWED, MATTERS = 5.0, 0.5, 0.2
"""The smallest sudden falls of wear that count. A rest: deviations of a step; after maintenance also shares of all wear
so far, and of that from the first reading to the threshold."""

BESIDE = 5
"""Readings before and after a fall whose medians say whether it lasted."""

OF_LATE = 50
"""Steps before one, by which it is told how much they usually differ: a machine that wears vibrates unevenly."""

DUST = 1e-9
"""Share of all that readings span below which a difference of steps is one of rounding."""


def recoveries(times: Array, wear: Array, threshold: float) -> tuple[Array, float]:
    """Return times of sudden falls, by more than ``EVENT`` deviations of a step, and the time since when it is renewed.

    After maintenance, which takes off ``RENEWED`` of all wear and ``MATTERS`` of the way to the threshold or more, what
    was before says nothing of what comes; a battery that rested goes on as before, and its recoveries are part of its
    trend.
    """
    steps = np.diff(wear)
    off = np.abs(steps - np.median(steps))
    dust = DUST * float(np.ptp(wear))
    different = off[off > dust]
    # A signal of few digits mostly stands still, and its least step is no fall.
    least = max(1.4826 * float(np.median(off)), float(different.min()) if len(different) else dust)
    usual = np.maximum(1.4826 * before(off, OF_LATE), least)
    led_away = max(-float(np.median(steps)), 0.0)  # a fall is at once where it is twice that, however even steps are
    fell = np.flatnonzero(-steps - led_away > np.maximum(EVENT * usual, led_away))
    matters = MATTERS * (threshold - wear[0])
    large = [k for k in fell.tolist() if -steps[k] > max(RENEWED * (wear[: k + 1].max() - wear[0]), matters)]
    # It was up and stays down: otherwise it was bad readings.
    large = [
        k for k in large
        if np.median(wear[max(k + 1 - BESIDE, 0) : k + 1]) - np.median(wear[k + 1 : k + 1 + BESIDE]) > -steps[k] / 2
    ]  # fmt: skip
    return times[fell + 1], float(times[large[-1] + 1]) if large else -math.inf


def before(values: Array, count: int) -> Array:
    """Return the median of so many values before each, of fewer at the start; shape of ``values``."""
    padded = np.concatenate([np.full(count, np.nan), values[:-1]])
    windows = np.lib.stride_tricks.sliding_window_view(padded, count).copy()
    windows[0, -1] = values[0]
    result: Array = np.nanmedian(windows, axis=1)
    return result
