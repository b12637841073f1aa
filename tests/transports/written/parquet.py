"""The drive as ``robophm data export`` writes it of a recording of ROS."""

from collections import Counter

from robophm.measured.export import export
from robophm.measured.recordings import recordings, signal_of


def write(drive, signals, folder):
    (recorded,) = recordings([drive.record(folder.parent / f"{folder.name}.bag")])
    path = folder / "drive.parquet"
    export(recorded, [signal_of(signal, [recorded]) for signal in signals], path, Counter())
    return path
