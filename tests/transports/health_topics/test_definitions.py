"""The types of phm_msgs, and messages out of mappings."""

from __future__ import annotations

import numpy as np
import pytest

from robophm.transports.health_topics.definitions import Generation, definition, typestore
from robophm.transports.health_topics.message_of_fields import compose
from robophm.transports.health_topics.names import topics_of

HASHES = {
    "HazardRate": "345e162d70f8fb4d2e3700072feeb74d49cd11085b10e4c67e1fe4a7aa93eb29",
    "Health": "8f8f18cbb640f384ef1b8ef07ae397b40b40ff30b2e153691d93d0518edec2ec",
    "Potc": "a6889822cf608850b5b07cbeaff21be293dca83cf98f6b3f74f26b8cb553988d",
    "PotcInfo": "9e4dfcb9de34b159b0490dbd6d56d4342f2831dac837bf73c234af00d3ca4b7e",
    "Reliability": "384921bbf366b9d5d4059519c62f76167d90bdc8f8cb802a010619a3bcd6219d",
    "TaskLeg": "6e0ec71efab228aeea875b2916d719a443a94b17717013d587ea3ebd95f3c41b",
    "TaskCompletion": "ff7b858fadbcb85e22688b789a1e8bae61566f6f2896d70d085f48b354d71cc2",
}
"""RIHS01 of ros/phm_msgs/msg, as rosidl_generator_type_description (ros2/rosidl 95739d5b) computes them."""


@pytest.mark.parametrize("name", HASHES)
def test_type_hashes_are_those_of_rosidl(name: str) -> None:
    assert typestore(2).hash_rihs01(f"phm_msgs/msg/{name}") == f"RIHS01_{HASHES[name]}"


@pytest.mark.parametrize("generation", [1, 2])
@pytest.mark.parametrize("name", HASHES)
def test_a_definition_has_all_parts(name: str, generation: Generation) -> None:
    text = definition(f"phm_msgs/msg/{name}", generation)
    assert ("MSG: std_msgs/Header" in text) == (name in ("Health", "TaskCompletion"))
    assert ("MSG: phm_msgs/PotcInfo" in text) == (name == "Potc")
    assert ("builtin_interfaces/Time" in text) == (generation == 2 and name not in ("PotcInfo", "TaskLeg"))


def test_what_is_not_said_of_a_message_is_zero() -> None:
    generations: tuple[Generation, ...] = (1, 2)
    for generation in generations:
        store = typestore(generation)
        message = compose(store, "nav_msgs/msg/Odometry", {"pose": {"pose": {"position": {"x": 2.0}}}})
        assert (message.pose.pose.position.x, message.pose.pose.position.y, message.child_frame_id) == (2.0, 0, "")
        assert message.pose.covariance.tolist() == [0.0] * 36
        raw = store.serialize_ros1 if generation == 1 else store.serialize_cdr
        assert len(raw(message, "nav_msgs/msg/Odometry")) > 600
        rates = compose(store, "phm_msgs/msg/HazardRate", {"module_names": ["a"], "module_values": [0.5]})
        assert rates.module_values.dtype == np.float32
        assert rates.module_names == ["a"]


def test_a_field_that_is_none() -> None:
    with pytest.raises(KeyError, match=r"std_msgs/msg/Float64 has no value"):
        compose(typestore(1), "std_msgs/msg/Float64", {"value": 1.0})


def test_topics_of_any_name() -> None:
    """Letters, digits and underscores, never two of a name; REP-144 and ROS 2's rules of names."""
    paths = ["R", "R/Power", "R/power", "R/3V3 regulator", "R/Bücher/ä", "R/Power/+5 V (2)", "R/___"]
    assert topics_of(paths, "/x/phm") == {
        "R": "/x/phm/r",
        "R/Power": "/x/phm/r/power",
        "R/power": "/x/phm/r/power_2",
        "R/3V3 regulator": "/x/phm/r/n3v3_regulator",
        "R/Bücher/ä": "/x/phm/r/b_cher/n",
        "R/Power/+5 V (2)": "/x/phm/r/power/n5_v_2",
        "R/___": "/x/phm/r/n",
    }
