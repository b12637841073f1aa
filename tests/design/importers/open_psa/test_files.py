"""What a model of several files is, of a project of SCRAM too; and what is looked at though nobody asks for it."""

import math

import pytest

from robophm.core.errors import DesignError
from robophm.design.importers.open_psa import load, load_all

TREE = """<opsa-mef><define-fault-tree name="t">
<define-gate name="top"><or><basic-event name="a"/><basic-event name="b"/></or></define-gate>
</define-fault-tree></opsa-mef>"""
DATA = """<opsa-mef><model-data><define-basic-event name="a"><float value="0.1"/></define-basic-event>
<define-basic-event name="b"><exponential><float value="1e-4"/><system-mission-time/></exponential>
</define-basic-event></model-data></opsa-mef>"""
PROJECT = "<scram><model>{}</model><options><limits><mission-time>{}</mission-time></limits></options></scram>"
NAMED = "<file>tree.xml</file><file>data.xml</file>"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "tree.xml").write_text(TREE)
    (tmp_path / "data.xml").write_text(DATA)
    return tmp_path


def by_hand(hours):
    return 1 - 0.9 * math.exp(-1e-4 * hours)


def test_a_project_is_its_files_at_its_mission_time(folder):
    (folder / "project.xml").write_text(PROJECT.format(NAMED, 48))
    found = load(folder / "project.xml")
    assert (found.probability(), found.time) == (pytest.approx(by_hand(48)), 48.0)
    assert load(folder / "project.xml", 8760.0).probability() == pytest.approx(by_hand(8760))
    assert load([folder / "tree.xml", folder / "data.xml"], 48.0).probability() == pytest.approx(by_hand(48))


@pytest.mark.parametrize(
    ("files", "time", "says"),
    [
        ("", 48, "names no file of a model"),
        ("<file>../tree.xml</file>", 48, "expected a file in the same folder or below"),
        ("<file>sub\\tree.xml</file>", 48, "expected a file in the same folder or below"),
        ("<file>none.xml</file>", 48, "none.xml: cannot be read"),
        ("<file>project.xml</file>", 48, "is a 'scram'; expected an opsa-mef"),
        (NAMED, "two days", "mission time 'two days'; expected hours"),
        (NAMED, "-1", "mission time '-1'; expected hours"),
    ],
)
def test_a_wrong_project_is_refused(folder, files, time, says):
    (folder / "project.xml").write_text(PROJECT.format(files, time))
    with pytest.raises(DesignError, match=says) as refused:
        load(folder / "project.xml")
    assert "\n" not in str(refused.value)


def test_a_model_in_order_that_asks_nothing(folder):
    assert load_all(folder / "data.xml") == []
    with pytest.raises(DesignError, match="defines no gate"):
        load(folder / "data.xml")


UNASKED = [
    ('<define-parameter name="x"><parameter name="y"/></define-parameter>'
     '<define-parameter name="y"><parameter name="x"/></define-parameter>', "loop: parameter x → y → x"),
    ('<define-parameter name="x"><median-deviate/></define-parameter>', "expression 'median-deviate' is not taken"),
    ('<define-parameter name="x"><uniform-deviate><float value="0.5"/><float value="-10"/></uniform-deviate>'
     "</define-parameter>", "'uniform-deviate' of 0.5, -10; expected its lower end below its upper"),
    ('<define-parameter name="x"><normal-deviate><float value="1"/><float value="0"/></normal-deviate>'
     "</define-parameter>", "expected a mean and a deviation above zero"),
    ('<define-parameter name="x"><lognormal-deviate><float value="1"/><float value="1"/><float value="0.95"/>'
     "</lognormal-deviate></define-parameter>", "an error factor above one and its level"),
    ('<define-basic-event name="c"><float value="2"/></define-basic-event>', "'c' has the probability 2"),
    ('<define-gate name="g"><gate name="h"/></define-gate><define-gate name="h"><gate name="g"/></define-gate>',
     "loop: "),
    ('<define-house-event name="h"><float value="1"/></define-house-event>', "house event 'h' has no state"),
    ('<define-CCF-group name="g" model="beta-factor"><members><basic-event name="x"/><basic-event name="y"/></members>'
     '<distribution><float value="0.1"/></distribution><factor><float value="7"/></factor></define-CCF-group>',
     "common-cause group 'g': "),
]  # fmt: skip


@pytest.mark.parametrize(("text", "says"), UNASKED)
def test_what_nobody_asks_for_is_looked_at_too_unless_one_is_wanted(folder, text, says):
    (folder / "more.xml").write_text(f'<opsa-mef><define-fault-tree name="m">{text}</define-fault-tree></opsa-mef>')
    paths = [folder / name for name in ("tree.xml", "data.xml", "more.xml")]
    with pytest.raises(DesignError, match=says):
        load_all(paths, 1.0)
    (wanted,) = load_all(paths, 1.0, "top")
    assert wanted.probability() == pytest.approx(by_hand(1))


def switch(cases, other):
    inside = "".join(
        f'<case><lt><system-mission-time/><float value="{below}"/></lt><float value="{p}"/></case>'
        for below, p in cases
    )
    return f'<switch>{inside}<float value="{other}"/></switch>'


@pytest.mark.parametrize(("hours", "p"), [(5, 0.1), (15, 0.2), (25, 0.3)])
def test_a_switch_takes_its_first_case_that_is_true(folder, hours, p):
    event = f'<define-basic-event name="s">{switch([(10, 0.1), (20, 0.2)], 0.3)}</define-basic-event>'
    path = folder / "switch.xml"
    path.write_text(
        f'<opsa-mef><define-fault-tree name="t"><define-gate name="g"><basic-event name="s"/></define-gate>'
        f"{event}</define-fault-tree></opsa-mef>"
    )
    assert load(path, hours).probability() == pytest.approx(p)
    path.write_text(path.read_text().replace("<case>", "<when>").replace("</case>", "</when>"))
    with pytest.raises(DesignError, match="'when' of 2 expressions; expected a case"):
        load(path, hours)
