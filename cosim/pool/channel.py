"""Messages between two processes: pickles over a socket, arrays beside them without a copy."""

from __future__ import annotations

import os
import pickle
import select
import socket
import struct
import threading
from dataclasses import dataclass
from typing import Any

from cosim.closing import Closing

STALLED = 60.0
"""Silence in the middle of a message after which the other side is given up, s."""
LENGTH = struct.Struct("!Q")


@dataclass(frozen=True)
class Parcel:
    """A message as it came, to be opened where its imports may be done."""

    body: bytearray
    arrays: list[bytearray]

    def open(self) -> Any:
        """Return the message."""
        return pickle.loads(self.body, buffers=self.arrays)


class MessageChannel(Closing):
    """One end of a connection; several threads may send, one receives."""

    def __init__(self, end: socket.socket) -> None:
        self.end = end
        self.lock = threading.Lock()
        self.maker = os.getpid()

    @property
    def own(self) -> bool:
        """Whether this is the process that made it, and no copy that foreign code forked."""
        return os.getpid() == self.maker

    def send(self, message: Any) -> None:
        """Send one message; arrays in it go straight from their memory.

        A copy of the process, which an FMU forked, ends here: two must not answer for one.

        Raises
        ------
        OSError
            The other side is gone.
        """
        if not self.own:
            os._exit(0)
        arrays: list[pickle.PickleBuffer] = []
        parts: list[bytes | memoryview] = [
            pickle.dumps(message, 5, buffer_callback=arrays.append),
            *(array.raw() for array in arrays),
        ]
        with self.lock:
            self.end.sendall(LENGTH.pack(len(parts)))
            for part in parts:
                self.end.sendall(LENGTH.pack(memoryview(part).nbytes))
                self.end.sendall(part)

    def waits(self, timeout: float | None) -> bool:
        """Whether there is something to receive, the end of the connection included, within so many s."""
        poll = select.poll()
        poll.register(self.end, select.POLLIN)
        return bool(poll.poll(None if timeout is None else 1e3 * timeout))

    def receive(self) -> Parcel:
        """Wait for one message.

        Raises
        ------
        EOFError, OSError
            The other side is gone, or silent in the middle of the message.
        """
        self.end.settimeout(None)
        (count,) = LENGTH.unpack(self._take(LENGTH.size))
        self.end.settimeout(STALLED)
        try:
            body, *arrays = [self._take(LENGTH.unpack(self._take(LENGTH.size))[0]) for _ in range(count)]
        finally:
            self.end.settimeout(None)
        return Parcel(body, arrays)

    def _take(self, size: int) -> bytearray:
        taken = bytearray(size)
        free = memoryview(taken)
        while free:
            if not (count := self.end.recv_into(free)):
                raise EOFError
            free = free[count:]
        return taken

    def close(self) -> None:
        """End the connection."""
        self.end.close()
