"""``python -m book`` builds the site into build/book/site; any warning, as of a broken link, fails."""

from __future__ import annotations

import subprocess
import sys

from book.pages import CONFIG, ROOT, lay_out


def main() -> int:
    """Lay out the pages and build the site; the exit code of the builder."""
    lay_out(ROOT / "build" / "book" / "pages")
    command = [sys.executable, "-m", "zensical", "build", "--strict", "--clean", "--config-file", str(CONFIG)]
    done = subprocess.run(command, cwd=ROOT, check=False)
    if not done.returncode:
        print(f"open {ROOT / 'build' / 'book' / 'site' / 'index.html'}")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
