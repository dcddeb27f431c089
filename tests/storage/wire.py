"""A wire before a server that counts, and drops, stalls, truncates and lies when it is told."""

import threading
import time
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

HOST = "127.0.0.1"
EMPTY = b"HTTP/1.1 %s\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"


class Wire(ThreadingHTTPServer):
    """Hands on every request to the server; keeps requests, and counts bytes that come back.

    It does `fault` to the next `times` requests whose verb and path hold `of`.
    `drop`: closes before the answer; `stall`: takes the request and stays silent; `trickle`: a byte
    of the answer in 0.2 s; `truncate`: half of the answer, then the end; `lie`: an answer with a
    shorter length than asked for; else the text is the answer's status, such as "404 Not Found".
    """

    daemon_threads = True

    def __init__(self, target: int) -> None:
        super().__init__((HOST, 0), _Handler)
        self.target = target
        self.reset()
        self.faulty("", 0)
        threading.Thread(target=self.serve_forever, args=(0.02,), daemon=True).start()

    def reset(self) -> None:
        self.requests: list[tuple[str, str]] = []  # what each does, and to which object
        self.received = 0

    def faulty(self, fault: str, times: int, of: str = " /") -> None:
        self.fault, self.times, self.of = fault, times, of

    def handle_error(self, request: object, client_address: object) -> None:
        """The client has gone, or the server: the connection ends."""


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: Wire

    def log_message(self, *_: object) -> None:
        pass

    def _hand_on(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        self.server.requests.append((self.command, self.path))
        hit = self.server.times > 0 and self.server.of in f"{self.command} {self.path}"
        self.server.times -= hit
        fault = self.server.fault if hit else ""
        self.close_connection = True
        if fault == "stall":
            self.rfile.read(1)  # until the client closes
        elif fault[:1].isdigit():
            self.wfile.write(EMPTY % fault.encode())
        elif fault != "drop":
            self._answer(fault, body)

    do_GET = do_HEAD = do_PUT = do_POST = do_DELETE = _hand_on

    def _answer(self, fault: str, body: bytes) -> None:
        server = HTTPConnection(HOST, self.server.target, timeout=10)
        server.request(self.command, self.path, body, dict(self.headers))
        found = server.getresponse()
        content = found.read()
        server.close()
        self.server.received += len(content)
        kept = len(content) // 2 if fault in ("truncate", "lie") else len(content)
        fields = dict(found.getheaders()) | {"Connection": "close"}
        if fault == "lie":
            fields["Content-Length"] = str(kept)
        lines = [
            f"HTTP/1.1 {found.status} {found.reason}",
            *(f"{k}: {v}" for k, v in fields.items()),
        ]
        answer = "\r\n".join([*lines, "\r\n"]).encode() + content[:kept]
        for i in range(len(answer) if fault == "trickle" else 0):
            self.wfile.write(answer[i : i + 1])
            time.sleep(0.2)
        self.wfile.write(answer)
