"""The drive as a recording of ROS."""


def write(drive, signals, folder):
    return drive.record(folder / "drive.bag")
