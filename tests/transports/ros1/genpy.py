"""Classes of rospy for phm_msgs, as Debian's genpy makes them."""

from __future__ import annotations

import subprocess
from pathlib import Path

from robophm.transports.health_topics.definitions import PACKAGE

ROOT = Path(__file__).parents[3] / "ros" / PACKAGE


def generated(folder: Path, **texts: str) -> Path:
    """A folder from which Python imports phm_msgs, as genpy makes it."""
    sources, made = folder / "sources", folder / "made" / PACKAGE / "msg"
    sources.mkdir(parents=True)
    for name, text in texts.items():
        (sources / f"{name}.msg").write_text(text)
    command = ["/usr/bin/python3", "/usr/lib/genpy/genmsg_py.py"]
    include = [f"-Istd_msgs:{next(Path('/usr/share').glob('std_msgs*/msg'), '')}", f"-I{PACKAGE}:{sources}"]
    files = [str(sources / f"{name}.msg") for name in texts]
    subprocess.run([*command, *files, "-p", PACKAGE, *include, "-o", str(made)], check=True)
    subprocess.run([*command, "--initpy", "-o", str(made), "-p", PACKAGE], check=True)
    (made.parent / "__init__.py").touch()
    return folder / "made"


def generated_services(folder: Path) -> Path:
    """A folder from which Python imports the services of phm_msgs, and the messages in them."""
    made = generated(folder, TaskLeg=(ROOT / "msg" / "TaskLeg.msg").read_text())
    target = made / PACKAGE / "srv"
    include = [f"-Istd_msgs:{next(Path('/usr/share').glob('std_msgs*/msg'), '')}", f"-I{PACKAGE}:{folder / 'sources'}"]
    command = ["/usr/bin/python3", "/usr/lib/genpy/gensrv_py.py"]
    files = [str(file) for file in sorted((ROOT / "srv").glob("*.srv"))]
    subprocess.run([*command, *files, "-p", PACKAGE, *include, "-o", str(target)], check=True)
    subprocess.run([*command, "--initpy", "-o", str(target), "-p", PACKAGE], check=True)
    return made
