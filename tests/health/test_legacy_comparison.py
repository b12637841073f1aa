"""The 2020 tool's figures beside exact ones: its guide's, and closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from robophm.design.importers.legacy.reading import import_legacy
from robophm.health.legacy_comparison import comparisons

DATA = Path(__file__).parents[1] / "data"


def test_the_guides_figures_and_ours() -> None:
    """f/R at 1000 h in series is the sum of rates, by hand."""
    found = {one.path: one for one in comparisons(import_legacy(DATA / "legacy_ota.yaml"))}
    assert found[""].legacy_reliability == pytest.approx(0.589292457145637, rel=1e-14, abs=0)
    assert found["Mobility"].hazard_rate == pytest.approx(4.7201147504e-05, rel=1e-12, abs=0)
    assert found["Communication"].hazard_rate == pytest.approx(1.06245744208149e-05 - 2.7e-7, rel=1e-12, abs=0)


def test_a_module_without_parts_is_compared_too_and_one_without_a_rate_has_nothing_exact(tmp_path: Path) -> None:
    (tmp_path / "old.yaml").write_text(
        "System: {A: {Failure Rate: 1.0e-5}, B: {Failure Rate: 0}, Final Configuration: A}"
    )
    whole, a, b = comparisons(import_legacy(tmp_path / "old.yaml"), 2000.0)
    assert (a.legacy_stored, a.hazard_rate) == (1e-5, 1e-5)
    assert a.unreliability == pytest.approx(-math.expm1(-0.02), rel=1e-12, abs=0)
    assert a.legacy_reliability == pytest.approx(math.exp(-0.02), rel=1e-12, abs=0)
    assert (whole.legacy_hazard_rate, whole.legacy_stored) == (1e-5, None)
    assert (b.legacy_stored, b.hazard_rate, b.reliability, b.unreliability) == (0, None, None, None)
