"""A new robot by its routes: what is handed in, drafted, used, and drafted again."""

import pytest

from robophm.design.file import load
from robophm.web.bounded_bodies import FILES, MOST_BYTES, MOST_OF_FILES

from ..drafting.test_received import PARTS, URDF
from .conftest import serving
from .test_guard import raw


@pytest.fixture
def served(tmp_path):
    with serving(tmp_path / "cart.yaml") as found:
        yield found


def hand_in(served, name, content, status=200):
    answer = served.client.post("/api/new/files", params={"name": name}, content=content)
    assert answer.status_code == status, answer.text
    return answer.json()


def use(served, status=200, **asked):
    return served.post("/api/new/use", {"revision": served.get("/api/design")["revision"], **asked}, status)


def test_a_recording_may_be_large_and_nothing_else(served):
    said = raw(served, f"POST {FILES}?name=a.mcap HTTP/1.1\r\nContent-Length: {MOST_OF_FILES + 1}\r\n")
    assert said.split(b" ", 2)[1] == b"413"
    content = b" " * (MOST_BYTES + 1)
    assert "tells nothing of a robot" in hand_in(served, "large.bin", content, 422)["message"]
    assert served.client.post("/api/new/draft", content=content).status_code == 413


def test_a_draft_changes_nothing_and_its_answers_are_judged_one_by_one(served):
    hand_in(served, "cart.urdf", URDF)
    before = served.get("/api/design")
    answers = {"where": "mars", "hours": "4", "battery": ""}
    found = served.post("/api/new/draft", {"answers": answers, "parts": [{"part": "eye", "words": "lidar"}]})
    assert {one["key"]: bool(one["wrong"]) for one in found["questions"]} == {
        "hours": False, "where": True, "battery": False, "computer": False, "sensors": False, "drive": False,
        "needs": False,
    }  # fmt: skip
    assert found["refused"] == ""
    assert "further parts/eye" in {one["path"] for one in found["parts"]}
    assert all(one["low"] < one["rate"] < one["high"] and one["source"] for one in found["parts"])
    refused = served.post("/api/new/draft", {"parts": [{"part": "nose", "words": "none"}]})
    assert refused["refused"].startswith("no part 'nose' to leave out")
    assert refused["parts"] == []
    served.post("/api/new/draft", {"answers": {"colour": "red"}}, 422)
    assert served.get("/api/design") == before
    assert not served.design.exists()


def test_a_used_draft_is_saved_and_a_later_one_changes_what_nobody_touched(served):
    hand_in(served, "cart.urdf", URDF)
    hand_in(served, "board.csv", PARTS)
    assert served.get("/api/new")["becomes"] == "new"
    used = use(served, answers={"computer": "none"}, modules={"board.csv": "drive/board"})
    assert used["saved"]
    assert used["valid"]
    robot = load(served.design)
    assert "drive/board/R1" in {part.path for part in robot.all_components()}
    assert served.get("/api/new")["becomes"] == "update"
    assert served.get("/api/new")["answers"] == {"computer": "none"}
    served.edit({"op": "put", "path": ["modules", "power", "components", "battery", "rate"], "value": "7 FPMH"},
                {"op": "delete", "path": ["modules", "power", "components", "battery", "part"]})  # fmt: skip
    hand_in(served, "later.csv", PARTS)
    use(served, answers={"computer": "raspberry pi"}, modules={"board.csv": "drive/board", "later.csv": "later"})
    assert "later/R1" in {part.path for part in load(served.design).all_components()}
    text = served.get("/api/design/text")["text"]
    assert "rate: 7 FPMH" in text
    assert "computing/computer" in {part.path for part in load(served.design).all_components()}


def test_a_draft_takes_the_place_of_a_design_by_hand_and_undo_brings_it_back(small):
    assert small.get("/api/new")["becomes"] == "replacement"
    before = small.get("/api/design/text")["text"]
    assert use(small)["state"] != 1
    small.post("/api/new/use", {"revision": 1}, 409)
    small.post("/api/design/undo", {"revision": small.get("/api/design")["revision"], "edit": None})
    assert small.get("/api/design/text")["text"] == before


def test_recordings_that_are_handed_in_can_be_watched(served):
    table = "time,/battery.voltage\n1709553600.0,25.9\n1709553601.0,25.8\n"
    assert "recordings" not in {one["name"] for one in served.get("/api/monitoring")["sources"]}
    hand_in(served, "battery.csv", table)
    sources = served.get("/api/monitoring")["sources"]
    assert ("recordings", "battery.csv") in {(one["name"], one["label"]) for one in sources}


def test_ranges_are_told_where_rates_are_uncertain_alone(small, served):
    assert small.get("/api/analysis/ranges") == {"rows": [], "advice": []}
    use(served)
    found = served.get("/api/analysis/ranges")
    assert [len(row) for row in found["rows"]] == [4, 4, 4, 4]
    assert len(found["advice"]) == 3


def test_an_example_does_not_begin_while_another_robot_is_watched(small):
    small.post("/api/new/example", {"revision": small.get("/api/design")["revision"]})
    small.post("/api/new/example", {"revision": small.get("/api/design")["revision"]}, 422)
    small.post("/api/monitoring/stop")
