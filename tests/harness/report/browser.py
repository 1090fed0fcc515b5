"""A page in Chromium without a screen, driven by its remote protocol."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tornado.websocket import websocket_connect

PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
DOMAINS = ("Runtime", "Log", "Page", "Network")
TROUBLES = ("Runtime.exceptionThrown", "Runtime.consoleAPICalled", "Log.entryAdded")
LOADED = "location.protocol === 'file:' && document.readyState === 'complete'"
OWN = ("file:", "data:", "blob:", "chrome")
QUESTION = """(async () => {
  // on a small screen `innerWidth` grows with what is too wide
  const width = document.documentElement.clientWidth;
  const outside = [...document.querySelectorAll("article *, main *")].filter((part) =>
    !part.closest(".md-typeset__scrollwrap, pre, .output, .scroll") &&
    part.getBoundingClientRect().right > width + 1);
  return {
    sideways: document.documentElement.scrollWidth > width,
    outside: outside.map((part) => part.outerHTML.slice(0, 80)),
    color: getComputedStyle(document.body).backgroundColor,
  };
})()"""
LIGHT = "rgb(255, 255, 255)"
SCREENS = pytest.mark.parametrize(
    ("width", "theme"), [(1400, "light"), (1400, "dark"), (400, "light"), (400, "dark")]
)


@contextlib.contextmanager
def started(folder: Path) -> Iterator[str]:
    """Address of a Chromium that ends with the block; the test is skipped where it ends before it listens.

    Parameters
    ----------
    folder
        Empty folder, for what it keeps.
    """
    options = ["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0"]
    command = [str(PROGRAM), *options, f"--user-data-dir={folder}", "about:blank"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as chromium:
        try:
            yield listening(chromium, folder / "DevToolsActivePort")
        finally:
            chromium.kill()


def listening(chromium: subprocess.Popen[bytes], place: Path) -> str:
    """Wait for the file with the address of Chromium."""
    for _ in range(900):
        if place.is_file() and place.read_text().count("\n"):
            port, path = place.read_text().splitlines()[:2]
            return f"ws://127.0.0.1:{port}{path}"
        if chromium.poll() is not None:
            pytest.skip(f"`{PROGRAM}` cannot start: it ended with exit code {chromium.returncode}")
        time.sleep(0.1)
    pytest.fail(f"`{PROGRAM}` gives no address")


def complaints(browser: str, page: Path, width: int, theme: str) -> list[str]:
    """List the problems of a page on a screen: its texts are in an `article` or in `main`."""
    answer, _, found = visit(browser, page, width, theme, QUESTION)
    if answer["sideways"] or answer["outside"]:
        found.append(f"wider than the screen: {answer['outside']}")
    if (answer["color"] == LIGHT) != (theme == "light"):
        found.append(f"the page is {answer['color']}")
    return found


def visit(
    browser: str, page: Path, width: int, theme: str, question: str, printed: str = "null"
) -> tuple[Any, Any, list[str]]:
    """Open a page in a new profile.

    Returns what two JavaScript expressions give in the end, the second one of the page as it is printed, and
    what went wrong meanwhile.
    """
    return asyncio.run(asyncio.wait_for(asked(browser, page, width, theme, (question, printed)), 90))


async def asked(
    browser: str, page: Path, width: int, theme: str, questions: tuple[str, str]
) -> tuple[Any, Any, list[str]]:
    socket = await websocket_connect(browser)
    numbers = itertools.count(1)
    troubles: list[str] = []
    session: dict[str, str] = {}

    async def call(method: str, **parameters: Any) -> Any:
        number = next(numbers)
        words = {"id": number, "method": method, "params": parameters, **session}
        await socket.write_message(json.dumps(words))
        while True:
            reported = await socket.read_message()
            assert reported is not None, "Chromium ended"
            message = json.loads(reported)
            if message.get("id") == number:
                return message.get("result")
            url = message.get("params", {}).get("request", {}).get("url", "file:")
            if message.get("method") in TROUBLES or not url.startswith(OWN):
                troubles.append(json.dumps(message["params"])[:500])

    own = await call("Target.createBrowserContext", disposeOnDetach=True)
    target = await call("Target.createTarget", url="about:blank", **own)
    attached = await call("Target.attachToTarget", targetId=target["targetId"], flatten=True)
    session["sessionId"] = attached["sessionId"]
    for domain in DOMAINS:
        await call(f"{domain}.enable")
    size = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
    await call("Emulation.setDeviceMetricsOverride", **size)
    scheme = {"name": "prefers-color-scheme", "value": theme}
    await call("Emulation.setEmulatedMedia", features=[scheme])
    await call("Page.navigate", url=page.as_uri())
    while (await call("Runtime.evaluate", expression=LOADED))["result"].get("value") is not True:
        await asyncio.sleep(0.1)
    answers = []
    for media, question in zip(("screen", "print"), questions, strict=True):
        await call("Emulation.setEmulatedMedia", media=media, features=[scheme])
        found = await call("Runtime.evaluate", expression=question, awaitPromise=True, returnByValue=True)
        answers.append(found["result"].get("value"))
    # with it goes all that the page left
    socket.close()
    return *answers, troubles
