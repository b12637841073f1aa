"""Designs as documents with their comments, by ruamel.yaml, which is loaded with the first."""

from __future__ import annotations

import io
from typing import Any

from robophm.core.yaml_nodes import uncollected
from robophm.design.located_error import LocatedError


def load(text: str) -> Any:
    """Return a design's document, comments attached. Raises LocatedError."""
    document = load_value(text)
    if not isinstance(document, dict):
        raise LocatedError((), "the design is no mapping and can only be replaced")
    return document


@uncollected()
def load_value(text: str) -> Any:
    """Return any value, comments attached. Raises LocatedError."""
    from ruamel.yaml.error import YAMLError

    from robophm.design.file import round_trip

    try:
        return round_trip().load(text)
    except (YAMLError, ValueError, RecursionError) as error:
        raise LocatedError((), f"is not YAML, and can only be replaced: {str(error).splitlines()[0]}") from None


@uncollected()
def dump(document: Any) -> str:
    """Return a document, or a part of one, as text."""
    from robophm.design.file import round_trip

    stream = io.StringIO()
    round_trip().dump(document, stream)
    return stream.getvalue()
