"""What tests of tasks ask for."""

from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(params=[".bag", ".mcap", ".db3"])
def new(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """The name of a recording that is not there yet, in each of the formats."""
    return tmp_path / f"new{request.param}"
