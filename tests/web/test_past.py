"""The robot's past beside its design: it goes on over stops, starts, edits and restarts of the service."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import StoreError
from robophm.core.signal import SECOND, Sample
from robophm.design.file import load
from robophm.health.ledger import Ledger
from robophm.monitoring.live_loop import watch
from robophm.monitoring.replay import replay
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.journal import Journal
from robophm.transports.recordings.opening import open_source
from robophm.web.service import Service
from robophm.web.sources import Choice

from .conftest import Printed, Served, serving, until

START = 1_795_000_020 * SECOND
MINUTES = 0.06
"""Hours of silence after drives, in which the cart still counts as on."""

CART = """\
schema_version: 1
name: cart
signals:
  temperature: {topic: /t, field: c, max_age: 60 s}
modules:
  drive:
    components:
      motor: {rate: 1e-4 /h, acceleration: {model: q10, reference_temperature: 25 degC}}
      brake: {rate: 2e-4 /h}
components:
  lamp: {rate: 3e-4 /h}
"""


@pytest.fixture
def cart(tmp_path: Path) -> Path:
    path = tmp_path / "cart.yaml"
    path.write_text(CART)
    return path


def drive(path: Path, hour: int) -> Path:
    """A journal of one hour, a sample every ten seconds, getting warmer."""
    with Journal(path, ["/t.c"]) as journal:
        for i in range(361):
            journal.write(Sample(START + (hour * 3600 + 10 * i) * SECOND, "/t.c", 25 + i / 20))
    return path


def live(path: Path) -> Choice:
    """A source that is no recording to the service: what it says counts in the robot's past."""
    return Choice("live", "live", lambda speed: open_source(path), lambda: (), False)


@contextmanager
def beside(design: Path, **settings: Any) -> Iterator[Served]:
    """The design served as ``robophm serve`` does without --store."""
    with serving(design, store=f"{design}.past", own_store=True, **settings) as served:
        yield served


def run_through(served: Served, source: str, speed: float = 10_000) -> None:
    served.post("/api/monitoring/start", {"source": source, "speed": speed})
    until(lambda: served.get("/api/monitoring")["state"] != "running")
    assert served.get("/api/monitoring")["error"] == ""


def ages(served: Served) -> dict[str, float]:
    """Hours that each part has behind it, by its path now."""
    robot = served.service.prepared().robot
    ledger = served.service.monitoring.last_ledger(robot)
    return {mode.path: float(age) for mode, age in zip(robot.modes, ledger.age.value, strict=True)}


def hours(**said: float) -> Any:
    return pytest.approx({path.replace("_", "/"): age for path, age in said.items()}, abs=MINUTES)


def test_the_past_goes_on_over_edits_starts_and_restarts(
    cart: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with beside(cart) as served:
        monkeypatch.setattr(Service, "sources", {"live": live(drive(tmp_path / "first", 0))})
        assert served.get("/api/design/past") == {"kept": False, "parts": [], "trouble": ""}
        run_through(served, "live")
        assert ages(served) == hours(drive_motor=1, drive_brake=1, lamp=1)
        rename = {"op": "rename", "path": ["modules", "drive"], "name": "traction"}
        move = {"op": "move", "path": ["components", "lamp"], "to": ["modules", "traction"]}
        new = {"op": "put", "path": ["components", "horn"], "value": {"rate": "1 FPMH"}}
        gone = {"op": "delete", "path": ["modules", "traction", "components", "brake"]}
        served.edit(rename, move, {"op": "put", "path": ["name"], "value": "wagon"})
        served.edit(gone)
        found = {one["path"]: one["said"] for one in served.get("/api/design/past")["parts"]}
        assert found == {
            "traction/motor": "goes on; was drive/motor",
            "traction/lamp": "goes on; was lamp",
            "drive/brake": "is kept aside, and goes on if it comes back",
        }
        state = served.post("/api/design/undo", {"revision": served.get("/api/design")["revision"]})
        served.post("/api/design/save", {"revision": state["revision"]})
        served.edit(new)
        monkeypatch.setattr(Service, "sources", {"live": live(drive(tmp_path / "second", 2))})
        run_through(served, "live")
        assert ages(served) == hours(traction_motor=2, traction_brake=2, traction_lamp=2, horn=1)
    with beside(cart) as served:
        assert ages(served) == hours(traction_motor=2, traction_brake=2, traction_lamp=2, horn=1)
        robot = served.service.prepared().robot
        assert (robot.name, robot.identity) == ("wagon", "cart")
        monkeypatch.setattr(Service, "sources", {"live": live(drive(tmp_path / "third", 4))})
        run_through(served, "live")
        assert ages(served) == hours(traction_motor=3, traction_brake=3, traction_lamp=3, horn=2)


@pytest.mark.full
def test_what_a_hand_edit_leaves_open_is_answered_on_the_page(
    cart: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with beside(cart) as served:
        monkeypatch.setattr(Service, "sources", {"live": live(drive(tmp_path / "first", 0))})
        run_through(served, "live")
    cart.write_text(CART.replace("brake", "clutch"))
    with beside(cart) as served:
        monkeypatch.setattr(Service, "sources", {"live": live(drive(tmp_path / "second", 2))})
        refused = served.post("/api/monitoring/start", {"source": "live"}, 422)
        assert "'drive/clutch' has no past, and 'drive/brake' has one, but is gone" in refused["message"]
        (asked, gone) = served.get("/api/design/past")["parts"]
        assert (asked["path"], asked["kind"], asked["candidates"]) == ("drive/clutch", "asked", ["drive/brake"])
        assert asked["place"] == ["modules", "drive", "components", "clutch"]
        assert (gone["path"], gone["kind"], gone["place"]) == ("drive/brake", "removed", [])
        served.edit({"op": "put", "path": [*asked["place"], "identity"], "value": "drive/brake"})
        run_through(served, "live")
        assert ages(served) == hours(drive_motor=2, drive_clutch=2, lamp=2)


def test_a_robot_renamed_by_hand_is_not_begun_anew_without_a_word(
    cart: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with beside(cart) as served:
        monkeypatch.setattr(Service, "sources", {"live": live(drive(tmp_path / "first", 0))})
        run_through(served, "live")
    cart.write_text(CART.replace("name: cart", "name: wagon"))
    with beside(cart) as served:
        monkeypatch.setattr(Service, "sources", {"live": live(drive(tmp_path / "second", 2))})
        refused = served.post("/api/monitoring/start", {"source": "live"}, 422)
        assert "known: cart; where it is 'cart' under another name, `identity: cart`" in refused["message"]
        assert served.get("/api/design/past")["trouble"] == refused["message"]


@pytest.mark.parametrize("store", [pytest.param(True, marks=pytest.mark.full), False])
def test_a_recording_that_was_stopped_goes_on_where_it_was(cart: Path, tmp_path: Path, store: bool) -> None:
    """It ends as one that was not, to the last bit; then it begins anew, and is no part of the robot's own past."""
    path = drive(tmp_path / "drive", 0)
    robot = load(cart)
    whole = watch(robot, open_source(path), period=1.0).ledger
    with beside(cart, recordings=(path,)) if store else serving(cart, recordings=(path,)) as served:
        run = lambda: served.service.monitoring.run  # noqa: E731
        for least in (50, 150):
            served.post("/api/monitoring/start", {"source": "recordings", "speed": 1000})
            until(lambda least=least: run().ledger and (run().ledger.newest or 0) >= START + 10 * least * SECOND)
            served.post("/api/monitoring/stop")
        assert run().state == "stopped"
        assert whole.newest > run().ledger.newest
        run_through(served, "recordings")
        for name in ("age", "effective", "hazard", "clocks"):
            assert getattr(run().ledger, name).value.tolist() == _settled(robot, whole, name).tolist()
        run_through(served, "recordings")
        assert ages(served) == hours(drive_motor=1, drive_brake=1, lamp=1)
    assert not Path(f"{cart}.past").exists()


def test_a_sensor_that_was_heard_before_this_start_is_not_called_never_heard(cart: Path, tmp_path: Path) -> None:
    path = drive(tmp_path / "drive", 0)
    for _ in range(2):  # the second has nothing left to hear
        with serving(cart, store=str(tmp_path / "store.db"), recordings=(path,)) as served:
            run_through(served, "recordings")
            (sensor,) = served.get("/api/health")["sensors"]
    assert (sensor["value"], sensor["age"]) == (None, pytest.approx(0.0, abs=60.0))


def _settled(robot: Any, ledger: Ledger, name: str) -> Any:
    from robophm.health.exposure import ExposureIntegrator

    return getattr(ExposureIntegrator(robot).settled(ledger), name).value


def test_whoever_asks_an_idle_service_again_and_again_costs_it_little(cart: Path, tmp_path: Path) -> None:
    """The same past is read and worked out once; what another process adds to it, or another store there, is seen."""
    past = Path(f"{cart}.past")

    def lived(*hours: int) -> None:
        with SqliteStore(past) as store:
            for hour in hours:
                replay(load(cart), drive(tmp_path / f"{hour}.journal", hour), store=store)

    def hours() -> float:
        return float(served.get("/api/health")["clocks"]["operating"])

    lived(0)
    with beside(cart) as served:
        prepared = served.service.prepared()
        reports = [prepared.health(*served.service.past(prepared))[0] for _ in range(2)]
        assert reports[0] is reports[1]
        assert hours() == pytest.approx(1, rel=1e-12)
        lived(1)
        assert hours() == pytest.approx(2, rel=1e-12)
        for one in tmp_path.glob("cart.yaml.past*"):
            one.unlink()
        assert hours() == 0


def test_where_the_past_is_kept_is_said(cart: Path, printed: Printed) -> None:
    assert printed(cart.parent, cart.name)[0][1] == "The robot's past is kept in cart.yaml.past"
    assert printed(cart.parent, cart.name, "--store", "sqlite:other.db")[0][1] == "The robot's past is kept in other.db"
    assert printed(cart.parent, cart.name, "--no-store")[0][1] == "The robot's past is kept only until then"
    assert sorted(path.name for path in cart.parent.iterdir()) == ["cart.yaml", "cart.yaml.access", "cart.yaml.edits"]


def test_a_store_of_another_version_is_refused_in_words(cart: Path, printed: Printed) -> None:
    with SqliteStore(f"{cart}.past") as store:
        store._base.execute("PRAGMA user_version = 99")
    said = r"a robophm store of version 99, of a newer robophm; this one knows up to version 4"
    with pytest.raises(StoreError, match=said):
        printed(cart.parent, cart.name)


MAY_NOT_WRITE = ["setpriv", *(f"--{which}=-dac_override,-dac_read_search" for which in ("bounding-set", "inh-caps"))]
"""Words before a command that make even the superuser heed the modes of folders."""


@pytest.mark.skipif(not shutil.which("setpriv"), reason="needs setpriv, of util-linux")
@pytest.mark.full
def test_in_a_folder_that_cannot_be_written_it_runs_on_and_says_so(cart: Path) -> None:
    cart.parent.chmod(0o555)
    with subprocess.Popen(
        [*(MAY_NOT_WRITE if os.geteuid() == 0 else ()), sys.executable, "-m", "robophm", "serve", cart.name,
         "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=cart.parent,
    ) as child:  # fmt: skip
        assert child.stdout
        assert child.stderr
        lines = [child.stdout.readline().strip() for _ in range(2)]
        child.terminate()
        words = child.stderr.read()
    assert "is served at http" in lines[0]
    assert lines[1] == "The robot's past is kept only until then"
    assert "cart.yaml.past: cannot be written; the robot's past is kept only until this ends" in words
    assert "cannot be written; edits cannot be saved, and are kept only until this ends" in words
    assert [path.name for path in cart.parent.iterdir()] == ["cart.yaml"]
