"""Along what ages grow: one line through the ages of all failure modes of a group, straight between its corners.

What matters to a group is only how the ages of its members go together, not when: time may be told by any clock
that advances with them. Steps in the same direction therefore make one straight piece, whatever each adds.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Rows = npt.NDArray[np.intp]


class Path:
    """The ages of failure modes as functions of a time s ≥ 0 of any unit; the last piece has no end."""

    def __init__(self, modes: int) -> None:
        self.corners = np.zeros(1)
        """Times when pieces begin, shape (pieces,)."""
        self.gained = np.zeros((1, modes))
        """Ages that the modes have gained by then, shape (pieces, modes)."""
        self.speed = np.zeros((1, modes))
        """Ageing of the modes per unit of time along each piece, shape (pieces, modes)."""
        self.end = 0.0
        """Time until which steps have been added."""

    def add(self, step: Array) -> tuple[float, float]:
        """Add a step in which the modes age so much, shape (modes,); return when it begins and how long it takes."""
        begin, speed = self.end, self.speed[-1]
        if not step.any():
            return begin, 0.0
        length = float(step @ speed) / float(speed @ speed) if speed.any() else 0.0
        if not np.allclose(step, length * speed, rtol=1e-12, atol=0.0):
            if speed.any():
                self.gained = np.vstack((self.gained, self.gained[-1] + speed * (begin - self.corners[-1])))
                self.corners = np.append(self.corners, begin)
                self.speed = np.vstack((self.speed, step))
            else:
                self.speed = step[None]
            length = 1.0
        self.end += length
        return begin, length

    def steps(self, steps: Iterable[Array]) -> tuple[Array, Array]:
        """Add several steps, one after the other; return when they begin and how long they take."""
        begin, length = np.array([self.add(step) for step in steps]).reshape(-1, 2).T
        return begin, length

    def piece(self, s: Array) -> Rows:
        """Return the piece on which a time lies; at a corner the later one."""
        if len(self.corners) == 1:
            return np.zeros(np.shape(s), dtype=np.intp)
        return np.searchsorted(self.corners, s, side="right") - 1

    def at(self, s: Array) -> list[Array]:
        """Return the age that each mode has gained by ``s``; arrays of the shape of ``s``."""
        p = self.piece(s)
        into = s - self.corners[p]
        return [self.gained[p, j] + self.speed[p, j] * into for j in range(self.speed.shape[1])]

    def when(self, mode: int, gained: Array) -> Array:
        """Return when a mode has aged so much; infinite for never."""
        p = np.maximum(np.searchsorted(self.gained[:, mode], gained, side="right") - 1, 0)
        rest, speed = np.maximum(gained - self.gained[p, mode], 0.0), self.speed[p, mode]
        with np.errstate(all="ignore"):
            return self.corners[p] + np.where(rest > 0, rest / speed, 0.0)

    def between(self, start: Array, length: Array) -> list[Array]:
        """Return the age that each mode gains in a stretch; ``length`` has its own digits."""
        p, end = self.piece(start), start + length
        if len(self.corners) == 1:
            return [self.speed[0, j] * length for j in range(self.speed.shape[1])]
        # The end of a stretch is on its start's piece, unless it lies beyond.
        last = np.maximum(np.searchsorted(self.corners, end, side="left") - 1, p)
        following = np.minimum(p + 1, len(self.corners) - 1)
        out, into = self.corners[following] - start, end - self.corners[last]
        return [
            np.where(
                last == p,
                self.speed[p, j] * length,
                self.speed[p, j] * out
                + (self.gained[last, j] - self.gained[following, j])
                + self.speed[last, j] * into,
            )
            for j in range(self.speed.shape[1])
        ]
