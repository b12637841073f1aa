"""The drive as a table, written by hand."""

from collections import defaultdict


def write(drive, signals, folder):
    rows = defaultdict(dict)
    for time, signal, value in drive.samples(signals):
        rows[time][signal] = value
    lines = [",".join(["time", *signals])]
    for time, row in rows.items():
        lines.append(",".join([f"{time // 10**9}.{time % 10**9:09}", *(repr(row[s]) for s in signals)]))
    path = folder / "drive.csv"
    path.write_text("\n".join(lines))
    return path
