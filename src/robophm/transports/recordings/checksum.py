"""CRC-32, three times as fast as zlib's where that can be had: it is a third of the time that an .mcap takes."""

from __future__ import annotations

try:
    from isal.isal_zlib import crc32
except ImportError:  # not made for this processor
    from zlib import crc32

__all__ = ["crc32"]
