"""Names by which nodes of rmw_zenoh find each other: keys of topics, tokens of who is there, and attachments.

The design is published (ros2/rmw_zenoh, docs/design.md): a topic is the key ``domain/name/type/hash``; every node,
publisher, subscription, server and client declares a token whose key says all that there is to know of it; and every
message has a number, a time and the identifier of its publisher beside it.
"""

from __future__ import annotations

import re
import struct
from typing import Literal, NamedTuple

SPACE = "@ros2_lv"
"""The space of tokens, which no wildcard of a topic reaches."""

Kind = Literal["NN", "MP", "MS", "SS", "SC"]
"""The kind of an entity: a node, a publisher, a subscription, a server or a client."""

LATCHED, BEST_EFFORT, DEFAULT_DEPTH = "1", "2", 42
"""Values of the quality of service in a token: of rmw's durability and reliability, and the depth that is not told."""

LONGEST_TOKEN = 4096
"""Characters of a token, beyond which it is none."""

_ATTACHMENT = struct.Struct("<qqB16s")
_GID = 16
_QUALITY = re.compile(r"([0-9]?):([0-9]?):[0-9]?,[0-9]{0,19}(:|\Z)", re.ASCII)


class Entity(NamedTuple):
    """Somebody who is there, as a token tells of them; a node has no topic."""

    kind: Kind
    node: str
    """Name of the node with its namespace, ``/hall/talker``."""
    topic: str = ""
    """Name of the topic or service, ``/battery``."""
    type: str = ""
    """Type as DDS spells it, ``std_msgs::msg::dds_::Float64_``."""
    hash: str = ""
    reliable: bool = True
    latched: bool = False


class Attachment(NamedTuple):
    """The number of a message, the time when it was sent [ns since the epoch], and its publisher's identifier."""

    number: int
    time: int
    gid: bytes

    @property
    def raw(self) -> bytes:
        """Return it as bytes: numbers with the least byte first, and the length of the identifier before that."""
        return _ATTACHMENT.pack(self.number, self.time, _GID, self.gid)


def attachment_of(raw: bytes | None) -> Attachment | None:
    """Return what is beside a message; None where it is none of rmw_zenoh."""
    if raw is None or len(raw) != _ATTACHMENT.size:
        return None
    number, time, length, gid = _ATTACHMENT.unpack(raw)
    return Attachment(number, time, gid) if length == _GID else None


def key_of(domain: int, name: str, type_: str, hash_: str) -> str:
    """Return the key of a topic or service, its type spelled as in DDS."""
    return f"{domain}/{name.strip('/')}/{type_}/{hash_}"


def token_of(domain: int, session: str, node: int, number: int, entity: Entity) -> str:
    """Return the key of a token; ``node`` and ``number`` are of the node and of the entity in its session."""
    namespace, _, name = entity.node.rpartition("/")
    parts = [SPACE, str(domain), session, str(node), str(number), entity.kind, "%", _flat(namespace or "/"), name]
    if entity.kind != "NN":
        durability = LATCHED if entity.latched else ""
        reliability = "" if entity.reliable else BEST_EFFORT
        quality = f"{reliability}:{durability}:,{'1' if entity.latched else ''}:,:,:,,"
        parts += [_flat(entity.topic), entity.type, entity.hash, quality]
    return "/".join(parts)


def entity_of(token: str) -> Entity | None:
    """Return whom a token tells of; None where it is no token of rmw_zenoh."""
    parts = token.split("/")
    if len(token) > LONGEST_TOKEN or len(parts) < 9 or parts[0] != SPACE or not all(parts):
        return None
    kind, _, namespace, name = parts[5:9]
    node = f"{_name(namespace).rstrip('/')}/{name}"
    if kind == "NN":
        return Entity("NN", node)
    if kind not in ("MP", "MS", "SS", "SC") or len(parts) < 13 or not (told := _QUALITY.match(parts[12])):
        return None
    topic, type_, hash_ = _name(parts[9]), parts[10], parts[11]
    return Entity(kind, node, topic, type_, hash_, told[1] != BEST_EFFORT, told[2] == LATCHED)  # type: ignore[arg-type]


def _flat(name: str) -> str:
    return name.replace("/", "%")


def _name(flat: str) -> str:
    return flat.replace("%", "/")
