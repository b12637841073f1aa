from __future__ import annotations

from pathlib import Path

import pytest

from robophm.core.signal import HOUR
from robophm.transports.synthetic import SyntheticOta


@pytest.fixture(scope="session")
def day(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two hours of a day of the synthetic robot."""
    return SyntheticOta(seed=1, duration=2 * HOUR).record(tmp_path_factory.mktemp("recorded") / "day.mcap")
