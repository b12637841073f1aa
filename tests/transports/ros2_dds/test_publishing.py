"""What we publish arrives at peers over Fast DDS as it was, and nodes are seen under their names."""

from __future__ import annotations

import pytest

from robophm.core.errors import SourceError
from robophm.transports.ros2_dds import Node, Publisher

from ..listener import within
from .conftest import FLOAT64, TEMPERATURE, Peer
from .test_listening import graph

pytestmark = pytest.mark.usefixtures("_participant")


def test_a_latched_value_reaches_who_comes_later_and_new_ones_who_is_there(peer: Peer) -> None:
    with Node("/health") as node, Publisher(node, "/health/level", "std_msgs/Float64", latched=True) as publisher:
        kind = publisher.types["std_msgs/msg/Float64"]
        publisher.publish(kind(data=0.25))
        publisher.publish(kind(data=0.5))
        peer.ask(f"reader r rt/health/level {FLOAT64} reliable latched", "made")
        assert peer.line() == "r 0.5"
        assert publisher.subscribers == 1
        publisher.publish(kind(data=1e-300))
        assert peer.line() == "r 1e-300"
        with pytest.raises(SourceError, match="message on /health/level is no std_msgs/msg/Float64"):
            publisher.publish(3.0)
        with pytest.raises(SourceError, match="publishes /health/level already"):
            Publisher(node, "/health/level", "std_msgs/Float64")


def test_a_stamped_message_field_by_field(peer: Peer) -> None:
    with Node() as node, Publisher(node, "/warm", "sensor_msgs/msg/Temperature") as publisher:
        kinds = publisher.types
        peer.ask(f"reader r rt/warm {TEMPERATURE} besteffort volatile", "made")
        peer.matched(name="r")
        within(5, lambda: publisher.subscribers == 1)
        stamp = kinds["builtin_interfaces/msg/Time"](sec=-5, nanosec=999_999_999)
        header = kinds["std_msgs/msg/Header"](stamp=stamp, frame_id="fünf")
        publisher.publish(kinds["sensor_msgs/msg/Temperature"](header=header, temperature=36.6, variance=0.1))
        assert peer.line() == "r -5 999999999 fünf 36.600000000000001 0.10000000000000001"


def test_a_type_of_ones_own_with_its_definition(peer: Peer) -> None:
    definition = "own_msgs/Part[] parts\n" + "=" * 80 + "\nMSG: own_msgs/Part\nfloat64 rate\nstring name\n"
    with Node() as node, Publisher(node, "/own", "own_msgs/msg/Whole", definition) as publisher:
        peer.ask("reader r rt/own own_msgs::msg::dds_::Whole_ reliable volatile", "made")
        within(5, lambda: publisher.subscribers == 1)
        part, whole = (publisher.types[f"own_msgs/msg/{name}"] for name in ("Part", "Whole"))
        publisher.publish(whole(parts=[part(rate=1.0, name="ab"), part(rate=2.0, name="")]))
        # encapsulation 4, length 4 and padding 4, rate 8, 4 + 3 and padding 1, rate 8, 4 + 1; padded to 4
        assert peer.line() == "r 44"


def test_the_nodes_of_one_process_are_seen_with_what_they_publish(cyclone: Peer) -> None:
    """Three names in one participant, as ``ros2 node list`` takes them from ros_discovery_info."""
    rate, reliability = "/phm_hazard_rate_calculation_node", "/robot_1/phm_reliability_estimation_node"
    with Node(rate) as one, Node(reliability) as other, Node("/silent"):
        Publisher(one, "/phm_hazard_rate", "std_msgs/Float64")
        Publisher(one, "/rates", "std_msgs/Float64")
        last = Publisher(other, "/robot_1/phm_reliability", "std_msgs/Float64")
        expected = [
            "/ phm_hazard_rate_calculation_node reads writes rt/phm_hazard_rate rt/rates",
            "/ robophm_tests reads writes",
            "/ silent reads writes",
            "/robot_1 phm_reliability_estimation_node reads writes rt/robot_1/phm_reliability",
        ]
        within(5, lambda: graph(cyclone) == expected)
        last.close()
        within(5, lambda: "/robot_1 phm_reliability_estimation_node reads writes" in graph(cyclone))
        with pytest.raises(SourceError, match="has a node /silent already"):
            Node("/silent")
        with pytest.raises(SourceError, match="'silent' is not the name of a ROS node"):
            Node("silent")
    within(5, lambda: graph(cyclone) == ["/ robophm_tests reads writes"])
