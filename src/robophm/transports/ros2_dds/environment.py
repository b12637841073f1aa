"""Settings of ROS 2 from the environment: the domain, and how far nodes look for each other; in Cyclone's words."""

from __future__ import annotations

import os
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

from robophm.core.errors import SourceError, nearest

LAST_DOMAIN = 232
"""The ports of a higher one are none (docs.ros.org: The ROS_DOMAIN_ID)."""

MOST_PARTICIPANTS = 32
"""Processes of a machine that are looked for without multicast; ROS's own Cyclone looks for as many."""

RANGES = {
    "SUBNET": "the networks of this machine",
    "LOCALHOST": "this machine",
    "OFF": "this process",
    "SYSTEM_DEFAULT": "what DDS is configured for",
}
"""Values of ROS_AUTOMATIC_DISCOVERY_RANGE that are known, and where each looks."""

LONGEST_MESSAGE = 64 << 20
"""Bytes of a message, beyond which it is not put together."""

RECEIVED_AT_ONCE = 32 << 20
"""Bytes of packets that may wait to be read, where the kernel allows as many (net.core.rmem_max)."""


@dataclass(frozen=True)
class Place:
    """The place of our nodes in the network of ROS 2: their domain and its settings."""

    domain: int
    config: str
    """Configuration of Cyclone DDS: XML fragments, and what CYCLONEDDS_URI names."""


def place(domain: int | None = None) -> Place:
    """Return the place of our nodes by ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and the like.

    As rmw_cyclonedds maps them, so that both find each other. Raises SourceError where a value is none.
    """
    if domain is None:
        domain = _domain(os.environ.get("ROS_DOMAIN_ID") or "0")
    if not 0 <= domain <= LAST_DOMAIN:
        raise SourceError(f"{domain} is not a ROS domain; expected 0 to {LAST_DOMAIN}")
    reach = _reach()
    peers = [peer for peer in os.environ.get("ROS_STATIC_PEERS", "").split(";") if peer.strip()]
    if os.environ.get("ROS_LOCALHOST_ONLY") == "1":
        peers = []
    own = os.environ.get("CYCLONEDDS_URI")
    return Place(domain, ",".join(part for part in (_config(reach, peers), own) if part))


def _reach() -> str:
    if os.environ.get("ROS_LOCALHOST_ONLY") == "1":  # the older way to say it, which wins as long as it is there
        return "LOCALHOST"
    reach = (os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or "SUBNET").upper()
    if reach not in RANGES:
        hint = nearest(reach, RANGES)
        raise SourceError(f"ROS_AUTOMATIC_DISCOVERY_RANGE is '{reach}'; expected {', '.join(RANGES)}{hint}")
    return reach


def place_in_words(domain: int | None = None) -> str:
    """Return where nodes are looked for, for people. Raises SourceError as ``place``."""
    return f"domain {place(domain).domain}, {RANGES[_reach()]}"


def hidden_by(*, over_dds: bool) -> list[str]:
    """Return what in the environment could keep topics from being heard; ``over_dds``: we speak DDS ourselves."""
    said = os.environ.get
    hints = [f"robots in other domains than {said('ROS_DOMAIN_ID') or '0'} are not heard: set ROS_DOMAIN_ID"]
    if (reach := _reach()) != "SUBNET":
        hints.append(
            f"nodes are looked for on {RANGES[reach]} alone: ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_LOCALHOST_ONLY"
        )
    if over_dds and "zenoh" in said("RMW_IMPLEMENTATION", ""):
        hints.append(f"RMW_IMPLEMENTATION is {said('RMW_IMPLEMENTATION')}, whose nodes do not speak DDS")
    if said("ROS_DISCOVERY_SERVER"):
        hints.append("ROS_DISCOVERY_SERVER is set: nodes that register with a server of Fast DDS alone are not found")
    if said("CYCLONEDDS_URI"):
        hints.append("CYCLONEDDS_URI is set: it may name an interface at which nobody is")
    if over_dds and said("ROS_SECURITY_ENABLE", "").lower() == "true":
        hints.append("ROS_SECURITY_ENABLE is true: nodes that enforce security are not heard without their keys")
    return [*hints, "the network or a firewall may not let multicast through: ROS_STATIC_PEERS names machines"]


def _domain(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise SourceError(f"ROS_DOMAIN_ID is '{text}'; expected a number from 0 to {LAST_DOMAIN}") from None


def _config(reach: str, peers: list[str]) -> str:
    general, discovery = "", ""
    if reach in ("LOCALHOST", "OFF"):
        general += "<AllowMulticast>false</AllowMulticast>"
    if reach == "LOCALHOST":
        peers = ["localhost", *peers]
    if reach == "OFF":
        discovery += f"<ParticipantIndex>none</ParticipantIndex><Tag>ros_discovery_off_{os.getpid()}</Tag>"
    elif reach != "SYSTEM_DEFAULT":
        discovery += (
            "<ParticipantIndex>auto</ParticipantIndex>"
            f"<MaxAutoParticipantIndex>{MOST_PARTICIPANTS}</MaxAutoParticipantIndex>"
        )
        if peers:
            addresses = "".join(f"<Peer address={quoteattr(peer.strip())}/>" for peer in peers)
            discovery += f"<Peers>{addresses}</Peers>"
    return (
        f'<CycloneDDS><Domain id="any"><General>{general}</General>'
        f"<Discovery>{discovery}</Discovery>"
        # without the hash of its key, Fast DDS does not see that a reader or writer of ours is gone
        f"<Internal><MaxSampleSize>{LONGEST_MESSAGE}B</MaxSampleSize><GenerateKeyhash>true</GenerateKeyhash>"
        # a picture of some megabytes comes at once, and what does not fit is dropped; the kernel gives what it allows
        f'<SocketReceiveBufferSize min="default" max="{RECEIVED_AT_ONCE}B"/></Internal>'
        "</Domain></CycloneDDS>"
    )
