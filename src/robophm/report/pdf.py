"""A report page as a PDF, by WeasyPrint: nothing is loaded from anywhere, the same page gives the same bytes."""

from __future__ import annotations

import re
from contextlib import redirect_stdout
from io import StringIO
from typing import Any

from robophm.core.errors import RobophmError
from robophm.report.style import on_paper

_STYLE = re.compile(r"(?<=<style>)[^<]*")
_VARIABLE = re.compile(r"var\(--([a-z0-9]+)\)")


class Printer:
    """WeasyPrint, as the printer of pages."""

    def __init__(self) -> None:
        """Raise RobophmError where WeasyPrint, or the library of the system that it needs, is missing."""
        try:
            with redirect_stdout(StringIO()):  # on which it talks where it lacks something
                from weasyprint import HTML
        except ImportError as error:
            raise RobophmError(f"a PDF needs WeasyPrint ({error.name or error}): pip install 'robophm[pdf]'") from None
        except OSError as error:  # it loads Pango as it is imported
            raise RobophmError(
                f"a PDF needs Pango, a library of the system ({str(error).partition(':')[0]}); on Debian and Ubuntu: "
                "sudo apt-get install libpango-1.0-0 libpangoft2-1.0-0 libharfbuzz-subset0; on macOS: "
                "brew install pango"
            ) from None
        self._document = HTML

    def pdf(self, html: str) -> bytes:
        """The page as PDF on A4."""
        made: bytes = self._document(string=_in_plain_colours(html), url_fetcher=_nothing).write_pdf()
        return made


def _nothing(url: str, *_: Any, **__: Any) -> Any:
    """Whatever a page asks for, it does not get."""
    raise ValueError(f"{url}: a report loads nothing")


def _in_plain_colours(html: str) -> str:
    """Colours in the place of their variables, which WeasyPrint does not know in drawings."""
    colours = on_paper()
    return _STYLE.sub(
        lambda style: _VARIABLE.sub(lambda name: colours.get(name[1], name[0]), style[0]),
        html,
    )
