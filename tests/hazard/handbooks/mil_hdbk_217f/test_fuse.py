"""MIL-HDBK-217F Notice 2 §22.1, fuses: by hand."""

import pytest

from robophm.hazard.handbooks import handbook_model

FUSE = handbook_model("mil_hdbk_217f.fuse")


def test_a_robot_is_not_fired_from_a_cannon():
    """The paper's resettable fuse has the factor of cannon launch, 230; a fuse of a mobile robot is 8e-8 /h."""
    assert FUSE.evaluate(FUSE.settle({"environment": "GM"})).value == pytest.approx(8e-8, rel=1e-14)
