"""``robophm fleet`` as people type it; ``serve`` and the robot's side run in processes of their own."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess

import pytest
from tests.cli.conftest import EXAMPLE
from tests.fleet.conftest import wait_for
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.cli.shared.fleet import TOKEN, TOKENS, fleet_address, token_of
from robophm.core.errors import RobophmError
from robophm.fleet.questions import reports, status
from robophm.fleet.store import FleetStore


def fleet(*words, code=0):
    done = CliRunner().invoke(app, ["fleet", *map(str, words)])
    assert done.exit_code == code, (done.output, done.exception)
    return done.stdout


def test_a_robot_reports_to_a_service_and_what_is_asked_of_it(command, tmp_path):
    path = tmp_path / "fleet.db"
    token = json.loads(fleet("token", "ota 7", "--store", path, "--json"))
    assert token["path"] == "/robots/ota%207"
    fleet("token", "ota-8", "--store", path)
    serving = [*command, "fleet", "serve", "--store", str(path), "--port", "0"]
    with subprocess.Popen(serving, stdout=subprocess.PIPE, text=True) as service:
        line = service.stdout.readline()
        assert line.startswith("Robots report to http://127.0.0.1:")
        address = line.split()[3].removesuffix("/robots/NAME")
        watching = [*command, "serve", str(EXAMPLE), "--synthetic", "--start", "synthetic", "--speed", "600", "--store",
                    str(tmp_path / "robot.db"), "--port", "0", "--fleet", f"{address}{token['path']}"]  # fmt: skip
        with subprocess.Popen(watching, env={**os.environ, TOKEN: token["token"]}, stdout=subprocess.DEVNULL) as robot:
            with FleetStore(path) as store:
                wait_for(lambda: len([*reports(store)]) >= 3)
            robot.send_signal(signal.SIGINT)
            assert robot.wait(60) == 0
        with FleetStore(path) as store:
            wait_for(lambda: status(store)[0].design)
        service.send_signal(signal.SIGINT)
        assert service.wait(60) == 0
    _asked(path, tmp_path)


def _asked(path, folder):
    """All questions, for people and for machines."""
    found = json.loads(fleet("status", "--store", path, "--json"))["robots"]
    assert [(one["robot"], one["design"], one["missing"], one["waiting"]) for one in found] == [
        ("ota 7", "OTA", 0, 0), ("ota-8", None, 0, None),
    ]  # fmt: skip
    assert "its clock is" in fleet("status", "--store", path) or abs(found[0]["clock_ahead"]) < 60
    said = json.loads(fleet("worst", "--store", path, "--horizon", "1 day", "--json"))
    assert (said["horizon"], said["of"], said["unknown"], said["robots"][0]["robot"]) == (24.0, 1, 1, "ota 7")
    assert 0 < said["robots"][0]["chance"] < 0.1
    text = fleet("worst", "--store", path)
    assert "P(fails within 7 days), of 1 robots" in text
    assert "Not known of 1 more" in text
    told = json.loads(fleet("history", "ota 7", "--store", path, "--json"))
    assert len(told["times"]) == found[0]["reports"]
    assert told["figures"]["failure_within.24"]["mean"][-1] == pytest.approx(said["robots"][0]["chance"])
    assert "P(fails within 1 week)" in fleet("history", "ota 7", "--store", path)
    assert "no reports of that time" in fleet("history", "ota-8", "--store", path)
    fleet("export", "--store", path, "--to", folder / "reports.csv")
    with (folder / "reports.csv").open() as file:
        rows = [*csv.DictReader(file)]
    assert len(rows) == found[0]["reports"]
    assert float(rows[-1]["failure_within.24"]) == pytest.approx(said["robots"][0]["chance"])
    fleet("export", "--store", path, "--to", folder / "all.jsonl", "--robot", "ota 7")
    (line,) = (folder / "all.jsonl").read_text().splitlines()
    assert json.loads(line)["ledger"]["modes"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["status", "--store", "none.db"], "no such file; expected a fleet's store"),
        (["history", "x", "--store", "fleet.db"], "no robot 'x'"),
        (["history", "x", "--store", "fleet.db", "--from", "2026-02", "--to", "2026-01-01"], "expected a date"),
        (["worst", "--store", "fleet.db", "--horizon", "1 year"], "expected one of them"),
        (["export", "--store", "fleet.db", "--to", "x.xlsx"], "ends in .csv or .jsonl"),
        (["export", "--store", "fleet.db", "--to", "x.csv", "--robot", "y"], "no robot 'y'"),
        (["token", "a/b", "--store", "fleet.db"], "expected a name"),
        (["serve", "--store", "fleet.db", "--key", "k.pem"], "expected --certificate too"),
    ],
)  # fmt: skip
def test_mistakes_are_said_on_one_line(inside, tmp_path, words, said):
    FleetStore(tmp_path / "fleet.db", make=True).close()
    done = inside("fleet", *words)
    assert done.returncode == 3
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "token", "said"),
    [
        (["--fleet", "https://h/robots/r"], "t", "expected --store too"),
        (
            ["--store", "r.db", "--fleet", "https://h/robots/r"],
            None,
            "expected the robot's token in ROBOPHM_FLEET_TOKEN",
        ),
        (["--store", "r.db", "--fleet", "http://h/robots/r"], "t", "expected https://host/robots/NAME"),
    ],
)
def test_a_robot_that_cannot_report_is_not_watched(inside, tmp_path, monkeypatch, words, token, said):
    if token:
        monkeypatch.setenv(TOKEN, token)
    done = inside("watch", EXAMPLE, *words)
    assert (done.returncode, said in done.stderr) == (3, True), done.stderr
    assert not (tmp_path / "r.db").exists()


def test_tokens_of_several_robots(tmp_path, monkeypatch):
    path, several = tmp_path / "tokens", "https://fleet.example/robots/*"
    path.write_text("amr_1 robophm_1\nsite_amr 2  robophm_2\n\n")
    monkeypatch.delenv(TOKENS, raising=False)
    with pytest.raises(RobophmError, match=f"expected the name of a file with the tokens of the robots in {TOKENS}"):
        fleet_address(several, "past.db", "amr_1")
    monkeypatch.setenv(TOKENS, str(path))
    assert fleet_address(several, "past.db", "amr_1").reports == "https://fleet.example/robots/amr_1/reports"
    assert (token_of("amr_1"), token_of("site_amr 2")) == ("robophm_1", "robophm_2")
    with pytest.raises(RobophmError, match=r"tokens: no token of amr_2; .*amr_1.*; expected a line 'amr_2 TOKEN'"):
        fleet_address(several, "past.db", "amr_2")
    with pytest.raises(RobophmError, match=r"is of one robot; expected https://host/robots/\* of several"):
        fleet_address("https://fleet.example/robots/amr_1", "past.db", "amr_1")
    path.unlink()
    with pytest.raises(RobophmError, match="tokens cannot be read: No such file"):
        token_of("amr_1")
