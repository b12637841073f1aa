"""That robophm installs on ARM: pip finds a wheel of everything, for each Python, without ARM being there."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PROJECT: dict[str, Any] = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
ON_ROBOTS = (["ros2"], ["zenoh", "foxglove", "rosbridge", "mqtt"], ["parquet", "px4", "mavlink", "cbor", "msgpack"])
"""Extras that are wanted on a robot, or beside one."""

GLIBC = range(17, 40)
"""Minor versions of the C library whose wheels an ARM robot may take: Debian 12 has 2.36, Ubuntu 24.04 2.39."""


def there(python: str) -> dict[str, str]:
    """What conditions of requirements ask for, on Linux on ARM: pip itself asks the machine on which it runs."""
    return {"python_version": python, "python_full_version": f"{python}.0", "platform_machine": "aarch64",
            "sys_platform": "linux", "platform_system": "Linux", "os_name": "posix", "implementation_name": "cpython",
            "platform_python_implementation": "CPython"}  # fmt: skip


def held(texts: Iterable[str], python: str, extras: Iterable[str] = ("",)) -> Iterator[Requirement]:
    """The requirements whose conditions hold there, without them."""
    for requirement in map(Requirement, texts):
        marker, requirement.marker = requirement.marker, None
        if marker is None or any(marker.evaluate({**there(python), "extra": extra}) for extra in extras):
            yield requirement


def wanted(python: str, extras: Sequence[str]) -> list[Requirement]:
    texts = [one for extra in extras for one in PROJECT["optional-dependencies"][extra]]
    return list(held([*PROJECT["dependencies"], *texts], python))


@pytest.mark.full
@pytest.mark.parametrize("extras", ON_ROBOTS, ids=" ".join)
@pytest.mark.parametrize("python", ["3.11", "3.12", "3.13", "3.14"])
def test_everything_has_a_wheel_for_arm(python: str, extras: Sequence[str], tmp_path: Path) -> None:
    """Level by level: what is required, then what that requires."""
    command = [sys.executable, "-m", "pip", "install", "--dry-run", "--ignore-installed", "--no-deps", "--quiet",
               "--only-binary=:all:", "--target", str(tmp_path), "--python-version", python, "--implementation", "cp",
               "--abi", f"cp{python.replace('.', '')}", "--abi", "abi3", "--abi", "none",
               "--platform", "manylinux2014_aarch64", "--platform", "any"]  # fmt: skip
    command += [word for minor in GLIBC for word in ("--platform", f"manylinux_2_{minor}_aarch64")]
    command += ["--report", str(tmp_path / "report.json")]
    level, seen = wanted(python, extras), set[str]()
    while level := [one for one in level if canonicalize_name(one.name) not in seen]:
        names = {canonicalize_name(one.name): one for one in level}
        done = subprocess.run([*command, *map(str, names.values())], capture_output=True, text=True, check=False)
        if "Could not fetch URL" in done.stderr or "NewConnectionError" in done.stderr:
            pytest.skip("no package index here")
        assert done.returncode == 0, done.stderr[-2000:]
        seen |= names.keys()
        level = []
        for one in json.loads((tmp_path / "report.json").read_text())["install"]:
            asked = names[canonicalize_name(one["metadata"]["name"])].extras
            level += held(one["metadata"].get("requires_dist", ()), python, ("", *asked))
    assert {"numpy", "scipy", "pydantic-core"} <= seen


def test_dds_is_not_asked_for_where_it_has_no_wheel() -> None:
    assert "cyclonedds" not in {one.name for one in wanted("3.12", ["ros2"])}
