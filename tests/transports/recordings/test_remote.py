"""Recordings on a web server and in object storage: read as if they were here, fetched as far as they are asked for."""

from __future__ import annotations

import functools
import gzip
import logging
import re
import subprocess
import sys
import textwrap
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings import remote
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.looking import columns_of, spans_of, topics_of
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta

from .columns.test_sparse import drive

pytest.importorskip("obstore", reason="no obstore (make setup installs it)")

KINDS = [(".bag", ""), (".bag", "LZ4"), (".mcap", "NONE"), (".mcap", "LZ4")]
LEVEL = "/level.data"


class Server(ThreadingHTTPServer):
    """A web server of files in a folder, on the loopback interface, that counts what it has sent."""

    daemon_threads = True

    def __init__(self, folder: Path) -> None:
        super().__init__(("127.0.0.1", 0), Answer)
        self.folder = folder
        self.ranges = True
        self.tag = '"1"'
        self.short = False
        self.sent = 0
        self.counting = threading.Lock()

    def address(self, name: str) -> str:
        return f"http://127.0.0.1:{self.server_port}/{name}"


class Answer(BaseHTTPRequestHandler):
    """RFC 9110: HEAD and GET, single ranges, If-Match."""

    protocol_version = "HTTP/1.1"
    server: Server

    def do_HEAD(self) -> None:
        self.answer(head=True)

    def do_GET(self) -> None:
        self.answer(head=False)

    def answer(self, *, head: bool) -> None:
        path = self.server.folder / self.path.lstrip("/")
        if self.path == "/secret.mcap":
            return self.reply(403, b"", head)
        if not path.is_file():
            return self.reply(404, b"", head)
        size = path.stat().st_size
        if self.headers.get("If-Match", self.server.tag) != self.server.tag:
            return self.reply(412, b"", head)
        wanted = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        if not wanted or not self.server.ranges:
            return self.reply(200, path.read_bytes(), head)
        first, last = int(wanted[1]), min(int(wanted[2]), size - 1)
        with path.open("rb") as file:
            file.seek(first)
            part = file.read(last + 1 - first)
        return self.reply(206, part, head, f"bytes {first}-{last}/{size}")

    def reply(self, status: int, content: bytes, head: bool, part: str = "") -> None:
        self.send_response(status)
        self.send_header("Content-Length", str(len(content)))
        if self.server.tag:
            self.send_header("ETag", self.server.tag)
        self.send_header("Last-Modified", "Thu, 01 Jan 2026 00:00:00 GMT")
        if part:
            self.send_header("Content-Range", part)
        self.end_headers()
        if not head:
            self.wfile.write(content[: len(content) // 2] if self.server.short and part else content)
            with self.server.counting:
                self.server.sent += len(content)
        if self.server.short:
            self.close_connection = True

    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    folder = tmp_path / "served"
    folder.mkdir()
    with Server(folder) as served:
        thread = threading.Thread(target=served.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield served
        served.shutdown()
        thread.join()


@pytest.fixture(scope="module", params=KINDS, ids=lambda kind: "-".join(kind))
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six megabytes, nearly all images, six numbers among them."""
    suffix, compression = request.param
    return drive(tmp_path_factory.mktemp("recorded") / f"drive{suffix}", compression, 3)


def rows(path: str | Path, signal: str) -> tuple[list[int], list[float]]:
    blocks = list(columns_of([Path(path)], [signal]))
    topic, _, field = signal.partition(".")
    received = np.concatenate([block[topic].received for block in blocks])
    return received.tolist(), np.concatenate([block[topic].values[field] for block in blocks]).tolist()


def packed(path: Path) -> bool:
    return b"lz4" in path.read_bytes()


def test_numbers_among_images_are_read_without_the_images(recorded: Path, server: Server) -> None:
    (server.folder / recorded.name).write_bytes(recorded.read_bytes())
    address = server.address(recorded.name)
    assert topics_of(Path(address)) == topics_of(recorded)
    assert spans_of([Path(address)]) == spans_of([recorded])
    size = recorded.stat().st_size
    listed = server.sent
    assert listed < size / 4
    assert rows(address, LEVEL) == rows(recorded, LEVEL)
    if not packed(recorded):
        assert server.sent < size / 4
    again = server.sent
    with open_source(address) as source:
        assert isinstance(source, Recording)
        assert not source.lost()
        assert [value for _, signal, value in source.samples([LEVEL]) if signal == LEVEL] == rows(recorded, LEVEL)[1]
    assert server.sent <= max(again, size * 1.1)


def test_everything_is_read_as_it_is_here(recorded: Path, server: Server) -> None:
    (server.folder / recorded.name).write_bytes(recorded.read_bytes())
    address = server.address(recorded.name)
    for signal in ("/image.data[7]", LEVEL):
        assert rows(address, signal) == rows(recorded, signal)
    with open_source(address) as there, open_source(recorded) as source:
        assert there.fingerprint == source.fingerprint
        assert there.topics() == source.topics()
    assert server.sent < recorded.stat().st_size * 1.3


STRAYS = """
    import ctypes, mmap, sys
    import numpy as np
    from pathlib import Path
    from robophm.transports.recordings import remote
    from robophm.transports.recordings.columns import mapped
    from robophm.transports.recordings.looking import spans_of, topics_of
    from robophm.transports.recordings.columns import read_columns

    libc = ctypes.CDLL(None, use_errno=True)
    guarded = []
    map_, bring = mapped.MappedFile._map, remote.Fetched._write

    def protect(file, there):
        if file._memory is None:
            return
        address = file._content.__array_interface__["data"][0]
        for number, known in enumerate(there):
            known = known and (number or len(sys.argv) < 3)
            begin = number * remote.BLOCK
            length, allowed = min(remote.BLOCK, file.size - begin), mmap.PROT_READ if known else 0
            assert not libc.mprotect(ctypes.c_void_p(address + begin), length, allowed), ctypes.get_errno()

    def guard(file):
        content = map_(file)
        guarded[:] = [file]
        protect(file, file._fetched._there)
        return content

    def write(fetched, parts):
        bring(fetched, parts)
        for file in guarded:
            protect(file, fetched._there)

    mapped.MappedFile._map, remote.Fetched._write = guard, write
    path = Path(sys.argv[1])
    topics_of(path), spans_of([path])
    count = sum(len(block["/level"]) for block in read_columns(path, ["/level.data"]))
    there = remote.here(path).fetched._there
    print(count, there.mean() < 1)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="mprotect of Linux")
def test_nothing_is_read_that_was_not_fetched(recorded: Path, server: Server) -> None:
    """Pages that were not fetched may not be touched: a process that does is ended by the system."""
    (server.folder / recorded.name).write_bytes(recorded.read_bytes())
    command = [sys.executable, "-c", textwrap.dedent(STRAYS), server.address(recorded.name)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split()[0] == "6"
    assert done.stdout.split()[1] == str(not packed(recorded))  # each chunk has a number
    assert subprocess.run([*command, "stray"], capture_output=True, timeout=120).returncode == -11


@pytest.mark.parametrize("suffix", [".csv", ".db3", ".csv.gz"])
def test_what_is_not_read_in_parts_is_fetched_as_a_whole_and_that_is_said(
    suffix: str, server: Server, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    if suffix == ".db3":
        folder = SyntheticOta(seed=1, duration=3000 * SECOND).record(tmp_path / "x.db3")
        path, signal = next(folder.glob("*.db3")), "/ota/battery.voltage"
    else:
        table = "time,/t.x\n" + "".join(f"{1_700_000_000 + n},{n * 0.123456789}\n" for n in range(50_000))
        path, signal = tmp_path / f"x{suffix}", "/t.x"
        content = table.encode()
        path.write_bytes(gzip.compress(content, compresslevel=0) if suffix == ".csv.gz" else content)
    (server.folder / path.name).write_bytes(path.read_bytes())
    assert path.stat().st_size > remote.SMALL
    with caplog.at_level(logging.WARNING), open_source(server.address(path.name)) as there, open_source(path) as source:
        assert [*there.samples([signal])] == [*source.samples([signal])]
        assert there.fingerprint == source.fingerprint
    said = [record.getMessage() for record in caplog.records if "fetched" in record.getMessage()]
    assert len(said) == 1
    why = "its format is not read in parts"
    assert re.fullmatch(rf"{server.address(path.name)}: all of [\d.]+ MB is fetched: {why}", said[0])


def test_splits_that_lie_elsewhere_are_read_at_once_all_the_same(server: Server, tmp_path: Path) -> None:
    from benchmarks.transports import split

    drive = SyntheticOta(seed=1, duration=240 * SECOND).record(tmp_path / "drive.mcap")
    parts = sorted(split(drive, tmp_path / "parts").iterdir())
    for part in parts:
        (server.folder / part.name).write_bytes(part.read_bytes())
    assert len(parts) >= 4
    signal = "/ota/battery.voltage"
    with open_source(*(server.address(part.name) for part in parts)) as there, open_source(drive) as source:
        assert [*there.samples([signal])] == [*source.samples([signal])]
        assert there.topics() == source.topics()


def test_a_server_without_ranges_sends_the_whole(
    recorded: Path, server: Server, caplog: pytest.LogCaptureFixture
) -> None:
    (server.folder / recorded.name).write_bytes(recorded.read_bytes())
    server.ranges, server.tag = False, ""
    with caplog.at_level(logging.WARNING):
        assert rows(server.address(recorded.name), LEVEL) == rows(recorded, LEVEL)
    assert "what serves it knows no ranges of bytes" in caplog.text


def test_one_that_was_not_closed_is_fetched_as_a_whole(server: Server, tmp_path: Path) -> None:
    path = drive(tmp_path / "cut.mcap", "NONE", 3)
    path.write_bytes(path.read_bytes()[:-60_000])
    (server.folder / path.name).write_bytes(path.read_bytes())
    here, there = read_columns(path, [LEVEL]), read_columns(server.address(path.name), [LEVEL])
    assert sum(len(block["/level"]) for block in here) == sum(len(block["/level"]) for block in there) > 3
    assert here.notes == there.notes


def test_what_cannot_be_had_is_one_line(server: Server, tmp_path: Path) -> None:
    path = drive(tmp_path / "drive.mcap", "NONE", 3)
    for name in ("a.mcap", "b.mcap", "c.mcap"):
        (server.folder / name).write_bytes(path.read_bytes())
    (server.folder / "empty.mcap").write_bytes(b"")
    for address, words in {
        server.address("none.mcap"): "no such file",
        server.address("secret.mcap"): "may not be read; expected who may in the environment",
        server.address("empty.mcap"): "is empty; expected a recording",
        server.address("a.mcap#1"): "has more than a path; expected an address without '#' or '@'",
        "s3://bucket/a.mcap?token=1": "has more than a path; expected an address without '?', '#' or '@'",
        "ftp://somebody:word@127.0.0.1/a.mcap?token=1": "no place of recordings 'ftp'",
        "ftp://127.0.0.1/a.mcap": "no place of recordings 'ftp'",
        "htps://127.0.0.1/a.mcap": "no place of recordings 'htps'; did you mean",
    }.items():
        with pytest.raises(SourceError) as error:
            open_source(address)
        assert words in str(error.value)
        assert str(error.value).startswith(address.partition("?")[0].replace("somebody:word@", "").partition("#")[0])
        assert "token" not in str(error.value)
        assert "\n" not in str(error.value)
    with open_source(server.address("b.mcap")) as source:
        server.tag = '"2"'
        with pytest.raises(SourceError, match=r"/b\.mcap: was changed while it was read"):
            list(source.samples(["/image.data[3]"]))
    server.short = True
    with pytest.raises(SourceError, match=r"/c\.mcap: cannot be read: "):
        open_source(server.address("c.mcap"))


def test_without_obstore_it_is_said_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "obstore.store", None)
    with pytest.raises(SourceError, match=r"pip install 'robophm\[remote\]'"):
        open_source("s3://bucket/without.mcap")


def test_a_full_disk_is_not_filled(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    (server.folder / "large.csv").write_bytes(b"time,/t.x\n" + b"1,2\n" * 400_000)
    usage = functools.partial(type("Usage", (), {"free": 2_000_000}))
    monkeypatch.setattr(remote.shutil, "disk_usage", lambda _: usage())
    with pytest.raises(SourceError, match=r"large\.csv: has 2 MB; they do not fit on the disk here"):
        open_source(server.address("large.csv"))


def test_commands_take_addresses(server: Server, tmp_path: Path) -> None:
    path = drive(tmp_path / "drive.mcap", "NONE", 3)
    (server.folder / path.name).write_bytes(path.read_bytes())
    address = server.address(path.name)
    listed = CliRunner().invoke(app, ["data", "list", address])
    assert listed.exit_code == 0, listed.output
    assert "/level" in listed.output
    here = CliRunner().invoke(app, ["data", "list", str(path)]).output
    assert listed.output.split()[-20:] == here.split()[-20:]
    missing = CliRunner().invoke(app, ["data", "list", server.address("none.mcap")])
    assert missing.exit_code != 0


def test_files_here_may_be_called_anything(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = drive(tmp_path / "drive.mcap", "NONE", 3)
    (tmp_path / "s3:" / "bucket").mkdir(parents=True)
    path.rename(tmp_path / "s3:" / "bucket" / "drive.mcap")
    monkeypatch.chdir(tmp_path)
    assert len(rows("s3:/bucket/drive.mcap", LEVEL)[0]) == 6


@pytest.mark.parametrize("suffix", [".mcap", ".bag"])
def test_object_storage_that_speaks_s3(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A server that others keep, moto, by the protocol of S3, with a key."""
    moto = pytest.importorskip("moto.server", reason="no moto (make test-full installs it)")
    boto3 = pytest.importorskip("boto3", reason="no boto3 (make test-full installs it)")
    served = moto.ThreadedMotoServer("127.0.0.1", 0)
    served.start()
    try:
        host, port = served.get_host_and_port()
        for name, value in {
            "AWS_ACCESS_KEY_ID": "key", "AWS_SECRET_ACCESS_KEY": "secret", "AWS_REGION": "us-east-1",
            "AWS_ENDPOINT_URL": f"http://{host}:{port}",
        }.items():  # fmt: skip
            monkeypatch.setenv(name, value)
        client = boto3.client("s3", endpoint_url=f"http://{host}:{port}", region_name="us-east-1")
        client.create_bucket(Bucket="drives")
        path = drive(tmp_path / f"drive{suffix}", "NONE" if suffix == ".mcap" else "", 3)
        client.put_object(Bucket="drives", Key=f"monday morning/drive{suffix}", Body=path.read_bytes())
        address = f"s3://drives/monday morning/drive{suffix}"
        assert rows(address, LEVEL) == rows(path, LEVEL)
        copy = remote.here(address)
        assert isinstance(copy, remote.RemotePath)
        assert copy.fetched.fetched < path.stat().st_size / 4
        with pytest.raises(SourceError, match=r"s3://drives/none\.mcap: no such file"):
            open_source("s3://drives/none.mcap")
    finally:
        served.stop()
