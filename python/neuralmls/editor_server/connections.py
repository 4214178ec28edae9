"""How many connections the server has at once, and how long one may take to say what it wants.

Anybody on this machine can connect, and each connection takes a thread. So there is a bound; and since whoever knows
the address asks at once, it is the connection that has kept silent for longest that makes room for a new one.
"""

from __future__ import annotations

import contextlib
import socket
import threading
import time

MOST = 64
SECONDS_TO_ASK = 10.0


class Connections:
    """The open connections: those that have not asked yet, and those that are being answered."""

    def __init__(self, most: int = MOST, seconds_to_ask: float = SECONDS_TO_ASK) -> None:
        self.seconds_to_ask = seconds_to_ask
        self._free = threading.Semaphore(most)
        self._lock = threading.Lock()
        # The oldest first.
        self._silent: dict[socket.socket, float] = {}

    def admit(self, connection: socket.socket) -> bool:
        """Whether there is room for this one, for which a silent one may have to go; if so, `end` must follow."""
        if not self._free.acquire(blocking=False) and not (self._cut_oldest() and self._free.acquire(timeout=1)):
            return False
        with self._lock:
            self._silent[connection] = time.monotonic()
        return True

    def asked(self, connection: socket.socket) -> None:
        """Note that this one knows the address: it may take its time from now on."""
        with self._lock:
            self._silent.pop(connection, None)

    def end(self, connection: socket.socket) -> None:
        """Note that an admitted one is over, before it is closed."""
        self.asked(connection)
        self._free.release()

    def cut_late(self) -> None:
        """Cut those that should have asked by now."""
        late = time.monotonic() - self.seconds_to_ask
        with self._lock:
            for connection in [one for one, since in self._silent.items() if since < late]:
                self._cut(connection)

    def _cut_oldest(self) -> bool:
        with self._lock:
            oldest = next(iter(self._silent), None)
            if oldest is not None:
                self._cut(oldest)
        return oldest is not None

    def _cut(self, connection: socket.socket) -> None:
        """Wake the thread that waits for it, which then finds its end."""
        del self._silent[connection]
        with contextlib.suppress(OSError):  # gone already
            connection.shutdown(socket.SHUT_RDWR)
