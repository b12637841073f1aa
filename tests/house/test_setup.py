"""Set-up that has been done is not done again: the second `make demo` starts at once."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_set_up_runs_once() -> None:
    ready = ROOT / ".venv" / "ready"
    if not ready.exists():
        pytest.skip("not run from make's own .venv")
    before = ready.stat().st_mtime_ns
    if any((ROOT / name).stat().st_mtime_ns > before for name in ("pyproject.toml", "constraints.txt", "tools/setup")):
        pytest.skip("set-up is older than what it is made of: this would make it anew")
    command = ["sh", "tools/setup", sys.executable]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=20, check=True)
    assert (done.stdout, done.stderr) == ("", "")
    assert ready.stat().st_mtime_ns == before
