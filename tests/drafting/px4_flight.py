"""A simulated flight of a quadrotor as its PX4 autopilot logs it: messages as PX4 1.15 defines them, by pyulog.

The physics are simple: a square is flown at 10 m, the battery is drained at a constant current, what is warm comes near
its end temperature exponentially.
"""

import io
import math
import re
import struct
from pathlib import Path

from pyulog import ULog

from robophm.transports.ros2_dds.interfaces import releases

from ..transports.written.ulog import START, head, listens, message

RELEASE, START_UTC, AMBIENT = "1.15", 1_790_000_000_000_000, 18.0
TOPICS = ("BatteryStatus", "EscStatus", "SensorBaro", "SensorGps", "VehicleImuStatus",
          "VehicleLocalPosition", "Cpuload")  # fmt: skip
CODES = {"bool": "?", "uint8": "B", "int8": "b", "uint16": "H", "int16": "h", "uint32": "I", "int32": "i",
         "uint64": "Q", "int64": "q", "float32": "f", "float64": "d"}  # fmt: skip


def logged_name(type_: str) -> str:
    """The name of a message in a log: battery_status, of BatteryStatus."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", type_).lower()


def fields_of(type_: str) -> list[tuple[str, str, int]]:
    """The type, name and number of each field as PX4 defines them; 0 where it is no array."""
    text = releases("px4_msgs")[RELEASE][f"px4_msgs/msg/{type_}"].text
    found = (re.match(r"(?:px4_msgs/)?(\w+)(?:\[(\d+)\])? (\w+)", line) for line in text.splitlines())
    return [(one[1], one[3], int(one[2] or 0)) for one in found if one]


def format_of(type_: str) -> str:
    """The format of a message as a log has it."""

    def kind(name: str) -> str:
        if name not in CODES:
            return logged_name(name)
        return {"float32": "float", "float64": "double", "bool": "bool"}.get(name, f"{name}_t")

    fields = (f"{kind(name)}{f'[{many}]' if many else ''} {field};" for name, field, many in fields_of(type_))
    return f"{logged_name(type_)}:{''.join(fields)}"


def packed(type_: str, said: dict[str, float]) -> bytes:
    """A message with these numbers by their paths, ``esc[0].esc_temperature``, and zeros else."""
    content = b""
    for kind, field, many in fields_of(type_):
        for number in range(many or 1):
            path = f"{field}[{number}]" if many else field
            if kind in CODES:
                content += struct.pack("<" + CODES[kind], said.get(path, 0))
            else:
                inner = {key.removeprefix(f"{path}."): one for key, one in said.items() if key.startswith(f"{path}.")}
                content += packed(kind, inner)
    return content


def said_at(t: float) -> dict[str, dict[str, float]]:
    """What each message says at a time [s] of the flight."""
    along = t / 10 % 4
    side, way = int(along), 10 * (along % 1)  # 10 m in 10 s
    x, y = [(way, 0), (10, way), (10 - way, 10), (0, 10 - way)][side]
    warm = 1 - math.exp(-t / 150)
    escs = {
        f"esc[{k}].{key}": value
        for k in range(4)
        for key, value in {"esc_temperature": AMBIENT + (28 + k) * warm, "esc_voltage": 15.8 - t / 600,
                           "esc_current": 3.5, "esc_rpm": 6200 + 10 * k}.items()
    }  # fmt: skip
    return {
        "BatteryStatus": {"connected": True, "voltage_v": 16.6 - t / 500, "current_a": 14.0, "remaining": 1 - t / 1100,
                          "temperature": AMBIENT + 9 * warm, "cell_count": 4},
        "EscStatus": {"esc_count": 4, "esc_online_flags": 15, **escs},
        "SensorBaro": {"pressure": 100_000.0, "temperature": AMBIENT + 22 * warm},
        "SensorGps": {"fix_type": 3, "time_utc_usec": START_UTC + round(t * 1e6), "latitude_deg": 47.4,
                      "longitude_deg": 8.5},
        "VehicleImuStatus": {"temperature_accel": AMBIENT + 25 * warm, "temperature_gyro": AMBIENT + 25 * warm},
        "VehicleLocalPosition": {"x": x, "y": y, "z": -10.0},
        "Cpuload": {"load": 0.4, "ram_usage": 0.3},
    }  # fmt: skip


def fly(path: Path, seconds: int = 600) -> Path:
    """Write the log of a flight, each message twice a second."""
    inner = {kind for type_ in TOPICS for kind, _, _ in fields_of(type_) if kind not in CODES}
    log = [head(*map(format_of, (*sorted(inner), *TOPICS)))]
    log += [listens(number, logged_name(type_)) for number, type_ in enumerate(TOPICS)]
    for step in range(2 * seconds):
        stamp = START + step * 500_000
        for number, (type_, said) in enumerate(said_at(step / 2).items()):
            log.append(message("D", struct.pack("<H", number) + packed(type_, {"timestamp": stamp, **said})))
    ULog(io.BytesIO(b"".join(log))).write_ulog(str(path))
    return path
