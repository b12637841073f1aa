"""The drive as ArduPilot would log it: the published format (ardupilot.org/dev/docs/logmessages.html)."""

import struct
from collections import defaultdict

START = 17_000_000
"""Microseconds from the start of the autopilot to the first message."""

NAMES = {
    "/ota/battery.current": "/BAT.Curr",
    "/ota/battery.voltage": "/BAT.Volt",
    "/ota/mobility/temperature.temperature": "/TEMP.Temp",
    "/ota/odom.pose.pose.position.x": "/ODOM.X",
    "/ota/odom.twist.twist.angular.z": "/ODOM.YawRate",
}
"""What the signals are called in such a log, where names have four letters."""

LETTERS = {"b": "b", "B": "B", "M": "B", "h": "h", "H": "H", "i": "i", "I": "I", "q": "q", "Q": "Q", "g": "e", "f": "f",
           "d": "d", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i", "n": "4s", "N": "16s", "Z": "64s",
           "a": "32h"}  # fmt: skip

FMT = "BBnNZ"
FORMATS = {"FMT": (128, FMT, "Type,Length,Name,Format,Columns")}


def layout(letters):
    return struct.Struct("<" + "".join(LETTERS[letter] for letter in letters))


def message(number, letters, *values):
    return bytes([0xA3, 0x95, number]) + layout(letters).pack(*values)


def defines(number, name, letters, labels):
    """The message that says how messages of this number lie."""
    size = 3 + layout(letters).size
    return message(128, FMT, number, size, name.encode(), letters.encode(), labels.encode())


GPS = "QBBIHB", "TimeUS,I,Status,GMS,GWk,NSats"
GPS_EPOCH = 315_964_800
"""1980-01-06 in seconds since 1970."""

LEAP = 18
"""Seconds that GPS is ahead of UTC since 2017 (IERS Bulletin C)."""


def gps(number, stamp, utc, *, status=3, instance=0):
    """A fix at a time of the autopilot, in microseconds, of the UTC in milliseconds."""
    week, within = divmod(utc - (GPS_EPOCH - LEAP) * 1000, 7 * 24 * 3600 * 1000)
    return message(number, GPS[0], stamp, instance, status, within, week, 9)


def head(**kinds):
    """The formats with which a log begins; kinds by name, letters and labels each, are numbered from 129."""
    every = {"FMT": (FMT, "Type,Length,Name,Format,Columns"), **kinds}
    return b"".join(defines(number, name, *each) for number, (name, each) in enumerate(every.items(), 128))


def write(drive, signals, folder):
    rows = defaultdict(dict)
    for time, signal, value in drive.samples(signals):
        rows[time][NAMES[signal]] = value
    kinds = defaultdict(list)
    for name in (NAMES[signal] for signal in signals):
        kinds[name[1:].partition(".")[0]].append(name.partition(".")[2])
    log = [head(GPS=GPS, **{name: ("Q" + "d" * len(own), ",".join(["TimeUS", *own])) for name, own in kinds.items()})]
    first = min(rows)
    for time, row in sorted(rows.items()):
        stamp, rest = divmod(time - first, 1000)
        assert rest == 0  # a log has whole microseconds
        if time % 1_000_000 == 0:  # and a GPS whole milliseconds
            log.append(gps(129, START + stamp, time // 1_000_000))
        for number, (name, own) in enumerate(kinds.items(), 130):
            if f"/{name}.{own[0]}" in row:
                values = [row[f"/{name}.{label}"] for label in own]
                log.append(message(number, "Q" + "d" * len(own), START + stamp, *values))
    path = folder / "drive.BIN"
    path.write_bytes(b"".join(log))
    return path
