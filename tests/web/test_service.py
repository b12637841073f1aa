"""What the service answers about a small robot, against closed forms; live values against the samples themselves."""

import json
import math
import time

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from robophm.core.signal import SECOND
from robophm.transports.synthetic import SyntheticOta
from robophm.web.series import Points, Series, decimated

from .conftest import OTA, serving

MOTORS, ENCODER, LIDAR, CAMERA = 16e-6, 2e-6, 30e-6, 90e-6


def works(hours):
    """R of the courier: two motors and an encoder in series with a lidar or a camera."""
    drive = math.exp(-(MOTORS + ENCODER) * hours)
    return drive * (1 - (1 - math.exp(-LIDAR * hours)) * (1 - math.exp(-CAMERA * hours)))


def test_what_each_level_promises(shared_small):
    levels = shared_small.get("/api/design")["levels"]
    assert levels["drive"]["hazard_rate"] == pytest.approx(MOTORS + ENCODER, rel=1e-12)
    assert levels["drive/motor"] == {
        "kind": "component", "hazard_rate": pytest.approx(MOTORS), "quantity": 2, "single_point": True
    }  # fmt: skip
    assert not levels["see/lidar"]["single_point"]
    assert levels[""]["hazard_rate"] == pytest.approx(MOTORS + ENCODER)  # of two in parallel none fails at once


def test_curves(shared_small):
    found = shared_small.get("/api/analysis/curves", horizon=50_000, points=11)
    assert found["hours"] == [5000.0 * i for i in range(11)]
    for view in ("nominal", "sensor_based"):
        assert found[view]["reliability"] == pytest.approx([works(hours) for hours in found["hours"]], rel=1e-12)
        assert found[view]["unreliability"][0] == 0
    lidar = shared_small.get("/api/analysis/curves", path="see/lidar", horizon=100, points=2)
    assert lidar["nominal"]["hazard_rate"] == pytest.approx([LIDAR, LIDAR])
    assert lidar["nominal"]["remaining_life"]["median"] == pytest.approx(math.log(2) / LIDAR)


def test_can_i_do_this(shared_small):
    task = {"name": "round", "legs": [{"distance": "360 m", "speed": "0.1 m/s"}]}
    answer = shared_small.post("/api/tasks/predict", {"tasks": [task, task]})
    assert answer["tasks"][0]["duration"] == pytest.approx(1)
    assert (answer["distance"], answer["duration"]) == (pytest.approx(720), pytest.approx(2))
    whole = answer["together"]["nominal"]
    assert whole["probability"] == pytest.approx(works(2), rel=1e-12)
    assert whole["failure"] == pytest.approx(1 - works(2), rel=1e-9)
    assert {one["path"] for one in answer["deciding"][:2]} == {"drive/motor", "drive/encoder"}
    refused = shared_small.post("/api/tasks/predict", {"tasks": [{"legs": [{"distance": "5 kg"}]}]}, 422)
    assert "does not measure what 'm' does" in refused["message"]


def test_a_prognosis_tells_how_far_it_is_and_can_be_cancelled(shared_small):
    task = {"legs": [{"duration": "100 h"}]}
    job = shared_small.post("/api/tasks/prognosis", {"tasks": [task], "repeat": 50, "threshold": 0.99})
    found = finished(shared_small, job)["prognosis"]
    each = [works(100 * n) / works(100 * (n - 1)) for n in range(1, 51)]
    assert found["repetitions"] == list(range(1, 51))
    assert found["nominal"]["probability"] == pytest.approx(each, rel=1e-9)
    assert found["nominal"]["together"]["probability"] == pytest.approx(works(5000), rel=1e-9)
    below = [n for n, p in enumerate(each, 1) if p < 0.99]
    assert found["nominal"]["below_at"] == (below[0] if below else None)
    long = shared_small.post("/api/tasks/prognosis", {"tasks": [task] * 200, "repeat": 1_000_000})
    assert shared_small.client.delete(f"/api/jobs/{long['number']}").status_code == 200
    assert finished(shared_small, long)["state"] == "cancelled"
    assert shared_small.client.get("/api/jobs/12345").status_code == 404


def finished(served, job):
    """The job when it is over, within a minute."""
    until = time.monotonic() + 60
    while job["state"] in ("waiting", "running") and time.monotonic() < until:
        time.sleep(0.1)
        job = served.get(f"/api/jobs/{job['number']}")
    return job


def test_what_if_changes_nothing(shared_small):
    before = shared_small.get("/api/design")
    found = shared_small.post(
        "/api/analysis/what-if",
        {"operations": [{"op": "delete", "path": ["modules", "see", "components", "camera"]}], "horizon": 1000},
    )
    changed = found["changed"]["nominal"]["reliability"][-1]
    assert changed == pytest.approx(math.exp(-(MOTORS + ENCODER + LIDAR) * 1000), rel=1e-12)
    assert found["baseline"]["nominal"]["reliability"][-1] == pytest.approx(works(1000), rel=1e-12)
    assert shared_small.get("/api/design") == before


def test_importance_and_cut_sets(shared_small):
    parts = shared_small.get("/api/analysis/importance", hours=1000)["parts"]
    motors = next(one for one in parts if one["part"] == "drive/motor")
    without = (1 - (1 - math.exp(-LIDAR * 1000)) * (1 - math.exp(-CAMERA * 1000))) * math.exp(-ENCODER * 1000)
    assert motors["birnbaum"] == pytest.approx(without, rel=1e-9)
    assert shared_small.get("/api/analysis/cut-sets")["counted"].startswith("3 minimal cut sets: 2 of 1, 1 of 2")


def test_what_is_infinite_is_not_what_does_not_apply(small):
    """Of the only way to fail: without it nothing would (RRW = Q / 0); where nothing fails, 0 / 0 is no number."""
    for rate, wanted in (("8 FPMH", "Infinity"), ("unknown", None)):
        design = {"op": "put", "path": ["modules"], "value": {"drive": {"components": {"motor": {"rate": rate}}}}}
        small.edit(design)
        (motor,) = small.get("/api/analysis/importance", hours=1000)["parts"]
        assert motor["reduction"] == wanted
    said = small.get("/api/analysis/importance", hours=1000)["unknown"]
    assert said["failing"] == "at least"
    assert "1 part of unknown rate is left out of the totals: a figure without 'at least'" in said["sentence"]
    assert "a probability of failing is at least" in small.get("/api/analysis/cut-sets")["unknown"]


def test_the_drawing_has_every_part_once_and_the_gate(shared_small):
    drawing = shared_small.get("/api/design/drawing", path="see", width=600)
    assert sorted(box["part"] for box in drawing["boxes"]) == ["see/camera", "see/lidar"]
    assert [gate["text"] for gate in drawing["gates"]] == ["1/2"]
    refused = shared_small.client.get("/api/design/drawing", params={"path": "sea"})
    assert refused.status_code == 422
    assert "known: drive, see" in refused.json()["message"]


def test_every_model_is_a_form_and_answers_as_the_command_line(shared_small):
    from robophm.hazard.handbooks import handbook_models

    names = [one["name"] for one in shared_small.get("/api/library")["models"]]
    assert names == handbook_models()
    for name in names:
        form = shared_small.get(f"/api/library/models/{name}")
        assert all(one["options"] for one in form["inputs"] if one["kind"] == "choice")
    said = {"style": "CDR", "capacitance": "1 uF", "temperature": "45 degC", "dc_voltage": "5 V",
            "rated_voltage": "16 V", "environment": "GM"}  # fmt: skip
    answer = shared_small.post("/api/library/rate", {"model": "mil_hdbk_217f.capacitor", "inputs": said})
    assert math.prod(one["value"] for one in answer["factors"]) == pytest.approx(answer["hazard_rate"])
    refused = shared_small.post("/api/library/rate", {"model": "mil_hdbk_217f.capacitor",
                                                      "inputs": {**said, "temperature": "45 kg"}}, 422)  # fmt: skip
    assert "temperature" in refused["message"]
    own = {"formula": "a * exp(b)", "unit": "FPMH", "variables": {"a": 3, "b": 0}}
    assert shared_small.post("/api/library/formula", own)["hazard_rate"] == pytest.approx(3e-6)
    for formula in ("__import__('os')", "a.b", "a(", "9**9**9"):
        shared_small.post("/api/library/formula", {**own, "formula": formula}, 422)


def test_imports_are_looked_at_before_anything_changes(shared_small):
    listed = b"Reference,Value,Footprint,Qty\nR1 R2,10k,R_0603,2\nC1,100n,C_0603,1\n"
    answer = shared_small.client.post("/api/imports/parts-list", params={"name": "../board.csv"}, content=listed)
    assert answer.status_code == 200, answer.text
    assert answer.json()["mapping"]["reference"] == "Reference"
    assert len(answer.json()["rows"]) == 2
    assert "motor" in answer.json()["text"]
    old = (OTA.parents[2] / "tests" / "data" / "legacy_ota.yaml").read_bytes()
    answer = shared_small.client.post("/api/imports/legacy", content=old)
    assert any("25MHz" in one for one in answer.json()["findings"])
    refused = shared_small.client.post("/api/imports/legacy", content=b"\x00\xff")
    assert refused.status_code == 422
    assert "/tmp" not in refused.json()["message"]
    assert shared_small.get("/api/design")["revision"] == 1


def test_two_people_edit_and_neither_loses(small):
    body = {"revision": 1, "operations": [{"op": "put", "path": ["name"], "value": "mine"}]}
    small.post("/api/design/edits", body)
    stale = small.post(
        "/api/design/edits", {**body, "operations": [{"op": "put", "path": ["name"], "value": "his"}]}, 409
    )
    assert stale["yours"] == 1
    assert stale["current"]["revision"] == 2
    assert stale["current"]["document"]["name"] == "mine"


@pytest.fixture(scope="module")
def watched(tmp_path_factory):
    design = tmp_path_factory.mktemp("watched") / "robot.yaml"
    design.write_bytes(OTA.read_bytes())
    with serving(design, seed=3, journal=design.with_name("run.journal")) as served:
        served.post("/api/monitoring/start", {"source": "synthetic", "speed": 1000})
        until = time.monotonic() + 60
        while served.get("/api/health")["samples"] < 3000 and time.monotonic() < until:
            time.sleep(0.2)
        yield served


def frame(data):
    length = int.from_bytes(data[:4], "little")
    header, at, found = json.loads(data[4 : 4 + length]), 4 + length, {}
    assert at % 8 == 0
    for name, count in header["series"]:
        found[name] = Points(np.frombuffer(data, "<f8", count, at), np.frombuffer(data, "<f8", count, at + 8 * count))
        at += 16 * count
    assert at == len(data)
    return header, found


def test_live_values_are_the_samples_each_once_for_every_browser(watched):
    signal = "/ota/power/temperature.temperature"
    truth = {sample.time / SECOND: sample.value for sample in SyntheticOta(seed=3).samples([signal])}
    url = watched.address.replace("http", "ws") + "api/live"
    with connect(url) as one, connect(url) as other:
        for socket in (one, other):
            socket.send(json.dumps({"watch": [signal], "seconds": 1e6, "pixels": 4000}))
        for socket in (one, other):
            times = []
            while len(times) < 200:
                for points in frame(socket.recv(timeout=20))[1].values():
                    times += points.times.tolist()
                    assert [truth[at] for at in points.times.tolist()] == points.values.tolist()
            assert times == sorted(set(times))


def drained(socket):
    """All that comes, until the other side closes."""
    while True:
        socket.recv(timeout=5)


def test_history_keeps_the_extremes(watched):
    signal = "/ota/odom.pose.pose.position.x"
    with connect(watched.address.replace("http", "ws") + "api/live") as socket:
        socket.send(json.dumps({"history": signal, "id": 7, "from": 0, "to": 1e10, "pixels": 20}))
        while True:
            header, found = frame(socket.recv(timeout=20))
            if header["kind"] == "history":
                break
    assert header["id"] == 7
    assert 2 <= len(found[signal].times) <= 40
    socket_text = [b"x", b"[]", b'{"watch": 5}', b'{"history": "a"}', b'{"watch": ["' + b"a" * 2000 + b'"]}']
    for text in socket_text:
        with connect(watched.address.replace("http", "ws") + "api/live") as socket:
            socket.send(text.decode())
            with pytest.raises(ConnectionClosed, match="1003"):
                drained(socket)


def test_it_watches_without_a_browser_and_stops_when_told(watched):
    health = watched.get("/api/health")
    assert health["monitoring"] == "running"
    assert [one["signal"] for one in health["sensors"] if one["stale"]] == []
    assert health["subjects"][0]["sensor_based"]["remaining_life"]["median"] > 0
    power = next(one for one in health["sensors"] if "power" in one["signal"])
    tested = watched.post("/api/sensors/test", {"topic": "/ota/power/temperature", "field": "temperature",
                                                "unit": "degC", "wanted": "K"})  # fmt: skip
    assert tested["value"] == pytest.approx(power["value"] + 273.15, abs=5)
    metrics = watched.client.get("/metrics").text
    assert "robophm_monitoring 1" in metrics
    assert 'robophm_hazard_rate_per_hour{robot="OTA",path="Power",view="sensor_based"}' in metrics
    assert watched.post("/api/monitoring/start", {"source": "synthetic"}, 422)["message"].startswith("monitoring runs")
    until = time.monotonic() + 60
    done = []
    while not done and time.monotonic() < until:
        time.sleep(0.1)
        done = [one for one in watched.get("/api/tasks/arrived")["tasks"] if one["actual"]]
    assert done
    assert all(0 < one["actual"]["chance"]["nominal"]["probability"] < 1 for one in done)
    assert watched.post("/api/monitoring/stop")["state"] == "stopped"
    end = watched.get("/api/health")
    assert end["state"] != "ok"
    assert end["samples"] >= health["samples"]
    journal = watched.design.with_name("run.journal").read_text().splitlines()
    assert sum(not line.startswith("#") for line in journal) == end["samples"]


def test_a_source_that_is_not_there_is_said(small):
    for asked, words in (({"source": "tape"}, "no source 'tape'"), ({"source": "synthetic"}, "listens to nothing")):
        assert words in small.post("/api/monitoring/start", asked, 422)["message"]
    assert small.client.get("/api/topics", params={"source": "synthetic"}).status_code == 200


def test_a_ring_keeps_the_latest_and_its_extremes():
    series = Series(kept=64)
    for i in range(1000):
        series.add(float(i), float(i % 10))
    times, values = series.since(0)
    assert times[-1] == 999
    assert times.tolist() == sorted(times.tolist())
    assert (values == times % 10).all()
    assert series.since(998).times.tolist() == [998.0, 999.0]
    rng = np.random.default_rng(1)
    many = Points(np.arange(10_000.0), rng.normal(size=10_000))
    few = decimated(many, 100)
    assert len(few.times) <= 200
    for column in range(100):  # brute force: each column's own extremes are there
        inside = (many.times / many.times[-1] * 100).astype(int).clip(max=99) == column
        kept = few.values[np.isin(few.times, many.times[inside])]
        assert {kept.min(), kept.max()} == {many.values[inside].min(), many.values[inside].max()}


def test_the_report_on_paper(shared_small):
    pytest.importorskip("weasyprint", exc_type=Exception, reason="no WeasyPrint, or no Pango")
    answer = shared_small.client.get("/api/report.pdf")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/pdf")
    assert answer.content[:5] == b"%PDF-"
