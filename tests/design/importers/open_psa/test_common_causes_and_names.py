"""Common-cause groups, private names, several files, and trees without probabilities.

Against what SCRAM's tests print (bench_core_tests.cc, bench_hipps_tests.cc) and sums over all states.
"""

import itertools
import math

import pytest

from robophm.blocks.cut_sets import MinimalSets
from robophm.core.errors import DesignError
from robophm.design.importers.open_psa import files, load

FACTORS = {
    "beta-factor": {3: 0.2}, "MGL": {3: 0.1, 2: 0.2}, "alpha-factor": {1: 0.7, 2: 0.2, 3: 0.1},
    "phi-factor": {1: 0.7, 2: 0.2, 3: 0.1},
}  # fmt: skip


def group(name: str, model: str, chance: float, factors: dict[int, float], count: int = 3) -> str:
    members = "".join(f'<basic-event name="{name}{i}"/>' for i in range(count))
    levels = "".join(f'<factor level="{k}"><float value="{x}"/></factor>' for k, x in factors.items())
    return (
        f'<define-CCF-group name="{name}" model="{model}"><members>{members}</members>'
        f'<distribution><float value="{chance}"/></distribution><factors>{levels}</factors></define-CCF-group>'
    )


def trains(*groups: str) -> str:
    """Three trains of a valve and a pump each, all of which fail."""
    lines = "".join(
        f'<define-gate name="train{i}"><or><event name="v{i}"/><event name="p{i}"/></or></define-gate>'
        for i in range(3)
    )
    top = '<define-gate name="top"><and><gate name="train0"/><gate name="train1"/><gate name="train2"/></and>'
    tree = f'<define-fault-tree name="t">{top}</define-gate>{lines}</define-fault-tree>'
    return f"<opsa-mef>{tree}{''.join(groups)}</opsa-mef>"


@pytest.fixture
def written(tmp_path):
    def write(text: str, name: str = "model.xml"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return path

    return write


PRINTED = {"beta-factor": 0.04308, "MGL": 0.01630, "alpha-factor": 0.05298, "phi-factor": 0.04104}


@pytest.mark.parametrize("model", PRINTED)
def test_groups_of_every_model(written, model):
    """SCRAM's example of three trains: valves and pumps of 0.1 each; its tests print probability and sets by order."""
    factors = FACTORS[model]
    path = written(trains(group("v", model, 0.1, factors), group("p", model, 0.1, factors)))
    found = load(path)
    assert found.probability() == pytest.approx(PRINTED[model], abs=1e-5)
    expected = [2, 0, 8] if model == "beta-factor" else [2, 24, 8]
    assert MinimalSets(found.tree).count_by_order(3) == expected
    assert "[v0 v1 v2]" in found.tree.names


@pytest.mark.parametrize("model", PRINTED)
def test_what_a_group_adds_up_to(written, model):
    """Of a pair: P(both) from Q1 and Q2, worked out by hand."""
    q, x = 0.02, 0.3
    shares = {
        "beta-factor": (1 - x, x), "MGL": (1 - x, x), "phi-factor": (0.7, 0.3),
        "alpha-factor": (0.7 / 1.3, 0.6 / 1.3),
    }[model]  # fmt: skip
    factors = {2: x} if model in ("beta-factor", "MGL") else {1: 0.7, 2: 0.3}
    text = (
        '<opsa-mef><define-fault-tree name="t"><define-gate name="top"><and><event name="v0"/><event name="v1"/></and>'
    )
    text += f"</define-gate></define-fault-tree>{group('v', model, q, factors, 2)}</opsa-mef>"
    alone, both = (q * one for one in shares)
    assert load(written(text)).probability() == pytest.approx(both + (1 - both) * alone**2, rel=1e-13)


@pytest.mark.parametrize(
    ("model", "factors", "says"),
    [
        ("beta-factor", {2: 0.1}, "beta factor of level [2]; expected one, of level 3"),
        ("MGL", {1: 0.1, 2: 0.1}, "expected 2, 3 … at most 3"),
        ("MGL", {2: 0.1, 3: 0.1, 4: 0.1}, "expected 2, 3 … at most 3"),
        ("alpha-factor", {1: 0.5, 3: 0.5}, "expected 1, 2 … at most 3"),
        ("phi-factor", {1: 0.5, 2: 0.1, 3: 0.1}, "that add up to 1"),
        ("beta-factor", {3: -0.1}, "expected 0 ≤ beta < 1"),
        ("gamma-factor", {3: 0.1}, "common-cause model 'gamma-factor' is not taken"),
    ],
)
def test_factors_that_are_none(written, model, factors, says):
    with pytest.raises(DesignError, match=r"model\.xml:") as refused:
        load(written(trains(group("v", model, 0.1, factors), group("p", "beta-factor", 0.1, {3: 0.1}))))
    assert says in str(refused.value)


PRIVATE = """<opsa-mef><define-fault-tree name="t">
<define-gate name="top"><or><gate name="sub.inner"/><event name="a"/></or></define-gate>
<define-component name="sub" role="private">
  <define-gate name="inner"><and><event name="a"/><event name="t.b"/><event name="b"/></and></define-gate>
  <define-basic-event name="a"><parameter name="p"/></define-basic-event>
  <define-basic-event name="b" role="public"><float value="0.5"/></define-basic-event>
  <define-parameter name="p"><float value="0.25"/></define-parameter>
</define-component>
<define-basic-event name="a"><parameter name="p"/></define-basic-event>
<define-parameter name="p"><float value="0.125"/></define-parameter>
</define-fault-tree></opsa-mef>"""


def test_private_names_are_those_next_to_it_first(written):
    """Two events and two parameters of one name; the public one is found from everywhere."""
    found = load(written(PRIVATE.replace("t.b", "t.sub.b")))
    assert dict(zip(found.tree.names, found.occurred, strict=True)) == {"t.sub.a": 0.25, "b": 0.5, "a": 0.125}
    assert found.probability() == pytest.approx(1 - (1 - 0.25 * 0.5) * (1 - 0.125), rel=1e-15)
    with pytest.raises(DesignError, match=r"model\.xml:4: 't\.b' is not defined"):
        load(written(PRIVATE))


def test_a_private_event_is_not_found_from_outside(written):
    text = PRIVATE.replace("t.b", "b").replace('name="sub.inner"', 'name="inner"')
    with pytest.raises(DesignError, match=r"model\.xml:2: 'inner' is not defined"):
        load(written(text))


def test_a_model_of_several_files(written):
    """Given together, or one that includes the other; the tree alone has no probabilities."""
    tree = trains().replace("<opsa-mef>", '<opsa-mef xmlns:xi="http://www.w3.org/2001/XInclude">')
    data = "".join(
        f'<define-basic-event name="{x}{i}"><float value="0.5"/></define-basic-event>'
        for x, i in itertools.product("vp", range(3))
    )
    events = written(f"<opsa-mef><model-data>{data}</model-data></opsa-mef>", "below/events.xml")
    whole = tree.replace(
        "</opsa-mef>", '<xi:include href="below/events.xml" xpointer="xpointer(/opsa-mef/*)"/></opsa-mef>'
    )
    for found in (load([written(tree, "tree.xml"), events]), load(written(whole))):
        assert found.probability() == pytest.approx(0.75**3, rel=1e-14)


@pytest.mark.parametrize(
    ("href", "says"),
    [
        ("model.xml", "model.xml:1: includes itself"),
        ("../model.xml", "expected a file in the same folder or below"),
        ("/etc/hostname", "expected a file in the same folder or below"),
        ("http://a/b.xml", "expected a file in the same folder or below"),
        ("none.xml", "none.xml: cannot be read: No such file"),
    ],
)
def test_what_is_not_included(written, href, says):
    with pytest.raises(DesignError) as refused:
        load(written(f'<opsa-mef><xi:include href="{href}"/></opsa-mef>'))
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_files_that_include_each_other_many_times_end(written, monkeypatch):
    monkeypatch.setattr(files, "MOST_FILES", 20)
    for i in range(6):
        inside = f'<xi:include href="f{i + 1}.xml"/>' * 3 if i < 5 else ""
        path = written(f"<opsa-mef>{inside}</opsa-mef>", f"f{i}.xml")
    with pytest.raises(DesignError, match="one of more than 20 files"):
        load(path.parent / "f0.xml")


def test_a_test_makes_as_new(written):
    """Every 100 h from 50 h on: 1 − exp of the hours since the last test; at a test, right before it."""
    text = """<opsa-mef><define-fault-tree name="t"><define-gate name="g"><event name="a"/></define-gate>
    </define-fault-tree><model-data><define-basic-event name="a"><periodic-test>
    <float value="1e-3"/><float value="100"/><float value="50"/>
    <system-mission-time/></periodic-test></define-basic-event></model-data></opsa-mef>"""
    path = written(text)
    for time, since in ((30, 30), (50, 50), (60, 10), (149, 99), (150, 100), (275, 25)):
        assert load(path, time).probability() == pytest.approx(-math.expm1(-1e-3 * since), rel=1e-12)


def test_without_probabilities_there_is_none(written):
    found = load(
        written(
            trains(*(f'<model-data><define-basic-event name="{x}{i}"/></model-data>' for x in "vp" for i in range(3)))
        )
    )
    assert MinimalSets(found.structure().tree).count() == 8
    with pytest.raises(DesignError, match=r"model\.xml:1: '[vp]\d' has no probability, nor 5 more"):
        found.top_event()
