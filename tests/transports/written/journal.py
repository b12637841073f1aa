"""The drive as a live run that is kept."""

from robophm.core.signal import CLOCK, Sample
from robophm.transports.recordings.journal import Journal


def write(drive, signals, folder):
    path = folder / "drive.journal"
    with Journal(path, signals) as run:
        for sample in drive.samples(signals):
            run.write(sample)
        run.write(Sample(int(drive.times[-1]) + 10**9, CLOCK, 0.0))
    return path
