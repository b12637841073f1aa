"""The command line: ``robophm COMMAND``, and the exit codes that it leaves with."""

from __future__ import annotations

import io
import os
import sys

from robophm.core.ending import end_at_once, ignore

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TextIO

OK, BREACHED, USAGE, INVALID, DEFECT, INTERRUPTED = 0, 1, 2, 3, 70, 130
EXIT_CODES = (
    "Exit codes: 0 ok, 1 a threshold of the design is breached or predictions are not calibrated, 2 usage, "
    "3 invalid input, 70 a defect of robophm, 130 interrupted (143 by SIGTERM); what serves or watches is ended so, "
    "with 0."
)
TRACEBACK = "ROBOPHM_TRACEBACK"
"""The environment variable that shows where a defect came from."""


def main() -> None:
    """Run the command line and leave with its exit code; a user's mistake is one line on stderr, and so is ours."""
    end_at_once()  # until a command is there that says how it ends
    sys.stdout, sys.stderr = _Output.of(sys.stdout, "replace"), _Output.of(sys.stderr, "backslashreplace")
    try:
        sys.exit(_run())
    finally:
        sys.stderr.flush()


def _run() -> int | None:
    """The exit code with which the process leaves."""
    try:
        from robophm.cli.app import app
        from robophm.cli.shared.option_hints import with_options
        from robophm.core.errors import RobophmError

        try:
            app(prog_name="robophm")
        except RobophmError as error:
            print(f"error: {with_options(str(error))}", file=sys.stderr)
            return INVALID
        except SystemExit as leaving:
            if leaving.code == INTERRUPTED:
                raise KeyboardInterrupt from None
            if isinstance(leaving.code, str):  # from a library: Python would print it and leave with 1
                return _defect(leaving)
            return leaving.code
        finally:
            sys.stdout.flush()
    except _OutputError as error:
        _nowhere(sys.stdout)
        print(f"error: standard output: {error}", file=sys.stderr)
        return INVALID
    except KeyboardInterrupt:
        ignore()  # who asks again while it ends asks for what is being done
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    except Exception as error:
        if isinstance(error, OSError) and error.filename is not None:  # what the rooms below did not see coming
            print(f"error: {error.filename}: {error.strerror or error}", file=sys.stderr)
            return INVALID
        return _defect(error)
    return OK


def _defect(error: BaseException) -> int:
    """Say on one line that it is a defect; never exit with 1, which says that a threshold is breached."""
    from traceback import extract_tb, print_exception

    error = error.__cause__ if isinstance(error, NotOursError) and error.__cause__ else error
    if os.environ.get(TRACEBACK):
        print_exception(error)
    frames = extract_tb(error.__traceback__)
    where = f" at {frames[-1].filename.rpartition(os.sep)[2]}:{frames[-1].lineno}" if frames else ""
    said = " ".join(f"{type(error).__name__}: {error}".split())
    print(f"error: {said}{where}: a defect of robophm, not of your input; {TRACEBACK}=1 in the environment shows where "
          "it comes from", file=sys.stderr)  # fmt: skip
    return DEFECT


class NotOursError(Exception):
    """Carries past the command-line library what that would itself end with 1."""


class _OutputError(Exception):
    """Standard output takes nothing more, as on a full disk."""


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
        except OSError as error:
            raise _OutputError(error.strerror or error) from error

    def flush(self) -> None:
        try:
            super().flush()
        except BrokenPipeError:
            _nowhere(self)
        except OSError as error:
            raise _OutputError(error.strerror or error) from error


def _nowhere(stream: TextIO) -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
