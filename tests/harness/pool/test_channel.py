"""Bytes of others in a connection are no message, wherever they came in."""

from __future__ import annotations

import os
from typing import Any, BinaryIO

import numpy as np
import pytest

from cosim.pool.channel import MessageChannel, NoMessageError


def pipe() -> tuple[BinaryIO, BinaryIO]:
    """Both ends of a pipe."""
    source, sink = os.pipe()
    return os.fdopen(source, "rb"), os.fdopen(sink, "wb")


def sent(message: object) -> bytes:
    """Bytes of a message in transit."""
    source, sink = pipe()
    with source:
        MessageChannel(source, sink).send(message)
        sink.close()
        return source.read()


def received(stream: bytes) -> Any:
    """Message of what came."""
    source, sink = pipe()
    with MessageChannel(source, sink) as channel:
        sink.write(stream)
        sink.close()
        return channel.receive()()


def test_a_message_comes_as_it_was_sent() -> None:
    name, values = received(sent(("trace", np.arange(5.0))))
    assert name == "trace"
    assert values.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]


@pytest.mark.parametrize("foreign", [b"x", b"\x80\x05]\x94." * 9, b"\xff" * 4096, bytes(64)])
def test_bytes_of_others_are_found_at_any_place(foreign: bytes) -> None:
    whole = sent(("trace", np.arange(5.0)))
    for place in range(0, len(whole), 5):
        with pytest.raises((NoMessageError, EOFError)):
            received(whole[:place] + foreign + whole[place:])
