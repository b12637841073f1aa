"""Which files are meant."""

from __future__ import annotations

from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.transports.recordings.files import recordings_in


def test_recordings_as_named_and_those_in_folders_in_order(tmp_path: Path) -> None:
    day = tmp_path / "day"
    day.mkdir()
    for name in ("b.mcap", "a.bag", "notes.txt"):
        (day / name).touch()
    table = tmp_path / "run.csv"
    table.touch()
    assert recordings_in([table, day]) == (table, day / "a.bag", day / "b.mcap")
    assert recordings_in([]) == ()


def test_what_is_not_there_is_said_with_what_is(tmp_path: Path) -> None:
    (tmp_path / "run.mcap").touch()
    with pytest.raises(SourceError, match=r"rum.mcap: no such file; did you mean 'run.mcap'"):
        recordings_in([tmp_path / "rum.mcap"])
    (tmp_path / "empty").mkdir()
    with pytest.raises(SourceError, match="holds no recording"):
        recordings_in([tmp_path / "empty"])
