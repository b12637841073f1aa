"""Parametric models of common cause failure: how much of a part's failures it shares with parts like it.

A model says which share of a part's failures, by rate or by probability, is due to a cause that fails exactly a given
set of k of the n parts of a group: Q_k / Q_t. Each such set has a cause of its own, a unit that is drawn in series with
each of its parts.

Sources: Mosleh et al., "Procedures for treating common cause failures in safety and reliability studies", NUREG/CR-4780
(1988), for beta factor and multiple Greek letter; Mosleh, Rasmuson and Marshall, "Guidelines on modeling common-cause
failures in probabilistic risk assessment", NUREG/CR-5485 (1998), for alpha factor under both testing schemes.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from math import comb, isclose

from robophm.core.errors import StructureError

Shares = tuple[float, ...]
"""Shares of one part of n: at k − 1, the share of its failures that any one set of k parts, it among them, has in
common.
"""

MOST_PARTS = 8
"""The most parts of a group any set of which may fail together; there are 2ⁿ sets."""


def beta_factor(beta: float, parts: int) -> Shares:
    """Return shares by which a part ``beta`` of failures takes all parts, the rest one alone. Raises StructureError."""
    _check(parts)
    if not 0 <= beta < 1:
        raise StructureError(f"beta {beta:g}; expected 0 ≤ beta < 1")
    return (1 - beta, *[0.0] * (parts - 2), beta)


def multiple_greek_letter(letters: Sequence[float], parts: int) -> Shares:
    """Return the shares Q_k/Q_t = ρ₁ρ₂…ρ_k (1 − ρ_k₊₁) / C(n−1, k−1), with ρ₁ = 1 and ρ_n₊₁ = 0.

    ``letters`` are ρ₂ … ρ_n = β, γ, δ …: the share of the failures of at least k − 1 parts that takes at least k.
    Raises StructureError.
    """
    _check(parts, MOST_PARTS)
    if len(letters) != parts - 1:
        raise StructureError(f"mgl has {len(letters)} letters for {parts} parts; expected {parts - 1}")
    if not all(0 <= one <= 1 for one in letters) or not letters[0] < 1:
        raise StructureError(f"mgl {list(letters)}; expected 0 ≤ beta < 1 and the others from 0 to 1")
    rho = [1.0, *letters, 0.0]
    shares, reached = [], 1.0
    for k in range(1, parts + 1):
        reached *= rho[k - 1]
        shares.append(reached * (1 - rho[k]) / comb(parts - 1, k - 1))
    return tuple(shares)


def alpha_factor(alpha: Sequence[float], parts: int, *, staggered: bool = True) -> Shares:
    """Return shares from ``alpha``: at k − 1, the share of the group's failure events in which exactly k parts fail.

    Staggered testing Q_k/Q_t = α_k / C(n−1, k−1), else k·α_k / (α_t C(n−1, k−1)) with α_t = Σ k·α_k.
    Raises StructureError.
    """
    _check(parts, MOST_PARTS)
    if len(alpha) != parts:
        raise StructureError(f"alpha has {len(alpha)} factors for {parts} parts; expected {parts}")
    if not all(0 <= one <= 1 for one in alpha) or not alpha[0] > 0:
        raise StructureError(f"alpha {list(alpha)}; expected the first above 0 and all from 0 to 1")
    if not isclose(sum(alpha), 1.0, abs_tol=1e-3):  # as printed factors do, but for their digits
        raise StructureError(f"alpha adds up to {sum(alpha):g}; expected 1")
    weight = [one if staggered else k * one for k, one in enumerate(alpha, 1)]
    total = sum(weight)  # of staggered testing 1, but for the digits that were written
    return tuple(one / total / comb(parts - 1, k) for k, one in enumerate(weight))


def shared_causes(shares: Shares) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield the sets of parts, by number, that a cause fails together, and its share of each one's failures."""
    for k, share in enumerate(shares[1:], 2):
        if share > 0:
            for together in combinations(range(len(shares)), k):
                yield together, share


def _check(parts: int, most: int | None = None) -> None:
    if parts < 2:
        raise StructureError(f"{parts} part; expected at least two that can fail together")
    if most is not None and parts > most:
        raise StructureError(f"{parts} parts; expected at most {most}: each set of them may fail together")
