"""Traces that are streamed to Parquet while the run goes: the same numbers, and a file that is whole."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pyarrow import parquet

import cosim
from cosim.cli import app
from cosim.errors import CosimError
from cosim.loop import recorder
from cosim.loop.engines import Engine
from cosim.loop.recorder import Recorder
from cosim.trace import parquet as streamed

Cart = Callable[..., Path]

METRIC = """
[[metric]]
name = "far"
value = "max(abs(plant.position)) + rms(controller.out[time > 0.01])"
"""


@pytest.fixture(autouse=True)
def _short_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of seven rows, so that short runs fill several and the last is not full."""
    monkeypatch.setattr(streamed, "ROWS", 7)


@pytest.mark.parametrize("engine", ["reference", "native"])
@pytest.mark.parametrize("every", [1, 2])
def test_a_streamed_trace_has_the_numbers_of_one_in_memory(cart: Cart, engine: Engine, every: int) -> None:
    scenario = cosim.load(cart(METRIC), [f"loop.record_every={every}"])
    held = cosim.run(scenario, engine=engine)
    done = cosim.run(scenario, engine=engine, stream="x.parquet")
    assert held.trace is not None
    assert (done.trace, done.file) == (None, Path("x.parquet"))
    assert parquet.ParquetFile("x.parquet").num_row_groups == -(-len(held.trace) // 7) > 3
    found = cosim.read_trace("x.parquet")
    assert found.trace.dtype == held.trace.dtype
    assert found.trace.tobytes() == held.trace.tobytes()
    assert (done.metrics, done.criteria, done.simulated_s) == (held.metrics, held.criteria, held.simulated_s)
    assert cosim.evaluate(scenario, found).metrics == held.metrics


@pytest.mark.parametrize("engine", ["reference", "native"])
def test_a_run_that_ends_early_leaves_its_rows(cart: Cart, engine: Engine) -> None:
    # in the last row of a block, in the first of the next, and in the middle of one; native and not
    for condition in ("time >= 0.006", "time >= 0.007", "time >= 0.0165", "exp(time) >= exp(0.0205)"):
        scenario = cosim.load(cart(), [f"loop.stop_when={condition}"])
        held = cosim.run(scenario, engine=engine)
        assert held.trace is not None
        done = cosim.run(scenario, engine=engine, stream="x.parquet")
        assert cosim.read_trace("x.parquet").trace.tobytes() == held.trace.tobytes()
        assert done.simulated_s == held.simulated_s < 0.03


def test_the_file_shows_units_and_what_ran(cart: Cart) -> None:
    result = cosim.run(cosim.load(cart()), seed=5, stream="x.parquet")
    schema = parquet.read_schema("x.parquet")
    of_input, of_mode = (schema.field(f"controller.{name}").metadata for name in ("in", "mode"))
    assert of_input == {b"units": b"m"}
    assert schema.field("plant.position").metadata[b"descriptions"]
    assert json.loads(of_mode[b"items"]) == result.items["controller.mode"]
    facts = json.loads(schema.metadata[b"cosim"])
    assert (facts["scenario"], facts["seed"], facts["engine"]) == ("cart", 5, "native")
    assert list(facts["fmus"]) == ["probe"]
    assert facts["cosim"]
    found = cosim.read_trace("x.parquet")
    assert (found.units, found.items) == ({n: u for n, u in result.units.items() if u}, result.items)
    assert found.about["simulated_s"] == result.simulated_s
    # the same as a file that is written afterwards
    cosim.run(cosim.load(cart()), seed=5).save_trace("y.parquet")
    again = cosim.read_trace("y.parquet")
    assert (again.units, again.items, again.about) == (found.units, found.items, found.about)
    assert again.trace.tobytes() == found.trace.tobytes()


def test_only_a_block_of_rows_is_in_memory(cart: Cart, monkeypatch: pytest.MonkeyPatch) -> None:
    tables = []
    begin = Recorder.__init__
    # the run that is repeated before the second one
    monkeypatch.setattr(recorder, "BLOCK", 7)

    def noted(self: Recorder, *arguments: Any) -> None:
        begin(self, *arguments)
        tables.append(len(self.table))

    monkeypatch.setattr(Recorder, "__init__", noted)
    for engine in ("reference", "native"):
        cosim.run(cosim.load(cart()), engine=engine, stream="x.parquet")
    assert tables == [7, 7, 7]


@pytest.mark.parametrize(("fault", "problem"), [("fail_at=40", "step 40"), ("crash_at=40", "SIGSEGV")])
def test_a_run_that_fails_leaves_no_file(cart: Cart, folder: Path, fault: str, problem: str) -> None:
    scenario = cosim.load(cart(), [f"controller.{fault}"])
    with pytest.raises(CosimError, match=problem):
        cosim.run(scenario, stream="x.parquet", isolated=True)
    assert [file.name for file in folder.iterdir() if "parquet" in file.name] == []


def test_ctrl_c_leaves_no_file_and_not_the_old_one_torn(cart: Cart, folder: Path) -> None:
    scenario = cosim.load(cart())
    cosim.run(scenario, stream="x.parquet")
    whole = (folder / "x.parquet").read_bytes()

    def press(done: int, _: int) -> None:
        os.kill(os.getpid(), signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            cosim.run(scenario, seed=9, stream="x.parquet", progress=press)
    finally:
        signal.signal(signal.SIGINT, before)
    assert [file.name for file in folder.iterdir() if "parquet" in file.name] == ["x.parquet"]
    assert (folder / "x.parquet").read_bytes() == whole


def test_a_disk_that_is_full_is_an_error_of_the_trace(cart: Cart, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(streamed.Writer, "write", full)
    for engine in ("reference", "native"):
        with pytest.raises(CosimError, match=r"^the trace cannot be written: No space left on device at "):
            cosim.run(cosim.load(cart()), engine=engine, stream="x.parquet")


def test_what_cannot_be_streamed_is_said_before_the_run(cart: Cart) -> None:
    for name, problem in (("x.npz", "cannot be streamed to `x.npz`"), ("no/x.parquet", "the folder")):
        with pytest.raises(CosimError, match=problem):
            cosim.run(cosim.load(cart()), stream=name)


def test_the_command_streams_plots_and_evaluates(
    cart: Cart, folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    cart(METRIC)

    def run(*arguments: str) -> int:
        monkeypatch.setattr("sys.argv", ["cosim", *arguments])
        return app.status_of(app.app)

    assert run("run", "cart.toml", "--trace", "x.parquet", "--plot", "x.svg", "--json", "x.json", "-q") == 0
    assert (folder / "x.svg").stat().st_size > 0
    assert run("run", "cart.toml", "--trace", "x.npz", "--in-process", "-q") == 0
    assert run("compare", "x.npz", "x.parquet") == 0
    assert run("evaluate", "x.parquet", "cart.toml", "--json", "y.json") == 0
    metrics = [json.loads((folder / name).read_text())["metrics"] for name in ("x.json", "y.json")]
    assert metrics[0] == metrics[1]
    assert "cannot" not in capfd.readouterr().err
