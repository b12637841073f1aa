"""All use of the cyclonedds wheel, in one place: it has few types, and two functions here are its own affair.

Messages go in and come out as bytes, CDR with its encapsulation; that they are of their type Cyclone sees to.
"""

from __future__ import annotations

import os
import platform
import re
import sys
import threading
from collections import Counter
from typing import Any, NamedTuple, cast

from robophm.core.errors import SourceError
from robophm.transports.ros2_dds.definition import Definition
from robophm.transports.signals.incidents import Incidents

BLOCKED = 0
"""Nanoseconds that a writer waits for slow readers: it never does."""

PUBLISHED = 100
"""Messages that a writer keeps for readers that are slower."""

AT_ONCE = 256
"""Messages that are taken together."""

HISTORY = 40 * AT_ONCE
"""Messages of a topic that may wait to be taken."""

_LONGEST_LINE = 4096
_REFUSED = re.compile(rb": deserialization ([^ ]+)/[^ /]+ failed|: malformed packet received")
_TIMED_OUT = -10
_ANY_STATE = 0xFFFFFFFF


class Offer(NamedTuple):
    """A publisher's offer of a topic, as discovery tells of it."""

    key: int
    """Number by which messages say whose they are."""
    topic: str
    """Topic as DDS spells it, ``rt/battery``."""
    type: str
    """Type as DDS spells it, ``std_msgs::msg::dds_::Float64_``."""
    reliable: bool
    latched: bool
    user_data: bytes


class Message(NamedTuple):
    """One message as it was received."""

    raw: bytes
    key: int
    """Key of its publisher's offer."""
    number: int | None = None
    """Number in the sequence of its publisher; Cyclone does not tell."""


def wheel() -> Any:
    """Return the package cyclonedds. Raises SourceError, which says what to install, where it cannot be had."""
    try:
        import cyclonedds.builtin
        import cyclonedds.core
        import cyclonedds.domain
        import cyclonedds.idl.types
        import cyclonedds.pub
        import cyclonedds.sub
        import cyclonedds.topic
        import cyclonedds.util
        from cyclonedds import _clayer
    except Exception as error:  # its loader raises errors of its own where its library does not load
        raise SourceError(f"ROS 2 over DDS needs the package cyclonedds ({error}): {_remedy()}") from None
    return cyclonedds if _clayer else None


def _remedy() -> str:
    if platform.machine() not in ("x86_64", "AMD64") or sys.version_info >= (3, 14):
        here = f"Python {sys.version_info[0]}.{sys.version_info[1]} on {platform.machine()}"
        return f"there is none for {here}; with ROS 2's setup sourced, its own rclpy serves; or robophm[zenoh]"
    return "pip install robophm[ros2]"


class Log(threading.Thread):
    """Reads Cyclone's log for messages it dropped as not of their type, which it tells nowhere else."""

    def __init__(self) -> None:
        super().__init__(name="ros2 log", daemon=True)
        self.refused = Incidents()
        """Messages by topic, as DDS spells it; under no topic, packets that are none of DDS."""
        self._out, self._in = os.pipe()
        self.config = (
            f'<CycloneDDS><Domain id="any"><Tracing><Verbosity>warning</Verbosity>'
            f"<OutputFile>/dev/fd/{self._in}</OutputFile></Tracing></Domain></CycloneDDS>"
        )

    def run(self) -> None:
        """Read the log until it is closed."""
        with os.fdopen(self._out, "rb") as lines:
            while line := lines.readline(_LONGEST_LINE):
                if match := _REFUSED.search(line):
                    self.refused.add((match[1] or b"").decode("ascii", "replace"))

    def close(self) -> None:
        """Stop reading the log."""
        os.close(self._in)
        if self.ident is None:  # it never ran
            os.close(self._out)
        else:
            self.join()


class Participant:
    """A participant of a DDS domain, with the domain's settings, which hold for the whole process."""

    def __init__(self, domain: int, config: str) -> None:
        dds = wheel()
        self._log = Log() if sys.platform != "win32" else None
        self._making = threading.RLock()
        self._structs: dict[tuple[str, str], Any] = {}
        self._topics: dict[tuple[str, str], Any] = {}
        try:
            self._domain = dds.domain.Domain(domain, f"{self._log.config},{config}" if self._log else config)
            qos = dds.core.Qos(dds.core.Policy.Userdata(b"enclave=/;"))
            self.entity = dds.domain.DomainParticipant(domain, qos)
        except dds.core.DDSException as error:
            if self._log:
                self._log.close()
            raise SourceError(
                f"no DDS in domain {domain}: {error}; expected a network interface and free ports"
            ) from None
        self.gid: bytes = self.entity.guid.bytes
        if self._log:
            self._log.start()

    def refused(self) -> Counter[str]:
        """Return the messages of each topic, by its name in DDS, that were not of its type."""
        return self._log.refused.copy() if self._log else Counter()

    def topic(self, name: str, definition: Definition) -> Any:
        """Return the topic of this name, spelled as in DDS, and of this type."""
        dds = wheel()
        key = name, definition.hash
        with self._making:
            if key not in self._topics:
                struct = self._struct(definition.type.name, definition)
                qos = dds.core.Qos(dds.core.Policy.DataRepresentation(use_cdrv0_representation=True))
                self._topics[key] = dds.topic.Topic(self.entity, name, struct, qos)
            return self._topics[key]

    def _struct(self, name: str, definition: Definition) -> Any:
        """The type as the wheel wants it, a class."""
        from cyclonedds.idl import make_idl_struct

        key = name, definition.hash
        if key not in self._structs:
            fields = {field: self._part(part, definition) for field, part in definition.type.definitions[name][1]}
            self._structs[key] = make_idl_struct(
                name.rpartition("/")[2] + "_", definition.spelled(name).replace("::", "."), fields
            )
        return self._structs[key]

    def _part(self, part: Any, definition: Definition) -> Any:
        """Bounds of strings and sequences left out: DDS would hold types apart by them that are the same on the way."""
        from cyclonedds.idl import types
        from rosbags.interfaces import Nodetype

        node, detail = part
        if node == Nodetype.NAME:
            return self._struct(detail, definition)
        if node == Nodetype.ARRAY:
            return types.array[self._part(detail[0], definition), detail[1]]
        if node == Nodetype.SEQUENCE:
            return types.sequence[self._part(detail[0], definition)]
        name = detail[0]
        if name in ("string", "bool"):
            return str if name == "string" else bool
        return getattr(types, "uint8" if name == "char" else name)

    def close(self) -> None:
        """Leave the domain; closing twice does no harm."""
        delete(self.entity)
        delete(self._domain)
        if self._log:
            self._log.close()


class Writer:
    """A writer of one topic over DDS."""

    def __init__(self, participant: Participant, topic: str, definition: Definition, *, latched: bool) -> None:
        dds = wheel()
        policy = dds.core.Policy
        qos = dds.core.Qos(
            policy.Reliability.Reliable(BLOCKED),
            policy.Durability.TransientLocal if latched else policy.Durability.Volatile,
            policy.History.KeepLast(1 if latched else PUBLISHED),
            policy.DataRepresentation(use_cdrv0_representation=True),
            policy.Userdata(definition.user_data),
        )
        self._entity = dds.pub.DataWriter(participant.entity, participant.topic(topic, definition), qos)
        self._write = dds._clayer.ddspy_write
        self.gid: bytes = self._entity.guid.bytes

    def write(self, raw: bytes) -> bool:
        """Send a message; False where slow readers leave no room. Raises ValueError where it is not of the type."""
        code = self._write(self._entity._ref, raw + bytes(-len(raw) % 4))
        if code < 0 and code != _TIMED_OUT:
            raise ValueError(f"DDS refuses it ({code})")
        return bool(code >= 0)

    @property
    def readers(self) -> int:
        """Return how many readers are connected now."""
        return len(self._entity.get_matched_subscriptions())

    def close(self) -> None:
        """Write no more; twice does no harm."""
        delete(self._entity)


class Reader:
    """A reader of one topic over DDS."""

    def __init__(
        self, participant: Participant, topic: str, definition: Definition, *, reliable: bool, latched: bool
    ) -> None:
        dds = wheel()
        policy = dds.core.Policy
        qos = dds.core.Qos(
            policy.Reliability.Reliable(BLOCKED) if reliable else policy.Reliability.BestEffort,
            policy.Durability.TransientLocal if latched else policy.Durability.Volatile,
            policy.History.KeepLast(HISTORY),
            policy.DataRepresentation(use_cdrv0_representation=True),
            policy.TypeConsistency.AllowTypeCoercion(),
            policy.Userdata(definition.user_data),
        )
        self.entity = dds.sub.DataReader(participant.entity, participant.topic(topic, definition), qos)
        status = dds.core.DDSStatus
        self.entity.set_status_mask(status.DataAvailable)
        self._take = dds._clayer.ddspy_take
        self._together = 0
        self._overrun = 0
        self.gid: bytes = self.entity.guid.bytes

    def take(self) -> list[Message]:
        """Return the messages that have come, at most AT_ONCE; an empty list where there are none."""
        taken = self._take(self.entity._ref, _ANY_STATE, AT_ONCE)
        if isinstance(taken, int):
            return []
        # a history that was full has let the oldest go without a word
        self._together = self._together + len(taken) if len(taken) == AT_ONCE else 0
        if self._together >= HISTORY:
            self._together = 0
            self._overrun += 1
        # without valid data it says that a writer is gone
        return [Message(raw, info.publication_handle) for raw, info in taken if info.valid_data]

    def lost(self) -> int:
        """Return the number of messages that Cyclone dropped since this was asked last."""
        lost = self.entity.get_sample_lost_status().total_count_change
        rejected = self.entity.get_sample_rejected_status().total_count_change
        return cast(int, lost + rejected)

    def overrun(self) -> int:
        """Return how often since the last call more messages came at once than the history keeps."""
        overrun, self._overrun = self._overrun, 0
        return overrun

    def refused(self) -> int:
        """Return the publishers since this was asked last whose quality of service does not go with ours."""
        return cast(int, self.entity.get_requested_incompatible_qos_status().total_count_change)

    def close(self) -> None:
        """Stop reading; closing twice does no harm."""
        delete(self.entity)


class Discovery:
    """Finds out who publishes in the domain."""

    def __init__(self, participant: Participant) -> None:
        dds = wheel()
        self.entity = dds.builtin.BuiltinDataReader(participant.entity, dds.builtin.BuiltinTopicDcpsPublication)
        self._policy = dds.core.Policy
        self.offers: dict[int, Offer] = {}

    def look(self) -> bool:
        """Take what is new into ``offers``; return whether there was something."""
        changed = False
        while taken := self.entity.take(AT_ONCE):
            for each in taken:
                changed = True
                key = each.sample_info.instance_handle
                if each.sample_info.valid_data and each.sample_info.instance_state == 16:  # alive
                    self.offers[key] = self._offer(key, each)
                else:
                    self.offers.pop(key, None)
        return changed

    def _offer(self, key: int, each: Any) -> Offer:
        policy = self._policy
        reliability, durability = each.qos[policy.Reliability], each.qos[policy.Durability]
        user_data = each.qos[policy.Userdata]
        return Offer(
            key,
            each.topic_name,
            each.type_name,
            reliability is not None and reliability != policy.Reliability.BestEffort,
            durability is not None and durability != policy.Durability.Volatile,
            user_data.data if user_data else b"",
        )

    def close(self) -> None:
        """Stop looking for publishers."""
        delete(self.entity)


class Waiting:
    """Waits for any of some readers, or to be woken."""

    def __init__(self, participant: Participant) -> None:
        dds = wheel()
        self._set = dds.core.WaitSet(participant.entity)
        self._guard = dds.core.GuardCondition(participant.entity)
        self._set.attach(self._guard)

    def add(self, entity: Any) -> None:
        """Wait for this reader too."""
        self._set.attach(entity)

    def remove(self, entity: Any) -> None:
        """Wait for this reader no longer."""
        self._set.detach(entity)

    def wait(self, seconds: float) -> None:
        """Wait until something has come, at most so many seconds."""
        self._set.wait(int(seconds * 1e9))

    def wake(self) -> None:
        """End waiting, now and later; from any thread."""
        self._guard.set(True)

    def close(self) -> None:
        """Release the wait set."""
        delete(self._set)
        delete(self._guard)


def delete(entity: Any) -> None:
    """End an entity of DDS now, not when Python gets to it; twice does no harm."""
    if entity._ref >= 0:
        entity._delete(entity._ref)
        entity._entities.pop(entity._ref, None)
        entity._ref = -1
