"""Importances against the sum over all states, closed forms, printed figures and what must hold of any structure."""

import itertools
import math
import random
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from numpy.testing import assert_allclose

from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit
from robophm.blocks.importance import barlow_proschan, importance
from robophm.blocks.reliability import Structure

from ..structures import draw, works
from .test_identities import chances, diagrams, dual, every, seeds, stages


def failing(block: Block, names: tuple[str, ...], units: list[list[Fraction]]) -> tuple[Fraction, Fraction]:
    """P(works now), and P(works now and has failed by the end), from the chances (before, during, after) of units."""
    states = np.array(list(itertools.product((0, 1, 2), repeat=len(names))))
    now, end = (works(block, {name: states[:, i] >= k for i, name in enumerate(names)}) for k in (1, 2))
    alive = fails = Fraction(0)
    for state, works_now, works_then in zip(states.tolist(), now, end, strict=True):
        chance = math.prod(units[i][k] for i, k in enumerate(state))
        alive += chance if works_now else 0
        fails += chance if works_now and not works_then else 0
    return alive, fails


def intensity(structure, works, failed, density):
    """Iᵢ·fᵢ: how often each unit's failure is the one that fails the system."""
    return structure.birnbaum(works, failed) * density


@pytest.mark.parametrize("seed", range(40))
def test_every_measure_is_what_it_is_said_to_be(seed: int) -> None:
    rng = random.Random(seed)
    size = rng.randint(1, 6)
    block = draw(rng, [f"u{i}" for i in range(size)], rng.randint(size, 2 * size))
    structure = Structure(block)
    units = []
    for _ in structure.names:
        parts = [rng.choice([0, rng.randint(1, 2**20), rng.randint(1, 50)]) for _ in range(2)]
        whole = 2**22
        units.append([Fraction(x, whole) for x in (parts[0], parts[1], whole - sum(parts))])
    alive, fails = failing(block, structure.names, units)
    found = importance(structure, *(np.array([float(unit[k]) for unit in units]) for k in range(3)))
    for i, (b, c, s) in enumerate(units):
        safe = failing(block, structure.names, [*units[:i], [b, Fraction(0), c + s], *units[i + 1 :]])[1]
        lost = failing(block, structure.names, [*units[:i], [b, c + s, Fraction(0)], *units[i + 1 :]])[1]
        expected = {
            "birnbaum": (lost - safe) / alive,
            "improvement": (fails - safe) / alive,
            "criticality": (fails - safe) / fails if fails else math.nan,
            "achievement": lost / fails if fails else math.inf if lost else math.nan,
            "reduction": fails / safe if safe else math.inf if fails else math.nan,
        }
        for measure, value in expected.items():
            if value is math.nan and measure == "reduction":  # nothing to reduce: the system cannot fail
                continue
            assert getattr(found, measure)[i] == pytest.approx(float(value), rel=1e-12, nan_ok=True), measure


def test_nothing_is_lost_where_all_hangs_on_one_unit() -> None:
    """RRW of 1e18: the failure without the unit is solved for, not subtracted."""
    structure = Structure(Series("a", Parallel("b", "c")))
    failed = np.array([1e-2, 1e-10, 1e-10])
    found = importance(structure, 0.0, failed, 1 - failed)
    assert found.reduction[0] == pytest.approx(1e-2 / 1e-20, rel=1e-12)
    alone = importance(Structure(Parallel("a", "b")), 0.0, np.array([1e-30, 0.5]), np.array([1.0, 0.5]))
    assert alone.reduction.tolist() == [math.inf, math.inf]
    assert_allclose(alone.criticality, 1.0, rtol=1e-15)


PRINTED = {
    "PTC Windchill practitioner's guide, an OR gate": (
        Series("A", "B"), {"A": 0.1, "B": 0.2}, 1e-12, {"birnbaum": {"A": 0.8, "B": 0.9}},
    ),
    "RePyability 0.15, NonRepairableRBD.criticality_importance and FaultTree": (
        Series(Parallel("p1", "p2"), "v"), {"p1": 0.1, "p2": 0.1, "v": 0.05}, 5.1e-5, {
            "birnbaum": {"p1": 0.095, "p2": 0.095, "v": 0.99},
            "criticality": {"p1": 0.1597, "p2": 0.1597, "v": 0.8319},
        },
    ),
    "RePyability 0.15, the same, RAW and RRW": (
        Series(Parallel("p1", "p2"), "v"), {"p1": 0.1, "p2": 0.1, "v": 0.05}, 5.1e-3, {
            "achievement": {"p1": 2.44, "v": 16.81}, "reduction": {"p1": 1.19, "v": 5.95},
        },
    ),
    "SCRAM, tests/risk_analysis_tests.cc, ImportanceDefault": (
        Parallel(Series("ValveOne", "PumpOne"), Series("ValveTwo", "PumpTwo")),
        {"ValveOne": 0.4, "PumpOne": 0.6, "ValveTwo": 0.5, "PumpTwo": 0.7}, 5.1e-4, {
            "birnbaum": {"PumpOne": 0.51, "PumpTwo": 0.38, "ValveOne": 0.34, "ValveTwo": 0.228},
            "criticality": {"PumpOne": 0.4737, "PumpTwo": 0.4118, "ValveOne": 0.2105, "ValveTwo": 0.1765},
            "achievement": {"PumpOne": 1.316, "PumpTwo": 1.176, "ValveOne": 1.316, "ValveTwo": 1.176},
            "reduction": {"PumpOne": 1.9, "PumpTwo": 1.7, "ValveOne": 1.267, "ValveTwo": 1.214},
        },
    ),
    "RePyability 0.15, importances_given_state: a pair, one of which is 60 h old, after 20 h more": (
        Parallel("old", "new"), {"old": -math.expm1(0.6**2 - 0.8**2), "new": -math.expm1(-(0.2**2))}, 5.1e-5,
        {"birnbaum": {"old": 0.0392, "new": 0.2442}},
    ),
}  # fmt: skip


@pytest.mark.parametrize("source", PRINTED)
def test_printed_figures(source: str) -> None:
    block, failed, tolerance, expected = PRINTED[source]
    structure = Structure(block)
    q = np.array([failed[name] for name in structure.names])
    found = importance(structure, 0.0, q, 1 - q)
    for measure, values in expected.items():
        said = dict(zip(structure.names, getattr(found, measure), strict=True))
        for name, value in values.items():
            assert said[name] == pytest.approx(value, abs=tolerance, rel=0), (measure, name)


@every
@given(diagrams, seeds)
def test_intensities_add_up_to_the_hazard_of_the_system(block, seed):
    """Σ Iᵢ fᵢ / R = f / R."""
    structure = Structure(block)
    p, q = chances(seed, len(structure.names))
    f = np.random.default_rng(seed).uniform(0.1, 2, len(p)) * p
    state = structure.state(p, q, f)
    assert_allclose((structure.birnbaum(p, q) * f).sum() / state.works, state.density / state.works, rtol=1e-11)


@every
@given(diagrams, seeds)
def test_a_diagram_and_its_dual_hang_on_the_same_units(block, seed):
    one, other = Structure(block), Structure(dual(block))
    p, q = chances(seed, len(one.names))
    assert_allclose(other.birnbaum(q, p), one.birnbaum(p, q), rtol=1e-12, atol=1e-290)


@every
@given(diagrams, seeds)
def test_measures_hang_together(block, seed):
    structure = Structure(block)
    b, c, s = stages(seed, len(structure.names), 3)
    system, found = structure.transition(b, c, s), importance(structure, b, c, s)
    fails = system.fails / (system.fails + system.survives)
    assert np.all(found.criticality <= 1 + 1e-12)
    assert_allclose(found.improvement, found.criticality * fails, rtol=1e-11, atol=1e-290)
    assert_allclose(found.improvement, found.birnbaum * c / (c + s), rtol=1e-11, atol=1e-290)
    assert_allclose(1 / found.reduction, 1 - found.criticality, rtol=1e-9, atol=1e-12)
    assert_allclose((found.achievement - 1) * fails, found.birnbaum * s / (c + s), rtol=1e-6, atol=1e-12)


def test_trailing_axes_are_evaluated_apart() -> None:
    structure = Structure(KOutOfN(2, "a", Series("b", "c"), "d"))
    b, c, s = (np.array(one).reshape(2, 3, 4).transpose(2, 0, 1) for one in stages(5, 24, 3))
    together = importance(structure, b, c, s)
    for i, j in np.ndindex(2, 3):
        alone = importance(structure, b[:, i, j], c[:, i, j], s[:, i, j])
        for one, other in zip(together, alone, strict=True):
            assert_allclose(one[:, i, j], other, rtol=1e-13)


class Lives:
    """Weibull lives of the units of a diagram."""

    def __init__(self, block: Block, scale: dict[str, float], shape: dict[str, float] | None = None) -> None:
        self.structure = Structure(block)
        self.rate = np.array([1 / scale[name] for name in self.structure.names])[:, None]
        self.shape = np.array([(shape or {}).get(name, 1.0) for name in self.structure.names])[:, None]

    def state(self, hours: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        with np.errstate(over="ignore"):  # so far ahead that nothing works
            hazard = np.minimum((self.rate * hours) ** self.shape, 1e300)
        density = self.shape * hazard / hours * np.exp(-hazard)
        return np.exp(-hazard), -np.expm1(-hazard), density

    def caused(self, until: float = math.inf) -> dict[str, float]:
        def curve(hours):
            return self.structure.probability(*self.state(hours)[:2])[::-1]

        found = barlow_proschan(lambda hours: intensity(self.structure, *self.state(hours)), curve, until)
        return dict(zip(self.structure.names, found.tolist(), strict=True))


def test_of_exponential_lives_in_series_it_is_the_share_of_the_rate() -> None:
    scales = {"a": 10.0, "b": 300.0, "c": 1e7}
    total = sum(1 / scale for scale in scales.values())
    found = Lives(Series(*scales), scales).caused()
    assert found == {name: pytest.approx(1 / scale / total, rel=1e-9) for name, scale in scales.items()}
    early = Lives(Series(*scales), scales).caused(until=2.0)
    fails = -math.expm1(-2 * total)
    assert early == {name: pytest.approx(fails / scale / total, rel=1e-9) for name, scale in scales.items()}


def test_of_a_pair_it_is_the_chance_to_fail_last() -> None:
    """And of Weibull lives of one shape in series, the share of λ^shape, also where young ones fail more often."""
    found = Lives(Parallel("a", "b"), {"a": 20.0, "b": 500.0}).caused()
    assert found == {"a": pytest.approx(20 / 520, rel=1e-9), "b": pytest.approx(500 / 520, rel=1e-9)}
    for shape in (0.4, 1.0, 3.0):
        found = Lives(Series("a", "b"), {"a": 20.0, "b": 500.0}, {"a": shape, "b": shape}).caused()
        assert found["a"] / found["b"] == pytest.approx(25**shape, rel=1e-9)


def test_of_two_of_three_equal_ones_each_is_as_likely() -> None:
    found = Lives(KOutOfN(2, "a", "b", "c"), dict.fromkeys("abc", 7.0), dict.fromkeys("abc", 2.2)).caused()
    assert found == dict.fromkeys("abc", pytest.approx(1 / 3, rel=1e-10))


@pytest.mark.parametrize("seed", range(10))
def test_they_add_up_to_the_chance_to_fail(seed: int) -> None:
    rng = random.Random(seed)
    block = draw(rng, [f"u{i}" for i in range(6)], 9)
    names = Structure(block).names
    lives = Lives(block, {name: 10 ** rng.uniform(0, 4) for name in names},
                  {name: rng.choice([0.5, 1.0, 1.7, 4.0]) for name in names})  # fmt: skip
    assert sum(lives.caused().values()) == pytest.approx(1, abs=1e-9)
    until = 10 ** rng.uniform(-2, 3)
    failed = lives.structure.probability(*lives.state(np.array([until]))[:2])[1][0]
    assert sum(lives.caused(until).values()) == pytest.approx(failed, rel=1e-9)


def test_what_may_never_fail_counts_for_less() -> None:
    """H = 1 − e^(−t/9): with probability 1/e it never fails."""
    structure = Structure(Unit("a"))

    def state(hours):
        hazard = -np.expm1(-hours / 9)[None]
        return np.exp(-hazard), -np.expm1(-hazard), np.exp(-hours / 9)[None] / 9 * np.exp(-hazard)

    found = barlow_proschan(
        lambda hours: intensity(structure, *state(hours)),
        lambda hours: structure.probability(*state(hours)[:2])[::-1],
    )
    assert found[0] == pytest.approx(-math.expm1(-1), rel=1e-9)


def test_beside_next_to_no_failure_a_sure_one_is_infinitely_worse():
    """1/1e-312 is no number that floating point has."""
    found = importance(Structure(Series(Unit("a"), Unit("b"))), 0.0, [1e-312, 1e-312], 1.0)
    assert found.achievement.tolist() == [math.inf, math.inf]
    assert_allclose(found.criticality, 0.5, rtol=1e-9)
