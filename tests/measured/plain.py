"""The same by plain loops over samples, one at a time; and recordings to look at."""

import math

from mcap.writer import Writer
from rosbags.typesys import Stores, get_typestore

from robophm.core.signal import SECOND
from robophm.transports.recordings.recording import Recording

STORE = get_typestore(Stores.ROS2_HUMBLE)
START = 1_700_000_000 * SECOND
TEMPERATURE, BARE = "/motor/temperature.temperature", "/level.data"


def write(path, messages, chunk_size=1 << 20):
    """A recording of temperatures with a stamp, or numbers without one: (received, stamp or None, value)."""
    types = STORE.types
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=chunk_size)
        writer.start(profile="ros2")
        channels = {}
        for topic, type_ in (("/motor/temperature", "sensor_msgs/msg/Temperature"), ("/level", "std_msgs/msg/Float64")):
            definition = STORE.generate_msgdef(type_, ros_version=2)[0].encode()
            channels[topic] = writer.register_channel(
                topic, "cdr", writer.register_schema(type_, "ros2msg", definition)
            )
        for received, stamp, value in messages:
            if stamp is None:
                topic, type_, message = "/level", "std_msgs/msg/Float64", types["std_msgs/msg/Float64"](value)
            else:
                time = types["builtin_interfaces/msg/Time"](*divmod(stamp, SECOND))
                header = types["std_msgs/msg/Header"](time, "")
                topic, type_ = "/motor/temperature", "sensor_msgs/msg/Temperature"
                message = types[type_](header, value, 0.0)
            writer.add_message(channels[topic], received, bytes(STORE.serialize_cdr(message, type_)), received)
        writer.finish()
    return path


def samples(path, signal):
    """Time and value of each sample in order of time; of several at one time the largest."""
    with Recording(path) as recording:
        pairs = sorted((one.time, one.value) for one in recording.samples([signal]) if math.isfinite(one.value))
    return [pair for pair, after in zip(pairs, [*pairs[1:], None], strict=False) if after is None or after[0] > pair[0]]


def stretches(pairs, max_age):
    """Begin, end, value, and the next sample where it comes in time, of every stretch that one value holds."""
    found = []
    for (time, value), after in zip(pairs, [*pairs[1:], None], strict=False):
        end = time if after is None else min(after[0], time + max_age)
        found.append((time, end, value, after if after and after[0] == end else None))
    return found


def hits(pairs, max_age, holds, at_least):
    """Begin, end, lowest and highest of each stretch in which ``holds`` says a number and not None."""
    found, current = [], None
    for begin, end, value, after in stretches(pairs, max_age):
        says = holds(begin, value, after)
        if current and (says is None or begin != current[1]):
            found.append(current)
            current = None
        if says is not None:
            low, high = current[2:] if current else (says, says)
            current = (current[0] if current else begin, end, min(low, says), max(high, says))
    found += [current] if current else []
    return [hit for hit in found if hit[1] - hit[0] >= at_least]
