"""The robot that does not exist: it follows its plan, measures, tells of its tasks, and writes recordings."""

from __future__ import annotations

import hashlib
import math
from collections import Counter
from collections.abc import Collection, Iterator
from functools import partial
from heapq import merge
from itertools import groupby, pairwise
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robophm.core.errors import SourceError, nearest
from robophm.core.signal import HOUR, SECOND, Sample, split_signal
from robophm.transports.signals.source import SignalSource, TopicInfo
from robophm.transports.synthetic.drive import CAPACITY, DAY, STATIONS, Trip, plan_drive, working_shifts
from robophm.transports.synthetic.messages import (
    ALL_TYPES,
    LATENCY,
    MEASURED_TYPES,
    MODULES,
    TOLD_TYPES,
    message_layout,
    typestore,
)

if TYPE_CHECKING:
    from robophm.transports.tasks import DoneTask, PlannedTask

    Floats = NDArray[np.float64]

_NOON = 1_709_553_600 * SECOND  # Monday 4 March 2024, 12:00 UTC
_THERMAL = {  # module: thermal resistance [K/W], time constant [s]
    "power": (0.55, 1800.0),
    "sensing": (1.10, 600.0),
    "communication": (1.30, 900.0),
    "mobility": (1.80, 1200.0),
    "computation": (0.90, 400.0),
}


class _Told(NamedTuple):
    """A message about a task: the look at which it is sent, and a text or the places of a path."""

    look: int
    topic: str
    content: str | list[tuple[float, float]]


class SyntheticOta(SignalSource):
    """The AGV's drive: the same seed gives the same values.

    A task is to fetch a load and to bring it: two trips, or fewer where it must charge or its day is over. The robot
    tells the stations and speeds when the task comes, and the times and where it was when it is done.

    ``duration``, ``start`` (since the epoch) and ``period`` are in ns, ``working_hours`` in hours of the UTC
    day; outside of them the robot is switched off and silent. The arrays are the truth, before sensor noise:
    one element for each period in which the robot is on.

    Raises SourceError where nothing would be sent, or the robot would send more than once a millisecond.
    """

    times: NDArray[np.int64]
    """Header stamps [ns since the epoch]."""
    x: Floats
    """Position x of the robot [m]."""
    y: Floats
    """Position y of the robot [m]."""
    heading: Floats
    """Heading [rad], not wrapped."""
    speed: Floats
    """Forward speed [m/s]."""
    turn_rate: Floats
    """Rate of turn [rad/s]."""
    payload: Floats
    """Mass carried by the robot [kg]."""
    current: Floats
    """Battery current [A], negative when it discharges."""
    voltage: Floats
    """Voltage of the battery [V]."""
    state_of_charge: Floats
    """State of charge, 0 to 1."""
    ambient: Floats
    """Temperature of the hall [°C]."""
    temperature: dict[str, Floats]
    """Temperature [°C] of each module."""
    operating: float
    """Hours that it is switched on."""

    def __init__(
        self,
        seed: int = 0,
        duration: int = DAY,
        start: int = _NOON,
        period: int = SECOND,
        working_hours: tuple[float, float] = (6.0, 22.0),
    ) -> None:
        if period < SECOND // 1000:
            raise SourceError(f"period of {period} ns; expected at least a millisecond, {SECOND // 1000} ns")
        self.notes = Counter()
        rng = np.random.default_rng(seed)
        shifts = working_shifts(start, duration, working_hours)
        grid = start + np.arange(0, max(duration, 0), period, dtype=np.int64)
        on = np.zeros(len(grid), dtype=bool)
        for begin, end in shifts:
            on |= (grid >= begin) & (grid < end)
        if not on.any():
            raise SourceError(f"the robot is switched off for all of the {duration / HOUR:g} h from its start")
        plan, tasks = plan_drive(rng, [((begin - start) / SECOND, (end - start) / SECOND) for begin, end in shifts])
        self._simulate(rng, grid, on, plan, period / SECOND)
        self.operating = len(self.times) * period / HOUR
        self._measure(rng)
        self._told = sorted(self._tell(tasks, start, period), key=attrgetter("look"))

    def _simulate(
        self,
        rng: np.random.Generator,
        grid: NDArray[np.int64],
        on: NDArray[np.bool_],
        plan: Floats,
        step: float,
    ) -> None:
        """Simulate the plan: kinematics, loads, battery, heat; then keep what happens while switched on."""
        t = (grid - grid[0]) / SECOND
        at, speed, heading, x, y, payload, charging = plan.T
        leg = np.clip(np.searchsorted(at, t, side="right") - 1, 0, len(at) - 2)
        since, length = t - at[leg], np.diff(at)[leg]
        acceleration = np.diff(speed)[leg] / length
        path = np.concatenate([[0.0], np.cumsum(np.diff(at) * (speed[1:] + speed[:-1]) / 2)])
        travelled = path[leg] + since * (speed[leg] + acceleration * since / 2)
        v = speed[leg] + acceleration * since
        carried, at_charger = payload[leg], charging[leg] > 0
        turn_rate = np.diff(heading)[leg] / length
        effort = v / 0.3 + np.abs(turn_rate)

        def wander(amplitude: float, memory: float) -> Floats:
            """Noise that forgets within ``memory`` seconds."""
            keep = math.exp(-step / memory)
            return _first_order(rng.normal(0.0, amplitude * math.sqrt(1 - keep**2), len(t)), keep)

        drive_power = effort * (14.0 + 1.3 * carried)
        compute_power = np.maximum(8.0 + 9.0 * (effort > 0) + wander(3.0, 300.0), 4.0)
        radio_power = 4.0 + np.maximum(wander(2.0, 60.0), 0.0)
        current = on * (20.0 * at_charger - (drive_power + compute_power + radio_power + 32.0) / 25.0)
        charge = np.clip(0.9 + np.cumsum(current) * step / 3600.0 / CAPACITY, 0.0, 1.0)
        ambient = 20.0 + 4.0 * np.sin(2 * np.pi * ((grid % DAY) / HOUR - 10.0) / 24.0) + wander(0.5, 3600.0)
        heat = {
            "power": 2.0 + 0.08 * current**2,
            "sensing": np.full(len(t), 8.0),
            "communication": radio_power,
            "mobility": 1.5 + 0.45 * drive_power,
            "computation": compute_power,
        }
        self.temperature = {}
        for module, (resistance, time_constant) in _THERMAL.items():
            keep = math.exp(-step / time_constant)
            target = ambient + resistance * heat[module] * on
            driven = (1 - keep) * target
            driven[0] = ambient[0]
            self.temperature[module] = _first_order(driven, keep)[on]
        self.times = grid[on]
        self.x = np.interp(travelled, path, x)[on]
        self.y = np.interp(travelled, path, y)[on]
        self.heading = (heading[leg] + turn_rate * since)[on]
        self.speed, self.turn_rate, self.payload = v[on], turn_rate[on], carried[on]
        self.current, self.state_of_charge, self.ambient = current[on], charge[on], ambient[on]
        self.voltage = 22.5 + 4.0 * self.state_of_charge + 0.05 * self.current

    def _measure(self, rng: np.random.Generator) -> None:
        """Make the readings of the sensors: the fields of each topic that are not constant zero."""
        n = len(self.times)
        stamp = {"header.stamp.sec": self.times // SECOND, "header.stamp.nanosec": self.times % SECOND}
        nan = np.full(n, np.nan)
        self._measured: dict[str, dict[str, NDArray[Any]]] = {
            f"/ota/{module}/temperature": stamp
            | {
                "temperature": self.temperature[module] + rng.normal(0.0, 0.1, n),
                "variance": np.full(n, 0.01),
            }
            for module in MODULES
        }
        self._measured["/ota/battery"] = stamp | {
            "voltage": self.voltage + rng.normal(0.0, 0.02, n),
            "temperature": self.temperature["power"] + rng.normal(0.0, 0.2, n),
            "current": self.current + rng.normal(0.0, 0.05, n),
            "charge": nan,
            "capacity": nan,
            "design_capacity": np.full(n, CAPACITY),
            "percentage": self.state_of_charge,
            "power_supply_status": np.where(self.current > 0, 1, 2),
            "power_supply_technology": np.full(n, 2),
            "present": np.ones(n, dtype=bool),
        }
        moving = self.speed > 0
        self._measured["/ota/odom"] = stamp | {
            "pose.pose.position.x": self.x,
            "pose.pose.position.y": self.y,
            "pose.pose.orientation.z": np.sin(self.heading / 2),
            "pose.pose.orientation.w": np.cos(self.heading / 2),
            "twist.twist.linear.x": self.speed + moving * rng.normal(0.0, 0.005, n),
            "twist.twist.angular.z": self.turn_rate,
        }
        digest = hashlib.sha256(b"synthetic ota")
        for topic, fields in self._measured.items():
            for field, values in fields.items():
                digest.update(f"{topic}.{field}".encode() + values.tobytes())
        self.fingerprint = digest.hexdigest()

    def _tell(self, tasks: list[list[Trip]], start: int, period: int) -> Iterator[_Told]:
        """Tell of tasks, each at the first look after it; nothing where the robot does not look in time."""
        for trips in tasks:
            due = [start + math.ceil(at * SECOND) for at in (trips[0].begin, *(trip.arrived for trip in trips))]
            looks = np.searchsorted(self.times, due).tolist()
            seen = [
                look < len(self.times) and self.times[look] - at < period for look, at in zip(looks, due, strict=True)
            ]
            if all(seen) and all(one < other for one, other in pairwise(looks)):
                times = (np.diff(self.times[looks]) / SECOND).tolist()
                yield _Told(looks[-1], "/ota/task_time", str(times))
                yield _Told(looks[-1], "/ota/task_position", str(np.column_stack([self.x, self.y])[looks].tolist()))
            if seen[0]:
                stations = [STATIONS[trip.here] for trip in trips] + [STATIONS[trips[-1].there]]
                speeds = [trip.cruise for trip in trips] + [0.0]
                waypoints = [[x, y, speed] for (x, y), speed in zip(stations, speeds, strict=True)]
                yield _Told(looks[0], "/ota/robot_task_list", str(waypoints))
                yield _Told(looks[0], "/ota/plan", stations)

    def topics(self) -> list[TopicInfo]:
        """Return the topics that the robot sends; times are receipt times [ns]."""
        from robophm.transports.signals.message_type import numeric_fields

        definitions = typestore(2).fielddefs
        found = []
        for topic, type_ in MEASURED_TYPES.items():
            receipt = self.times + LATENCY[topic]
            fields = tuple(numeric_fields(definitions, type_))
            found.append(TopicInfo(topic, type_, len(receipt), int(receipt[0]), int(receipt[-1]), fields))
        for topic, type_ in TOLD_TYPES.items():
            when = [int(self.times[one.look]) + LATENCY[topic] for one in self._told if one.topic == topic]
            fields = tuple(numeric_fields(definitions, type_))
            found.append(TopicInfo(topic, type_, len(when), min(when, default=None), max(when, default=None), fields))
        return sorted(found, key=lambda info: info.topic)

    def tasks(self) -> list[PlannedTask | DoneTask]:
        """Return the tasks that it tells of, as a listener to its texts hears them."""
        from robophm.transports.tasks import TaskListener

        listener = TaskListener(self.notes)
        texts = ((one, one.content) for one in self._told if isinstance(one.content, str))
        heard = (listener.hear(int(self.times[one.look]) + LATENCY[one.topic], one.topic, text) for one, text in texts)
        return [task for task in heard if task]

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """Yield the samples of these signals, as a recording of the drive yields them."""
        from robophm.transports.signals.message_type import field_getter

        wanted: dict[str, list[tuple[str, str]]] = {}
        for signal in sorted(set(signals)):
            topic, field = split_signal(signal)
            if topic not in ALL_TYPES:
                raise SourceError(f"synthetic OTA: no topic '{topic}'{nearest(topic, ALL_TYPES)}")
            try:
                field_getter(typestore(2).fielddefs, ALL_TYPES[topic], field)
            except SourceError as error:
                raise SourceError(f"synthetic OTA: topic '{topic}' {error}") from None
            wanted.setdefault(topic, []).append((signal, field))
        self.notes.clear()
        columns = []
        for topic in MEASURED_TYPES:
            if topic not in wanted:
                continue
            messages = self._messages(topic, 2)
            for signal, field in wanted[topic]:
                name, _, index = field.partition("[")
                if name not in (messages.dtype.names or ()):
                    self.notes[f"no element for {signal}"] += len(self.times)  # an empty sequence
                    continue
                values = messages[name][:, int(index[:-1])] if index else messages[name]
                columns.append((signal, values.astype(float)))
        told = []
        for one in self._told:
            message = self._message(one, 2) if one.topic in wanted else None
            for signal, field in wanted.get(one.topic, ()):
                try:
                    value = field_getter(typestore(2).fielddefs, ALL_TYPES[one.topic], field)(message)
                except IndexError:
                    self.notes[f"no element for {signal}"] += 1
                else:
                    told.append(Sample(int(self.times[one.look]), signal, float(value)))
        return merge(self._samples(columns), told, key=attrgetter("time")) if told else self._samples(columns)

    def _samples(self, columns: list[tuple[str, Floats]]) -> Iterator[Sample]:
        names = [signal for signal, _ in columns]
        # lists of floats are large: a part of the day at a time
        for first in range(0, len(self.times), 4096):
            rows = zip(*(values[first : first + 4096].tolist() for _, values in columns), strict=True)
            for time, row in zip(self.times[first : first + 4096].tolist(), rows, strict=bool(columns)):
                yield from map(partial(Sample, time), names, row)

    def record(self, path: str | Path) -> Path:
        """Write the drive as a recording; return the file, or the rosbag2 folder, that was written.

        The suffix says which: ``.mcap`` (ROS 2, zstd), ``.bag`` (ROS 1), or ``.db3``, which makes a rosbag2
        folder of that name without the suffix.

        Raises SourceError where the suffix is another, or the file is there already.
        """
        path = Path(path)
        writers = {".mcap": self._record_mcap, ".bag": self._record_bag, ".db3": self._record_db3}
        if path.suffix not in writers:
            raise SourceError(f"{path}: cannot be written; expected a name that ends in {', '.join(writers)}")
        target = path.with_suffix("") if path.suffix == ".db3" else path
        if target.exists():
            raise SourceError(f"{target}: is there already; expected a new name")
        writers[path.suffix](target)
        return target

    def _record_mcap(self, path: Path) -> None:
        from mcap.writer import Writer

        store = typestore(2)
        with path.open("xb") as file:
            writer = Writer(file)
            writer.start(profile="ros2", library="robophm")
            schemas = {
                type_: writer.register_schema(type_, "ros2msg", store.generate_msgdef(type_, 2)[0].encode())
                for type_ in dict.fromkeys(ALL_TYPES.values())
            }
            channels = {
                topic: writer.register_channel(topic, "cdr", schemas[type_], {"offered_qos_profiles": ""})
                for topic, type_ in ALL_TYPES.items()
            }
            for topic, number, receipt, stamp, payload in self._payloads(2):
                writer.add_message(channels[topic], receipt, payload, stamp, number)
            writer.finish()  # type: ignore[no-untyped-call]

    def _record_db3(self, path: Path) -> None:
        from rosbags.rosbag2 import Writer

        store = typestore(2)
        with Writer(path, version=9) as writer:
            connections = {
                topic: writer.add_connection(topic, type_, typestore=store) for topic, type_ in ALL_TYPES.items()
            }
            for topic, _, receipt, _, payload in self._payloads(2):
                writer.write(connections[topic], receipt, payload)

    def _record_bag(self, path: Path) -> None:
        from rosbags.rosbag1 import Writer

        store = typestore(1)
        with Writer(path) as writer:
            connections = {
                topic: writer.add_connection(topic, type_, typestore=store) for topic, type_ in ALL_TYPES.items()
            }
            for topic, _, receipt, _, payload in self._payloads(1):
                writer.write(connections[topic], receipt, payload)

    def _payloads(self, ros: Literal[1, 2]) -> Iterator[tuple[str, int, int, int, bytes]]:
        """Topic, number, receipt, stamp and bytes of every message, in order of receipt."""
        store = typestore(ros)
        serialize = store.serialize_ros1 if ros == 1 else store.serialize_cdr
        packed = []
        for topic in MEASURED_TYPES:
            messages = self._messages(topic, ros)
            packed.append((topic, messages.tobytes(), messages.dtype.itemsize))
        told = {look: [*group] for look, group in groupby(self._told, attrgetter("look"))}
        sent: Counter[str] = Counter()
        for number, stamp in enumerate(self.times.tolist()):
            for topic, payload, size in packed:
                yield topic, number, stamp + LATENCY[topic], stamp, payload[number * size : (number + 1) * size]
            for one in sorted(told.get(number, ()), key=lambda one: LATENCY[one.topic]):
                payload = bytes(serialize(self._message(one, ros), ALL_TYPES[one.topic]))
                yield one.topic, sent[one.topic], stamp + LATENCY[one.topic], stamp, payload
                sent[one.topic] += 1

    def _message(self, told: _Told, ros: Literal[1, 2]) -> Any:
        """A message about a task, as rosbags has it."""
        types = typestore(ros).types
        if isinstance(told.content, str):
            return types["std_msgs/msg/String"](told.content)
        stamp = types["builtin_interfaces/msg/Time"](*map(int, divmod(self.times[told.look], SECOND)))
        header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="odom", **({"seq": 0} if ros == 1 else {}))
        courses = [math.atan2(there[1] - here[1], there[0] - here[0]) for here, there in pairwise(told.content)]
        poses = []
        for (x, y), course in zip(told.content, [*courses, courses[-1]], strict=True):
            position = types["geometry_msgs/msg/Point"](x, y, 0.0)
            orientation = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, math.sin(course / 2), math.cos(course / 2))
            pose = types["geometry_msgs/msg/Pose"](position, orientation)
            poses.append(types["geometry_msgs/msg/PoseStamped"](header, pose))
        return types["nav_msgs/msg/Path"](header, poses)

    def _messages(self, topic: str, ros: Literal[1, 2]) -> NDArray[Any]:
        """All messages of a topic, serialised: one record of a fixed layout a message."""
        fields = message_layout(ros, topic)
        dtype = np.dtype(
            {
                "names": [name for name, _, _, _ in fields],
                "formats": [format_ for _, format_, _, _ in fields],
                "offsets": [offset for _, _, offset, _ in fields],
            }
        )
        messages = np.zeros(len(self.times), dtype)
        for name, _, _, constant in fields:
            if constant is not None:
                messages[name] = constant
        for name, values in self._measured[topic].items():
            messages[name] = values
        if ros == 1:
            messages["header.seq"] = np.arange(len(messages))
        return messages


def _first_order(driven: Floats, keep: float) -> Floats:
    """Solve y[k] = keep · y[k−1] + driven[k] by doubling: each pass adds the older half of what is known."""
    y = driven.copy()
    shift = 1
    while shift < len(y) and keep**shift > 1e-300:
        y[shift:] += keep**shift * y[:-shift]
        shift *= 2
    return y
