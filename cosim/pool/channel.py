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
MARK = b"\xc0sim\r\n\x1a\0"
"""Stands before each number of a message and behind its end: other bytes in between are found."""
NUMBER = struct.Struct(f"!{len(MARK)}sQQ")
"""The mark, a number, and the same number with all bits turned."""
ALL_BITS = 2**64 - 1


class NoMessageError(Exception):
    """What came was written by somebody else, or into the middle of a message."""


def numbered(number: int) -> bytes:
    """Bytes of a number, which cannot come about by chance."""
    return NUMBER.pack(MARK, number, number ^ ALL_BITS)


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
            self.end.sendall(numbered(len(parts)))
            for part in parts:
                self.end.sendall(numbered(memoryview(part).nbytes))
                self.end.sendall(part)
            self.end.sendall(MARK)

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
        NoMessageError
            Bytes came that are no message.
        """
        self.end.settimeout(None)
        count = self._number()
        self.end.settimeout(STALLED)
        try:
            body, *arrays = [self._take(self._number()) for _ in range(count)]
            if self._take(len(MARK)) != MARK:
                raise NoMessageError
        finally:
            self.end.settimeout(None)
        return Parcel(body, arrays)

    def _number(self) -> int:
        came = self._take(NUMBER.size)
        number = int(NUMBER.unpack(came)[1])
        if came != numbered(number):
            raise NoMessageError
        return number

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
