"""Each model for itself, and a document that JSON can say."""

import json

import numpy as np
import pytest

from robophm.calibration.predictions import LEVELS, Lives, Predictions, Tasks
from robophm.calibration.score import score
from robophm.core.errors import ModelError


def lives(n=500, mean=100.0):
    observed = np.random.default_rng(2).exponential(mean, n)
    quantiles = np.tile(-mean * np.log1p(-np.array(LEVELS)), (n, 1))
    return Lives(np.arange(n), np.zeros(n), quantiles, -np.expm1(-observed / mean), observed, np.zeros(n, bool))


def test_models_are_scored_for_themselves():
    failure = np.full(3000, 0.1)
    failed = np.random.default_rng(1).random(3000) < 0.1
    found = score(Predictions(
        {"good": Tasks(failure, 1 - failure, failed), "half": Tasks(failure / 2, 1 - failure / 2, failed)},
        {"half": lives(), "lives": lives()},
    ))  # fmt: skip
    assert [one.model for one in found.models] == ["good", "half", "lives"]
    assert [one.rejected for one in found.models] == [False, True, False]
    assert found.models[0].lives is None
    assert found.models[2].tasks is None
    document = json.loads(json.dumps(found.to_json(), allow_nan=False))
    good, half, _ = document["models"]
    assert good["task_verdict"]["finding"] == "calibrated"
    assert good["tasks"]["failed"] == int(failed.sum())
    assert half["rejected"] is True
    assert len(half["lives"]["histogram"]) == 10


@pytest.mark.parametrize(
    ("off", "rejected"),
    [
        ({"robophm": 1, "other": 2}, False),
        ({"robophm": 2, "other": 1}, True),
        ({"other": 2, "another": 1}, False),
        ({"other": 2}, True),
    ],
)
def test_others_may_be_there_to_be_found_out(off, rejected):
    """What failures are off by a factor of two is found out; it says something of us where it is ours, or alone."""
    failure = np.full(3000, 0.1)
    failed = np.random.default_rng(1).random(3000) < 0.1
    told = {name: Tasks(failure / factor, 1 - failure / factor, failed) for name, factor in off.items()}
    assert score(Predictions(told)).rejected is rejected


def test_what_is_infinite_is_said_to_be():
    found = score(Predictions({"m": Tasks(np.zeros(2), np.ones(2), np.array([True, False]))}))
    entry = found.to_json()["models"][0]
    assert entry["tasks"]["logarithmic_score"] == "Infinity"
    assert entry["tasks"]["impossible"] == 1


@pytest.mark.parametrize(
    ("failure", "completion", "failed"),
    [
        ([], [], []),
        ([np.nan], [0.5], [True]),
        ([1.2], [-0.2], [True]),
        ([0.1], [0.8], [True]),
        ([0.1], [0.9], [True] * 2),
    ],
)
def test_what_are_no_tasks(failure, completion, failed):
    with pytest.raises(ModelError, match="predictions: expected "):
        Tasks(np.array(failure, dtype=float), np.array(completion, dtype=float), np.array(failed, dtype=bool))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("fraction", [1.5]),
        ("observed", [-1.0]),
        ("time", [np.nan]),
        ("quantiles", [[1.0, 2, 3, 4, 5, 6, 7, 8, 7]]),
        ("quantiles", [[1.0, 2]]),
        ("censored", [[False]]),
    ],
)
def test_what_are_no_lives(name, value):
    right = {
        "robot": [0],
        "time": [0.0],
        "quantiles": [range(9)],
        "fraction": [0.5],
        "observed": [4.0],
        "censored": [False],
    }
    Lives(**{key: np.array(one) for key, one in right.items()})
    with pytest.raises(ModelError, match="predictions: expected "):
        Lives(**{key: np.array(one) for key, one in (right | {name: value}).items()})
