"""Fault trees of the design and of files, as the service tells them."""

from __future__ import annotations

import math
from typing import Any

import pytest

from robophm.cli.app import app

from .conftest import Served
from .test_faults import sent

BRIDGE = """<opsa-mef>
  <define-fault-tree name="bridge">
    <define-gate name="top">
      <or><and><basic-event name="a"/><basic-event name="b"/></and><basic-event name="c"/></or>
    </define-gate>
  </define-fault-tree>
  <model-data>
    <define-basic-event name="a"><float value="0.1"/></define-basic-event>
    <define-basic-event name="b"><float value="0.2"/></define-basic-event>
    <define-basic-event name="c">
      <exponential><float value="1e-3"/><system-mission-time/></exponential>
    </define-basic-event>
  </model-data>
</opsa-mef>
"""

SPARE = 'toplevel "S"; "S" csp "A" "B"; "A" lambda=0.5; "B" lambda=0.5 dorm=0;'


def failed(per_million_hours: float, hours: float) -> float:
    return -math.expm1(-per_million_hours * 1e-6 * hours)


def courier(hours: float) -> float:
    """That the courier has failed, in closed form: its drive, or lidar and camera."""
    return 1 - math.exp(-18e-6 * hours) * (1 - failed(30, hours) * failed(90, hours))


def test_the_designs_tree_in_closed_form(shared_small: Served) -> None:
    found = shared_small.get("/api/analysis/fault-tree", hours=2000)
    assert found["says"] == (
        f"courier, after 2,000 h of operation, new and as designed: occurs with {courier(2000):.6g} (exact)"
    )
    rows = {row[0]: row for row in found["tables"][0]["rows"]}
    assert rows["see/lidar, see/camera"][2] == f"{failed(30, 2000) * failed(90, 2000):.4g}"
    assert rows["drive/encoder"][1] == "1"
    assert found["tree"][0] == {"depth": 0, "text": "courier: any one of 2", "chance": ""}  # drive and see
    assert sorted(one["text"] for one in found["tree"] if one["chance"]) == [
        "drive/encoder", "drive/motor", "see/camera", "see/lidar",
    ]  # fmt: skip
    below = next(i for i, one in enumerate(found["tree"]) if one["text"] == "all 2 of")
    assert [(one["depth"], one["text"], one["chance"]) for one in found["tree"][below + 1 : below + 3]] == [
        (2, "see/lidar", f"{failed(30, 2000):.4g}"), (2, "see/camera", f"{failed(90, 2000):.4g}"),
    ]  # fmt: skip


def test_what_is_downloaded_is_read_again_with_the_same_probability(shared_small: Served) -> None:
    model = shared_small.client.get("/api/analysis/fault-tree.xml", params={"hours": 500})
    assert model.headers["content-type"] == "application/xml"
    for hours in (500, 2000):
        found = sent(shared_small, "fault-tree-of-file", model.text, "courier.xml", hours=hours)
        assert f"occurs with {courier(hours):.6g} (exact)" in found["says"]


def test_the_page_says_what_the_command_says(shared_small: Served, capsys: pytest.CaptureFixture[str]) -> None:
    app(["fault-tree", str(shared_small.design), "--at", "700"], standalone_mode=False)
    said = capsys.readouterr().out.splitlines()
    found = shared_small.get("/api/analysis/fault-tree", hours=700)
    assert said[:3] == [found["says"], found["notes"][-1], found["tables"][0]["title"]]
    for row in found["tables"][0]["rows"]:
        assert any(line.split() == [word for cell in (*row[1:], row[0]) for word in cell.split()] for line in said)


def test_a_model_of_another_tool_and_a_dynamic_tree(shared_small: Served) -> None:
    found = sent(shared_small, "fault-tree-of-file", BRIDGE, "bridge.xml", hours=100)
    occurs = 1 - (1 - 0.1 * 0.2) * math.exp(-0.1)
    assert found["says"] == f"top, at 100 h: occurs with {occurs:.6g} (exact)"
    spare = sent(shared_small, "fault-tree-of-file", SPARE, "spare.dft", hours=2)
    assert spare["says"] == f"S, at 2 h: occurs with {1 - 2 * math.exp(-1):.6g} (exact)"  # Erlang, of two at 0.5
    assert "It occurs after 4 h on average." in spare["notes"]


def test_a_model_of_several_top_events_is_asked_for_one(shared_small: Served) -> None:
    two = BRIDGE.replace(
        "  </define-fault-tree>",
        '<define-gate name="other"><and><basic-event name="a"/><basic-event name="c"/></and></define-gate>'
        "</define-fault-tree>",
    )
    found = sent(shared_small, "fault-tree-of-file", two, "two.xml", hours=100)
    assert sorted(found["tops"]) == ["other", "top"]
    both = 0.1 * -math.expm1(-0.1)
    assert ["other", f"{both:.6g} (exact)"] in found["tables"][0]["rows"]
    one = sent(shared_small, "fault-tree-of-file", two, "two.xml", hours=100, top="other")
    assert f"occurs with {both:.6g} (exact)" in one["says"]


def test_bounds_where_a_page_has_no_time_hold_what_is_exact(shared_small: Served, monkeypatch: Any) -> None:
    monkeypatch.setattr("robophm.web.routes.fault_trees.STEPS", 1)
    shared = BRIDGE.replace(
        '<basic-event name="c"/></or>',
        '<and><basic-event name="a"/><basic-event name="c"/></and>'
        '<and><basic-event name="b"/><basic-event name="c"/></and></or>',
    )
    found = sent(shared_small, "fault-tree-of-file", shared, "vote.xml", hours=100)
    assert "proved bounds" in found["says"]
    low, high = (float(found["says"].partition(word)[2].split()[0]) for word in ("between ", "and "))
    a, b, c = 0.1, 0.2, -math.expm1(-0.1)
    assert low * (1 - 1e-5) <= a * b + a * c + b * c - 2 * a * b * c <= high * (1 + 1e-5)  # printed with six digits
    assert any(note.startswith("By chance: ") for note in found["notes"])


@pytest.mark.parametrize(
    ("text", "name", "said"),
    [
        ("<opsa-mef>", "torn.xml", "torn.xml:"),
        ("<html/>", "page.xml", "expected an opsa-mef"),
        (BRIDGE.replace('name="c"/></or>', 'name="d"/></or>'), "lost.xml", "lost.xml:4: "),
        (SPARE, "spare.dft", "spare.dft: is a dynamic fault tree; expected the time"),
        ("x", "tree.txt", "expected an Open-PSA model, .xml, or a Galileo tree, .dft"),
        ('<opsa-mef><xi:include href="/etc/passwd"/></opsa-mef>', "in.xml", "expected a file in the same folder"),
        ('<opsa-mef><xi:include href="more.xml"/></opsa-mef>', "in.xml", "more.xml: "),
    ],
)
def test_a_file_that_is_none_is_refused_in_a_line(shared_small: Served, text: str, name: str, said: str) -> None:
    message = sent(shared_small, "fault-tree-of-file", text, name, 422)["message"]
    assert said in message
    assert "robophm-" not in message  # the folder that it is read in
    assert "\n" not in message


def test_a_function_that_there_is_not_is_refused_with_the_nearest(shared_small: Served) -> None:
    answer = shared_small.client.get("/api/analysis/fault-tree", params={"function": "drve"})
    assert answer.status_code == 422
    assert "drve" in answer.json()["message"]
