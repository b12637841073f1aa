"""Models in the Open-PSA format against hand-worked probabilities, and what is refused of them."""

import math
import re

import numpy as np
import pytest

from robophm.blocks.diagram import KOutOfN, Link, Network, Parallel, Series
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.reliability import Structure
from robophm.core import markup
from robophm.core.errors import DesignError
from robophm.design.importers.open_psa import load
from robophm.design.importers.open_psa.writing import document

EVENTS = """<model-data>
<define-basic-event name="a"><float value="0.1"/></define-basic-event>
<define-basic-event name="b"><float value="0.2"/></define-basic-event>
<define-basic-event name="c"><float value="0.3"/></define-basic-event>
<define-house-event name="on"><constant value="true"/></define-house-event>
<define-house-event name="off"><constant value="false"/></define-house-event>
</model-data>"""
A, B, C = ('<basic-event name="a"/>', '<event name="b"/>', '<event name="c" type="basic-event"/>')
ON, OFF = '<house-event name="on"/>', '<event name="off"/>'


@pytest.fixture
def read(tmp_path):
    def read(text: str, **options):
        path = tmp_path / "model.xml"
        path.write_text(text)
        return load(path, **options)

    return read


def gate(formula: str, name: str = "top") -> str:
    return f'<define-gate name="{name}">{formula}</define-gate>'


def model(*gates: str, data: str = EVENTS) -> str:
    tree = f'<define-fault-tree name="t">{"".join(gates)}</define-fault-tree>'
    return f'<?xml version="1.0"?>\n<opsa-mef>{tree}{data}</opsa-mef>'


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        (A, 0.1),
        (f"<and>{A}{B}</and>", 0.02),
        (f"<or>{A}{B}</or>", 0.28),
        (f"<not>{A}</not>", 0.9),
        (f"<xor>{A}{B}</xor>", 0.1 * 0.8 + 0.9 * 0.2),
        (f"<nand>{A}{B}</nand>", 0.98),
        (f"<nor>{A}{B}</nor>", 0.72),
        (f"<iff>{A}{B}</iff>", 0.02 + 0.72),
        (f"<imply>{A}{B}</imply>", 1 - 0.1 * 0.8),
        (f'<atleast min="2">{A}{B}{C}</atleast>', 0.02 * 0.7 + 0.1 * 0.3 * 0.8 + 0.2 * 0.3 * 0.9 + 0.006),
        (f'<cardinality min="1" max="1">{A}{B}</cardinality>', 0.1 * 0.8 + 0.9 * 0.2),
        (f'<atleast min="2">{A}{B}{ON}</atleast>', 0.28),
        (f'<atleast min="2">{A}{B}{OFF}</atleast>', 0.02),
        (f"<xor>{A}{ON}</xor>", 0.9),
        (f'<or>{A}<and>{B}<constant value="true"/></and></or>', 0.28),
        (f"<or>{ON}{A}</or>", 1.0),
        (f"<and>{OFF}{A}</and>", 0.0),
    ],
)
def test_a_formula(read, formula, expected):
    """By hand, of P(a) = 0.1, P(b) = 0.2, P(c) = 0.3."""
    assert read(model(gate(formula))).probability() == pytest.approx(expected, rel=1e-14)


def test_gates_in_any_order_and_in_several_trees(read):
    inner = f'<define-fault-tree name="u">{gate(f"<or>{A}{B}</or>", "inner")}</define-fault-tree>'
    text = model(gate(f'<and><gate name="u.inner"/>{C}</and>'), data=inner + EVENTS)
    found = read(text)
    assert found.name == "top"
    assert found.probability() == pytest.approx(0.28 * 0.3)
    assert read(text, top="inner").probability() == pytest.approx(0.28)


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ('<exponential><float value="1e-3"/><system-mission-time/></exponential>', -math.expm1(-0.1)),
        ('<exponential><parameter name="rate"/><system-mission-time/></exponential>', -math.expm1(-0.2)),
        ('<Weibull><float value="200"/><float value="2"/><float value="0"/><system-mission-time/></Weibull>',
         -math.expm1(-0.25)),
        ('<GLM><float value="0.1"/><float value="0"/><float value="0"/><float value="5"/></GLM>', 0.1),
        ('<GLM><float value="0"/><float value="0.01"/><float value="0.03"/><float value="50"/></GLM>',
         0.25 * -math.expm1(-2)),
        ('<mul><float value="0.5"/><sub><int value="1"/><float value="0.25"/></sub></mul>', 0.375),
        ('<lognormal-deviate><float value="0.01"/><float value="3"/><float value="0.95"/></lognormal-deviate>', 0.01),
    ],
)  # fmt: skip
def test_an_expression(read, expression, expected):
    """Closed forms at 100 h."""
    data = f"""<model-data><define-basic-event name="a">{expression}</define-basic-event>
    <define-parameter name="rate" unit="hours-1">
    <mul><float value="2"/><parameter name="base"/></mul></define-parameter>
    <define-parameter name="base"><float value="1e-3"/></define-parameter></model-data>"""
    assert read(model(gate(A), data=data), time=100.0).probability() == pytest.approx(expected, rel=1e-14)


def event(expression: str) -> str:
    return model(
        gate(A), data=f'<model-data><define-basic-event name="a">{expression}</define-basic-event></model-data>'
    )


LAUGHS = "<!DOCTYPE lolz [" + '<!ENTITY a "ha">' + "".join(
    f'<!ENTITY a{i} "{("&a" + str(i - 1 or "") + ";") * 10}">' for i in range(1, 10)
) + "]><opsa-mef>&a9;</opsa-mef>"  # fmt: skip


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "1: is no XML: no element found"),
        ("<opsa-mef>\n<define-fault-tree>", "2: is no XML: no element found"),
        ("<opsa-mef></opsa>", "1: is no XML: mismatched tag"),
        ('<?xml version="1.0" encoding="klingon"?><opsa-mef/>', "1: is no XML"),
        ("<html/>", "1: is a 'html'; expected an opsa-mef"),
        (LAUGHS, "1: declares the entity 'a'; none is taken"),
        ('<!DOCTYPE x [<!ENTITY e SYSTEM "file:///etc/passwd">]><opsa-mef>&e;</opsa-mef>', "declares the entity 'e'"),
        ('<!DOCTYPE x [<!ENTITY % e SYSTEM "http://x/">%e;]><opsa-mef/>', "declares the entity 'e'"),
        ("<opsa-mef>&e;</opsa-mef>", "is no XML: undefined entity"),
        ("<opsa-mef><define-event-tree/></opsa-mef>", "'define-event-tree' has no name"),
        (model('<define-CCF-group name="x"/>'), "common-cause group 'x' has 0 members; expected at least two"),
        (model(gate("<and/>")), "2: 'and' has no inputs; expected at least one"),
        (model(gate("")), "gate 'top' has 0 formulas; expected one"),
        (model(gate(f"{A}{B}")), "gate 'top' has 2 formulas; expected one"),
        (model(gate(f"<not>{A}{B}</not>")), "'not' has 2 inputs; expected 1"),
        (model(gate(f"<xor>{A}</xor>")), "'xor' has 1 inputs; expected at least 2"),
        (model(gate(f'<atleast min="4">{A}{B}{C}</atleast>')), "'atleast' has min = 4 of 3 inputs; expected at most n"),
        (model(gate(f'<atleast min="-1">{A}{B}</atleast>')), "'atleast' has min '-1'; expected a whole number"),
        (model(gate(f"<atleast>{A}{B}</atleast>")), "'atleast' has min ''; expected a whole number"),
        (model(gate(f'<cardinality min="2" max="1">{A}{B}</cardinality>')), "cardinality min 2 above max 1"),
        (model(gate(f"<nandd>{A}{B}</nandd>")), "formula 'nandd' is not taken; did you mean 'nand'?"),
        (model(gate('<basic-event name="aa"/>')), "'aa' is not defined; did you mean 'a'?"),
        (model(gate('<gate name="a"/>')), "'a' is used as a gate, but is a basic-event"),
        (model(gate("<gate/>")), "'gate' has no name"),
        (model(gate(A), gate(B)), "2: 'top' is defined twice; first in line 2"),
        (model(gate(A, "a")), "'a' is defined twice"),
        (model(gate(A), gate(B, "other")), "answers 2 questions: 'top' (line 2), 'other' (line 2)"),
        (model(), "defines no gate"),
        (model(gate('<gate name="top"/>')), "loop: top → top"),
        (model(gate('<gate name="x"/>'), gate('<and><gate name="y"/></and>', "x"), gate('<gate name="x"/>', "y")),
         "loop: x → y → x"),
        (model(gate('<gate name="y"/>', "x"), gate('<gate name="x"/>', "y")), "loop: y → x → y"),
        (model(gate('<constant value="maybe"/>')), "constant 'maybe'; expected true or false"),
        (event('<float value="1.5"/>'), "'a' has the probability 1.5; expected 0 … 1"),
        (event('<float value="nan"/>'), "float value 'nan' is not a finite number"),
        (event('<float value="12 FIT"/>'), "float value '12 FIT' is no number; expected one without a unit"),
        (event('<exponential><float value="1"/></exponential>'), "'exponential' has 1 arguments; expected 2"),
        (event("<exponential><float value='-1'/><float value='1'/></exponential>"), "of a negative rate or time"),
        (event('<exponential><float value="1"/><system-mission-time/></exponential>'), "the mission time, in hours"),
        (event('<Weibull><float value="0"/><float value="2"/><float value="0"/><float value="1"/></Weibull>'),
         "expected above zero"),
        (event('<div><float value="1"/><float value="0"/></div>'), "'div' of 1, 0 is not a number"),
        (event('<pow><float value="-1"/><float value="0.5"/></pow>'), "'pow' of -1, 0.5 is not a number"),
        (event('<glm/>'), "expression 'glm' is not taken"),
        (event('<parameter name="x"/>'), "parameter 'x' is not defined"),
        (event('<parameter name="x"/></define-basic-event><define-parameter name="x"><parameter name="x"/>'
               '</define-parameter><define-basic-event name="z"><float value="0"/>'), "loop: parameter x → x"),
        (event('<parameter name="x"/></define-basic-event><define-parameter name="x" unit="years"><float value="1"/>'
               '</define-parameter><define-basic-event name="z"><float value="0"/>'), "unit 'years' is not taken"),
        (event('<parameter name="x" unit="hours-1"/></define-basic-event><define-parameter name="x" unit="hours">'
               '<float value="1"/></define-parameter><define-basic-event name="z"><float value="0"/>'),
         "parameter 'x' is in hours and asked for in hours-1; expected the same unit"),
        (model(gate("<not>" * 200 + A + "</not>" * 200)), "is nested too deeply; expected at most 100 levels"),
    ],
)  # fmt: skip
def test_what_is_refused(read, text, says):
    with pytest.raises(DesignError) as refused:
        read(text)
    message = str(refused.value)
    assert says in message
    assert re.search(r"model\.xml:(\d+: | )", message)
    assert "\n" not in message


def test_what_is_too_large_is_refused(read, monkeypatch, tmp_path):
    with pytest.raises(DesignError, match=r"no gate or sequence 'tpo'; did you mean 'top'\?"):
        read(model(gate(A)), top="tpo")
    monkeypatch.setattr(markup, "MAX_ELEMENTS", 5)
    with pytest.raises(DesignError, match="more than 5 elements"):
        read(model(gate(A)))
    monkeypatch.setattr(markup, "MAX_BYTES", 50)
    with pytest.raises(DesignError, match="larger than 50 bytes"):
        read(model(gate(A)))
    with pytest.raises(DesignError, match="cannot be read"):
        load(tmp_path / "none.xml")


def test_a_chain_of_ten_thousand_gates_is_no_trouble(read):
    chain = [gate(f'<or><gate name="g{i + 1}"/>{A}</or>', f"g{i}") for i in range(10_000)]
    assert read(model(*chain, gate(B, "g10000"))).probability() == pytest.approx(0.28)


def test_a_diagram_written_and_read_is_the_same(read):
    diagram = Series(
        "Power/Battery[1]",
        KOutOfN(2, "motor <1>", "motor &2", Parallel("3", "top")),
        Network("s", "t", [Link("s", "a", "x"), Link("s", "b", "y"), Link("a", "b", "gate_1"), Link("a", "t", "3"),
                           Link("b", "t", "Power/Battery[1]")], {}),
    )  # fmt: skip
    tree = FaultTree.of(diagram)
    rng = np.random.default_rng(1)
    failed = rng.uniform(0.01, 0.5, len(tree.names))
    structure = Structure(diagram)
    q = np.array([failed[tree.names.index(name)] for name in structure.names])
    expected = float(structure.state(1 - q, q).failed)
    found = read(document("robot & <co>", tree, list(failed)))
    assert found.probability() == pytest.approx(expected, rel=1e-14)
    back = found.tree.diagram()
    again = Structure(back)
    q = np.array([found.occurred[found.tree.names.index(name)] for name in again.names])
    assert float(again.state(1 - q, q).failed) == pytest.approx(expected, rel=1e-13)


def test_a_tree_that_is_not_coherent_written_and_read_is_the_same(read):
    first = read(
        model(gate(f'<or><and>{A}<not>{B}</not></and><xor>{B}{C}</xor><atleast min="2">{A}{B}{C}</atleast></or>'))
    )
    second = read(document("x", first.tree, list(first.occurred)))
    assert second.probability() == pytest.approx(first.probability(), rel=1e-15)
