"""How far ahead curves go: closed forms of exponential lives."""

import math

import pytest

from robophm.design.file import parse
from robophm.health.curve_span import curve_span
from robophm.health.prognosis import RemainingLife
from robophm.monitoring.monitor import Monitor

ONE = "schema_version: 1\nname: R\nusage: {operating: 0.25}\nmodules: {m: {components: {c: {rate: 1e-4 /h}}}}\n"


def life(late):
    return RemainingLife(mean=late / 3, median=late / 4, early=0.0, late=late)


def test_until_95_percent_have_failed_in_the_view_that_lasts_longest():
    system = Monitor(parse(ONE)).report().system
    lives = [system.nominal.remaining_life, system.sensor_based.remaining_life]
    assert curve_span(lives, 0.25) == pytest.approx(-math.log(0.05) / 1e-4, rel=1e-9)  # of operation
    assert curve_span([life(3000.0), life(8000.0)], 0.5) == 4000.0


def test_where_no_life_is_known_to_end():
    assert curve_span([life(math.inf), None], 0.5) == 5000.0
    assert curve_span([life(math.inf), life(600.0)], 0.5) == 300.0


def test_of_a_robot_that_has_failed_a_curve_has_two_ends():
    assert curve_span([life(0.0)], 0.5) > 0
