"""``robophm doctor``: what is installed here, and whether robophm works with it."""

from __future__ import annotations

import platform
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from robophm.cli import INVALID
from robophm.cli.shared.options import Json
from robophm.cli.shared.output import console, print_json
from robophm.transports.running_robot import explained

NEEDED = ("robophm", "numpy", "scipy", "pydantic", "ruamel.yaml", "typer", "rich", "pint", "rosbags", "mcap", "PyYAML")

EXTRAS = {
    "web": ("the page: robophm serve", ("fastapi", "uvicorn", "websockets")),
    "fit": ("life data: robophm fit", ("surpyval",)),
    "ros2": ("ROS 2 without its installation, over DDS", ("cyclonedds",)),
    "zenoh": ("ROS 2 as rmw_zenoh speaks it, without its installation", ("eclipse-zenoh",)),
    "mqtt": ("robots that tell their state at an MQTT broker, as by VDA 5050", ("paho-mqtt",)),
    "foxglove": ("robots whose topics a Foxglove server serves, as foxglove_bridge", ("websockets",)),
    "rosbridge": ("robots behind rosbridge_server, of ROS 1 or 2", ("websockets",)),
    "notebook": ("data frames and plots in Python", ("pandas", "matplotlib")),
    "parquet": ("tables in Parquet", ("pyarrow",)),
    "cbor": ("messages of CBOR in MCAP", ("cbor2",)),
    "msgpack": ("messages of MessagePack in MCAP", ("msgpack",)),
    "bdd": ("large fault trees solved exactly, by CUDD", ("dd",)),
    "protobuf": ("messages of Protocol Buffers in MCAP", ("protobuf",)),
    "fleet": ("a fleet's service with PostgreSQL", ("fastapi", "uvicorn", "websockets", "psycopg")),
    "remote": ("recordings on web servers and in object storage", ("obstore",)),
    "px4": ("logs of PX4", ("pyulog",)),
    "mavlink": ("telemetry logs of ground stations", ("pymavlink",)),
    "pdf": ("reports as PDF", ("weasyprint",)),
    "progpy": ("battery and motor models of progpy: robophm wear", ("progpy",)),
    "sim": ("the live case study", ("mujoco",)),
}
"""Extras by name, each with what it is for and the packages that it brings."""


def command(as_json: Json = False) -> None:
    """Report what is installed here and whether it works."""
    versions = {"python": platform.python_version(), "platform": f"{platform.system()} {platform.machine()}"}
    for name in NEEDED:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "missing"
    extras = {name: " ".join(_missing(packages)) for name, (_, packages) in EXTRAS.items()}
    checks = {name: _try(check) for name, check in CHECKS.items()}
    live = explained()
    failed = [name for name, outcome in checks.items() if outcome != "ok"] + [
        n for n, v in versions.items() if v == "missing"
    ]
    if as_json:
        print_json(
            {
                "versions": versions,
                "checks": checks,
                "ok": not failed,
                "live": live,
                "extras": {name: {"for": EXTRAS[name][0], "missing": lacks.split()} for name, lacks in extras.items()},
            }
        )
    else:
        out = console()
        for name, text in (*versions.items(), *checks.items()):
            out.print(f"{name:<28} {text}", markup=False)
        for name, lacks in extras.items():
            state = f"not installed ({lacks}): pip install 'robophm[{name}]'" if lacks else "installed"
            out.print(f"{f'extra {name}':<28} {state}; {EXTRAS[name][0]}", markup=False, soft_wrap=True)
        for name, text in live.items():
            out.print(f"{f'robots: {name}':<28} {text}", markup=False, soft_wrap=True)
        out.print("all is well" if not failed else f"not well: {', '.join(failed)}", markup=False)
    if failed:
        sys.exit(INVALID)


def _missing(packages: Sequence[str]) -> Iterator[str]:
    """Those of these packages that are not installed."""
    for name in packages:
        try:
            version(name)
        except PackageNotFoundError:
            yield name


def _try(check: Callable[[], None]) -> str:
    try:
        check()
    except Exception as error:  # whatever it is, it is what the user came to learn
        return f"{type(error).__name__}: {error}"
    return "ok"


def _design() -> None:
    from robophm.design.file import example_design, load

    load(example_design())


def _store() -> None:
    from robophm.stores.sqlite import SqliteStore

    with tempfile.TemporaryDirectory() as folder, SqliteStore(Path(folder) / "doctor.db") as store:
        store.save("doctor", {"version": 1})


def _recording() -> None:
    from robophm.core.signal import SECOND
    from robophm.transports.recordings.recording import Recording
    from robophm.transports.synthetic import SyntheticOta

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "doctor.mcap"
        SyntheticOta(duration=5 * SECOND).record(path)
        with Recording(path) as recording:
            next(recording.samples(["/ota/battery.voltage"]))


CHECKS = {"reads a design": _design, "keeps a store": _store, "writes and reads recordings": _recording}
"""Each does the real thing, small."""
