"""Files are what they hold, whatever they are called and however they are compressed as a whole."""

from __future__ import annotations

import gzip
import shutil
import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest
import zstandard

from robophm.core import registry
from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK
from robophm.measured.overview import overview
from robophm.measured.recordings import recordings
from robophm.stores.sqlite import SqliteStore
from robophm.transports.recordings.files import recordings_in
from robophm.transports.recordings.formats.csv import CsvRecording
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recognising import FORMATS, formats
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta

from ..conftest import SIGNALS
from ..test_contract import written

PACK = {
    "plain": lambda content: content,
    "zstd": lambda content: zstandard.ZstdCompressor().compress(content),
    "gzip": gzip.compress,
}


def file_of(recorded: dict[str, Path], suffix: str) -> Path:
    """One file of the drive: of a rosbag2 folder the one in it."""
    path = recorded[suffix]
    return path if path.is_file() else next(path.glob(f"*{suffix}"))


@pytest.mark.parametrize("packed", PACK)
@pytest.mark.parametrize("suffix", [".bag", ".db3", ".mcap"])
@pytest.mark.parametrize("name", ["drive", "drive.bag.active", "drive.mcap.zstd", "drive.csv", "drive.ulg.gz"])
def test_its_name_does_not_decide(
    recorded: dict[str, Path], drive: SyntheticOta, tmp_path: Path, suffix: str, packed: str, name: str
) -> None:
    path = tmp_path / name
    path.write_bytes(PACK[packed](file_of(recorded, suffix).read_bytes()))
    with open_source(path) as source, Recording(file_of(recorded, suffix)) as recording:
        assert sorted(source.samples(SIGNALS)) == sorted(drive.samples(SIGNALS))
        assert source.topics() == recording.topics()
        assert source.fingerprint == recording.fingerprint  # however it lies there it is counted once
    assert recordings_in([tmp_path]) == (path,)


def test_what_a_recorder_left_open_is_read_under_its_name(tmp_path: Path, drive: SyntheticOta) -> None:
    whole = drive.record(tmp_path / "drive.bag")
    left = tmp_path / "drive.bag.active"
    left.write_bytes(whole.read_bytes()[: whole.stat().st_size * 2 // 3])  # without its index
    whole.unlink()
    with open_source(tmp_path) as source:
        assert 20 < len(list(source.samples(SIGNALS[:1]))) < 30
        assert any("damaged, and read as far as it is whole" in note for note in source.notes)


def test_tables_and_journals_under_other_names(tmp_path: Path) -> None:
    table = tmp_path / "table.txt"
    table.write_text("time,/a.x\n1,2.5\n")
    journal = tmp_path / "journal.csv"
    journal.write_text("# robophm journal 1\n# signal /a.x\n1000000000 2.5 /a.x\n")
    for path in (table, journal):
        assert [one for one in open_source(path).samples(["/a.x"]) if one.signal != CLOCK] == [(10**9, "/a.x", 2.5)]


def test_content_that_cannot_decide_leaves_it_to_the_suffix(tmp_path: Path) -> None:
    path = tmp_path / "drive.CSV"
    path.write_text("TIME,/a.x\n1,2.5\n")
    with pytest.raises(SourceError, match=r"line 1: first column is 'TIME'; expected 'time'"):
        open_source(path)


def test_an_sqlite_file_without_messages_is_no_recording(tmp_path: Path) -> None:
    SqliteStore(tmp_path / "robots.db").close()
    with pytest.raises(SourceError, match="holds no recording"):
        recordings_in([tmp_path])
    with pytest.raises(
        SourceError,
        match=r"robots\.db: not a recording; expected bag, csv, dataflash, db3, journal, mavlink, mcap.* or a folder",
    ):
        open_source(tmp_path / "robots.db")


def test_what_cannot_be_unpacked_is_said_in_one_line(recorded: dict[str, Path], tmp_path: Path) -> None:
    whole = gzip.compress(recorded[".bag"].read_bytes())
    for name, content in {"head.bag.gz": whole[:8], "cut.bag.gz": whole[: len(whole) // 2]}.items():
        (tmp_path / name).write_bytes(content)
    with pytest.raises(SourceError, match=r"^[^\n]*head\.bag\.gz: cannot be read: [^\n]*$"):
        open_source(tmp_path / "head.bag.gz")
    with open_source(tmp_path / "cut.bag.gz") as source:
        assert any("the rest is lost" in note for note in source.notes)


@pytest.mark.parametrize("packed", ["gzip", "zstd"])
@pytest.mark.parametrize("name", [name for name in formats() if name not in ("bag", "db3", "mcap")])
def test_samples_that_are_compressed(packed: str, name: str, drive: SyntheticOta, tmp_path: Path) -> None:
    made = written(name)
    (tmp_path / "made").mkdir()
    with made.open(drive, tmp_path / "made") as plain:
        (whole,) = (tmp_path / "made").iterdir()
        path = tmp_path / "drive.gz"
        path.write_bytes(PACK[packed](whole.read_bytes()))
        with open_source(path) as source:
            wanted = [*made.names.values()]
            assert sorted(one for one in source.samples(wanted) if one.signal != CLOCK) == made.samples(drive, SIGNALS)
            assert source.topics() == plain.topics()
            assert source.fingerprint == plain.fingerprint
            assert (source.spans(), source.ends, source.notes) == (plain.spans(), plain.ends, plain.notes)
            with pytest.raises(SourceError, match=rf"^{path}: no (signal|topic) "):
                source.samples(["/nothing.at_all"])
            source.close()
        (recorded,) = recordings([path])
        assert {one.name for one in overview(recorded).topics} == {info.topic for info in plain.topics()}


def test_samples_whose_file_is_cut_are_read_as_far_as_they_unpack(tmp_path: Path) -> None:
    path = tmp_path / "drive.csv.gz"
    rows = "".join(f"{n},{n * n % 97}\n" for n in range(50_000))
    path.write_bytes(gzip.compress(f"time,/a.x\n{rows}1,2,3\n".encode())[:-40])
    with pytest.raises(SourceError, match=rf"^{path}, line \d+"), open_source(path) as source:
        list(source.samples(["/a.x"]))
    path.write_bytes(gzip.compress(b"time,/a.x\n1,2.5\n")[:-4])
    with open_source(path) as source:
        assert [one.value for one in source.samples(["/a.x"])] == [2.5]
        assert any("the rest is lost" in note for note in source.notes)


def test_tables_lie_beside_recordings_and_are_not_counted_again(recorded: dict[str, Path], tmp_path: Path) -> None:
    shutil.copy(recorded[".mcap"], tmp_path / "drive.mcap")
    (tmp_path / "drive.csv").write_text("time,/ota/battery.voltage\n1,2.5\n")
    assert recordings_in([tmp_path]) == (tmp_path / "drive.mcap",)


@pytest.mark.skipif(sys.platform == "win32", reason="needs named pipes")
def test_a_pipe_is_no_recording(tmp_path: Path) -> None:
    subprocess.run(["mkfifo", str(tmp_path / "drive.bag")], check=True)
    with pytest.raises(SourceError, match="is no regular file"):
        open_source(tmp_path / "drive.bag")


@pytest.fixture
def theirs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """A format of another package, by its module's text."""

    def offered(text: str) -> None:
        (tmp_path / "their_format.py").write_text(text)
        monkeypatch.syspath_prepend(str(tmp_path))
        entry = EntryPoint("theirs", "their_format", FORMATS)
        monkeypatch.setattr(registry, "entry_points", lambda *, group, name=None: [entry] if group == FORMATS else [])
        formats.cache_clear()

    yield offered
    formats.cache_clear()
    sys.modules.pop("their_format", None)


def test_a_format_of_another_package(theirs, tmp_path: Path) -> None:
    theirs(
        "from robophm.transports.recordings.format import SampleFormat\n"
        "from robophm.transports.recordings.formats.csv import CsvRecording\n"
        "FORMAT = SampleFormat(('.theirs',), lambda head: head.startswith(b'time,/theirs'), CsvRecording)\n"
    )
    path = tmp_path / "run"
    path.write_text("time,/theirs.x\n1,2.5\n")
    assert isinstance(open_source(path), CsvRecording)
    with pytest.raises(SourceError, match=r"expected .*mcap.*theirs.* or a folder"):
        open_source(Path(__file__))


def test_a_plug_without_a_format_is_named(theirs, tmp_path: Path) -> None:
    theirs("")
    (tmp_path / "run.bag").touch()
    with pytest.raises(SourceError, match=r"recording format 'theirs': their_format has no FORMAT"):
        open_source(tmp_path / "run.bag")


@pytest.mark.parametrize(("content", "says"), [
    (b"#ROSBAG V1.2\n" + bytes(99), r"cannot be read: no topic is defined in it$"),
    (b"#ROSBAG V1.1\n" + bytes(99), r"is a bag of version 1\.1; expected 1\.2 or 2\.0$"),
    (b"#ROSBAG V3.0\n" + bytes(99), r"is a bag of version 3\.0; expected 1\.2 or 2\.0$"),
    (b"#ROSBAG V\xff\n" + bytes(99), "cannot be read: is "),
    (b"\x89HDF\r\n\x1a\n" + bytes(99), "is HDF5, which is not read; expected its signals as a table"),
], ids=["1.2", "1.1", "3.0", "damaged", "HDF5"])  # fmt: skip
def test_what_is_not_read_says_the_way_out(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "old"
    path.write_bytes(content)
    with pytest.raises(SourceError, match=says) as error:
        open_source(path)
    assert "\n" not in str(error.value)
