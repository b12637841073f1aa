"""That robophm installs on ARM: pip finds a wheel of everything, for each Python, without ARM being there."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement

PROJECT: dict[str, Any] = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
ON_ROBOTS = (["ros2"], ["zenoh", "foxglove", "rosbridge", "mqtt"], ["parquet", "px4", "mavlink", "cbor", "msgpack"])
"""Extras that are wanted on a robot, or beside one."""

GLIBC = range(17, 40)
"""Minor versions of the C library whose wheels an ARM robot may take: Debian 12 has 2.36, Ubuntu 24.04 2.39."""


def wanted(python: str, extras: Sequence[str]) -> Iterator[str]:
    """The requirements on Linux on ARM: pip itself evaluates their conditions for the machine on which it runs."""
    there = {"python_version": python, "python_full_version": f"{python}.0", "platform_machine": "aarch64",
             "sys_platform": "linux", "platform_system": "Linux", "extra": ""}  # fmt: skip
    for text in [
        *PROJECT["dependencies"],
        *(one for extra in extras for one in PROJECT["optional-dependencies"][extra]),
    ]:
        requirement = Requirement(text)
        if requirement.marker is None or requirement.marker.evaluate(there):
            requirement.marker = None
            yield str(requirement)


@pytest.mark.full
@pytest.mark.parametrize("extras", ON_ROBOTS, ids=" ".join)
@pytest.mark.parametrize("python", ["3.11", "3.12", "3.13", "3.14"])
def test_everything_has_a_wheel_for_arm(python: str, extras: Sequence[str], tmp_path: Path) -> None:
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed", "--no-cache-dir", "--quiet",
               "--only-binary=:all:", "--target", str(tmp_path), "--python-version", python, "--implementation", "cp",
               "--abi", f"cp{python.replace('.', '')}", "--abi", "abi3", "--abi", "none",
               "--platform", "manylinux2014_aarch64", "--platform", "any"]  # fmt: skip
    command += [word for minor in GLIBC for word in ("--platform", f"manylinux_2_{minor}_aarch64")]
    done = subprocess.run([*command, *wanted(python, extras)], capture_output=True, text=True, check=False)
    if "Could not fetch URL" in done.stderr or "NewConnectionError" in done.stderr:
        pytest.skip("no package index here")
    assert done.returncode == 0, done.stderr[-2000:]


def test_dds_is_not_asked_for_where_it_has_no_wheel() -> None:
    assert not any(one.startswith("cyclonedds") for one in wanted("3.12", ["ros2"]))
