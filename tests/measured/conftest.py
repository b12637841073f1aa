from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import settings
from tests.cases import examples

from robophm.core.signal import HOUR
from robophm.transports.synthetic import SyntheticOta

# Derandomised and without a database of examples: the same tests everywhere, every time.
settings.register_profile("robophm-measured", derandomize=True, database=None, deadline=None, max_examples=examples(60))
settings.load_profile("robophm-measured")


@pytest.fixture(scope="session")
def day(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two hours of a day of the synthetic robot."""
    return SyntheticOta(seed=1, duration=2 * HOUR).record(tmp_path_factory.mktemp("recorded") / "day.mcap")
