"""The 2020 tool's roll-up: series Σλ, "parallel" Σλ/Hₙ, reliability exp(−λt)."""

import math

import pytest

from robophm.core.errors import StructureError
from robophm.design.file import load, parse
from robophm.design.importers.legacy.figures import legacy_rate, legacy_reliability

HEAD = "schema_version: 1\nname: R\n"
PARTS = "components: {A: {rate: 1e-5 /h, quantity: 2}, B: {rate: 3e-5 /h}, C: {rate: 1e-5 /h}}\n"


@pytest.mark.parametrize(
    ("diagram", "expected"),
    [
        ("{series: [A, B, C]}", 6e-5),
        ("{parallel: [B, C]}", 4e-5 / 1.5),
        ("{parallel: [A, B, C]}", 6e-5 / (11 / 6)),
        ("{series: [A, {parallel: [B, C]}]}", 2e-5 + 4e-5 / 1.5),
        ("{parallel: [{series: [A, B]}, C]}", 6e-5 / 1.5),
    ],
)
def test_by_hand(diagram, expected):
    robot = parse(f"{HEAD}{PARTS}diagram: {diagram}")
    assert legacy_rate(robot) == pytest.approx(expected, rel=1e-14, abs=0)
    assert legacy_reliability(robot, 1000) == pytest.approx(math.exp(-1000 * expected), rel=1e-14, abs=0)


def test_two_equal_units_in_parallel_come_out_worse_than_one():
    robot = parse(f"{HEAD}components: {{A: {{rate: 3e-5 /h}}, B: {{rate: 3e-5 /h}}}}\ndiagram: {{parallel: [A, B]}}")
    assert legacy_rate(robot) == pytest.approx(4e-5, rel=1e-14, abs=0)


def test_modules_are_rolled_up_one_by_one():
    text = "modules: {M: {components: {A: {rate: 1e-5 /h}, B: {rate: 3e-5 /h}}, diagram: {parallel: [A, B]}}}\n"
    robot = parse(f"{HEAD}{text}components: {{C: {{rate: 1e-5 /h}}}}")
    assert legacy_rate(robot) == pytest.approx(4e-5 / 1.5 + 1e-5, rel=1e-14, abs=0)


@pytest.mark.parametrize(
    "text",
    [
        "components: {A: {rate: 1 FIT, quantity: 3, required: 2}}",
        "usage: {kilometres: 1 km/h}\ncomponents: {A: {rate: 1e-6 /km, clock: kilometres}}",
        "components: {A: {rate: 1 FIT}, B: {rate: 1 FIT}}\ndiagram: {k_of_n: {k: 1, of: [A, B]}}",
    ],
)
def test_what_it_does_not_know(text):
    with pytest.raises(StructureError, match="the 2020 tool knows n"):
        legacy_rate(parse(HEAD + text))


def test_series_agrees_with_the_sum_of_the_papers_table(examples):
    """Communication is all in series: Σ quantity · rate of its rows in Table 17."""
    communication = load(examples / "ota" / "robot.yaml").modules[2]
    total = 9 * 4.53e-7 + 9 * 1.66e-7 + 6.54e-6 + 5.9e-7 + 2.3e-7 + 1.7e-7 + 4 * 8e-8 + 5.9e-7 + 2.43e-6 + 7.5e-7
    assert legacy_rate(communication) == pytest.approx(total, rel=1e-12, abs=0)
