"""The command line: ``robophm COMMAND``. Exit codes: 0 ok, 1 threshold breached, 2 usage, 3 invalid input."""

from __future__ import annotations

import os
import sys

OK, BREACHED, USAGE, INVALID = 0, 1, 2, 3


def main() -> None:
    """Run the command line and leave with its exit code; a user's mistake is one line on stderr."""
    from robophm.cli.app import app
    from robophm.core.errors import RobophmError

    try:
        app()
    except RobophmError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(INVALID)
    except BrokenPipeError:  # whoever read our output has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(OK)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)
