"""A component that takes an entry of the library: what is its own wins, and where its rate is from stays known."""

import math

import pytest

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.parts import completed, graded, library

HEAD = "schema_version: 1\nname: R\nusage: {cycles: 1 cycle/h, kilometres: 1 km/h, starts: 1 start/h}\n"


def modes(text):
    return {mode.path: mode for mode in parse(f"{HEAD}{text}").modes}


def first(wanted):
    """The first entry of which this holds: the tests do not hang on one entry's figures."""
    return next(entry for entry in library().values() if wanted(entry.part))


AGES = first(lambda said: "l10" in said and "life" in said and "acceleration" in said and "clock" not in said)
MANY = first(
    lambda said: (
        len(said.get("failure_modes", {})) > 1 and all("uncertainty" in m for m in said["failure_modes"].values())
    )
)
BOOK = first(lambda said: "hazard" in said and "environment" in said)


def test_the_entry_is_taken_as_it_is():
    (mode,) = modes(f"components: {{A: {{part: {AGES.name}}}}}").values()
    assert mode.source == f"library: {AGES.name}, grade {AGES.grade}: {AGES.source}"
    assert mode.uncertainty.error_factor == AGES.part["uncertainty"]["error_factor"]
    assert [stress.model.name for stress in mode.stresses] == [AGES.part["acceleration"]["model"]]
    assert mode.life.survival(float(AGES.part["l10"].split()[0])) == pytest.approx(0.9, rel=1e-12)


@pytest.mark.parametrize("figure", ["rate: 1e-3 /h", "mtbf: 1000 h", "mttf: 1000 h"])
def test_a_figure_of_its_own_takes_the_place_of_the_entrys_and_what_is_said_of_that(figure):
    (mode,) = modes(f"components: {{A: {{part: {AGES.name}, {figure}}}}}").values()
    assert mode.rate == pytest.approx(1e-3, rel=1e-12)
    assert (mode.uncertainty, mode.source) == (None, "")
    assert mode.life.shape == AGES.part["life"]["shape"]  # it wears as it does
    assert len(mode.stresses) == 1
    own = modes(f"components: {{A: {{part: {AGES.name}, {figure}, uncertainty: {{failures: 3}}, source: own}}}}")["A"]
    assert (own.uncertainty.failures, own.source) == (3, "own")
    above = modes(f"uncertainty: {{failures: 4}}\ncomponents: {{A: {{part: {AGES.name}, {figure}}}}}")["A"]
    assert above.uncertainty.failures == 4


def test_any_other_key_takes_the_place_of_that_key():
    text = f"components: {{A: {{part: {AGES.name}, acceleration: none, life: {{distribution: rayleigh}}, quantity: 2, "
    (mode,) = modes(text + "uncertainty: {error_factor: 9}}}").values()
    assert (mode.stresses, mode.uncertainty.error_factor) == ((), 9)
    assert graded(mode.source) == f"{AGES.name}, grade {AGES.grade}"
    assert mode.life.survival(float(AGES.part["l10"].split()[0])) == pytest.approx(0.9, rel=1e-12)


@pytest.mark.parametrize(
    "own", ["failure_modes: {a: {rate: 5 FIT}}", "hazard: {model: general.constant, inputs: {rate: 5 FIT}}"]
)
@pytest.mark.parametrize("entry", [AGES, MANY, BOOK], ids=lambda entry: entry.name)
def test_failure_modes_or_a_model_of_its_own_are_all_that_is_said(own, entry):
    (mode,) = modes(f"components: {{A: {{part: {entry.name}, {own}}}}}").values()
    assert (mode.rate, mode.uncertainty, mode.source) == (5e-9, None, "")
    assert mode.life.cumulative_hazard(1e9) == pytest.approx(5.0, rel=1e-12)


def test_a_rate_that_nobody_knows_wins_too():
    found = modes(f"components: {{A: {{part: {AGES.name}, rate: unknown}}, B: {{rate: 1 FIT}}}}")
    assert (found["A"].unknown, found["A"].source, found["A"].stresses) == (True, "", ())


def test_failure_modes_are_taken_with_their_source_and_one_can_be_surer_of_all():
    found = modes(f"components: {{A: {{part: {MANY.name}}}}}")
    assert [path.removeprefix("A/") for path in found] == list(MANY.part["failure_modes"])
    assert {mode.source for mode in found.values()} == {MANY.origin}
    surer = modes(f"components: {{A: {{part: {MANY.name}, uncertainty: {{failures: 7}}}}}}")
    assert {mode.uncertainty.failures for mode in surer.values()} == {7}
    (mode,) = modes(f"components: {{A: {{part: {MANY.name}, mtbf: 10 h}}}}").values()
    assert mode.life.mean() == 10


def test_the_robots_environment_goes_before_the_librarys():
    """A handbook's figure is for where the robot works; the entry's is where nobody says."""
    text = f"components: {{A: {{part: {BOOK.name}}}}}"
    (theirs,) = modes(text).values()
    (same,) = modes(f"environment: {BOOK.part['environment']}\n{text}").values()
    (calm,) = modes(f"environment: GB\n{text}").values()
    (own,) = modes(f"environment: GF\n{text.replace('}}', ', environment: GB}}')}").values()
    assert theirs.rate == same.rate > calm.rate == own.rate > 0


def test_one_cannot_say_two_things_at_once():
    for own, said in (
        ("mtbf: 3 h, rate: 1 FIT", "components/A/rate: both 'rate' and 'mtbf' are given"),
        ("life: {distribution: weibull, shape: 2, scale: 3 h}", "'l10' and the life's own scale are given"),
        ("clock: cycles", "components/A/l10: unit 'h' does not measure what 'cycle' does"),
        ("part: 3", "duplicate name 'part'"),
    ):
        with pytest.raises(DesignError, match=said):
            modes(f"components:\n  A: {{part: {AGES.name}, {own}}}")


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (
            "ball_bearin",
            "design:5: components/A/part: no part 'ball_bearin' in the library; did you mean 'ball_bea",
        ),
        ("3", "design:5: components/A/part: expected a valid string, not 3"),
    ],
)
def test_a_part_that_there_is_not(said, expected):
    with pytest.raises(DesignError) as raised:
        modes(f"components:\n  A: {{part: {said}}}")
    assert expected in str(raised.value)


def test_nothing_is_changed_in_place():
    before = repr(MANY.part)
    first = completed({"part": MANY.name, "quantity": 2})
    first["failure_modes"].clear()
    assert repr(MANY.part) == before
    assert completed({"part": MANY.name})["failure_modes"]
    assert math.isfinite(modes(f"components: {{A: {{part: {MANY.name}}}}}").popitem()[1].rate)
