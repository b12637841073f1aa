"""What a design file held before it was written is kept beside it, and a later write takes nothing of it away."""

from __future__ import annotations

from pathlib import Path

import pytest

from robophm.core.errors import DesignError
from robophm.design.file import BACKUPS, replace_text, write


def beside(path: Path) -> dict[str, str]:
    return {other.name.removeprefix(path.name): other.read_text() for other in path.parent.iterdir() if other != path}


def test_each_write_keeps_what_was_there_and_all_before_it(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text("0")
    for i in range(1, 4):
        replace_text(path, str(i))
    assert path.read_text() == "3"
    assert beside(path) == {".bak": "2", ".bak.2": "1", ".bak.3": "0"}


def test_they_are_bounded_and_the_oldest_goes_first(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text("0")
    for i in range(1, 2 * BACKUPS):
        replace_text(path, str(i))
    kept = beside(path)
    assert len(kept) == BACKUPS
    assert [kept[".bak" if i == 1 else f".bak.{i}"] for i in range(1, BACKUPS + 1)] == [
        str(2 * BACKUPS - 1 - i) for i in range(1, BACKUPS + 1)
    ]


def test_to_write_the_same_again_pushes_nothing_out(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text("first")
    for _ in range(3 * BACKUPS):
        replace_text(path, "second")
    assert beside(path) == {".bak": "second", ".bak.2": "first"}


def test_a_design_is_written_whether_a_file_is_there_or_not(tmp_path):
    path = tmp_path / "robot.yaml"
    first, second = (f"schema_version: 1\nname: {name}\ncomponents: {{a: {{rate: 1 FIT}}}}\n" for name in "RS")
    assert write(path, first).name == "R"
    assert beside(path) == {}
    assert write(path, second).name == "S"
    assert (path.read_text(), beside(path)) == (second, {".bak": first})
    with pytest.raises(DesignError, match=r"robot\.yaml:1: schema_version: not stated; expected 1"):
        write(path, "name: T\n")
    assert (path.read_text(), beside(path)) == (second, {".bak": first})
    with pytest.raises(DesignError, match="cannot be written: No such file"):
        write(tmp_path / "no" / "robot.yaml", first)
