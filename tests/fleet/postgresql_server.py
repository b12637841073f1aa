"""A real PostgreSQL of one's own, on a socket in a folder: no port, no password, nothing of it is left."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PROGRAMS = Path("/usr/lib/postgresql")
"""Where Debian has the programs of each version."""


def missing() -> str | None:
    """What is not there that a server and its tests need; None where all is."""
    if importlib.util.find_spec("psycopg") is None:
        return "there is no psycopg: pip install 'robophm[fleet]'"
    if not [*PROGRAMS.glob("*/bin/initdb")]:
        return "there is no PostgreSQL: tools/ros-peers installs it"
    return None


class Server:
    """A server that can be killed and begun again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._bin = max(PROGRAMS.glob("*/bin/initdb"), key=lambda path: int(path.parts[-3])).parent
        self._user = {"user": "postgres", "group": "postgres", "extra_groups": []} if os.geteuid() == 0 else {}
        if self._user:
            shutil.chown(folder, "postgres", "postgres")
        self._run("initdb", "--pgdata", "data", "--auth", "trust", "--username", "robophm", "--no-sync", "--locale",
                  "C", "--encoding", "UTF8")  # fmt: skip
        self._process: subprocess.Popen[bytes] | None = None
        self.address = f"postgresql:///postgres?host={folder}&user=robophm"

    def _run(self, program: str, *words: str) -> None:
        done = subprocess.run([self._bin / program, *words], cwd=self.folder, capture_output=True, **self._user)
        assert done.returncode == 0, done.stderr.decode()

    def begin(self, *settings: str) -> None:
        """Start, and wait until it answers."""
        words = [one for setting in ("listen_addresses=", f"unix_socket_directories={self.folder}", *settings)
                 for one in ("-c", setting)]  # fmt: skip
        with (self.folder / "log").open("ab") as log:
            self._process = subprocess.Popen([self._bin / "postgres", "-D", "data", *words], cwd=self.folder,
                                             stdout=log, stderr=log, **self._user)  # fmt: skip
        end = time.monotonic() + 60
        asked = [self._bin / "pg_isready", "--host", str(self.folder), "--quiet"]
        while subprocess.run(asked, check=False).returncode:
            assert self._process.poll() is None, (self.folder / "log").read_text()
            assert time.monotonic() < end, "it does not answer"
            time.sleep(0.02)

    @property
    def process(self) -> int:
        """The number of its first process."""
        assert self._process
        return self._process.pid

    def kill(self) -> None:
        """End it at once, with all its processes, as a machine that loses power."""
        assert self._process
        self._process.send_signal(3)  # SIGQUIT: nothing is written any more, and recovered at the next start
        self._process.wait(60)


@contextmanager
def running(*settings: str) -> Iterator[Server]:
    """A server, until left."""
    with tempfile.TemporaryDirectory(prefix="robophm-pg-") as folder:
        server = Server(Path(folder))
        server.begin(*settings)
        try:
            yield server
        finally:
            server.kill()
