"""Recordings as a robot that lost its power leaves them, by every command that reads them: what is there is read, what
is lost is said, and what cannot be read at all is one line and exit code 3."""

from __future__ import annotations

import json
import re
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

import robophm
from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.synthetic import SyntheticOta

T0 = 1_709_553_600 * SECOND
DESIGN = """\
schema_version: 1
name: cart
usage: {operating: 0.5}
components:
  battery:
    rate: 20 FPMH
    wear: {topic: /ota/battery, field: voltage, every: 2 s, threshold: 20}
"""
COMMANDS = ["replay", "data", "task", "wear", "python"]


@pytest.fixture
def ask(inside: Callable[..., Any], design: Path, tmp_path: Path) -> Callable[[str, Path], Any]:
    """Exit code, what was printed and what was said of it, by each way there is."""
    worn = tmp_path / "cart.yaml"
    worn.write_text(DESIGN)

    def ask(command: str, path: Path) -> Any:
        if command == "python":
            try:
                report = robophm.replay(robophm.load(worn), path, skip_missing=True)
            except SourceError as error:
                return 3, "", f"error: {error}\n"
            return 0, json.dumps(report.clocks), "\n".join(report.notes)
        words = {
            "replay": ("replay", worn, path, "--skip-missing"),
            "data": ("data", path),
            "task": ("task", design, path, "--skip-missing"),
            "wear": ("wear", worn, path, "--skip-missing"),
        }[command]
        result = inside(*words)
        return result.returncode, result.stdout, result.stderr + result.stdout

    return ask


@pytest.fixture(scope="module")
def known() -> dict[str, Any]:
    """What each command says of the sound recording, asked once."""
    return {}


@pytest.fixture
def sound(known: dict[str, Any], ask: Callable[[str, Path], Any], split: Path) -> Callable[[str], Any]:
    return lambda command: known.get(command) or known.setdefault(command, ask(command, split))


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A rosbag2 folder of two files, with a task that is done in each."""
    folder = tmp_path_factory.mktemp("split")
    parts = [SyntheticOta(seed=5, start=T0 + begin * SECOND, duration=900 * SECOND) for begin in (0, 900)]
    one, other = (part.record(folder / f"part_{number}.db3") for number, part in enumerate(parts))
    shutil.move(other / "part_1.db3", one)
    text = (one / "metadata.yaml").read_text().replace("  - part_0.db3", "  - part_0.db3\n  - part_1.db3")
    assert "part_1.db3" in text
    (one / "metadata.yaml").write_text(text)
    return one


def said_in_one_line(text: str) -> bool:
    return text.count("\n") == 1 and text.startswith("error: ") and "Traceback" not in text


@pytest.fixture
def folder(split: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(split, tmp_path / "drive"))


def changed(path: Path, *words: tuple[str, str]) -> None:
    text = path.read_text()
    for old, new in words:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text)


METADATA: dict[str, Callable[[Path], Any]] = {
    "empty": lambda path: path.write_text(""),
    "gone": lambda path: path.unlink(),
    "no YAML": lambda path: path.write_text("a: [\n"),
    "a list": lambda path: path.write_text("- 1\n"),
    "no files": lambda path: path.write_text("rosbag2_bagfile_information: {version: 5}\n"),
    "no texts": lambda path: path.write_text("rosbag2_bagfile_information: {relative_file_paths: [{a: 1}, 3]}\n"),
    "bytes": lambda path: path.write_bytes(b"\xff\xfe\x00"),
    "bomb": lambda path: path.write_text(
        "a: &a [1,1,1,1,1,1,1,1,1,1]\n" + "".join(f"{b}: &{b} [{', '.join([f'*{a}'] * 10)}]\n"
                                                  for a, b in zip("abcdefghi", "bcdefghij", strict=True))
    ),
    "lies": lambda path: path.write_text(
        re.sub(r"message_count: \d+", "message_count: 7", path.read_text().replace("since_epoch: 1", "since_epoch: 3"))
    ),
    "another storage": lambda path: changed(path, ("sqlite3", "tape")),
    "compressed": lambda path: changed(path, ("compression_mode: ''", "compression_mode: MESSAGE")),
}  # fmt: skip


@pytest.mark.full
@pytest.mark.parametrize(
    ("what", "command"), [*((what, "python") for what in METADATA), *(("empty", command) for command in COMMANDS[:4])]
)
def test_what_metadata_says_is_not_believed(what: str, command: str, folder: Path, ask: Any, sound: Any) -> None:
    expected = sound(command)
    METADATA[what](folder / "metadata.yaml")
    code, printed, said = ask(command, folder)
    assert code == expected[0]
    assert "Traceback" not in said
    if command == "python":
        assert printed == expected[1]
    if what in ("empty", "no YAML", "a list", "no files", "no texts", "bytes", "bomb"):
        assert "metadata.yaml" in said


@pytest.mark.parametrize("command", COMMANDS)
def test_files_that_were_renamed_are_read(command: str, folder: Path, ask: Any, sound: Any) -> None:
    expected = sound(command)
    for part in sorted(folder.glob("*.db3")):
        part.rename(folder / f"moved_{part.name}")
    code, printed, said = ask(command, folder)
    assert code == expected[0]
    assert "moved_part_0.db3,moved_part_1.db3areread" in "".join(said.split())
    assert "lost" not in said
    if command == "python":
        assert printed == expected[1]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("damage", ["missing", "empty", "garbage", "cut"])
def test_a_lost_split_costs_itself_alone(damage: str, command: str, folder: Path, ask: Any) -> None:
    part = folder / "part_1.db3"
    content = part.read_bytes()
    part.unlink()
    if damage != "missing":
        part.write_bytes({"empty": b"", "garbage": b"x" * 9999, "cut": content[:5000]}[damage])
    code, printed, said = ask(command, folder)
    assert code == 0
    assert "part_1.db3" in "".join(said.split())
    assert "lost" in said or "damaged" in said
    if command == "python":
        assert 0.24 < json.loads(printed)["calendar"] < 0.26


@pytest.mark.parametrize("damage", ["nothing", "no files", "empty file", "garbage", "a file that is a folder"])
@pytest.mark.parametrize(
    ("suffix", "command"), [*((".db3", command) for command in COMMANDS), (".mcap", "python"), (".bag", "python")]
)
def test_what_cannot_be_read_at_all_is_one_line(
    suffix: str, damage: str, command: str, ask: Any, tmp_path: Path
) -> None:
    folder = tmp_path / "drive"
    folder.mkdir()
    name = f"a{suffix}"
    if damage != "nothing":
        (folder / "metadata.yaml").write_text(f"rosbag2_bagfile_information: {{relative_file_paths: [{name}]}}\n")
    if damage in ("empty file", "garbage"):
        (folder / name).write_bytes(b"" if damage == "empty file" else b"garbage" * 99)
    if damage == "a file that is a folder":
        (folder / name).mkdir()
    code, _, said = ask(command, folder)
    assert code == 3
    assert said_in_one_line(said)
    if damage in ("empty file", "garbage"):
        code, _, said = ask(command, folder / name)
        assert code == 3
        assert said_in_one_line(said)


@pytest.mark.parametrize("command", COMMANDS)
def test_one_bit_of_an_index_hides_nothing(command: str, folder: Path, ask: Any, sound: Any) -> None:
    """SQLite itself, asked by the index, then sees less."""
    expected = sound(command)
    part = folder / "part_0.db3"
    content = bytearray(part.read_bytes())
    with closing(sqlite3.connect(part)) as database, database:
        (root,) = database.execute("SELECT rootpage FROM sqlite_master WHERE name = 'timestamp_idx'").fetchone()
        (page,) = database.execute("PRAGMA page_size").fetchone()
        (messages,) = database.execute("SELECT count(*) FROM messages NOT INDEXED").fetchone()
    database.close()
    content[(root - 1) * page + 4] ^= 1  # how many cells its first page has
    part.write_bytes(content)
    with closing(sqlite3.connect(part)) as database, database:
        try:
            (seen,) = database.execute("SELECT count(*) FROM messages INDEXED BY timestamp_idx").fetchone()
        except sqlite3.DatabaseError:
            seen = 0
    database.close()
    assert seen < messages
    code, printed, said = ask(command, folder)
    assert code == expected[0]
    assert "indexisdamagedandwasnotasked" in "".join(said.split())
    if command == "python":
        assert printed == expected[1]


@pytest.mark.full
@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
@pytest.mark.parametrize("kept", [0.3, 0.9])
def test_of_two_that_overlap_a_cut_one_takes_nothing_from_the_other(kept: float, suffix: str, tmp_path: Path) -> None:
    """Both begin and end within each other; that one is cut may cost its own samples alone."""
    robot = robophm.load(Path(__file__).parents[2] / "examples" / "ota" / "robot.yaml")
    one = SyntheticOta(seed=5, start=T0, duration=1800 * SECOND).record(tmp_path / f"one{suffix}")
    other = SyntheticOta(seed=6, start=T0 + 60 * SECOND, duration=1800 * SECOND).record(tmp_path / f"other{suffix}")
    cut = one / f"one{suffix}" if one.is_dir() else one
    content = cut.read_bytes()
    cut.write_bytes(content[: int(len(content) * kept)])
    if one.is_dir():  # each file named by itself
        one, other = cut, other / f"other{suffix}"
    for given in ([one, other], [other, one]):
        report = robophm.replay(robot, given, skip_missing=True)
        assert not [note for note in report.notes if "late" in note]
        assert report.clocks["calendar"] == pytest.approx(1859 / 3600, abs=5 / 3600)
        assert any("lost" in note for note in report.notes)


@pytest.mark.parametrize(
    ("suffix", "kept", "says"),
    [
        (
            "mcap",
            500,
            r": \d+ bytes of a file that is cut or damaged at byte \d+ lost; no message that can be read is left",
        ),
        (
            "bag",
            2000,
            r": \d+ bytes of a file that is cut or damaged at byte 13 lost; no message that can be read is left",
        ),
        ("db3", 3000, r": is cut short: 3000 bytes; expected \d+; no table can be read: no such table: topics"),
    ],
)
def test_of_a_file_whose_begin_alone_is_left_it_is_said_that_it_is_cut(
    suffix: str, kept: int, says: str, tmp_path: Path, ask: Any
) -> None:
    written = SyntheticOta(seed=5, start=T0, duration=60 * SECOND).record(tmp_path / f"drive.{suffix}")
    content = (written / f"drive.{suffix}" if written.is_dir() else written).read_bytes()
    (path := tmp_path / f"cut.{suffix}").write_bytes(content[:kept])
    code, _, said = ask("replay", path)
    assert code == 3
    assert re.fullmatch(f"error: {re.escape(str(path))}{says}\n", said)
