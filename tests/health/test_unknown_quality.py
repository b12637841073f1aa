"""A quality that nobody has said: one unknown for all parts of a board, as a range that its statement narrows."""

import math

import numpy as np
import pytest
from scipy.stats import norm

from robophm.design.file import parse
from robophm.design.task import Leg, Task
from robophm.health.drawn_rates import draw_rates
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.rate_sensitivity import largest_unknowns, ranges
from robophm.health.uncertainty import life_uncertainty
from robophm.learning.rates.rate_update import _square_of_variation
from robophm.report.first_look import advice
from robophm.report.surroundings import qualities_in_words

CHIP = (
    "hazard: {model: mil_hdbk_217f.microcircuit.linear, inputs: {transistors: 100, package: SO, pins: 8, power: 0 W, "
)
CHIP += "years_in_production: 2 year}}"
RESISTOR = "hazard: {model: mil_hdbk_217f.resistor, inputs: {style: RM, power: 0.1 W, rated_power: 0.2 W, "
RESISTOR += "temperature: 40 degC}}"
COIL = "hazard: {model: mil_hdbk_217f.coil, inputs: {kind: fixed, temperature: 40 degC, temperature_rise: 10 K}}"
HOUR = Task((Leg(1.0),))
Z = norm.ppf(0.95)


def board(quality, more="", of_all=""):
    return parse(f"""
schema_version: 1
name: r
environment: GM
modules:
  Board:
    quality: {quality}
    components:
      chip: {{{CHIP}{more}{of_all}}}
      resistors: {{{RESISTOR}, quantity: 100{of_all}}}
      coil: {{{COIL}{of_all}}}
""")


def rates(robot):
    return {mode.path: mode.rate for mode in robot.modes}


def test_the_stated_rate_is_the_mean_between_the_two_qualities():
    """πQ 10 and 1 of a microcircuit, 10 and 0.1 of a chip resistor: lognormal with these as 95 and 5 %."""
    best, worst, unsaid = (rates(board(said)) for said in ("known pedigree", "commercial", "unknown"))
    for name, ratio in (("Board/chip", 10), ("Board/resistors", 100)):
        assert worst[name] / best[name] == pytest.approx(ratio, rel=1e-12)
        deviation = math.log(ratio) / (2 * Z)
        middle = math.sqrt(best[name] * worst[name])
        assert unsaid[name] == pytest.approx(middle * math.exp(deviation**2 / 2), rel=1e-12)
    assert unsaid["Board/coil"] == best["Board/coil"] == worst["Board/coil"]  # no rule has its quality


def test_the_board_as_a_whole_reaches_from_the_one_to_the_other():
    """All parts are bought alike: the quantiles of the sum are the sums of the quantiles."""
    now = as_designed(Plant(board("unknown")))
    found = ranges(now, now.plant.robot.diagram, HOUR).hazard_rate
    for quantile, said in ((found.low, "known pedigree"), (found.high, "commercial")):
        stated = board(said)
        total = sum(part.quantity * mode.rate for part in stated.all_components() for mode in part.modes)
        assert quantile == pytest.approx(total, rel=0.01)


def test_its_own_level_of_a_part_wins_and_nothing_is_left_open():
    said = board("unknown", more=", quality: military")
    open_ = {mode.path for mode in said.modes if mode.uncertainty}
    assert open_ == {"Board/resistors"}


def test_it_is_drawn_beside_what_else_is_not_known():
    """Two independent lognormal factors: the variances of their logarithms add up."""
    robot = board("unknown", more=", uncertainty: {error_factor: 3}")
    drawn = np.log(draw_rates(Plant(robot), 20_000, seed=3))
    row = [mode.path for mode in robot.modes].index("Board/chip")
    assert drawn[row].std() == pytest.approx(math.hypot(math.log(3), math.log(10) / 2) / Z, rel=0.02)
    other = [mode.path for mode in robot.modes].index("Board/resistors")
    assert np.corrcoef(drawn[row], drawn[other])[0, 1] == pytest.approx(
        math.log(10) / 2 / math.hypot(math.log(3), math.log(10) / 2), abs=0.02
    )


def test_two_boards_are_two_unknowns():
    parts = f"components: {{chip: {{{CHIP}}}}}"
    robot = parse(
        f"schema_version: 1\nname: r\nenvironment: GM\nmodules: {{A: {{quality: unknown, {parts}}}, "
        f"B: {{quality: unknown, {parts}}}}}"
    )
    one, other = draw_rates(Plant(robot), 4000, seed=1)
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.05


def test_it_is_among_what_it_would_help_most_to_know():
    robot = board("unknown", more=", uncertainty: {error_factor: 1.2}")
    now = as_designed(Plant(robot))
    first = largest_unknowns(now, robot.diagram, HOUR)[0]
    assert first.quality_of == "Board"
    assert {part.path for part in first.parts} == {"Board/chip", "Board/resistors"}
    assert first.left < 0.3  # what is left is the error factor of the chip

    class Look:
        left_out, unknowns = None, (first,)

    assert next(advice(Look)).startswith("find out how the 2 kinds of parts of Board were bought and state its quality")


@pytest.mark.parametrize("age", [0, 20_000, 5_000_000])
def test_after_a_long_past_its_parts_are_still_bought_alike(age):
    """Life to come under one unknown factor, likelier to be low the longer all lived, by plain sums over a grid."""
    robot = board("unknown", of_all=f", initial_exposure: {age} h")
    stated = rates(robot)
    quantity = {part.path: part.quantity for part in robot.all_components()}
    place = norm.ppf((np.arange(2000) + 0.5) / 2000)
    total = np.zeros_like(place)
    for name, ratio in (("Board/chip", 10), ("Board/resistors", 100), ("Board/coil", 1)):
        deviation = math.log(ratio) / (2 * Z)
        total += quantity[name] * stated[name] * np.exp(deviation * place - deviation**2 / 2)
    hours = np.geomspace(1, 1e9, 1000)
    survives = np.exp(-np.outer(hours, total)) @ (weight := np.exp(-age * total)) / weight.sum()
    wanted = np.exp(np.interp(-np.array([0.95, 0.5, 0.05]), -survives, np.log(hours)))
    now = as_designed(Plant(robot))
    assert life_uncertainty(now, robot.diagram).load_known == pytest.approx(wanted, rel=0.03)


def test_a_prior_is_as_weak_as_both_make_it():
    """The variance of a product of two independent factors of mean 1."""
    robot = board("unknown", more=", uncertainty: {failures: 2}")
    (mode,) = [one for one in robot.modes if one.path == "Board/chip"]
    of_quality = math.expm1((math.log(10) / 2 / Z) ** 2)
    assert _square_of_variation(mode.uncertainty, 1.0) == pytest.approx(1.5 * (1 + of_quality) - 1, rel=1e-9)


def test_it_is_said_first():
    said = list(qualities_in_words(board("unknown")))
    assert said[0].startswith("nobody has said the quality of Board: the λ of the 101 parts that it matters to is ")
    assert [line.partition(";")[0] for line in said[1:]] == ["quality levels of parts: lower (1)"]  # the coil's own
    assert not any("nobody" in line for line in qualities_in_words(board("commercial")))
