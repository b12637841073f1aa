"""Side by side with RePyability, where it is installed: its closed forms exactly, its grids as far as they go."""

from __future__ import annotations

import sys
from pathlib import Path as File

import numpy as np
import pytest

sys.path.insert(0, str(File(__file__).parent))
from solving import solved, standby, works

from robophm.life.exponential import Exponential
from robophm.life.weibull import Weibull

TIMES = np.array([20.0, 80.0, 250.0])


@pytest.mark.parametrize(("n", "active", "dormancy"), [(2, 1, 0.0), (4, 2, 0.0), (3, 1, 0.4), (6, 4, 0.1)])
def test_standby_of_constant_rates(n: int, active: int, dormancy: float) -> None:
    peer, surpyval = pytest.importorskip("repyability"), pytest.importorskip("surpyval")
    models = [surpyval.Exponential.from_params([0.01])] * n
    expected = peer.StandbyModel(models, k=active, dormancy_factor=dormancy).sf(TIMES)
    one = solved(standby(n, active, dormancy), [Exponential(0.01)] * n)
    np.testing.assert_allclose(works(one, *TIMES), expected, rtol=1e-9)


@pytest.mark.parametrize(("n", "dormancy", "switch"), [(2, 0.0, 1.0), (2, 0.3, 1.0), (3, 0.2, 1.0), (3, 0.0, 0.9)])
def test_standby_of_parts_that_age(n: int, dormancy: float, switch: float) -> None:
    peer, surpyval = pytest.importorskip("repyability"), pytest.importorskip("surpyval")
    models = [surpyval.Weibull.from_params([100.0, 1.5 + i]) for i in range(n)]
    model = peer.StandbyModel(models, switching_probability=switch, dormancy_factor=dormancy)
    one = solved(standby(n, 1, dormancy, switch), [Weibull(100.0, 1.5 + i) for i in range(n)])
    np.testing.assert_allclose(works(one, *TIMES), model.sf(TIMES), atol=3e-5)  # what it says of its grids


def test_several_active_of_cold_parts_that_age() -> None:
    peer, surpyval = pytest.importorskip("repyability"), pytest.importorskip("surpyval")
    model = peer.StandbyModel([surpyval.Weibull.from_params([100.0, 2.0])] * 4, k=2)
    one = solved(standby(4, 2), [Weibull(100.0, 2.0)] * 4)
    np.testing.assert_allclose(works(one, *TIMES), model.sf(TIMES), atol=3e-5)
