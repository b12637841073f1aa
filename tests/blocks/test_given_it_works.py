"""What lies ahead of random diagrams that work now, against the sum over all fates of their units in mpmath.

Each unit has failed before, fails meanwhile, or survives.
"""

import random
from itertools import product

import mpmath as mp
import numpy as np
from numpy.testing import assert_allclose
from tests.cases import each_case

from robophm.blocks.diagram import Block
from robophm.blocks.given_it_works import StructureGivenItWorks

from ..structures import draw, works

TIMES = 3
DIGITS = 1e-12


def hazards(rng: np.random.Generator, *shape: int) -> np.ndarray:
    return 10 ** rng.uniform(-12, 1, shape)


def by_fates(diagram: Block, names: list[str], known: np.ndarray, more: np.ndarray) -> tuple[float, float]:
    """P(fails meanwhile) and P(survives it), given that it works now; hazards of shape (units,)."""
    with mp.workdps(60):
        chance = []
        for past, ahead in zip(known.tolist(), more.tolist(), strict=True):
            alive = mp.exp(-mp.mpf(past))
            chance.append((-mp.expm1(-mp.mpf(past)), alive * -mp.expm1(-mp.mpf(ahead)), alive * mp.exp(-mp.mpf(ahead))))
        fates = np.array(list(product(range(3), repeat=len(names))))
        now, then = (works(diagram, {name: fates[:, i] >= least for i, name in enumerate(names)}) for least in (1, 2))
        fails = survives = mp.mpf(0)
        for fate in np.flatnonzero(now):
            p = mp.fprod(chance[unit][one] for unit, one in enumerate(fates[fate].tolist()))
            fails, survives = (fails, survives + p) if then[fate] else (fails + p, survives)
        return float(fails / (fails + survives)), float(survives / (fails + survives))


def expected(diagram: Block, names: list[str], known: np.ndarray, more: np.ndarray) -> np.ndarray:
    """The same of hazards of shape (units, times); shape (2, times)."""
    columns = zip(*(one.T for one in np.broadcast_arrays(known, more)), strict=True)
    return np.array([by_fates(diagram, names, *column) for column in columns]).T


@each_case("past", ["new", "some new", "lived"])
@each_case("seed", range(20))
def test_by_all_fates(seed: int, past: str) -> None:
    rng = random.Random(seed)
    diagram = draw(rng, ["a", "b", "c", "d"], rng.randint(1, 8))
    conditional = StructureGivenItWorks(diagram)
    names, numbers = list(conditional.structure.names), np.random.default_rng(seed)
    known, more = hazards(numbers, len(names), 1), hazards(numbers, len(names), TIMES)
    if past != "lived":
        known[: 1 if past == "some new" else None] = 0.0
    exact = expected(diagram, names, known, more)
    assert_allclose(conditional.given(known)(more), exact, rtol=DIGITS)
    for i in range(TIMES):
        assert_allclose(conditional.ahead(known[:, 0], more[:, i]), exact[:, i], rtol=DIGITS)


@each_case("new", [True, False])
@each_case(("known_shape", "more_shape"), [((1, TIMES), (2, 1)), ((1, 1), (2, TIMES)), ((2, TIMES), (1, 1)), ((), ())])
def test_shapes_broadcast_for_several_diagrams(
    known_shape: tuple[int, ...], more_shape: tuple[int, ...], new: bool
) -> None:
    rng, numbers = random.Random(5), np.random.default_rng(5)
    diagrams = [draw(rng, list(names), 6) for names in ("abc", "xyz")]
    conditional = StructureGivenItWorks(*diagrams)
    names = conditional.structure.names
    known = hazards(numbers, len(names), *known_shape) * (not new)
    more = hazards(numbers, len(names), *more_shape)
    found = np.stack(conditional.given(known)(more))
    wide = np.broadcast_shapes(known_shape, more_shape)
    assert found.shape == (2, 2, *wide)
    for i, diagram in enumerate(diagrams):
        own = list(StructureGivenItWorks(diagram).structure.names)
        rows = [names.index(name) for name in own]
        flat = (np.broadcast_to(one, (len(names), *wide))[rows].reshape(len(own), -1) for one in (known, more))
        assert_allclose(found[:, i].reshape(2, -1), expected(diagram, own, *flat), rtol=DIGITS)
