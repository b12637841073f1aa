"""A server of tasks on loopback: GET /next gives the next as [[x, y, speed], …], or nothing when all are given."""

from __future__ import annotations

import json
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

TASKS = [
    [[0.0, 0.0, 0.5], [2.0, 0.0, 0.4], [2.0, 1.5, 0.4]],
    [[2.0, 1.5, 0.6], [0.5, 1.5, 0.6], [0.0, 0.0, 0.6]],
]
"""x, y [m], and the speed from there on [m/s]."""


def serve(tasks: list[list[list[float]]]) -> ThreadingHTTPServer:
    """A server of these tasks, on any port of 127.0.0.1 that is free; ``serve_forever`` has it answer."""
    waiting = list(tasks)

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            answer = json.dumps(waiting.pop(0)).encode() if waiting and self.path == "/next" else b""
            self.send_response(200 if self.path == "/next" else 404)
            self.send_header("Content-Length", str(len(answer)))
            self.end_headers()
            self.wfile.write(answer)

        def log_message(self, *_: object) -> None:
            pass

    return ThreadingHTTPServer(("127.0.0.1", 0), Handler)
