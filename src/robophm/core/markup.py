"""XML from outside, read within bounds: nothing is declared or fetched, every element with its line."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from xml.parsers import expat

from robophm.core.errors import DesignError
from robophm.core.files import stream_of

MAX_BYTES = 50_000_000
"""A larger file is refused before it is parsed."""

MAX_DEPTH = 100
"""The deepest nesting of elements."""

MAX_ELEMENTS = 1_500_000
"""The most elements and attributes together, of a file and what it includes."""

MAX_TAG = 1_000_000
"""The most bytes that a tag or a comment may have: what has millions of attributes is refused before they are made."""

_PIECE = 1 << 16
_NO_ATTRIBUTES: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Element:
    """One XML element."""

    tag: str
    attributes: Mapping[str, str]
    line: int
    children: tuple[Element, ...]
    content: str
    """The text of this element, less its children's, without white space around it."""
    file: str
    """The name of the file in which it stands."""

    def inside(self) -> Iterator[Element]:
        """Yield its children, without those that only describe it."""
        return (child for child in self.children if child.tag not in ("label", "attributes"))

    def each(self, tag: str) -> Iterator[Element]:
        """Yield the children of this element that have a certain tag."""
        return (child for child in self.children if child.tag == tag)

    def all(self) -> Iterator[Element]:
        """Every element in it, itself first, as they stand in the file."""
        stack = [self]
        while stack:
            yield (one := stack.pop())
            stack += reversed(one.children)

    def fault(self, message: str) -> DesignError:
        """Return an error at this element, to be raised: file, line, what is wrong."""
        return DesignError(f"{self.file}:{self.line}: {message}")


class Markup:
    """Reads one XML file. Its errors are one line: file, line, what is wrong."""

    def __init__(self, path: Path) -> None:
        self.name = str(path)
        try:
            with stream_of(path) as file:
                self._text = file.read(MAX_BYTES + 1)
        except OSError as error:
            raise DesignError(f"{path}: cannot be read: {error.strerror}") from None
        except ValueError:  # with a character that no path has
            raise DesignError(f"{path}: cannot be read: expected the path of a file") from None
        self.size = len(self._text)
        """Bytes of the file."""
        if self.size > MAX_BYTES:
            raise DesignError(f"{path}: is larger than {MAX_BYTES:,} bytes")

    def fault(self, line: int, message: str) -> DesignError:
        """Return an error at a line, to be raised."""
        return DesignError(f"{self.name}:{line}: {message}")

    def root(self) -> Element:
        """Return the outermost element. Raises DesignError for what is no XML, declares entities or attributes, or
        exceeds the bounds."""
        parser = expat.ParserCreate()
        parser.buffer_text = True
        outermost: list[Element] = []
        stack: list[tuple[str, Mapping[str, str], int, list[Element], list[str]]] = []
        count = 0

        def start(tag: str, attributes: dict[str, str]) -> None:
            nonlocal count
            count += 1 + len(attributes)
            line = parser.CurrentLineNumber
            if count > MAX_ELEMENTS:
                raise self.fault(line, f"more than {MAX_ELEMENTS:,} elements and attributes")
            if len(stack) >= MAX_DEPTH:
                raise self.fault(line, f"is nested too deeply; expected at most {MAX_DEPTH} levels")
            stack.append((tag, attributes or _NO_ATTRIBUTES, line, [], []))

        def end(_: str) -> None:
            tag, attributes, line, children, text = stack.pop()
            whole = Element(tag, attributes, line, tuple(children), "".join(text).strip(), self.name)
            (stack[-1][3] if stack else outermost).append(whole)

        def entity(*declaration: object) -> None:
            raise self.fault(parser.CurrentLineNumber, f"declares the entity '{declaration[0]}'; none is taken")

        def default(tag: str, *_: object) -> None:  # each element of that name would have a copy of its own
            raise self.fault(parser.CurrentLineNumber, f"declares attributes of '{tag}'; none are taken")

        parser.StartElementHandler = start
        parser.EndElementHandler = end
        parser.CharacterDataHandler = lambda text: stack[-1][4].append(text)
        parser.EntityDeclHandler = entity
        parser.AttlistDeclHandler = default
        try:
            for begin in range(0, self.size, _PIECE):
                parser.Parse(self._text[begin : begin + _PIECE], False)
                if begin - parser.CurrentByteIndex > MAX_TAG:
                    raise self.fault(parser.CurrentLineNumber, f"a tag or comment has more than {MAX_TAG:,} bytes")
            parser.Parse(b"", True)
        except expat.ExpatError as error:
            raise self.fault(error.lineno, f"is no XML: {expat.ErrorString(error.code)}") from None
        except (ValueError, LookupError) as error:  # of an unknown encoding
            raise self.fault(1, f"is no XML: {error}") from None
        return outermost[0]
