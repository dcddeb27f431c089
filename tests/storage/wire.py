"""A wire before a server that counts, and drops, stalls, truncates and lies when it is told."""

import re
import socket
import threading
import time

HOST = "127.0.0.1"
ANSWER = b"HTTP/1.1 %s\r\nContent-Length: 0\r\nConnection: close\r\n\r\n"


class Wire:
    """Hands on every request to the server; counts requests, and bytes that come back.

    It does `fault` to the next `times` requests whose first line holds `of`.
    `drop`: closes before the answer; `stall`: takes the request and stays silent; `trickle`: a byte
    of the answer in 0.2 s; `truncate`: half of the answer, then the end; `lie`: an answer with a
    shorter length than asked for; else the text is the answer's status, such as "404 Not Found".
    """

    fault, times, of = "", 0, b""

    def __init__(self, target: int) -> None:
        self.target, self.received, self.sent = target, 0, b""
        self.door = socket.create_server((HOST, 0))
        self.port = self.door.getsockname()[1]
        threading.Thread(target=self._listen, daemon=True).start()

    @property
    def requests(self) -> list[tuple[str, str]]:
        """Each request: what it does, and to which object."""
        found = re.findall(rb"(GET|HEAD|PUT|DELETE|POST) (/\S*) HTTP/1\.1\r\n", self.sent)
        return [(verb.decode(), path.decode()) for verb, path in found]

    def reset(self) -> None:
        self.received, self.sent = 0, b""

    def faulty(self, fault: str, times: int, of: bytes = b" /") -> None:
        self.fault, self.times, self.of = fault, times, of

    def _listen(self) -> None:
        while True:
            try:
                client, _ = self.door.accept()
            except OSError:
                return
            try:
                server = socket.create_connection((HOST, self.target))
            except OSError:
                client.close()
                continue
            threading.Thread(target=self._hand_on, args=(client, server), daemon=True).start()

    def _hand_on(self, client: socket.socket, server: socket.socket) -> None:
        """Hand on one request and its answer; each has a connection of its own."""
        with client, server:
            client.settimeout(10)
            server.settimeout(10)
            request = _message(client)
            self.sent += request
            if not request:
                return
            hit = self.times > 0 and self.of in request.partition(b"\r\n")[0]
            self.times -= hit
            fault = self.fault if hit else ""
            if fault == "drop":
                return
            if fault == "stall":
                _until_closed(client)
                return
            if fault[:1].isdigit():
                client.sendall(ANSWER % fault.encode())
                return
            server.sendall(request.replace(b"\r\n", b"\r\nConnection: close\r\n", 1))
            answer = b"".join(iter(lambda: server.recv(65536), b""))
            head, _, body = answer.partition(b"\r\n\r\n")
            self.received += len(answer)
            if fault == "truncate":
                answer = answer[: len(head) + 4 + len(body) // 2]
            elif fault == "lie":
                short = body[: len(body) // 2]
                length, true = b"Content-Length: %d", len(body)
                head = head.replace(length % true, length % len(short))
                answer = head + b"\r\n\r\n" + short
            try:
                if fault == "trickle":
                    for k in range(len(answer)):
                        client.sendall(answer[k : k + 1])
                        time.sleep(0.2)
                client.sendall(answer)
            except OSError:
                return


def _message(sender: socket.socket) -> bytes:
    """Return a whole request, with what it says that its body holds."""
    data = b""
    while b"\r\n\r\n" not in data:
        part = sender.recv(65536)
        if not part:
            return data
        data += part
    head, _, body = data.partition(b"\r\n\r\n")
    lines = [line.partition(b":") for line in head.lower().split(b"\r\n")]
    fields = {name: value.strip() for name, _, value in lines}
    if b"100-continue" in fields.get(b"expect", b""):
        sender.sendall(b"HTTP/1.1 100 Continue\r\n\r\n")
        data = data.replace(b"Expect: 100-continue\r\n", b"")
    wanted = int(fields.get(b"content-length", b"0"))
    while len(body) < wanted:
        part = sender.recv(65536)
        if not part:
            break
        body += part
        data += part
    return data


def _until_closed(client: socket.socket) -> None:
    try:
        while client.recv(65536):
            pass
    except OSError:
        return
