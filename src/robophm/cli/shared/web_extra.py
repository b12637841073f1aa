"""Parts that the commands share which serve something over HTTP."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from robophm.core.errors import RobophmError

_PACKAGES = ("fastapi", "uvicorn", "starlette", "websockets", "h11")


@contextmanager
def web_extra(what: str) -> Iterator[None]:
    """Import what serves; ``what`` is named in the RobophmError that is raised where the extra is not installed."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name and error.name.partition(".")[0] in _PACKAGES:
            raise RobophmError(
                f"{what} needs what `pip install 'robophm[web]'` installs: there is no {error.name}"
            ) from None
        raise


def check_key(key: Path | None, certificate: Path | None) -> None:
    """Raise RobophmError for a key without the certificate that it is of."""
    if key and not certificate:
        raise RobophmError("--key is that of a certificate; expected --certificate too")
