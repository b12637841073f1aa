"""Processes that another one has begun to share its work."""

from __future__ import annotations

import os
from multiprocessing import parent_process
from threading import Thread


def end_with_parent() -> None:
    """Have this process end as soon as the one that began it does, however that ends."""
    Thread(target=_end, daemon=True).start()


def _end() -> None:
    if parent := parent_process():
        parent.join()
        os._exit(1)
