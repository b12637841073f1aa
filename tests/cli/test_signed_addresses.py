"""Addresses that let anybody read who knows them: no command shows them, nor what it writes."""

from __future__ import annotations

import logging
import os
from pathlib import Path

import pytest

from robophm.core.signal import SECOND
from robophm.transports.recordings import remote
from robophm.transports.synthetic import SyntheticOta

from ..transports.recordings.test_signed_addresses import SECRETS, Store, store
from .conftest import EXAMPLE, Run

__all__ = ["store"]


def test_no_face_store_or_log_shows_the_query(
    store: Store, tmp_path: Path, inside: Run, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    recorded = SyntheticOta(seed=1, duration=600 * SECOND).record(tmp_path / "day.mcap")
    (store.folder / recorded.name).write_bytes(recorded.read_bytes())
    (store.folder / "cut.mcap").write_bytes(recorded.read_bytes()[:-5000])
    (store.folder / "none.csv").write_bytes(b"nothing")
    design = str(EXAMPLE)
    said = ""
    day, cut, wrong = (store.address(name) for name in ("day.mcap", "cut.mcap", "none.csv"))
    battery = ["--signal", "/ota/battery.voltage"]
    for command in (
        ["data", "list", day], ["data", "list", day, "--json"], ["data", "list", cut], ["data", "list", wrong],
        ["data", "list", store.address("day.mcap", "X-Amz-Signature=cret+word")],
        ["data", "statistics", day, *battery, "--to", "table.csv", "--report", "page.html"],
        ["data", "statistics", day, "--signal", "/ota/batery.voltage", "--json"],
        ["data", "find", day, *battery, "--above", "1 V"], ["data", "export", day, *battery, "--to", "out.csv"],
        ["data", "profile", design, day, "--to", "load.yaml", "--report", "profile.html"],
        ["replay", design, day, "--store", "health.db", "--report", "report.html"],
        ["replay", design, day, cut, "--json"], ["replay", design, day, "--store", "health.db"],
        ["wear", design, day], ["bind", design, day], ["new", "first.yaml", "--bag", day],
        ["task", design, day, "--json"], ["history", design, "--store", "health.db"],
    ):  # fmt: skip
        result = inside(*command)
        said += f"\n$ {command[0]} {command[1]}\n{result.stdout}{result.stderr}"
        assert "Usage" not in result.stderr, result.stderr  # every command is as it is meant
    assert "day.mcap" in said
    assert "cut.mcap" in said
    written = [path for path in tmp_path.iterdir() if path.is_file()]
    copies = [Path(folder) / name for folder, _, names in os.walk(remote._folder()) for name in names]
    content = [said.encode(), caplog.text.encode(), *(path.read_bytes() for path in written)]
    content += [str(path).encode() for path in copies]
    for secret in SECRETS:
        lines = [line for one in content for line in one.splitlines() if secret.encode() in line]
        assert lines == []
    assert {"health.db", "report.html", "out.csv", "load.yaml", "page.html", "table.csv"} <= {
        path.name for path in written
    }
