"""What a design says in words: where it works, how much of the day, for how long."""

import pytest

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.report.surroundings import environments, environments_in_words

FUSE = "hazard: {model: mil_hdbk_217f.fuse, inputs: {%s}}"
HEAD = "schema_version: 1\nname: R\n"
PART = "components: {A: {rate: 1 FIT}}\n"


def rate(text):
    return parse(HEAD + text + f"components: {{A: {{{FUSE % ''}}}}}\n").components[0].modes[0].rate


def test_a_word_for_an_environment_is_its_symbol_at_every_level():
    assert rate("environment: flying\n") == rate("environment: ARW\n") == pytest.approx(0.01e-6 * 16)  # §22.1: πE 16
    own = parse(HEAD + f"environment: GB\ncomponents: {{A: {{{FUSE % 'environment: vehicle'}}}}}\n")
    assert own.components[0].modes[0].stresses[0].design["environment"] == "GM"


def test_what_was_taken_is_counted_by_parts():
    robot = parse(
        HEAD + f"environment: indoor\ncomponents: {{A: {{quantity: 3, {FUSE % ''}}}, B: {{rate: 1 FIT}}}}\n"
        f"modules: {{M: {{environment: vehicle, components: {{A: {{{FUSE % ''}}}}}}}}}\n"
    )
    assert environments(robot) == {"GB": 3, "GM": 1}
    first, second = environments_in_words(robot)
    assert first.startswith("environment GB (Ground, Benign: ")
    assert first.endswith("of 3 parts")
    assert second.endswith("of 1 part")


@pytest.mark.parametrize(
    ("usage", "share"),
    [
        ("{operating: 8 h/day}", 1 / 3),
        ("8 h/day", 1 / 3),
        ("30 %", 0.3),
        ("0.25", 0.25),
        ("{operating: 6 h per day}", 0.25),
    ],
)
def test_how_much_of_the_day(usage, share):
    assert parse(f"{HEAD}usage: {usage}\n{PART}").usage.operating == pytest.approx(share, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("usage: 30 h/day", "usage: expected less than or equal to 1, not 1.25"),
        ("usage: 8 km", "usage: unit 'km' does not measure what 'none' does; expected a share, e.g. 8 h/day"),
        ("duty: a lot", "duty: 'a lot' is not a number with a unit"),
        ("ambient: 40 C", "ambient: 'C' is no unit of temperature; did you mean 'degC'?"),
        ("environment: moon", r"environment: 'moon' is no environment of MIL-HDBK-217F Table 3-2; known: "),
    ],
)
def test_what_is_none_is_told_what_is(text, says):
    with pytest.raises(DesignError) as refused:
        parse(f"{HEAD}{text}\n{PART}")
    assert says in str(refused.value)


def test_a_duty_in_percent():
    assert parse(f"{HEAD}duty: 30 %\n{PART}").components[0].duty == 0.3


@pytest.mark.parametrize(("figure", "clock"), [("20000", "operating hours"), ("20000 km", "operating hours")])
def test_an_mtbf_is_told_its_unit(figure, clock):
    with pytest.raises(DesignError, match=f"mtbf is an age in h of {clock}"):
        parse(f"{HEAD}components: {{A: {{mtbf: {figure}}}}}\n")
