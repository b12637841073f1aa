"""robophm fault-tree and robophm cutsets, run as a newcomer does."""

import json
import math
import random

import pytest

ROBOT = """
schema_version: 1
name: Pair
components:
  computer: {rate: 10 FPMH}
  motor: {rate: 50 FPMH, quantity: 2, required: 1}
  lamp: {rate: 5 FPMH, life: {distribution: weibull, shape: 2}}
functions: {see: lamp, move: {series: [computer, motor]}}
"""


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT)
    return path


def failed(per_million_hours: float, hours: float) -> float:
    return -math.expm1(-per_million_hours * 1e-6 * hours)


def test_the_cut_sets_of_a_robot(inside, robot):
    done = inside("cutsets", robot, "--at", 2000, "--function", "move", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    said = json.loads(done.stdout)
    computer, motor = failed(10, 2000), failed(50, 2000)
    assert said["unreliability"] == pytest.approx(1 - (1 - computer) * (1 - motor**2), rel=1e-12)
    sets = {tuple(one["parts"]): one for one in said["cut_sets"]["listed"]}
    assert sets["computer",]["probability"] == pytest.approx(computer, rel=1e-12)
    assert sets["motor[1]", "motor[2]"]["probability"] == pytest.approx(motor**2, rel=1e-12)
    assert sets["computer",]["share"] == pytest.approx(computer / said["unreliability"], rel=1e-12)
    assert said["cut_sets"]["count"] == 2
    text = inside("cutsets", robot, "--paths").stdout
    assert "2 minimal path sets: 2 of 3" in text
    assert "computer, motor[1], lamp" in text


def test_few_are_listed_and_the_rest_is_stated(inside, robot):
    text = inside("cutsets", robot, "--order", 1).stdout
    assert "3 minimal cut sets: 2 of 1, 1 of 2" in text
    assert "motor[1]" not in text
    assert f"1 more is not listed; its probability is {failed(50, 1000) ** 2:.3g}" in text


def test_a_robots_tree_is_written_and_says_the_same(inside, robot, tmp_path):
    first = json.loads(inside("fault-tree", robot, "--at", 500, "--to", "tree.xml", "--json").stdout)
    second = json.loads(inside("fault-tree", "tree.xml", "--at", 500, "--json").stdout)
    assert second["probability"] == pytest.approx(first["probability"], rel=1e-12)
    assert second["cut_sets"]["count"] == first["cut_sets"]["count"] == 3
    assert '<exponential><float value="1e-05"/>' in (tmp_path / "tree.xml").read_text()
    shown = json.loads(inside("show", robot, "--at", 500, "--json").stdout)
    assert first["probability"] == pytest.approx(shown["modules"][0]["unreliability"], rel=1e-12)


def test_a_robots_tree_becomes_a_design_again(inside, robot, tmp_path):
    """Design, model, design: the same number, that of the closed form."""
    inside("fault-tree", robot, "--at", 500, "--to", "tree.xml")
    done = inside("fault-tree", "tree.xml", "--at", 500, "--to", "again.yaml")
    assert (done.returncode, done.stderr) == (0, "")
    assert "Written: again.yaml" in done.stdout
    ((_, shown),) = (
        (one["path"], one) for one in json.loads(inside("show", "again.yaml", "--at", 500, "--json").stdout)["modules"]
    )
    lamp = -math.expm1(-((math.gamma(1.5) * 5e-6 * 500) ** 2))  # Weibull of mean 200,000 h
    expected = 1 - (1 - failed(10, 500)) * (1 - failed(50, 500) ** 2) * (1 - lamp)
    assert shown["unreliability"] == pytest.approx(expected, rel=1e-10)
    assert "motor_1: {rate: 5e-05 /h}" in (tmp_path / "again.yaml").read_text()
    assert inside("check", "again.yaml").returncode == 0


def test_mistakes_are_one_line(inside, robot, tmp_path):
    (tmp_path / "bad.xml").write_text("<opsa-mef>\n<define-fault-tree name='x'>\n")
    (tmp_path / "half.xml").write_text(
        '<opsa-mef><define-fault-tree name="t"><define-gate name="g"><or><basic-event name="a"/></or></define-gate>'
        '<define-basic-event name="a"><float value="0.5"/></define-basic-event></define-fault-tree></opsa-mef>'
    )
    (tmp_path / "sure.xml").write_text(
        '<opsa-mef><define-fault-tree name="t"><define-gate name="g"><constant value="true"/></define-gate>'
        "</define-fault-tree></opsa-mef>"
    )
    for words, says in (
        (("fault-tree", "bad.xml"), "bad.xml:3: is no XML: no element found"),
        (("fault-tree", "none.xml"), "none.xml: cannot be read: No such file"),
        (("fault-tree", "sure.xml", "--to", "again.xml"), "'g' has no basic events with probabilities"),
        (("fault-tree", "half.xml", robot), "2 files with a robot's design; expected it alone"),
        (("cutsets", robot, "--function", "mve"), "no function 'mve'; did you mean 'move'?"),
        (("fault-tree", robot, "--to", "no/tree.xml"), "no such folder"),
        (
            ("fault-tree", robot, "--to", "again.yaml"),
            "again.yaml: of a robot its fault tree is written; expected a name",
        ),
        (("fault-tree", "half.xml", "--to", "again.yaml"), "half.xml: 'a' has a probability and no rate"),
        (
            ("fault-tree", "half.xml", "--at", 9, "--to", robot),
            "robot.yaml: exists already; expected the name of a new",
        ),
        (("cutsets", robot, "--at", "inf"), "--at inf: expected hours of at least 0"),
    ):
        done = inside(*words)
        assert done.returncode == 3
        assert says in done.stderr
        assert done.stderr.count("\n") == 1
        assert done.stdout == ""
    assert robot.read_text() == ROBOT
    assert not (tmp_path / "again.yaml").exists()


def test_a_tree_with_not_has_a_probability_and_prime_implicants(inside, tmp_path):
    (tmp_path / "m.xml").write_text(
        '<opsa-mef><define-fault-tree name="t"><define-gate name="g"><and><basic-event name="a"/><not>'
        '<basic-event name="b"/></not></and></define-gate></define-fault-tree><model-data><define-basic-event name="a">'
        '<float value="0.5"/></define-basic-event><define-basic-event name="b"><float value="0.25"/>'
        "</define-basic-event></model-data></opsa-mef>"
    )
    text = inside("fault-tree", "m.xml").stdout
    assert "occurs with 0.375" in text
    assert "1 prime implicant: 1 of 2\n" in text
    assert "a, not b" in text


def test_common_causes_and_groups_are_events(inside, tmp_path):
    """Of a pair that may fail together and a cold pair: the cause and the group are cut sets of one."""
    (tmp_path / "robot.yaml").write_text("""
schema_version: 1
name: R
components:
  motor: {rate: 50 FPMH, quantity: 2, required: 1}
  A: {rate: 20 FPMH}
  B: {rate: 20 FPMH}
common_causes: {heat: {of: [motor], beta: 0.1}}
diagram: {series: [motor, {standby: {of: [A, B]}}]}
""")
    said = json.loads(inside("fault-tree", "robot.yaml", "--at", 1000, "--to", "tree.xml", "--json").stdout)
    sets = {tuple(one["parts"]): one["probability"] for one in said["cut_sets"]["listed"]}
    assert sets == {
        ("heat",): pytest.approx(failed(5, 1000), rel=1e-12),
        ("motor[1]", "motor[2]"): pytest.approx(failed(45, 1000) ** 2, rel=1e-12),
        ("standby of A, B",): pytest.approx(1 - math.exp(-0.02) * 1.02, rel=1e-10),
    }
    again = json.loads(inside("fault-tree", "tree.xml", "--at", 1000, "--json").stdout)
    assert again["probability"] == pytest.approx(said["probability"], rel=1e-12)


def test_an_estimate_where_nothing_else_is_wanted(inside, robot):
    """A million samples of the tree of a robot, and of the model written of it: about what is exact."""
    exact = json.loads(inside("fault-tree", robot, "--at", 2e4, "--to", "tree.xml", "--json").stdout)["probability"]
    for tree in (robot, "tree.xml"):
        said = json.loads(inside("fault-tree", tree, "--at", 2e4, "--monte-carlo", 1_000_000, "--json").stdout)
        assert said["samples"] == 1_000_000
        assert 0 < said["high"] - said["low"] < 0.005
        assert said["probability"] == pytest.approx(exact, abs=5 * math.sqrt(exact * (1 - exact) / 1e6))
    text = inside("fault-tree", robot, "--monte-carlo", 1000).stdout
    assert "with 95 % confidence between" in text
    done = inside("fault-tree", robot, "--monte-carlo", 1000, "--to", "other.xml")
    assert done.returncode == 2
    assert "--to: not used for a robot, whose top event is of --function, only estimated (--monte-carlo)" in done.stderr


STRUCTURE = (
    '<opsa-mef><define-fault-tree name="t"><define-gate name="g"><or><event name="c"/><and><event name="a"/>'
    '<event name="b"/></and></or></define-gate>{}</define-fault-tree></opsa-mef>'
)


def test_a_tree_without_probabilities_has_cut_sets_alone(inside, tmp_path):
    events = "".join(f'<define-basic-event name="{name}"/>' for name in "abc")
    (tmp_path / "tree.xml").write_text(STRUCTURE.format(events))
    said = json.loads(inside("fault-tree", "tree.xml", "--json").stdout)
    assert (said["answer"], said["probability"], said["without_probability"]) == ("structure alone", None, 3)
    assert said["cut_sets"]["count"] == 2
    assert [(one["parts"], one["probability"]) for one in said["cut_sets"]["listed"]] == [
        (["c"], None),
        (["a", "b"], None),
    ]
    assert said["cut_sets"]["sum_of_probabilities"] is None
    text = inside("fault-tree", "tree.xml").stdout
    assert "g: 3 basic events have no probability, so that it has none" in text
    assert "0.5" not in text
    for more in (("--monte-carlo", 9), ("--to", "new.xml")):
        assert inside("fault-tree", "tree.xml", *more).returncode == 3
    assert not (tmp_path / "new.xml").exists()


def test_a_model_of_two_files_and_one_that_constants_decide(inside, tmp_path):
    data = "".join(f'<define-basic-event name="{name}"><float value="0.5"/></define-basic-event>' for name in "abc")
    (tmp_path / "tree.xml").write_text(STRUCTURE.format(""))
    (tmp_path / "data.xml").write_text(f"<opsa-mef><model-data>{data}</model-data></opsa-mef>")
    said = json.loads(inside("fault-tree", "tree.xml", "data.xml", "--json").stdout)
    assert (said["answer"], said["at_least"], said["at_most"]) == ("exact", 0.625, 0.625)
    (tmp_path / "sure.xml").write_text(
        '<opsa-mef><define-fault-tree name="t"><define-gate name="g"><not><house-event name="h"/></not></define-gate>'
        '<define-house-event name="h"/></define-fault-tree></opsa-mef>'
    )
    assert "g: always occurs (exact)" in inside("fault-tree", "sure.xml").stdout
    assert json.loads(inside("fault-tree", "sure.xml", "--json").stdout)["probability"] == 1.0


def test_a_model_that_asks_nothing(inside, tmp_path):
    """As the files of basic events that come beside a tree; a wrong one is refused."""
    path = tmp_path / "data.xml"
    text = '<opsa-mef><model-data><define-basic-event name="a"><float value="{}"/></define-basic-event></model-data>'
    path.write_text(text.format(0.1) + "</opsa-mef>")
    done = inside("fault-tree", path)
    assert done.returncode == 0
    assert "defines no gate, and no initiating event with an event tree: there is nothing to compute" in done.stdout
    assert json.loads(inside("fault-tree", path, "--json").stdout)["answers"] == []
    refused = inside("fault-tree", path, "--draws", 10)
    assert (refused.returncode, "not used for a model that asks nothing" in refused.stderr) == (2, True)
    path.write_text(text.format(1.5) + "</opsa-mef>")
    refused = inside("fault-tree", path)
    assert (refused.returncode, "'a' has the probability 1.5; expected 0 … 1" in refused.stderr) == (3, True)


def test_each_sequence_of_an_event_tree(inside, tmp_path):
    """Beside the top event; together the sequences are sure."""
    works, fails = "<not><gate name='stop fails'/></not>", "<gate name='stop fails'/>"
    paths = "".join(
        f"<path state='{state}'><collect-formula>{formula}</collect-formula><sequence name='{state}'/></path>"
        for state, formula in (("stops", works), ("hits", fails))
    )
    (tmp_path / "stop.xml").write_text(
        "<opsa-mef><define-initiating-event name='obstacle' event-tree='T'/><define-event-tree name='T'>"
        "<define-functional-event name='F'/><define-sequence name='stops'/><define-sequence name='hits'/>"
        f"<initial-state><fork functional-event='F'>{paths}</fork></initial-state></define-event-tree>"
        "<define-fault-tree name='R'><define-gate name='stop fails'><or><basic-event name='laser'/>"
        "<basic-event name='brake'/></or></define-gate></define-fault-tree><model-data>"
        "<define-basic-event name='laser'><float value='0.01'/></define-basic-event>"
        "<define-basic-event name='brake'><float value='0.02'/></define-basic-event></model-data></opsa-mef>"
    )
    said = json.loads(inside("fault-tree", "stop.xml", "--json").stdout)
    found = {one["name"]: (one["probability"], one["answer"]) for one in said["answers"]}
    assert found["obstacle: stops"] == (pytest.approx(0.99 * 0.98, rel=1e-12), "exact")
    assert found["obstacle: hits"][0] == pytest.approx(1 - 0.99 * 0.98, rel=1e-12) == found["stop fails"][0]
    assert said["sequences_together"] == {"obstacle": pytest.approx(1, rel=1e-12)}
    text = inside("fault-tree", "stop.xml").stdout
    assert "The sequences of obstacle together: 1\n" in text
    alone = inside("fault-tree", "stop.xml", "--top", "hits").stdout
    assert "2 minimal cut sets: 2 of 1" in alone
    refused = inside("fault-tree", "stop.xml", "--order", 1)
    assert refused.returncode != 0
    assert "--top names one" in refused.stderr


def test_what_is_uncertain_is_said_and_drawn(inside, tmp_path):
    (tmp_path / "m.xml").write_text(
        '<opsa-mef><define-fault-tree name="t"><define-gate name="g"><basic-event name="a"/></define-gate>'
        '</define-fault-tree><model-data><define-basic-event name="a"><uniform-deviate><float value="0.1"/>'
        '<float value="0.3"/></uniform-deviate></define-basic-event></model-data></opsa-mef>'
    )
    text = inside("fault-tree", "m.xml").stdout
    assert "occurs with 0.2 (exact)" in text
    assert "1 uncertain expression is at its mean; --draws 1000 says how far that may be off." in text
    said = json.loads(inside("fault-tree", "m.xml", "--draws", 2000, "--json").stdout)
    assert said["uncertain"] == 1
    found = [said["uncertainty"][key] for key in ("p05", "median", "p95", "mean")]
    assert found == pytest.approx([0.11, 0.2, 0.29, 0.2], abs=2e-4)
    assert (
        "90 % lie between 0.11 and 0.29: median 0.2, mean 0.2." in inside("fault-tree", "m.xml", "--draws", 2000).stdout
    )
    (tmp_path / "sure.xml").write_text((tmp_path / "m.xml").read_text().replace("uniform-deviate", "add"))
    refused = inside("fault-tree", "sure.xml", "--draws", 10)
    assert (refused.returncode, "nothing is uncertain in 'g'" in refused.stderr) == (3, True)


def test_bounds_have_an_estimate_beside_them(inside, tmp_path):
    """All of 30 gates, each "or" of five of sixty events of 0.1, of which one is negated, in a tenth of a second."""
    draw = random.Random(3)
    event = "<basic-event name='e{}'/>".format
    gates = "".join(f"<or>{''.join(map(event, draw.sample(range(60), 5)))}</or>" for _ in range(30))
    gates = gates.replace(event(0), f"<not>{event(0)}</not>")
    events = "".join(f"<define-basic-event name='e{i}'><float value='0.1'/></define-basic-event>" for i in range(60))
    (tmp_path / "m.xml").write_text(
        f"<opsa-mef><define-fault-tree name='t'><define-gate name='g'><and>{gates}</and></define-gate>"
        f"</define-fault-tree><model-data>{events}</model-data></opsa-mef>"
    )
    said = json.loads(inside("fault-tree", "m.xml", "--limit", 0.1, "--json").stdout)
    assert (said["answer"], said["probability"]) == ("proved bounds", None)
    found = said["estimate"]
    assert found["low"] < found["probability"] < found["high"] < found["low"] + 0.003
    assert found["samples"] == 1_000_000
    assert said["at_least"] <= found["high"]
    assert said["at_most"] >= found["low"]
    text = inside("fault-tree", "m.xml", "--limit", 0.1).stdout
    assert "occurs with a probability between" in text
    assert "By chance: " in text


def test_a_dynamic_tree(inside, tmp_path):
    """A cold spare: Erlang of two."""
    (tmp_path / "tree.dft").write_text('toplevel "A"; "A" csp "B" "C"; "B" lambda=0.5 dorm=0; "C" lambda=0.5 dorm=0;')
    said = json.loads(inside("fault-tree", "tree.dft", "--at", 2, "--json").stdout)
    assert said["probability"] == pytest.approx(1 - 2 * math.exp(-1), rel=1e-12)
    assert (said["mean_time"], said["may_never_occur"], said["states"]) == (pytest.approx(4), False, [3])
    text = inside("fault-tree", "tree.dft", "--at", 2).stdout
    assert "A, at 2 h: occurs with 0.264241 (exact)" in text
    assert "It occurs after 4 h on average." in text
    for wrong, says in ((["--order", 1, "--at", 2], "a dynamic fault tree"), ([], "expected it alone, and --at")):
        refused = inside("fault-tree", "tree.dft", *wrong)
        assert refused.returncode != 0
        assert says in refused.stderr
