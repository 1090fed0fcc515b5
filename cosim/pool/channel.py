"""Messages between two processes: pickles over pipes, with arrays outside of the pickle without a copy."""

from __future__ import annotations

import contextlib
import os
import pickle
import struct
import threading
from collections.abc import Callable
from functools import partial
from typing import Any, BinaryIO

from cosim.closing import Closing

MARK = b"\xc0sim\r\n\x1a\0"
"""Precedes each number of a message and follows its end, to detect foreign bytes."""
NUMBER = struct.Struct(f"!{len(MARK)}sQQ")
"""The mark, a number, and its bitwise complement."""
ALL_BITS = 2**64 - 1
Frame = Callable[[], Any]
"""A received message; the call decodes it, where its imports are allowed."""


class NoMessageError(Exception):
    """The received bytes were written by other code, or into the middle of a message."""


def numbered(number: int) -> bytes:
    """Bytes of a number with its check."""
    return NUMBER.pack(MARK, number, number ^ ALL_BITS)


class MessageChannel(Closing):
    """One end of a connection through two pipes; several threads can send, one receives."""

    def __init__(self, source: BinaryIO, sink: BinaryIO) -> None:
        self.source, self.sink = source, sink
        self.lock = threading.Lock()
        self.maker = os.getpid()

    @property
    def own(self) -> bool:
        """Whether this is the original process, not a fork by foreign code."""
        return os.getpid() == self.maker

    def send(self, message: Any) -> None:
        """Send one message, arrays directly from their memory; raises OSError if the other side is gone.

        A fork of the process by an FMU ends here, so that only one process answers.
        """
        if not self.own:
            os._exit(0)
        arrays: list[pickle.PickleBuffer] = []
        body = pickle.dumps(message, 5, buffer_callback=arrays.append)
        parts = [memoryview(body), *(array.raw() for array in arrays)]
        with self.lock:
            self.sink.write(numbered(len(parts)))
            for part in parts:
                self.sink.write(numbered(part.nbytes))
                self.sink.write(part)
            self.sink.write(MARK)
            self.sink.flush()

    def receive(self) -> Frame:
        """Wait for one message.

        Raises EOFError or OSError if the other side is gone, and NoMessageError for other bytes.
        """
        body, *arrays = [self._take(self._number()) for _ in range(self._number())]
        if self._take(len(MARK)) != MARK:
            raise NoMessageError
        return partial(pickle.loads, body, buffers=arrays)

    def _number(self) -> int:
        received = self._take(NUMBER.size)
        number = int(NUMBER.unpack(received)[1])
        if received != numbered(number):
            raise NoMessageError
        return number

    def _take(self, size: int) -> bytearray:
        taken = bytearray(size)
        if self.source.readinto(taken) < size:  # type: ignore[attr-defined]
            raise EOFError
        return taken

    def close(self) -> None:
        """End the connection."""
        for end in (self.sink, self.source):
            # what could not be sent is lost
            with contextlib.suppress(OSError):
                end.close()
