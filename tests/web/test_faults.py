"""FMEA, diagnosis, learned rates, fitted lives, a requirement and another design, as the service tells them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from robophm.cli.app import app

from .conftest import SMALL, Served

SENSORS = "sensor,part,detects,false alarm\nvibration,drive/motor,0.9,0.01\nself test,see/lidar,0.95,0.001\n"
LOG = "part,robot,exposure [h],censored\ndrive/motor,r1,4000,\ndrive/motor,r1,9000,yes\nsee/lidar,r1,9000,yes\n"


def sent(served: Served, route: str, text: str, name: str = "table.csv", status: int = 200, **query: Any) -> Any:
    answer = served.client.post(
        f"/api/analysis/{route}", params={"name": name, **query}, content=text.encode(),
        headers={"content-type": "application/octet-stream"},
    )  # fmt: skip
    assert answer.status_code == status, answer.text
    return answer.json()


def works(hours: float, lidar: float = 30e-6) -> float:
    """Reliability of the courier in closed form."""
    both, camera = lidar + 90e-6, 90e-6
    return math.exp(-18e-6 * hours) * (math.exp(-lidar * hours) + math.exp(-camera * hours) - math.exp(-both * hours))


def test_failure_modes_of_the_design_alone(shared_small: Served) -> None:
    found = shared_small.get("/api/analysis/fmea", hours=2000)
    (table,) = found["tables"]
    rows = {row[0]: dict(zip(table["columns"], row, strict=True)) for row in table["rows"]}
    assert rows.keys() == {"drive/motor", "drive/encoder", "see/lidar", "see/camera"}
    assert rows["drive/motor"]["end effect"] == "the robot fails"
    assert rows["see/lidar"]["end effect"] == "redundancy is lost"
    assert float(rows["drive/motor"]["occurs"]) == pytest.approx(-math.expm1(-2 * 8e-6 * 2000), rel=1e-3)
    assert rows["drive/encoder"]["detected by"] == "nothing"


def test_what_alarms_mean_by_a_table_of_sensors(shared_small: Served) -> None:
    found = sent(shared_small, "diagnosis", SENSORS, alarms=["vibration"], hours=100)
    assert found["sensors"] == ["vibration", "self test"]
    suspects, seen = found["tables"]
    assert suspects["rows"][0][0] == "drive/motor"
    assert [row[1:3] for row in seen["rows"] if row[0] == "drive/motor"] == [["0.9", ""]]
    assert found["notes"][0].startswith("Nothing has failed, and it is a false alarm: ")
    assert [table["title"][:14] for table in sent(shared_small, "diagnosis", SENSORS)["tables"]] == ["What sees what"]


def test_what_the_field_says_of_rates(shared_small: Served) -> None:
    (table,) = sent(shared_small, "learned", LOG)["tables"]
    motor = next(row for row in table["rows"] if row[0].startswith("drive/motor"))
    assert motor[1:3] == ["1", "0.104"]  # 13,000 h by 8 FPMH


def test_learned_rates_are_put_into_the_design_as_the_command_writes_them(
    small: Served, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "log.csv").write_text(LOG)
    app(
        ["learn", str(small.design), str(tmp_path / "log.csv"), "--to", str(tmp_path / "new.yaml")],
        standalone_mode=False,
    )
    capsys.readouterr()
    found = sent(small, "learned", LOG)
    assert found["text"] == (tmp_path / "new.yaml").read_text()
    added = [line[1:] for line in found["changes"] if line.startswith("+")]
    assert added
    assert set(added) == set(found["text"].splitlines()) - set(SMALL.splitlines())
    used = small.client.put("/api/design/text", json={"revision": found["revision"], "text": found["text"]})
    assert used.status_code == 200
    again = sent(small, "learned", LOG)  # from what is stated, not from what was learned
    assert (again["text"], again["known"], again["changes"]) == ("", True, [])
    assert again["tables"] == found["tables"]


def test_rates_that_the_design_cannot_have_are_said_so(small: Served) -> None:
    alias = "lidar: &seen {rate: 30 FPMH}"
    text = SMALL.replace("lidar: {rate: 30 FPMH}", alias).replace("camera: {rate: 90 FPMH}", "camera: *seen")
    small.client.put("/api/design/text", json={"revision": small.get("/api/design")["revision"], "text": text})
    found = sent(small, "learned", LOG.replace("see/lidar", "see/camera"))
    assert (found["text"], found["known"], found["changes"]) == ("", False, [])
    assert found["notes"][-1].startswith("They cannot be put into the design here: courier.yaml:")
    assert small.service.workspace.draft().text == text


def test_lives_are_fitted_the_best_first(shared_small: Served) -> None:
    pytest.importorskip("surpyval")
    lives = "time [h],censored\n" + "".join(f"{hours},\n" for hours in (105, 83, 123, 106, 92, 110, 94, 99, 101, 97))
    (table,) = sent(shared_small, "fits", lives)["tables"]
    scores = [float(row[5]) for row in table["rows"]]
    assert len(scores) > 3
    assert scores == sorted(scores)


def test_a_requirement_with_its_margin(shared_small: Served) -> None:
    good, bad = (shared_small.get("/api/analysis/requirement", reliability=r, hours=3000) for r in (0.9, 0.99))
    fails = 1 - works(3000)
    assert (good["met"], bad["met"]) == (True, False)
    assert f"with {100 * fails:.3f}"[:9] in good["says"]
    assert f"{0.1 / fails:.3g} times as rarely as allowed" in good["says"]
    assert f"{fails / 0.01:.3g} times as often as allowed" in bad["says"]


def test_another_design_beside_it(shared_small: Served) -> None:
    other = SMALL.replace("lidar: {rate: 30 FPMH}", "lidar: {rate: 300 FPMH}").replace(
        "      encoder: {rate: 2 FPMH}\n", ""
    )
    found = sent(shared_small, "compared", other, "other.yaml", hours=1000, unit="FPMH")
    figures, parts = found["tables"]
    assert parts["rows"] == [
        ["see/lidar", "30 FPMH", "300 FPMH", "+270 FPMH"], ["drive/encoder", "2 FPMH", "not in it", "−2 FPMH"],
    ]  # fmt: skip
    without = works(1000, 300e-6) * math.exp(2e-6 * 1000)
    change = 100 * (without - works(1000))
    assert figures["rows"][2][3] == f"−{abs(change):.3g} % points"


@pytest.mark.parametrize(
    ("route", "text", "name", "said"),
    [
        ("diagnosis", "sensor,part\nx,nobody\n", "s.csv", "s.csv:2: part: no part 'nobody'"),
        ("learned", "part\n", "log.csv", "log.csv"),
        ("learned", "x", "log.exe", "expected a table in .csv or .yaml"),
        ("fits", "time\nnever\n", "lives.csv", "lives.csv:2"),
        ("compared", "name: [", "other.yaml", "other.yaml: "),
    ],
)
def test_a_table_that_is_none_is_refused_in_a_line(
    shared_small: Served, route: str, text: str, name: str, said: str
) -> None:
    message = sent(shared_small, route, text, name, 422)["message"]
    assert said in message
    assert "robophm-" not in message  # the folder that it is read in
    assert "\n" not in message
