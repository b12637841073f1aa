from __future__ import annotations

import io
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from robophm.cli import main
from robophm.core.signal import SECOND
from robophm.transports.synthetic import SyntheticOta

Run = Callable[..., "subprocess.CompletedProcess[str]"]
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "ota" / "robot.yaml"


@pytest.fixture(scope="session")
def command() -> list[str]:
    """What runs the command line in a process of its own."""
    return [sys.executable, "-m", "robophm"]


@pytest.fixture
def run(command: list[str], tmp_path: Path) -> Run:
    """Run a command in an empty folder; further keywords are environment variables, None for unset ones."""

    def run(*args: object, cwd: Path = tmp_path, **variables: str | None) -> subprocess.CompletedProcess[str]:
        changed = {**os.environ, "PYTHONIOENCODING": None, **variables}
        env = {name: value for name, value in changed.items() if value is not None}
        words = [*command, *(str(word) for word in args)]
        return subprocess.run(words, capture_output=True, encoding="utf-8", errors="surrogateescape",
                              cwd=cwd, env=env, check=False, timeout=60)  # fmt: skip

    return run


@pytest.fixture
def inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """The same in this process, which is ten times as fast: `main` with streams of its own."""

    def run(*args: object) -> subprocess.CompletedProcess[str]:
        done = run_inside(tmp_path, [str(word) for word in args], monkeypatch)
        monkeypatch.undo()
        return done

    return run


def run_inside(folder: Path, words: list[str], monkeypatch: pytest.MonkeyPatch) -> subprocess.CompletedProcess[str]:
    """Run a command in this process, whose folder and streams ``monkeypatch`` changes."""
    monkeypatch.chdir(folder)
    streams = [io.TextIOWrapper(io.BytesIO(), encoding="utf-8") for _ in range(2)]
    for name, value in (("argv", ["robophm", *words]), ("stdout", streams[0]), ("stderr", streams[1])):
        monkeypatch.setattr(sys, name, value)
    with pytest.raises(SystemExit) as leaving:
        main()
    texts = [stream.buffer.getvalue().decode() for stream in streams]
    return subprocess.CompletedProcess(words, leaving.value.code or 0, *texts)


@pytest.fixture
def design(tmp_path: Path) -> Path:
    """The example's design in a folder where it may be changed."""
    path = tmp_path / "robot.yaml"
    path.write_bytes(EXAMPLE.read_bytes())
    return path


@pytest.fixture(scope="session")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ten minutes of the synthetic robot that the example describes."""
    return SyntheticOta(seed=3, duration=600 * SECOND).record(tmp_path_factory.mktemp("recorded") / "day.mcap")
