"""Members of groups that depend on other parts: closed forms, one way of solving by another, and chance."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from scipy.integrate import quad

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge
from robophm.groups.monte_carlo import AgeingMode, simulate
from robophm.health.outlooks import nominal_outlook
from robophm.health.plant import Plant

SURE = 1 - 1e-6


def robot(parts: str, diagram: str, more: str = "") -> Robot:
    return parse(f"schema_version: 1\nname: rover\n{more}components: {{{parts}}}\ndiagram: {diagram}\n", "robot.yaml")


def works(one: Robot, hours: float) -> float:
    return float(nominal_outlook(Plant(one), np.full(len(one.modes), hours)).survival(one.diagram).works)


def chance(one: Robot, hours: float) -> tuple[float, float]:
    units = {
        unit: [AgeingMode(mode.life) for mode in part.modes] for part in one.all_components() for unit in part.units
    }
    found = simulate(one.diagram, units, hours, 400_000, seed=3, confidence=SURE)
    return found.low, found.high


def weibull(scale: float, shape: float) -> str:
    return f"life: {{distribution: weibull, scale: {scale} h, shape: {shape}}}"


@pytest.mark.parametrize("named", ["P", "[P]", "{series: [P]}"])
def test_a_spare_whose_supply_runs_while_it_waits(named: str) -> None:
    """Cold B at 0.01 /h needs P at 0.02 /h, which runs from the start: R = exp(−λt)·(1 + λt·exp(−0.02 t))."""
    one = robot(f"A: {{rate: 0.01 /h}}, B: {{rate: 0.01 /h, depends_on: {named}}}, P: {{rate: 0.02 /h}}",
                "{standby: {of: [A, B]}}")  # fmt: skip
    assert works(one, 100.0) == pytest.approx(math.exp(-1) * (1 + math.exp(-2)), rel=1e-12)
    low, high = chance(one, 100.0)
    assert low < works(one, 100.0) < high


def test_the_first_whose_supply_fails_is_replaced() -> None:
    """A with its supply is gone at 0.03 /h; the switch comes off nine times in ten; then B is alone."""
    one = robot("A: {rate: 0.01 /h, depends_on: P}, B: {rate: 0.01 /h}, P: {rate: 0.02 /h}",
                "{standby: {of: [A, B], switch: 0.9}}")  # fmt: skip
    expected = math.exp(-3) + 0.9 * 0.03 * math.exp(-1) * -math.expm1(-2) / 0.02
    assert works(one, 100.0) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("dormancy", [0.0, 0.3])
def test_parts_that_age(dormancy: float) -> None:
    """R = S_A + S_P·∫ f_A(τ)·exp(−H_B((t − τ) + δτ)) dτ: the supply's age is the robot's, whoever works."""
    one = robot(f"A: {{{weibull(100, 2)}}}, B: {{{weibull(120, 3)}, depends_on: P}}, P: {{{weibull(150, 1.5)}}}",
                f"{{standby: {{of: [A, B], dormancy: {dormancy}}}}}")  # fmt: skip
    t = 110.0

    def takes_over(x: float) -> float:
        first = 2 / 100 * (x / 100) * math.exp(-((x / 100) ** 2))
        return first * math.exp(-(((t - x + dormancy * x) / 120) ** 3))

    expected = math.exp(-(1.1**2)) + math.exp(-((t / 150) ** 1.5)) * quad(takes_over, 0, t, epsabs=1e-14)[0]
    assert works(one, t) == pytest.approx(expected, rel=1e-11)
    low, high = chance(one, t)
    assert low < expected < high


@pytest.mark.parametrize("dormancy", [0.0, 0.4])
def test_three_with_supplies_by_the_chain_and_by_integrals(dormancy: float) -> None:
    """A Weibull life of shape 1 has a constant rate, but is solved as one that ages."""
    supplies = "P: {rate: 0.02 /h}, Q: {rate: 0.005 /h}"
    group = f"{{standby: {{of: [A, B, C], dormancy: {dormancy}, switch: 0.95}}}}"
    of = "A: {{{}}}, B: {{{}, depends_on: P}}, C: {{{}, depends_on: Q}}, ".format
    one = robot(of(*["rate: 0.01 /h"] * 3) + supplies, group)
    other = robot(of(*[weibull(100, 1)] * 3) + supplies, group)
    for t in (5.0, 100.0, 400.0):
        assert works(one, t) == pytest.approx(works(other, t), rel=1e-11)
    low, high = chance(one, 100.0)
    assert low < works(one, 100.0) < high


def test_a_shared_load_is_not_the_supplys() -> None:
    """Each of two at λ, its supply at μ; alone at 4λ, its supply still at μ. By the chain, by integrals, by chance."""
    of = "A: {{{0}, depends_on: P}}, B: {{{0}, depends_on: Q}}, P: {{{1}}}, Q: {{{1}}}".format
    group = "{load_sharing: {of: [A, B], exponent: 2}}"
    both, alone, t = 2 * (0.01 + 0.004), 4 * 0.01 + 0.004, 80.0
    expected = math.exp(-both * t) + both * (math.exp(-both * t) - math.exp(-alone * t)) / (alone - both)
    assert works(robot(of("rate: 0.01 /h", "rate: 0.004 /h"), group), t) == pytest.approx(expected, rel=1e-12)
    aged = robot(of(weibull(100, 1), weibull(250, 1)), group)
    assert works(aged, t) == pytest.approx(expected, rel=1e-11)
    low, high = chance(aged, t)
    assert low < expected < high
    ages = robot(of(weibull(100, 2.5), weibull(150, 1.5)), group)
    low, high = chance(ages, t)
    assert low < works(ages, t) < high


def test_what_all_depend_on_is_in_series_with_the_group() -> None:
    """And may serve others too, be redundant itself, and be known to have failed."""
    parts = "A: {rate: 0.01 /h, depends_on: P}, B: {rate: 0.01 /h, depends_on: P}, P: {rate: 0.02 /h}, "
    parts += "C: {rate: 1e-3 /h, depends_on: P}"
    one = robot(parts, "{series: [{standby: {of: [A, B]}}, C]}")
    assert works(one, 100.0) == pytest.approx(2 * math.exp(-1 - 2 - 0.1), rel=1e-12)
    lost = nominal_outlook(Plant(one), np.full(len(one.modes), 100.0), Knowledge(failed=frozenset({"P"})))
    assert lost.remaining_life(one.diagram).median == 0
    either = "{parallel: [P, Q]}"
    two = robot(f"A: {{rate: 0.01 /h, depends_on: {either}}}, B: {{rate: 0.01 /h, depends_on: {either}}}, "
                "P: {rate: 0.02 /h}, Q: {rate: 0.02 /h}", "{standby: {of: [A, B]}}")  # fmt: skip
    assert works(two, 100.0) == pytest.approx(2 * math.exp(-1) * (1 - (1 - math.exp(-2)) ** 2), rel=1e-12)


def test_what_is_known_of_a_supply() -> None:
    """Once P is known to have failed B is no spare; known to work, and A and B too, the group is as good as new."""
    one = robot("A: {rate: 0.01 /h}, B: {rate: 0.01 /h, depends_on: P}, P: {rate: 0.02 /h}", "{standby: {of: [A, B]}}")

    def fails(**known: tuple[str, ...]) -> float:
        knowledge = Knowledge(**{name: frozenset(parts) for name, parts in known.items()})
        outlook = nominal_outlook(Plant(one), np.full(len(one.modes), 70.0), knowledge)
        return float(outlook.curve(one.diagram)(np.array([50.0]))[0][0])

    assert fails(failed=("P",)) == pytest.approx(-math.expm1(-0.5), rel=1e-12)
    new = math.exp(-0.5) * (1 + 0.5 * math.exp(-1))
    assert fails(working=("A", "B", "P")) == pytest.approx(1 - new, rel=1e-12)


PARTS = "A: {rate: 1 FIT%s}, B: {rate: 1 FIT%s}, C: {rate: 1 FIT%s}, P: {rate: 1 FIT}, Q: {rate: 1 FIT}"
THREE = "{standby: {of: [A, B, C]}}"
ON = ", depends_on: {}".format
REFUSED = [
    ((ON("P"), ON("P"), ""), THREE, "'A' and 'B' depend on 'P', others of their group do not"),
    ((ON("P"), "", ""), f"{{series: [{THREE}, P]}}", "'P', on which a member depends, is needed outside the group too"),
    (("", ON("A"), ""), "{standby: {of: [A, B]}}", "'B' depends on 'A' of its own group; expected on others"),
    (("", ON("A"), ""), THREE, "'B' depends on 'A' of its own group; expected on others"),
    (("", ON("{parallel: [P, Q]}"), ""), THREE, "'B' is not of parts in series"),
]  # fmt: skip


@pytest.mark.parametrize(("on", "diagram", "says"), REFUSED)
def test_what_is_refused(on: tuple[str, str, str], diagram: str, says: str) -> None:
    with pytest.raises(DesignError, match=re.escape(says)) as error:
        robot(PARTS % on, diagram)
    assert "\n" not in str(error.value)


def test_a_cause_that_members_share_is_still_refused() -> None:
    with pytest.raises(DesignError, match="may fail together with others"):
        robot("A: {rate: 1 FIT}, B: {rate: 1 FIT}", "{standby: {of: [A, B]}}",
              "common_causes: {heat: {of: [A, B], beta: 0.1}}\n")  # fmt: skip
