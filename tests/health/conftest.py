from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import settings
from mpmath import mp
from tests.cases import examples

# Derandomised and without a database of examples: the same tests everywhere, every time.
settings.register_profile("robophm-health", derandomize=True, database=None, deadline=None, max_examples=examples(60))
settings.load_profile("robophm-health")


@pytest.fixture(autouse=True, scope="module")
def digits() -> Iterator[None]:
    """Expected values have more digits than they lose."""
    with mp.workdps(80):
        yield
