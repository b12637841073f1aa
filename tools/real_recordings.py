"""``python tools/real_recordings.py INTO CLONES``: lay recordings of other projects where their test looks for them.

INTO is the folder ``shared/recordings/real``; CLONES holds clones of the projects that are listed in
``tests/data/real_recordings.csv``, bare or not, each in ``OWNER+NAME``. What is not there, or is another file than was
listed, is said and left out.
"""

from __future__ import annotations

import csv
import hashlib
import subprocess
import sys
from pathlib import Path

LIST = Path(__file__).parent.parent / "tests/data/real_recordings.csv"


def laid(into: Path, clones: Path, listed: Path = LIST) -> int:
    """Copy what is listed; return how many are missing."""
    missing = 0
    with listed.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            folder = row["project"].replace("/", "+")
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
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(1 if laid(*map(Path, sys.argv[1:])) else 0)
