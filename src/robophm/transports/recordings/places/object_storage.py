"""Web servers and object storage of clouds, by obstore (robophm[remote]): ranges of bytes, and no more.

Who may read says the environment, as of the clouds' own programs: ``AWS_ACCESS_KEY_ID``, ``AWS_SECRET_ACCESS_KEY``,
``AWS_REGION``, ``AWS_ENDPOINT_URL`` (``AWS_SKIP_SIGNATURE=true`` where everybody may), ``GOOGLE_SERVICE_ACCOUNT``,
``AZURE_STORAGE_ACCOUNT_NAME`` and ``AZURE_STORAGE_ACCOUNT_KEY``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any
from urllib.parse import unquote, urlsplit

from robophm.core.errors import SourceError
from robophm.transports.recordings.place import Place, Range, RangesError, without_query

_AT_ONCE = 8
"""Requests that are under way at once."""

_LIMITS: dict[str, Any] = {"timeout": "60s", "connect_timeout": "10s"}
_RETRIES: Any = {"max_retries": 2}

_ASKS_MACHINE = "169.254.169.254"
"""The address at which a machine in a cloud is asked who it is, where nothing else says that."""

_WEB = ("http", "https")
"""Schemes whose addresses may have a query, as of links that are signed: it is never shown."""

_QUERY = re.compile(r"\?[^\s'\")\]]*")

_LONGEST = 200
"""Letters of somebody else's error that are told."""


class StoredFile:
    """A file on a web server or in object storage. Raises SourceError where there is none, or obstore is missing."""

    def __init__(self, address: str) -> None:
        self._address = without_query(address)
        try:
            from obstore.store import from_url
        except ImportError:
            raise SourceError(
                f"{self._address}: needs obstore; install it with `pip install 'robophm[remote]'`"
            ) from None
        parts = urlsplit(address)
        asked = f"?{parts.query}" if parts.query else ""
        self._signed = bool(asked)
        if parts.fragment or parts.username or (asked and parts.scheme not in _WEB):
            kinds = "'#' or '@'" if parts.scheme in _WEB else "'?', '#' or '@'"
            raise SourceError(f"{self._address}: has more than a path; expected an address without {kinds}")
        options: Any = _LIMITS | {"allow_http": parts.scheme != "https"}
        with self._told():
            root = f"{parts.scheme}://{parts.netloc}{'/' * bool(asked)}{asked}"
            self._store = from_url(root, client_options=options, retry_config=_RETRIES)
            self._path = unquote(parts.path).lstrip("/")
            found = self._asked() if asked else self._store_head()
        self.size = int(found["size"])
        self.changed = found["last_modified"].timestamp()
        self._same: Any = {"if_match": found["e_tag"]} if found["e_tag"] else {}
        """The condition under which the server gives the file: that it is what it was."""

    def _store_head(self) -> Any:
        import obstore

        return obstore.head(self._store, self._path)

    def _asked(self) -> Any:
        """What is said of the file by who gives some of it: a signed address often lets its reader do nothing else."""
        import obstore
        from obstore.exceptions import NotSupportedError

        try:
            return obstore.get(self._store, self._path, options={"range": (0, 1)}).meta
        except NotSupportedError:  # of ranges nothing is known there
            return obstore.get(self._store, self._path).meta

    def parts(self, ranges: Sequence[Range]) -> Iterator[tuple[int, bytes]]:
        """Yield the bytes of each range."""
        with ThreadPoolExecutor(_AT_ONCE, "fetching") as beside, self._told():
            yield from zip((start for start, _ in ranges), beside.map(self._part, ranges), strict=True)

    def _part(self, wanted: Range) -> bytes:
        """Some bytes; raises RangesError where there are others."""
        import obstore

        options: Any = {"range": wanted, **self._same}
        result = obstore.get(self._store, self._path, options=options)
        if tuple(result.range) != wanted:
            raise RangesError
        return bytes(result.bytes())

    def whole(self) -> Iterator[bytes]:
        """Yield all bytes, as they come."""
        import obstore

        with self._told():
            for part in obstore.get(self._store, self._path, options=self._same).stream():
                yield bytes(part)

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Turn what goes wrong into a SourceError of one line."""
        from obstore import exceptions as known

        try:
            yield
        except (SourceError, RangesError):
            raise
        except (known.NotFoundError, FileNotFoundError):
            raise SourceError(f"{self._address}: no such file") from None
        except (known.PermissionDeniedError, known.UnauthenticatedError, PermissionError):
            signed = "; its link may have run out, or be cut: it may have to stand in quotes"
            said = signed if self._signed else "; expected who may in the environment"
            raise SourceError(f"{self._address}: may not be read{said}") from None
        except known.PreconditionError:
            raise SourceError(f"{self._address}: was changed while it was read") from None
        except known.NotSupportedError:
            raise RangesError from None
        except (known.BaseError, OSError, ValueError) as error:
            reason = _QUERY.sub("", " ".join(str(error).split()))
            if "range" in reason.lower():
                raise RangesError from None  # whose text may have the query
            if _ASKS_MACHINE in reason:
                reason = "nobody says who may read it; expected that in the environment, as AWS_ACCESS_KEY_ID"
            shown = reason if len(reason) <= _LONGEST else f"{reason[:_LONGEST]}…"
            raise SourceError(f"{self._address}: cannot be read: {shown}") from None


PLACE = Place(("http", "https", "s3", "s3a", "gs", "az", "abfs", "abfss"), StoredFile)
