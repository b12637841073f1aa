"""Common-cause groups of an Open-PSA model: each member becomes the "or" of its own failure and of shared ones.

The models are those of ``blocks.common_cause``, of probabilities: a part's is divided among itself and its groups, so
that an event of k members has the probability Q_k. The alpha factors are of non-staggered testing, as in SCRAM; the
phi factors state Q_k/Q_t themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import NamedTuple

from robophm.blocks.common_cause import MOST_PARTS, Shares, alpha_factor, beta_factor, multiple_greek_letter
from robophm.core.errors import StructureError, nearest
from robophm.core.markup import Element
from robophm.design.importers.open_psa.expressions import Expressions
from robophm.design.importers.open_psa.names import name_of

_MODELS = ("beta-factor", "MGL", "alpha-factor", "phi-factor")


class Group(NamedTuple):
    """A group as it is defined: its element, the names of its members, and the path of what it stands in."""

    said: Element
    members: tuple[str, ...]
    base: str


def members(said: Element) -> list[Element]:
    """Return the elements that define the members of a group. Raises DesignError for less than two, or one twice."""
    found = [one for part in said.each("members") for one in part.inside()]
    names = [name_of(one) for one in found]
    if len(names) < 2:
        raise said.fault(f"common-cause group '{name_of(said)}' has {len(names)} members; expected at least two")
    for one, name in zip(found, names, strict=True):
        if names.count(name) > 1:
            raise one.fault(f"'{name}' is twice a member of '{name_of(said)}'")
    return found


def causes(group: Group, expressions: Expressions) -> Iterator[tuple[tuple[str, ...], float]]:
    """Yield the members that fail together, or one alone, and the probability of that. Raises DesignError."""
    said, names = group.said, group.members
    distribution = list(said.each("distribution"))
    if len(distribution) != 1:
        raise said.fault(f"common-cause group '{name_of(said)}' has no distribution; expected one")
    whole, _ = expressions.probability(distribution[0], group.base)
    try:
        shares = _shares(said, len(names), _factors(said, expressions))
    except StructureError as error:
        raise said.fault(f"common-cause group '{name_of(said)}': {error}") from None
    for k, share in enumerate(shares, 1):
        if share > 0:
            for together in combinations(names, k):
                yield together, share * whole


def _factors(said: Element, expressions: Expressions) -> dict[int, float]:
    """The factors by their levels; of a factor without a level, the next one."""
    listed = [*said.each("factor"), *(one for part in said.each("factors") for one in part.each("factor"))]
    first = {"MGL": 2, "beta-factor": 0}.get(said.attributes.get("model", ""), 1)
    found: dict[int, float] = {}
    for one in listed:
        text = one.attributes.get("level", str(first + len(found)) if first else "0")
        inside = list(one.inside())
        if not (text.isascii() and text.isdigit()) or len(text) > 3 or int(text) in found or len(inside) != 1:
            raise one.fault(f"factor of level {text!r:.20}; expected each level once, with one expression")
        found[int(text)] = expressions.value(inside[0])
    if not found:
        raise said.fault(f"common-cause group '{name_of(said)}' has no factors")
    return found


def _shares(said: Element, n: int, factors: Mapping[int, float]) -> Shares:
    model = said.attributes.get("model", "")
    levels = sorted(factors)
    if model not in _MODELS:
        raise said.fault(f"common-cause model {model!r:.40} is not taken{nearest(model, _MODELS)}")
    if model == "beta-factor":
        if levels not in ([0], [n]):
            raise StructureError(f"beta factor of level {levels}; expected one, of level {n}")
        return beta_factor(factors[levels[0]], n)
    first = 2 if model == "MGL" else 1
    if levels != list(range(first, first + len(levels))) or levels[-1] > n:
        raise StructureError(f"factors of the levels {levels}; expected {first}, {first + 1} … at most {n}")
    values = [factors.get(level, 0.0) for level in range(first, n + 1)]
    if model == "MGL":
        return multiple_greek_letter(values, n)
    if model == "alpha-factor":
        return alpha_factor([one / (sum(values) or 1.0) for one in values], n, staggered=False)
    if n > MOST_PARTS:
        raise StructureError(f"{n} members; expected at most {MOST_PARTS}: each set of them may fail together")
    if not all(one >= 0 for one in values) or abs(sum(values) - 1) > 1e-3:
        raise StructureError(f"phi factors {values}; expected some of at least 0 that add up to 1")
    return tuple(values)
