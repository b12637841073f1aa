"""A process that was asked to end does so in time, and says by its exit code where not all was kept."""

import signal
import subprocess
import sys
import time

import pytest

WATCHING = """
from robophm.core.ending import leave_in_time
import signal, time
leave_in_time(signal.SIGINT)
time.sleep(60)
"""
SERVING = """
from robophm.web.serving import Wish
import signal, time
class Server: should_exit = False
wish = Wish(of_process=True)
wish.ends(Server(), lambda: time.sleep(60))
wish.stop(signal.SIGTERM, None)
time.sleep(60)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs signals")
@pytest.mark.parametrize(("program", "number"), [(WATCHING, signal.SIGINT), (SERVING, signal.SIGTERM)])
def test_an_end_before_all_was_kept_is_no_success(program, number):
    begun = time.monotonic()
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=50, check=False)
    assert done.returncode == 128 + number
    assert time.monotonic() - begun < 30
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: ended before ")
