"""``python tools/real_recordings.py INTO CLONES [ADDRESS]``: lay recordings of other projects where their test looks.

INTO is the folder ``shared/recordings/real``; CLONES holds clones of the projects that are listed in
``tests/data/real_recordings.csv``, bare or not, each in ``OWNER+NAME``. Those that are missing are cloned there, of
their newest state what is asked for alone, if ADDRESS is given: that of the place, GitHub, where OWNER/NAME is one of
them. What is not there, or is another file than was listed, is said and left out.
"""

from __future__ import annotations

import csv
import hashlib
import os
import subprocess
import sys
from pathlib import Path

LIST = Path(__file__).parent.parent / "tests/data/real_recordings.csv"


def clone(project: str, clones: Path, address: str) -> None:
    """Clone a project that is not there."""
    folder = clones / project.replace("/", "+")
    if not folder.exists():
        what = ["git", "clone", "--quiet", "--bare", "--depth=1", "--filter=blob:none"]
        quiet = {**os.environ, "GIT_TERMINAL_PROMPT": "0"}  # of one that is gone a name and a password would be asked
        subprocess.run([*what, f"{address.rstrip('/')}/{project}", str(folder)], env=quiet, check=False)


def laid(into: Path, clones: Path, listed: Path = LIST, address: str = "") -> int:
    """Copy what is listed, of clones that are there or made; return how many are missing."""
    missing = 0
    with listed.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            folder = row["project"].replace("/", "+")
            if address:
                clone(row["project"], clones, address)
            given = ["git", "-C", str(clones / folder), "show", f"HEAD:{row['path']}"]
            content = subprocess.run(given, capture_output=True, check=False).stdout
            if hashlib.sha256(content).hexdigest() != row["sha256"]:
                print(f"{row['project']}: {row['path']} is not there, or another file", file=sys.stderr)
                missing += 1
                continue
            target = into / folder / row["path"]
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
    return missing


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    sys.exit(1 if laid(Path(sys.argv[1]), Path(sys.argv[2]), address="".join(sys.argv[3:])) else 0)
