"""Chunks unpacked within the size that they state; damaged ones raise an error."""

from __future__ import annotations

import bz2
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from robophm.transports.recordings.columns.field_extraction import Bytes
from robophm.transports.recordings.columns.pieces import DamageError

LARGEST_CHUNK = 1 << 27
"""Bytes of a compressed chunk, unpacked, beyond which its size is taken to be a lie."""

_STEP = 1 << 20
"""Bytes that are unpacked at once where nothing says how many there are."""


def unpack(content: Bytes, compression: str, size: int) -> Bytes:
    """A chunk's content, ``size`` bytes of it.

    Raises DamageError where it does not unpack to that size; no more memory than that is taken.
    """
    if compression in ("", "none"):
        unpacked: Any = content
    elif size > LARGEST_CHUNK:
        raise DamageError(f"a chunk of {size} bytes")
    else:
        with _unpacking():
            unpacked = np.frombuffer(_decompressor(compression)(content.data, size), np.uint8)
    if len(unpacked) != size:
        raise DamageError(f"chunk unpacks to {len(unpacked)} bytes; expected {size}")
    return unpacked  # type: ignore[no-any-return]


def unpack_begun(content: Bytes, compression: str, size: int) -> Bytes:
    """Unpack what is left of a chunk's content of ``size`` bytes whose end is missing.

    Raises DamageError as ``unpack``, but where it is less than that.
    """
    if compression in ("", "none"):
        return content
    if size > LARGEST_CHUNK:
        raise DamageError(f"a chunk of {size} bytes")
    with _unpacking():
        unpacker = partial(unpack_zstd, begun=True) if compression == "zstd" else _decompressor(compression)
        found = unpacker(content.data, size)
    return np.frombuffer(found, np.uint8)


def unpack_some(content: Bytes, compression: str, size: int) -> Bytes:
    """The first ``size`` bytes of a chunk's content, as far as there are so many. Raises DamageError."""
    with _unpacking():
        if compression == "zstd":
            import zstandard

            with zstandard.ZstdDecompressor().stream_reader(content.data) as stream:
                found = stream.read(size)
        elif compression == "lz4":
            from lz4.frame import LZ4FrameDecompressor

            found = LZ4FrameDecompressor().decompress(content.data, size)
        else:
            found = bz2.BZ2Decompressor().decompress(content.data, size)
    return np.frombuffer(found, np.uint8)


@contextmanager
def _unpacking() -> Iterator[None]:
    """Turn what goes wrong when a chunk is unpacked into a DamageError."""
    try:
        yield
    except (DamageError, MemoryError):
        raise
    except Exception as error:  # zstd, lz4 and bz2 have errors of their own
        raise DamageError(f"chunk does not unpack: {error}") from error


def _decompressor(compression: str) -> Callable[[Any, int], bytes]:
    if compression == "zstd":
        return unpack_zstd
    if compression == "lz4":
        from lz4.frame import LZ4FrameDecompressor

        return lambda content, size: LZ4FrameDecompressor().decompress(content, size + 1)
    if compression == "bz2":
        return lambda content, size: bz2.BZ2Decompressor().decompress(content, size + 1)
    raise DamageError(f"compression '{compression}' is not known")


def unpack_zstd(content: Any, size: int, *, begun: bool = False) -> bytes:
    """The content of a zstd frame, of at most ``size`` bytes; what there is of one that is only ``begun``.

    Raises DamageError where it is larger or broken.
    """
    import zstandard

    try:
        said = zstandard.frame_content_size(content)
        if said > size:
            raise DamageError(f"more than {size} bytes in what is compressed")
        if said >= 0 and not begun:
            return zstandard.ZstdDecompressor().decompress(content, max_output_size=size)
        parts, left = [], size
        with zstandard.ZstdDecompressor().stream_reader(content) as stream:
            while part := stream.read(_STEP):
                parts.append(part)
                left -= len(part)
                if left < 0:
                    raise DamageError(f"more than {size} bytes in what is compressed")
    except zstandard.ZstdError as error:
        raise DamageError(f"does not unpack: {error}") from error
    return b"".join(parts)
