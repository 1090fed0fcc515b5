"""Values that TOML allows but that make no sense: one message that names file or override, and key."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.errors import ScenarioError

from ..conftest import END

Write = Callable[..., Path]

DEEP = 2000
FILES = {
    "deep array": (f"[plot]\nzoom = {'[' * DEEP}{']' * DEEP}", "nested more than 32 deep"),
    "deep inline table": (f"[plot]\nzoom = {'{a = ' * DEEP}1{'}' * DEEP}", "nested more than 32 deep"),
    "deep dotted key": (f"[plot]\n{'a.' * DEEP}b = 1", "nested more than 32 deep"),
    "deep parameters": (f"[controller.parameters]\n{'a.' * DEEP}b = 1", "nested more than 32 deep"),
    "deep table": (f"[plot.{'a.' * DEEP}b]\nc = 1", "nested more than 32 deep"),
    "65 bits": (f"[controller.parameters]\ngain = {2**63}", "`9223372036854775808`, but integers have 64"),
    "400 digits": (f"[controller.parameters]\ngain = {'9' * 400}", "integers have 64 bits"),
    "5000 digits": (f"[controller.parameters]\ngain = {'9' * 5000}", "cannot be read: Exceeds the limit"),
}


@pytest.mark.parametrize(("added", "problem"), FILES.values(), ids=FILES.keys())
def test_nonsense_in_a_file(write: Write, added: str, problem: str) -> None:
    with pytest.raises(ScenarioError, match=problem) as refused:
        cosim.load(write(f"\n{added}\n"))
    assert refused.value.message.startswith("`lag.toml`: ")


OVERRIDES = {
    "loop.compute_delay=1.0": "is `1.0`, it must be `0` or `1`",
    "loop.compute_delay=0.0": "is `0.0`, it must be `0` or `1`",
    "loop.compute_delay=true": "is `true`, it must be `0` or `1`",
    "loop.substeps=1.0": r"is `1.0` \(a number\), it must be an integer",
    "loop.substeps=true": r"is `true` \(true or false\), it must be an integer",
    "loop.seed=99999999999999999999": "integers have 64 bits",
    f"controller.gain={'9' * 5000}": "cannot be read: Exceeds the limit",
    f"controller.gain={'[' * DEEP}{']' * DEEP}": "nested more than 32 deep",
    "wire.plant.u.minimum=nan": "`wire.plant.u.minimum` is `nan`, it must be a number",
    "wire.plant.u.scale=inf": "`wire.plant.u.scale` is `inf`, it must be finite",
    "criterion.end.maximum=nan": "`criterion.end.maximum` is `nan`, it must be a number",
    "criterion.end.equals=nan": "`criterion.end.equals` is `nan`, it must be a number",
}
CRITERION = "\n[[criterion]]\nid = 'end'\nclaim = 'ends low'\nmetric = 'end'\nmaximum = 1.0\n"


@pytest.mark.parametrize(("override", "problem"), OVERRIDES.items())
def test_nonsense_in_an_override(write: Write, override: str, problem: str) -> None:
    with pytest.raises(ScenarioError, match=problem) as refused:
        cosim.load(write(END + CRITERION), set=[override])
    assert refused.value.message.startswith(f"`--set {override.partition('=')[0]}`: ")


@pytest.mark.parametrize("part", ["wire.plant.u", "criterion.end"])
def test_a_minimum_above_its_maximum(write: Write, part: str) -> None:
    limits = [f"{part}.maximum=1", f"{part}.minimum=2"]
    with pytest.raises(ScenarioError, match=rf"`{part}.minimum` is `2.0`, .* above `maximum` = `1.0`"):
        cosim.load(write(END + CRITERION), set=limits)
    assert cosim.load(write(END + CRITERION), set=[limits[0], f"{part}.minimum=1"])


def test_a_byte_order_mark_is_no_text(write: Write) -> None:
    file = write()
    file.write_bytes(b"\xef\xbb\xbf" + file.read_bytes())
    assert cosim.load(file).title == "Lag with a probe"
