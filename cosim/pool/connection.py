"""The connection to a Dask scheduler: made, missed, and made anew."""

from __future__ import annotations

import contextlib
import logging
import time
from typing import Any

from cosim import extras
from cosim.errors import CosimError
from cosim.pool import address as addresses

CONNECT_TIMEOUT = 20.0
"""Time to reach the scheduler, s."""
RETURN_TIMEOUT = 300.0
"""Time that a scheduler which was lost, and then its first worker, may take to come back, s."""
POLL_INTERVAL = 1.0
"""Time between two attempts to reach a scheduler that was lost, s."""
GOES_ON = "the same command goes on from there"

log = logging.getLogger("cosim")


def dask() -> Any:
    """Return Dask's package `distributed`."""
    problem = "Dask is not installed, it runs sweeps on a cluster"
    distributed = extras.needed("distributed", problem, extras.hint("cluster"))
    for name in ("distributed", "distributed.client"):
        # what it says is told in our words
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
    except Exception as error:  # whatever listens there says whatever it says
        with contextlib.suppress(Exception):
            client.close(timeout=POLL_INTERVAL)
        # else it would try again when it is collected
        client.status = "closed"
        text = f"no Dask scheduler answers at `{scheduler.address}`: {error}"
        raise CosimError(text, "`dask scheduler` starts one") from None
    return client


def returned(distributed: Any, address: str) -> Any:
    """Client of a scheduler that was lost, when it is back or another has taken its address.

    Raises
    ------
    CosimError
        There is none in time.
    """
    log.warning("lost the Dask scheduler; the runs go on if it is back within %g s", RETURN_TIMEOUT)
    end = time.monotonic() + RETURN_TIMEOUT
    while True:
        try:
            client = connect(distributed, address)
        except CosimError as error:
            if time.monotonic() > end:
                text = f"lost the Dask scheduler, and it is not back after {RETURN_TIMEOUT:g} s"
                raise CosimError(f"{text}: {error.message}", GOES_ON) from None
            time.sleep(POLL_INTERVAL)
        else:
            log.warning("the Dask scheduler is back, the runs that were under way begin anew")
            return client


def security(distributed: Any, scheduler: addresses.Scheduler) -> Any:
    """Return what Dask needs for TLS, None without."""
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
    """Whether a client has the connection to its scheduler."""
    link = client.scheduler_comm
    return client.status == "running" and link is not None and not link.comm.closed()
