"""What every entry of the library keeps: fields, grade, a sound robot made of it, and the figure that it cites."""

import json
import math
import re
from collections import Counter
from functools import cache
from itertools import pairwise

import pytest
from tests.cases import each_case

from robophm.core.units import quantity
from robophm.design.file import parse
from robophm.design.robot import CLOCK_UNITS
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.life.curve import Curve
from robophm.parts import FIGURES, GRADES, graded, library, search

ENTRIES = library()
every = each_case("name", ENTRIES)
USAGE = {"kilometres": "1 km/h", "cycles": "0.1 cycle/h", "starts": "0.2 start/h"}


@cache
def robot(name, **more):
    """A robot of this part alone."""
    return parse(json.dumps({"schema_version": 1, "name": "R", "usage": USAGE, "components": {"Part": {"part": name}}}))


def modes_of(entry):
    """Its failure modes as it states them, beside what holds for all of them."""
    modes = entry.part.get("failure_modes", {"": entry.part})
    of_all = {"uncertainty": entry.part.get("uncertainty")}
    return {f"Part/{key}".rstrip("/"): of_all | said for key, said in modes.items()}


def test_names_and_words_are_told_apart():
    """Two entries that are found first by the same word, or called the same, would be one to whoever reads the list."""
    for what in ([entry.words[0].casefold() for entry in ENTRIES.values()], [one.title for one in ENTRIES.values()]):
        assert [word for word, count in Counter(what).items() if count > 1] == []
    kinds = [entry.kind for entry in ENTRIES.values()]
    assert kinds == sorted(kinds)


@every
def test_its_fields_are_there_and_sound(name):
    entry = ENTRIES[name]
    assert entry.grade in GRADES
    assert 3 <= len(entry.title) <= 90
    assert not entry.title.endswith(".")
    assert len(entry.statement) > 15
    assert len(entry.source) > 5
    assert not {"http", "www."} & {entry.source[:4], entry.statement[:4]}
    folded = [word.casefold() for word in entry.words]
    assert len(set(folded)) == len(folded) >= 2
    for text in (entry.title, entry.statement, entry.source, entry.reasoning, *entry.words):
        assert "://" not in text
        assert text == text.strip()
    if entry.grade == "C":
        assert len(entry.reasoning) > 30


@pytest.mark.full
@every
def test_it_is_found_by_its_name_and_its_first_word(name):
    entry = ENTRIES[name]
    assert entry in search(name.replace("_", " "))
    assert entry in search(entry.title)
    assert search(entry.words[0])[0] is entry


NUMBER = re.compile(
    r"(?P<digits>\d[\d,]*+(?:\.\d+)?+)(?![⁰¹²³⁴⁵⁶⁷⁸⁹])(?:e(?P<e>\d+))?"
    r"(?: ?[×·] ?10(?P<power>[⁰¹²³⁴⁵⁶⁷⁸⁹]+))?(?: (?P<word>million|billion))?"
    r"(?: to [\d.,]+(?: (?P<of_range>million|billion))?)?(?: (?P<unit>years|months))?"
)
POWER = re.compile(r"(?<![·×] )(?<![·×])10(?P<power>[⁰¹²³⁴⁵⁶⁷⁸⁹]+)")
HOURS = {"years": 8760, "months": 730}
RAISED = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789")
WORDS = {None: 1, "million": 10**6, "billion": 10**9}


def numbers_in(statement):
    """The numbers of a statement, and in hours those that are years or months; of 3 to 5 years the 3."""
    found = {10.0 ** int(power["power"].translate(RAISED)) for power in POWER.finditer(statement)}
    for one in NUMBER.finditer(statement):
        value = float(one["digits"].replace(",", "")) * WORDS[one["word"] or one["of_range"]]
        value *= 10.0 ** int(one["e"] or 0) * 10.0 ** int((one["power"] or "0").translate(RAISED))
        found |= {value, value * HOURS.get(one["unit"], 1)}
    return found


def is_stated(entry, said):
    """Whether the figure of a failure mode stands in the statement, digit by digit."""
    figures = [float(said[key].split()[0]) for key in FIGURES if key in said]
    return any(number == pytest.approx(one, rel=1e-9) for number in numbers_in(entry.statement) for one in figures)


def test_numbers_are_read_out_of_statements():
    said = "8,760 h, 1.5 million, 3 to 5 years, 2·10⁶ or 10⁷ cycles, 1.2e3, 12 months, 1 to 2 million"
    assert numbers_in(said) == {8760, 1.5e6, 3, 26280, 2e6, 1e7, 1200, 12, 12 * 730, 1e6}


@every
def test_a_figure_of_grade_a_stands_in_the_makers_statement(name):
    """What is scaled, converted or taken over from another part is none: it is B by a rule, else C."""
    if ENTRIES[name].grade == "A":
        assert all(is_stated(ENTRIES[name], said) for said in modes_of(ENTRIES[name]).values())


@every
def test_how_sure_it_is_befits_its_grade(name):
    """With an error factor of 3 the 95th percentile is three times the median; of an estimate at least five times.

    An entry with an estimate among its failure modes is of grade C; what a maker states of others is as sure as that.
    """
    estimated = 0
    for said in modes_of(ENTRIES[name]).values():
        (kind,) = said["uncertainty"]
        assert kind == "error_factor"
        stated = is_stated(ENTRIES[name], said)
        least = 5 if ENTRIES[name].grade == "C" and not stated else 1.5
        assert said["uncertainty"][kind] >= least
        estimated += said["uncertainty"][kind] >= 5
    assert estimated or ENTRIES[name].grade != "C"


@every
def test_a_robot_of_it_has_a_hazard_rate_and_a_remaining_life(name):
    found = robot(name)
    assert [warning for warning in found.warnings if "range" not in warning] == []
    for mode in found.modes:
        assert graded(mode.source) == f"{name}, grade {ENTRIES[name].grade}"
        assert 1e-12 < mode.rate * found.usage.per_operating_hour(mode.clock) < 1e-2
    new = as_designed(Plant(found))
    assert math.isfinite(new.hazard_rate(found.diagram))
    assert 1e-12 < 1 / new.remaining_life(found.diagram).mean < 1e-2
    left = new.remaining_life(found.diagram)
    assert all(0 < earlier < later < math.inf for earlier, later in pairwise((left.early, left.median, left.late)))


@every
def test_its_figure_is_that_of_its_life(name):
    """R(l10) = 0.9; the mean life is the mtbf; a rate is its inverse. In the unit of its clock."""
    entry, found = ENTRIES[name], {mode.path: mode for mode in robot(name).modes}
    assert found.keys() == modes_of(entry).keys()
    for path, said in modes_of(entry).items():
        mode = found[path]
        (key,) = said.keys() & {*FIGURES, "hazard"}
        unit = CLOCK_UNITS[said.get("clock", "operating")]
        if key in ("l10", "b10"):
            assert mode.life.survival(quantity(said[key], unit)) == pytest.approx(0.9, rel=1e-10)
        elif key in ("mtbf", "mttf"):
            assert mode.life.mean() == pytest.approx(quantity(said[key], unit), rel=1e-9)
        elif key == "rate":
            assert not isinstance(mode.life, Curve)
            assert 1 / mode.life.mean() == pytest.approx(quantity(said[key], f"1/{unit}"), rel=1e-9)
        else:
            assert mode.stresses[0].reference == mode.rate
