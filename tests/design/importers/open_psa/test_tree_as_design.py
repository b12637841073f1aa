"""A fault tree becomes a design whose diagram has failed with the tree's probability, to all digits."""

import itertools
import math

import numpy as np
import pytest

from robophm.blocks.diagram import Unit, units
from robophm.core.errors import DesignError, StructureError
from robophm.design.file import parse
from robophm.design.importers.open_psa import load
from robophm.design.importers.open_psa.as_design import as_design
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant

TIME = 500.0


@pytest.fixture
def made(tmp_path):
    """The robot made of a model."""

    def made(gates: str, data: str, time: float | None = TIME):
        path = tmp_path / "model.xml"
        path.write_text(
            f'<opsa-mef><define-fault-tree name="t">{gates}</define-fault-tree>'
            f"<model-data>{data}</model-data></opsa-mef>"
        )
        return parse(as_design(load(path, time), path.name, time))

    return made


def event(name: str, expression: str) -> str:
    return f'<define-basic-event name="{name}">{expression}</define-basic-event>'


def gate(name: str, formula: str) -> str:
    return f'<define-gate name="{name}">{formula}</define-gate>'


def of(kind: str, *names: str) -> str:
    """A formula of gates, whose names are capital, and events."""
    inside = "".join(f'<{"gate" if name[0].isupper() else "basic-event"} name="{name}"/>' for name in names)
    return f"<{kind}>{inside}</{kind.split()[0]}>"


TIMED = "<system-mission-time/>"
DATA = (
    '<define-parameter name="rate"><float value="2e-4"/></define-parameter>'
    '<define-parameter name="t"><system-mission-time/></define-parameter>'
    + event("a", f'<exponential><float value="1e-3"/>{TIMED}</exponential>')
    + event("b", '<exponential><parameter name="rate"/><parameter name="t"/></exponential>')
    + event("c", f'<Weibull><float value="900"/><float value="2"/><float value="100"/>{TIMED}</Weibull>')
    + event("d", '<float value="0.3"/>')
    + event("e", '<exponential><float value="1e-3"/><float value="24"/></exponential>')  # not of the mission
)
FAILED = {
    "a": -math.expm1(-1e-3 * TIME),
    "b": -math.expm1(-2e-4 * TIME),
    "c": -math.expm1(-(((TIME - 100) / 900) ** 2)),
    "d": 0.3,
    "e": -math.expm1(-0.024),
}
GATES = (
    gate("Top", of("or", "Two", "Both", "e"))
    + gate("Both", of("and", "Shared", "d"))
    + gate("Shared", of("or", "a", "b"))
    + gate("Two", of('atleast min="2"', "Shared", "c", "d"))
)


def occurs(a: bool, b: bool, c: bool, d: bool, e: bool) -> bool:
    shared = a or b
    return shared + c + d >= 2 or (shared and d) or e


def test_the_diagram_has_the_trees_probability(made):
    """The sum over all 32 states; the shared gate is written once and drawn twice."""
    robot = made(GATES, DATA)
    expected = math.fsum(
        math.prod(FAILED[name] if failed else 1 - FAILED[name] for name, failed in zip("abcde", state, strict=True))
        for state in itertools.product((False, True), repeat=5)
        if occurs(*state)
    )
    new = as_designed(Plant(robot))
    assert new.survival_curve(robot.diagram, np.array([TIME])).failed[0] == pytest.approx(expected, rel=1e-12)
    assert robot.name == "Top"
    assert robot.warnings == ()
    assert sorted(units(robot.diagram)).count("a") == 2


def test_a_part_has_the_life_of_its_event(made):
    """At another time too, but for what has a probability alone, which holds at the one time."""
    new = as_designed(Plant(robot := made(GATES, DATA)))
    at = {mode.path: new.survival_curve(Unit(mode.path), np.array([TIME, 900.0])).failed for mode in robot.modes}
    assert {name: both[0] for name, both in at.items()} == pytest.approx(FAILED, rel=1e-12)
    assert at["a"][1] == pytest.approx(-math.expm1(-0.9), rel=1e-12)
    assert at["b"][1] == pytest.approx(-math.expm1(-0.18), rel=1e-12)
    assert at["c"][1] == pytest.approx(-math.expm1(-((800 / 900) ** 2)), rel=1e-12)
    assert at["d"][1] == pytest.approx(1 - 0.7 ** (900 / TIME), rel=1e-12)


def test_names_that_no_design_may_have_become_others(made):
    names = ["x/1", "x-1", "true", "a: b", "[x]", "x" * 300, "x" * 301, "&", "*x", "'", "#"]
    half = "".join(event(name.replace("&", "&amp;"), '<float value="0.5"/>') for name in names)
    inside = "".join(f'<basic-event name="{name.replace("&", "&amp;")}"/>' for name in names)
    robot = made(gate("Top", f"<or>{inside}</or>"), half)
    assert len({part.path for part in robot.components}) == len(names)
    assert {"x-1", "x-1 2", "true", "a: b", "(x)", "&", "*x", "'", "#"} < {part.path for part in robot.components}


def test_one_event_is_a_design(made):
    robot = made(gate("Top", of("or", "a")), DATA)
    assert list(units(robot.diagram)) == ["a"]


@pytest.mark.parametrize(
    ("gates", "data", "time", "says"),
    [
        (gate("Top", of("xor", "a", "d")), DATA, TIME, "it has 'not' or 'xor' gates, so that it is no design"),
        (gate("Top", of("not", "a")), DATA, TIME, "it has 'not' or 'xor' gates"),
        (
            gate("Top", of("or", "d")), DATA, None,
            "model.xml: 'd' has a probability and no rate, as a part of a design has; expected a mission time above 0",
        ),
        (gate("Top", of("or", "d")), DATA, 0.0, "expected a mission time above 0"),
        (gate("Top", of("or", "z")), event("z", '<float value="0"/>'), TIME, "'z' never occurs, and a part has a rate"),
        (gate("Top", of("or", "z")), event("z", '<float value="1"/>'), TIME, "'z' always occurs, and a part has a ra"),
        (gate("Top", '<constant value="true"/>'), "", TIME, "'Top' is decided by constants; expected a tree with"),
        (
            "".join(gate(f"G{i}", of("or", f"G{i + 1}", f"H{i}")) + gate(f"H{i}", of("and", f"G{i + 1}", f"e{i}"))
                    for i in range(30)) + gate("G30", of("and", "a", "d")),
            DATA + "".join(event(f"e{i}", '<float value="0.5"/>') for i in range(30)), TIME,
            "model.xml: 'G0' unfolds to more than 100,000 events",
        ),
        (
            "".join(gate(f"G{i}", of(("or", "and")[i % 2], f"G{i + 1}", f"e{i}")) for i in range(60))
            + gate("G60", of("and", "a", "d")),
            DATA + "".join(event(f"e{i}", '<float value="0.5"/>') for i in range(60)), TIME,
            "model.xml, as a design:",
        ),
    ],
)  # fmt: skip
def test_what_is_no_design_is_refused_in_one_line(made, gates, data, time, says):
    with pytest.raises((StructureError, DesignError)) as refused:
        made(gates, data, time)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)
