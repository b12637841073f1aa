"""The drive as a PX4 autopilot would log it: the published format (docs.px4.io/main/en/dev_log/ulog_file_format)."""

import struct
from collections import defaultdict

START = 17_000_000
"""Microseconds from the start of the autopilot to the first message."""

GPS = "vehicle_gps_position:uint64_t timestamp;uint64_t time_utc_usec;uint8_t fix_type;uint8_t[7] _padding0;"


def message(kind: str, content: bytes) -> bytes:
    """A message of a log: its size, kind and content."""
    return struct.pack("<HB", len(content), ord(kind)) + content


def head(*formats: str) -> bytes:
    """What a log begins with: version 1, flags, and the formats of its messages."""
    return b"".join(
        [
            b"ULog\x01\x12\x35\x01" + struct.pack("<Q", START),
            message("B", bytes(40)),
            *(message("F", one.encode()) for one in formats),
        ]
    )


def listens(number: int, name: str, instance: int = 0) -> bytes:
    """From here on messages of this number are of this topic."""
    return message("A", struct.pack("<BH", instance, number) + name.encode())


def data(number: int, layout: str, *values: float) -> bytes:
    return message("D", struct.pack("<H" + layout, number, *values))


def formats_of(name: str, fields: list[str]) -> list[str]:
    """The formats of messages with these fields, all doubles, some in messages within."""
    within = defaultdict(list)
    own = []
    for field in fields:
        first, dot, rest = field.partition(".")
        within[first] += [rest] if dot else []
        own += [] if dot else [f"double {field};"]
    own += [f"{name}_{first} {first};" for first, rest in within.items() if rest]
    found = [f"{name}:{'' if '_' in name else 'uint64_t timestamp;'}{''.join(own)}"]
    for first, rest in within.items():
        found += formats_of(f"{name}_{first}", rest) if rest else []
    return found


def write(drive, signals, folder):
    rows = defaultdict(lambda: defaultdict(list))
    fields = defaultdict(list)
    for signal in sorted(signals):
        fields[signal[1:].partition(".")[0]].append(signal.partition(".")[2])
    for time, signal, value in drive.samples(signals):
        rows[time][signal[1:].partition(".")[0]].append(value)
    names = [*fields]
    log = [head(GPS, *(one for name in names for one in formats_of(name, fields[name]))), listens(0, GPS.split(":")[0])]
    log += [listens(number, name) for number, name in enumerate(names, 1)]
    first = min(rows)
    for time, row in sorted(rows.items()):
        stamp, rest = divmod(time - first, 1000)
        assert rest == 0  # a log has whole microseconds
        log.append(data(0, "QQB", START + stamp, time // 1000, 3))
        log += [data(names.index(name) + 1, f"Q{len(row[name])}d", START + stamp, *row[name]) for name in row]
    path = folder / "drive.ulg"
    path.write_bytes(b"".join(log))
    return path
