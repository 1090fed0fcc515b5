"""The connection to a Dask scheduler, and its recovery after a loss."""

from __future__ import annotations

import contextlib
import logging
import time
from typing import Any

from cosim import extras
from cosim.errors import CosimError
from cosim.pool import address as addresses

CONNECT_TIMEOUT = 20.0
"""Timeout of the connection to the scheduler, s."""
RETURN_TIMEOUT = 300.0
"""Maximum time for the return of a lost scheduler, and then of its first worker, s."""
POLL_INTERVAL = 1.0
"""Time between two connection attempts to a lost scheduler, s."""
GOES_ON = "Run the same command again to continue."

log = logging.getLogger("cosim")


def dask() -> Any:
    """Return Dask's package `distributed`."""
    problem = "Dask is not installed; it runs sweeps on a cluster"
    distributed = extras.needed("distributed", problem, extras.hint("cluster"))
    for name in ("distributed", "distributed.client"):
        # our errors replace its log
        logging.getLogger(name).setLevel(logging.CRITICAL)
    return distributed


def connect(distributed: Any, address: str) -> Any:
    """Client of a scheduler."""
    scheduler = addresses.scheduler(address)
    client = distributed.Client.__new__(distributed.Client)
    try:
        client.__init__(
            scheduler.address,
            security=security(distributed, scheduler),
            timeout=CONNECT_TIMEOUT,
            set_as_default=False,
        )
    except Exception as error:  # another server may send anything
        with contextlib.suppress(Exception):
            client.close(timeout=POLL_INTERVAL)
        # otherwise it would retry when it is collected
        client.status = "closed"
        text = f"no Dask scheduler answers at `{scheduler.address}`: {error}"
        raise CosimError(text, "Start one with `dask scheduler`.") from None
    return client


def returned(distributed: Any, address: str) -> Any:
    """Client of a lost scheduler after its return, or of another one at its address.

    Raises
    ------
    CosimError
        There is none in time.
    """
    log.warning("lost the Dask scheduler; waiting %g s for its return", RETURN_TIMEOUT)
    end = time.monotonic() + RETURN_TIMEOUT
    while True:
        try:
            client = connect(distributed, address)
        except CosimError as error:
            if time.monotonic() > end:
                text = f"lost the Dask scheduler, which did not return within {RETURN_TIMEOUT:g} s"
                raise CosimError(f"{text}: {error.message}", GOES_ON) from None
            time.sleep(POLL_INTERVAL)
        else:
            log.warning("the Dask scheduler is available again; unfinished runs are restarted")
            return client


def security(distributed: Any, scheduler: addresses.Scheduler) -> Any:
    """Return the TLS settings for Dask; None without TLS."""
    if not scheduler.tls:
        return None
    tls = scheduler.tls
    return distributed.Security(
        tls_ca_file=tls["ca"],
        tls_client_cert=tls["certificate"],
        tls_client_key=tls["key"],
        require_encryption=True,
    )


def is_connected(client: Any) -> bool:
    """Whether a client is connected to its scheduler."""
    link = client.scheduler_comm
    return client.status == "running" and link is not None and not link.comm.closed()
