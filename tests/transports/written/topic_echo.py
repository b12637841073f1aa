"""The drive as `ros2 topic echo --csv` prints messages of one topic: fields in order, without names."""

from collections import defaultdict

NAMES = {
    "/ota/battery.current": "/fix.latitude",
    "/ota/battery.voltage": "/fix.altitude",
    "/ota/mobility/temperature.temperature": "/fix.longitude",
    "/ota/odom.pose.pose.position.x": "/fix.position_covariance[0]",
    "/ota/odom.twist.twist.angular.z": "/fix.position_covariance[8]",
}


def write(drive, signals, folder):
    rows = defaultdict(dict)
    for time, signal, value in drive.samples(signals):
        rows[time][NAMES[signal].partition(".")[2]] = value
    lines = ["sensor_msgs/msg/NavSatFix,/fix"]
    for time, row in rows.items():
        fields = [row["latitude"], row["longitude"], row["altitude"]]
        fields += [row.get(f"position_covariance[{number}]", 0.0) for number in range(9)]
        lines.append(",".join(map(str, [time // 10**9, time % 10**9, "gps", 0, 1, *fields, 2])))
    path = folder / "drive.csv"
    path.write_text("\n".join(lines))
    return path
