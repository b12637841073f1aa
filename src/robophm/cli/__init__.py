"""The command line: ``robophm COMMAND``. Exit codes: 0 ok, 1 threshold breached, 2 usage, 3 invalid input."""

from __future__ import annotations

import io
import os
import sys
from typing import TextIO

OK, BREACHED, USAGE, INVALID, INTERRUPTED = 0, 1, 2, 3, 130


def main() -> None:
    """Run the command line and leave with its exit code; a user's mistake is one line on stderr."""
    sys.stdout, sys.stderr = _Output.of(sys.stdout, "replace"), _Output.of(sys.stderr, "backslashreplace")
    try:
        sys.exit(_run())
    finally:
        sys.stderr.flush()


def _run() -> int | str | None:
    """What the process leaves with."""
    try:
        from robophm.cli.app import app
        from robophm.core.errors import RobophmError

        try:
            app(prog_name="robophm")
        except RobophmError as error:
            print(f"error: {error}", file=sys.stderr)
            return INVALID
        except SystemExit as leaving:
            if leaving.code == INTERRUPTED:
                raise KeyboardInterrupt from None
            return leaving.code
        finally:
            sys.stdout.flush()
    except OSError as error:  # of stdout, as on a full disk; the rooms below make their own errors of the others
        _nowhere(sys.stdout)
        print(f"error: {error.filename or 'standard output'}: {error.strerror or error}", file=sys.stderr)
        return INVALID
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    return OK


class _Output(io.TextIOWrapper):
    """A standard stream that takes every character, and goes on silently when whoever read it has seen enough.

    So the exit code is the command's own, whether its output was read to the end or not. Into a pipe or a file, too,
    every line goes out as it is written: who reads a command that runs for hours sees it while it runs.
    """

    @classmethod
    def of(cls, stream: TextIO | None, errors: str) -> TextIO:
        """The same stream, or nowhere at all where there is none."""
        if stream is None:
            return open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123
        return cls(stream.buffer, encoding=stream.encoding, errors=errors, line_buffering=True)

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except BrokenPipeError:
            _nowhere(self)
            return len(text)

    def flush(self) -> None:
        try:
            super().flush()
        except BrokenPipeError:
            _nowhere(self)


def _nowhere(stream: TextIO) -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
