"""Recordings of Humble, which define no types: those of one's own are found in folders of .msg files."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Any

import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from robophm.cli import app as app_module
from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.signals.installed_definitions import FOLDERS, use_folders

T0 = 1_700_000_000 * SECOND
DRIVE = "std_msgs/Header header\nown_msgs/Motor[] motors\nint8 UNKNOWN=-1\nsensor_msgs/Temperature air\n"
MOTOR = "string name\nfloat32 current\ngeometry_msgs/Vector3 force\n"


@pytest.fixture
def record(tmp_path: Path) -> Path:
    """A recording of a type of one's own, without definitions."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(DRIVE, "own_msgs/msg/Drive"))
    store.register(get_types_from_msg(MOTOR, "own_msgs/msg/Motor"))
    types: Any = store.types
    with Writer(tmp_path / "drive", version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        connection = writer.add_connection("/drive", "own_msgs/msg/Drive", typestore=store)
        for step in range(5):
            stamp = types["builtin_interfaces/msg/Time"](T0 // SECOND + step, 3)
            header = types["std_msgs/msg/Header"](stamp, "base")
            force = types["geometry_msgs/msg/Vector3"](0.25 * step, 1.0, 2.0)
            motors = [types["own_msgs/msg/Motor"](name, 1.5 * step, force) for name in ("left", "right")]
            air = types["sensor_msgs/msg/Temperature"](header, 20.0 + step, 0.0)
            raw = store.serialize_cdr(types["own_msgs/msg/Drive"](header, motors, air), "own_msgs/msg/Drive")
            writer.write(connection, T0 + step * SECOND, raw)
    (path,) = (tmp_path / "drive").glob("*.db3")
    with sqlite3.connect(path) as database:
        database.execute("DROP TABLE IF EXISTS message_definitions")
    database.close()
    return path


def put(folder: Path, **texts: str) -> Path:
    """A package's .msg files."""
    folder.mkdir(parents=True)
    for name, text in texts.items():
        (folder / f"{name}.msg").write_text(text)
    return folder


LAYOUTS = {
    "installation": "share/own_msgs/msg",
    "workspace": "src/drivers/own_msgs/msg",
    "package": "own_msgs/msg",
}


def check(path: Path, origin: Path) -> None:
    with open_source(path) as source:
        found = source.samples(["/drive.motors[right].current", "/drive.motors[0].force.x", "/drive.air.temperature"])
        assert [(one.time, one.value) for one in found if one.signal.endswith("temperature")] == [
            (T0 + step * SECOND + 3, 20.0 + step) for step in range(5)
        ]
        assert [one.value for one in source.samples(["/drive.motors[right].current"])] == [1.5 * n for n in range(5)]
        assert source.notes == {f"definition of own_msgs/msg/Drive taken from {origin}": 1}
        assert "motors[].force.z" in source.topics()[0].fields


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS)
def test_they_are_found_in_a_folder_that_is_named(
    record: Path, tmp_path: Path, layout: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", "")
    monkeypatch.setenv(FOLDERS, "")
    put(tmp_path / "tree" / layout, Drive=DRIVE, Motor=MOTOR)
    with Recording(record) as recording:
        assert "has the type 'own_msgs/msg/Drive', whose definition is missing" in recording.undecoded()["/drive"]
    use_folders([tmp_path / "tree"])
    check(record, tmp_path / "tree")


def test_they_are_found_in_an_installation(record: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(FOLDERS, raising=False)
    put(tmp_path / "overlay/share/own_msgs/msg", Drive=DRIVE, Motor=MOTOR)
    put(tmp_path / "overlay/share/sensor_msgs/msg", Temperature="float32 other\n")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"{tmp_path / 'nowhere'}:{tmp_path / 'overlay'}")
    with pytest.raises(SourceError, match=r"no number .temperature.|has no field"):  # its installation is believed
        check(record, tmp_path / "overlay")
    (tmp_path / "overlay/share/sensor_msgs/msg/Temperature.msg").unlink()
    put(tmp_path / "other/share/own_msgs/msg", Drive=DRIVE, Motor=MOTOR)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "other"))
    check(record, tmp_path / "other")


def test_a_missing_part_is_said(record: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(FOLDERS, str(tmp_path / "tree"))
    put(tmp_path / "tree/own_msgs/msg", Drive=DRIVE)
    with open_source(record) as source, pytest.raises(SourceError, match="'own_msgs/msg/Drive' is missing or damaged"):
        source.samples(["/drive.air.temperature"])


def test_a_type_whose_name_is_a_path_is_not_followed(
    record: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(tmp_path / "outside/msg", Drive="float64 secret\n")
    (tmp_path / "tree").mkdir()
    monkeypatch.setenv(FOLDERS, str(tmp_path / "tree"))
    with sqlite3.connect(record) as database:
        database.execute("UPDATE topics SET type = '../outside/msg/Drive'")
    database.close()
    with Recording(record) as recording:
        assert recording.topics()[0].fields == ()


def test_the_command_line_takes_folders(record: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from typer.testing import CliRunner

    monkeypatch.setenv(FOLDERS, "")
    put(tmp_path / "tree/own_msgs/msg", Drive=DRIVE, Motor=MOTOR)
    done = CliRunner().invoke(
        app_module.app, ["--messages", str(tmp_path / "tree"), "data", "list", str(record), "--json"]
    )
    assert done.exit_code == 0
    assert '"motors[].current"' in done.stdout
    refused = CliRunner().invoke(app_module.app, ["--messages", str(tmp_path / "none"), "data", str(record)])
    assert isinstance(refused.exception, SourceError)
    assert "no such folder" in str(refused.exception)
