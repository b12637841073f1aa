"""Addresses with a query, as of links that are signed: they are read, and what lets others read is shown nowhere."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from http.server import ThreadingHTTPServer
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.transports.recordings.opening import open_source

from .test_remote import LEVEL, Answer, drive, rows

pytest.importorskip("obstore", reason="no obstore (make setup installs it)")

QUERY = "X-Amz-Signature=se%2Fcret+word&X-Amz-Date=20260101T000000Z"
"""What a server wants to see, letter by letter: a signature is one of the address as it was written."""

SECRETS = ("se%2Fcret", "cret+word", "se/cret", "X-Amz")


class Signed(Answer):
    """A server that gives files by a signed address alone, and by that no more than the file: no HEAD."""

    def answer(self, *, head: bool) -> None:
        path, _, query = self.path.partition("?")
        if head or query != QUERY:
            return self.reply(403, b"<Error>AccessDenied</Error>", head)
        self.path = path.replace("%20", " ")
        return super().answer(head=head)


class Store(ThreadingHTTPServer):
    """A folder behind signed addresses."""

    daemon_threads = True

    def __init__(self, folder: Path) -> None:
        super().__init__(("127.0.0.1", 0), Signed)
        self.folder, self.ranges, self.tag, self.short, self.sent = folder, True, '"1"', False, 0
        self.counting = threading.Lock()

    def address(self, name: str, query: str = QUERY) -> str:
        return f"http://127.0.0.1:{self.server_port}/{name}?{query}"


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    (tmp_path / "served").mkdir()
    with Store(tmp_path / "served") as served:
        thread = threading.Thread(target=served.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield served
        served.shutdown()
        thread.join()


@pytest.mark.parametrize("ranges", [True, False])
def test_what_is_asked_for_comes_by_a_signed_address(store: Store, tmp_path: Path, ranges: bool) -> None:
    store.ranges = ranges
    path = drive(tmp_path / "drive 1.mcap", "NONE", 3)
    (store.folder / path.name).write_bytes(path.read_bytes())
    address = store.address("drive%201.mcap")
    assert rows(address, LEVEL) == rows(path, LEVEL)
    assert (store.sent < path.stat().st_size / 2) == ranges
    with open_source(address) as there, open_source(path) as here:
        assert there.fingerprint == here.fingerprint  # however often it is signed anew


def test_a_link_that_ran_out_says_so_without_showing_it(store: Store, tmp_path: Path) -> None:
    path = drive(tmp_path / "drive.mcap", "NONE", 3)
    (store.folder / path.name).write_bytes(path.read_bytes())
    with pytest.raises(SourceError, match=r"/drive\.mcap: may not be read; its link may have run out") as error:
        open_source(store.address(path.name, QUERY[:-1]))
    assert not any(secret in str(error.value) for secret in SECRETS)
    store.shutdown()
    store.server_close()
    with pytest.raises(SourceError, match=r"/other\.mcap: cannot be read: ") as gone:
        open_source(store.address("other.mcap"))
    assert not any(secret in str(gone.value) for secret in SECRETS)
