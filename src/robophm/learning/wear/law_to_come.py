"""How long wear goes on, given that its law may change: from no past can it be known that it keeps it.

Two things are not known. The law may be a little other than it seems: the rest of life is off by a factor. And what
goes ever slower may not do so to its end: a fade that slows, as of a battery after its first cycles, is followed to
many times its age, and some day another mechanism takes over. Of both nothing is known but what was seen, so that the
end of the law, and the pace after it, have the distribution of things of which only the past is known (Gott, Nature
363, 1993): there is nothing to be set.
"""

from __future__ import annotations

import math

import numpy as np

from robophm.learning.wear.models.candidates import Array, DegradationPath, Indices

LAW = {0: 0.15, 1: 0.25, -1: 0.25}
"""Deviation of ln(rest of life) for the law that may change: of wear that is straight so far, that goes ever faster or
slower, for each doubling of wear that is still to come, of which there is at least one: a law is known as far as it was
seen, and wanders beyond. Of real wear it is some 0.1 to 0.6 for each unit; docs/theory/wear.md has where it is from."""

LEAST = 0.01
"""Wear, as a share of the way to the threshold, below which it is no further from there than six doublings and more."""

STEEPER = -0.2
"""Mean of the same where wear goes ever faster: near its end it mostly goes faster still than its law so far says."""


def off_by_a_factor(passage: Array, accelerates: Indices, course: DegradationPath, rng: np.random.Generator) -> Array:
    """Return passages by laws that are a little other than they seem; shapes (draws,)."""
    law = np.select([accelerates == 0, accelerates > 0], [LAW[0], LAW[1]], LAW[-1]) * rng.standard_normal(len(passage))
    law *= math.sqrt(max(1.0, -math.log2(max(float(course.smooth[-1]), LEAST))))
    result: Array = passage * np.exp(law + STEEPER * (accelerates > 0))
    return result


def given_slowing_ends(
    passage: Array, accelerates: Indices, course: DegradationPath, rng: np.random.Generator
) -> Array:
    """Return passages, of draws that slow down with another law after some time; shapes (draws,).

    Seen for so long, the slowing law goes on for s more with P = seen / (seen + s). What is then left of the way takes
    so long as it would have at the mean pace so far, times a factor that exceeds f with P = 1 / (1 + f). Where that
    would be later than by the law itself, it stays; so it does before there is any wear.
    """
    seen, wear = float(course.times[-1] - course.times[0]), float(course.smooth[-1])
    if not 0 < wear < 1:
        return passage
    lasts, slower = (1 / (1 - rng.random(len(passage))) - 1 for _ in range(2))
    lasts *= seen
    # Less than that is left of a way that was fastest at first, so this is rather late.
    left = 1 - np.minimum(lasts / np.maximum(passage, 1e-300), 1.0)
    ends = lasts + left * (1 - wear) / wear * seen * slower
    result: Array = np.where((accelerates < 0) & (lasts < passage), np.minimum(ends, passage), passage)
    return result
