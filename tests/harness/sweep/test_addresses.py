"""Values of `--cluster`: addresses, scheduler files and security files; a sweep over TLS."""

from __future__ import annotations

import shutil
import socket
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from cosim.errors import CosimError
from cosim.pool import address
from cosim.pool.cluster import outcomes
from cosim.pool.limits import Limits

from . import clusters, studies

Write = Callable[..., Path]

SECURITY = """
address = "{}"
ca = "certificate.pem"
certificate = "certificate.pem"
key = "key.pem"
"""


@pytest.mark.parametrize("text", ["tls://node0:8786", "tcp://10.0.0.7:8786", "[::1]:8786", "node-1.x:8786"])
def test_an_address_is_taken_as_it_is(text: str) -> None:
    assert address.scheduler(text) == address.Scheduler(text, {})


WRONG = {
    "nope.json": (None, "cannot read `nope.json`: No such file"),
    "broken.json": ("{", "`broken.json` is not a file of a Dask scheduler"),
    "list.json": ("[]", "it is not a JSON object"),
    "empty.json": ("{}", "`address` in `empty.json` is ``, which is not an address"),
    "junk": (None, "the Dask scheduler is `junk`, which is not an address"),
    "nope.toml": (None, "cannot read `nope.toml`"),
    "unknown.toml": ('adress = "tls://node0:8786"\n', "`adress` is not a known key"),
    "half.toml": ('address = "tls://node0:8786"\n', "`ca` is missing"),
    "open.toml": (SECURITY.format("tcp://node0:8786"), "which is not encrypted"),
    "bare.toml": (
        SECURITY.format("tls://node0:8786"),
        "`ca` is `certificate.pem`, which does not exist",
    ),
}
"""Addresses, the text of the file that they name, and what is wrong."""


@pytest.mark.parametrize("text", WRONG)
def test_what_is_no_address_is_reported_immediately(text: str, folder: Path) -> None:
    content, problem = WRONG[text]
    if content is not None:
        (folder / text).write_text(content)
    with pytest.raises(CosimError) as caught:
        list(outcomes([], text, Limits()))
    assert problem in caught.value.message
    assert (
        caught.value.hint
        or "cannot read" in problem
        or "file" in caught.value.message
        or "does not exist" in problem
    )


def test_what_is_no_scheduler_gives_an_error_without_a_traceback(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("cosim.pool.connection.CONNECT_TIMEOUT", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            other, _ = server.accept()
            with other:
                other.sendall(b"HTTP/1.1 400 Bad Request\r\n\r\n")

        threading.Thread(target=answer, daemon=True).start()
        text = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(CosimError, match="no Dask scheduler answers at"):
            list(outcomes([], text, Limits()))
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.skipif(sys.platform != "linux", reason="workers of Linux")
@pytest.mark.skipif(shutil.which("openssl") is None, reason="makes the certificate")
def test_a_sweep_over_tls(write: Write, folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    secrets = tmp_path_factory.mktemp("tls")
    made = ["-keyout", "key.pem", "-out", "certificate.pem", "-days", "1", "-subj", "/CN=127.0.0.1"]
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", *made]
    subprocess.run(command, cwd=secrets, check=True, capture_output=True)
    certificate, key = secrets / "certificate.pem", secrets / "key.pem"
    tls = [f"--tls-ca-file={certificate}", f"--tls-cert={certificate}", f"--tls-key={key}"]
    write(studies.MEASURED)
    (folder / "grid.toml").write_text(studies.GRID)
    with clusters.running(secrets, "tls", tls) as cluster:
        where = cluster.address
        (secrets / "mine.toml").write_text(SECURITY.format(where))
        done = studies.sweep("grid.toml", "--cluster", str(secrets / "mine.toml"))
        refused = studies.sweep("grid.toml", "--out", "other", "--cluster", where)
    assert done.returncode == 1
    assert all(line.startswith("grid: ") for line in done.stderr.splitlines())
    assert set(studies.statuses(folder / "grid.sweep")) == {"passed", "failed"}
    assert len(studies.statuses(folder / "grid.sweep")) == 12
    assert refused.returncode == 2
    assert f"no Dask scheduler answers at `{where}`" in refused.stderr
