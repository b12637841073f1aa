"""Work that takes longer than a request: it tells how far it is, and ends when nobody wants it any more."""

from __future__ import annotations

import itertools
import logging
import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Literal

from robophm.core.errors import RobophmError, SourceError

MOST_JOBS = 20
"""The most jobs that are remembered; at most so many may wait."""

AT_ONCE = 2


class CancelledError(Exception):
    """The job was cancelled: its answer is no longer wanted."""


@dataclass
class Job:
    """A piece of work that goes on while its caller waits."""

    number: int
    kind: str
    state: Literal["waiting", "running", "done", "failed", "cancelled"] = "waiting"
    progress: float = 0.0
    """Share of the work that is done, 0 to 1."""
    error: str = ""
    result: Any = None
    unwanted: threading.Event = field(default_factory=threading.Event)

    def advance(self, share: float) -> None:
        """Say how far it is. Raises CancelledError where nobody wants it any more."""
        if self.unwanted.is_set():
            raise CancelledError
        self.progress = min(max(share, 0.0), 1.0)


class Jobs:
    """Runs jobs, AT_ONCE at a time, in the order in which they were asked for."""

    def __init__(self) -> None:
        self._pool = ThreadPoolExecutor(AT_ONCE, thread_name_prefix="job")
        self._lock = threading.Lock()
        self._jobs: OrderedDict[int, Job] = OrderedDict()
        self._numbers = itertools.count(1)

    def begin(self, kind: str, work: Callable[[Job], Any]) -> Job:
        """Have a piece of work done. Raises RobophmError where too much waits already."""
        with self._lock:
            over = [number for number, job in self._jobs.items() if job.state in ("done", "failed", "cancelled")]
            while len(self._jobs) >= MOST_JOBS and over:
                del self._jobs[over.pop(0)]
            if len(self._jobs) >= MOST_JOBS:
                raise SourceError(f"{MOST_JOBS} analyses wait already; cancel one, or try again later")
            job = Job(next(self._numbers), kind)
            self._jobs[job.number] = job
        self._pool.submit(self._do, job, work)
        return job

    def get(self, number: int) -> Job | None:
        """Return the job of this number, if it is still remembered."""
        return self._jobs.get(number)

    def cancel(self, number: int) -> Job | None:
        """Say that nobody wants it any more."""
        job = self._jobs.get(number)
        if job:
            job.unwanted.set()
            if job.state == "waiting":
                job.state = "cancelled"
        return job

    def close(self) -> None:
        """Cancel all jobs and start no more."""
        for job in list(self._jobs.values()):
            job.unwanted.set()
        self._pool.shutdown(wait=False, cancel_futures=True)

    @staticmethod
    def _do(job: Job, work: Callable[[Job], Any]) -> None:
        if job.unwanted.is_set():
            job.state = "cancelled"
            return
        job.state = "running"
        try:
            job.result = work(job)
            job.progress, job.state = 1.0, "done"
        except CancelledError:
            job.state = "cancelled"
        except RobophmError as error:
            job.error, job.state = str(error), "failed"
        except Exception:
            logging.getLogger("robophm").exception("job %s", job.kind)
            job.error, job.state = "a fault within robophm; its log says where", "failed"
