"""MIL-HDBK-217F Notice 2 §16.1, boards with plated through holes: by hand."""

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

BOARD = handbook_model("mil_hdbk_217f.printed_board")


def test_by_hand():
    """12 planes, 500 and 30 holes, lower quality, GM; discrete wiring has πC 1 and asks for no planes."""
    inputs = {"automated_holes": 500, "hand_soldered_holes": 30, "environment": "GM"}
    printed = BOARD.settle({**inputs, "technology": "printed", "planes": 12})
    complexity = 0.65 * 12**0.63
    expected = 1.7e-5 * (500 * complexity + 30 * (complexity + 13)) * 2 * 7 * 1e-6
    assert BOARD.evaluate(printed).value == pytest.approx(expected, rel=1e-14)
    discrete = BOARD.settle({**inputs, "technology": "discrete"})
    assert BOARD.evaluate(discrete).value == pytest.approx(1.1e-4 * (500 + 30 * 14) * 14e-6, rel=1e-14)
    with pytest.raises(ModelError, match="a printed board needs 'planes'"):
        BOARD.settle({**inputs, "technology": "printed"})


def test_a_hole_by_hand_is_thirteen_more_than_one_by_machine():
    design = BOARD.settle({
        "technology": "discrete", "automated_holes": 1, "hand_soldered_holes": 0, "environment": "GB"
    })  # fmt: skip
    machine, hand = BOARD.evaluate({
        **design, "automated_holes": np.array([1, 0]), "hand_soldered_holes": np.array([0, 1])
    }).value  # fmt: skip
    assert hand / machine == pytest.approx(14, rel=1e-14)
