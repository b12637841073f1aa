"""The drive as a ground station would log it, its messages made by pymavlink."""

import struct

from pymavlink.dialects.v20 import all as dialect

NAMES = {
    "/ota/battery.current": "/ATTITUDE.roll",
    "/ota/battery.voltage": "/ATTITUDE.pitch",
    "/ota/mobility/temperature.temperature": "/NAMED_VALUE_FLOAT_lift.value",
    "/ota/odom.pose.pose.position.x": "/LOCAL_POSITION_NED.x",
    "/ota/odom.twist.twist.angular.z": "/LOCAL_POSITION_NED.vz",
}
"""What the signals are called in such a log, by messages that have numbers for them."""


def stored(value):
    """A value as MAVLink has it: in 32 bits."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def sender(system=1, component=1):
    return dialect.MAVLink(None, srcSystem=system, srcComponent=component)


def logged(time, message, by):
    """A message as it lies in a log, behind its time [µs]."""
    return struct.pack(">Q", time) + message.pack(by)


def write(drive, signals, folder):
    by, log = sender(), []
    rows = {}
    for time, signal, value in drive.samples(signals):
        rows.setdefault(time, {})[signal] = value
    for time, row in sorted(rows.items()):
        assert time % 1000 == 0
        current, voltage, temperature, x, z = (row.get(signal) for signal in NAMES)
        made = []
        if current is not None:
            made.append(dialect.MAVLink_attitude_message(1, current, voltage, 0, 0, 0, 0))
        if temperature is not None:
            made.append(dialect.MAVLink_named_value_float_message(1, b"lift", temperature))
        if x is not None:
            made.append(dialect.MAVLink_local_position_ned_message(1, x, 0, 0, 0, 0, z))
        log += [logged(time // 1000, message, by) for message in made]
    path = folder / "drive.tlog"
    path.write_bytes(b"".join(log))
    return path
