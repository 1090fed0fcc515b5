"""Names of several FMUs: in signals, faults, metrics, overrides, warnings, errors and on the command line."""

from __future__ import annotations

import io
import shutil
from pathlib import Path

import pytest
from rich.console import Console

import cosim
from cosim.check import lint
from cosim.check.files import check
from cosim.cli import complete
from cosim.errors import CosimError, FmuError
from cosim.scenario import overrides
from cosim.schema.files import scenario_schema
from cosim.show import display
from cosim.sweep.command import Options, execute

from ..conftest import DATA, pack
from ..scenario.test_schema import problems
from .several import LOOP, Write, column, fmu, run, signal, wire

IDLE = '["a.count", "a.mode", "a.flag", "b.count", "b.flag"]'
DEMAND = '[[criterion]]\nid = "end"\nclaim = "The end is {0}"\nmetric = "end"\nequals = {0}\n'
END = '[[metric]]\nname = "end"\nvalue = "last(b.out) + count(b.mode == \\"Fast\\")"\n'
CHAIN = (
    f"undriven = {IDLE}\n{LOOP}"
    + fmu("a", gain=2.0)
    + fmu("b")
    + wire("a.out", "b.in")
    + signal("a.in", [0.0], [1.0])
    + '[[signal]]\nto = "b.mode"\ntimes = [0.0, 0.01]\nvalues = ["Slow", "Fast"]\n'
    + signal("b.gain", [0.0], [3.0])
    + '[[inject]]\nto = "b.in"\nfrom_time = 0.005\nto_time = 0.01\nvalue = -1.0\n'
    + END
)


def test_signals_faults_metrics_and_criteria_name_them(write: Write) -> None:
    result = run(write(CHAIN + DEMAND.format(16.0), text=""))
    assert column(result, "b.in").tolist() == [2.0] * 5 + [-1.0] * 5 + [2.0] * 10
    assert column(result, "b.out").tolist() == (3.0 * column(result, "b.in")).tolist()
    assert result.passed
    assert result.units["a.out"] == result.units["b.out"] == "m"
    assert result.items["b.mode"] == {"Off": 1, "Slow": 2, "Fast": 4}


def test_a_run_ends_by_a_condition_over_any_of_them(write: Write) -> None:
    result = run(write(text=CHAIN), "loop.stop_when=b.out < 0")
    assert result.simulated_s == pytest.approx(0.006)


def test_overrides_reach_every_one(write: Write) -> None:
    scenario = cosim.load(write(text=CHAIN), set=["a.gain=0.5", "b.bias=[1, 2]", "b.step=0.002", "a.fmu=x"])
    first, second = scenario.fmu
    assert (first.fmu, first.parameters) == ("x", {"gain": 0.5})
    assert (second.step, second.parameters) == (0.002, {"bias": [1, 2]})
    assert scenario.origin("b.parameters.bias") == "`--set b.bias`"


def test_a_variant_replaces_one_and_drops_another(write: Write, folder: Path) -> None:
    write(text=CHAIN)
    changed = folder / "other.toml"
    more = wire("b.out", "c.in") + fmu("c") + fmu("a", gain=5.0)
    changed.write_text(f'extends = "lag.toml"\ndrop = ["wire.b.in"]\n{more}')
    scenario = cosim.load(changed)
    assert [choice.name for choice in scenario.fmu] == ["a", "b", "c"]
    assert scenario.fmu[0].parameters == {"gain": 5.0}
    changed.write_text('extends = "lag.toml"\ndrop = ["fmu.a"]\n')
    assert [choice.name for choice in cosim.load(changed).fmu] == ["b"]


def test_what_nothing_drives_is_warned_of(write: Write, caplog: pytest.LogCaptureFixture) -> None:
    run(write(text=CHAIN.replace('"b.flag"', '"b.flga"')))
    unknown, forgotten = (record.getMessage() for record in caplog.records)
    assert "lists `b.flga`" in unknown
    assert "Use `b.flag`" in unknown
    assert "nothing drives `b.flag`: " in forgotten


def test_an_error_shows_which_failed(write: Write) -> None:
    scenario = cosim.load(write(text=CHAIN), set=["b.fail_at=4"])
    with cosim.Session(scenario) as session:
        with pytest.raises(
            FmuError, match=r"^the FMU `b` failed at t = 0.004 s \(step 4\): failed on request"
        ):
            session.run()
        # the message of a watching process about a crash there
        assert (session.position.who(), session.position.when()) == ("the FMU `b`", "at t = 0.004 s (step 4)")


def test_an_fmu_that_allows_one_instance_is_rejected_twice(
    write: Write, folder: Path, probe_library: bytes
) -> None:
    description = (DATA / "probe.xml").read_text()
    once = 'canBeInstantiatedOnlyOncePerProcess="true" canHandle'
    pack(folder / "once.fmu", description.replace("canHandle", once), {library(): probe_library})
    text = CHAIN.replace('"probe"', '"once.fmu"')
    with pytest.raises(CosimError, match=r"`b\.fmu`|`a` and `b` are both `once.fmu`") as caught:
        run(write(text=text))
    assert "canBeInstantiatedOnlyOncePerProcess" in caught.value.hint
    (folder / "copy.fmu").write_bytes((folder / "once.fmu").read_bytes())
    with pytest.raises(CosimError, match="`a` and `b` are both"):
        run(write(text=text.replace('"once.fmu"', '"copy.fmu"', 1)))
    assert run(write(text=text.replace('"once.fmu"', '"probe"', 1))).metrics["end"].value == 16.0


def library() -> str:
    """Name of the probe's library in an FMU."""
    import fmpy

    return f"binaries/{fmpy.platform}/probe{fmpy.sharedLibraryExtension}"


def test_check_finds_units_and_mistakes(write: Write, folder: Path, probe_library: bytes) -> None:
    file = write(text=CHAIN + DEMAND.format(16.0))
    assert check(str(file)).warnings == []
    description = (DATA / "probe.xml").read_text()
    unit = '<Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit></UnitDefinitions>'
    small = description.replace("</UnitDefinitions>", unit)
    small = small.replace('causality="output"><Real unit="m"', 'causality="output"><Real unit="mm"')
    pack(folder / "small.fmu", small, {library(): probe_library})
    with cosim.Session(cosim.load(file, set=["a.fmu=small"])) as session:
        (reported,) = lint.check(session)
    assert reported == "`wire.b.in` connects mm of `a.out` to m without conversion; set `scale = 0.001`"
    found = check(str(write(text=CHAIN.replace('"a.out"', '"a.otu"'))))
    assert found.error is not None
    assert "the FMU `a` has no variable `otu`" in found.error.message


def test_the_schema_takes_either_form() -> None:
    several = {"title": "t", "loop": {"step": 1.0, "duration": 1.0}, "fmu": [{"name": "a", "fmu": "x"}]}
    assert problems(scenario_schema(), several) == []
    assert problems(scenario_schema(), {**several, "controller": {"fmu": "x"}}) != []
    assert problems(scenario_schema(), {**several, "fmu": [{"name": "a"}]}) == ["fmu.0"]
    assert problems(scenario_schema(), {key: several[key] for key in ("title", "loop")}) != []


def test_show_lists_each(write: Write) -> None:
    scenario = cosim.load(write(text=CHAIN))
    paper = Console(file=io.StringIO(), width=200)
    with cosim.Session(scenario) as session:
        paper.print(display.scenario(scenario, session.fmus, session.plant))
    shown = paper.file.getvalue()  # type: ignore[attr-defined]
    for words in ("a: Probe (probe.fmu)\nb: Probe (probe.fmu)", "a inputs", "b outputs", "2 (default 1)"):
        assert words in shown


def test_keys_are_completed(write: Write, folder: Path) -> None:
    write(text=CHAIN)
    table = overrides.read(folder / "lag.toml").table
    found = {*complete.scenario_keys(table), *complete.fmu_keys(table, folder)}
    assert {"a.gain", "b.gain", "a.fmu", "wire.b.in.noise"} <= found
    assert not any(key.startswith(("fmu.", "controller.")) for key in found)


def test_a_sweep_varies_them(write: Write, folder: Path) -> None:
    write(text=CHAIN + DEMAND.format(16.0))
    (folder / "study.toml").write_text(
        'scenario = "lag.toml"\n[design]\nkind = "grid"\n'
        '[[vary]]\nkey = "a.gain"\nvalues = [1.0, 2.0]\n[[vary]]\nkey = "b.fmu"\nvalues = ["probe", "same"]\n'
    )
    shutil.copy(folder / "probe.fmu", folder / "same.fmu")
    found, _ = execute(Options(folder / "study.toml", folder / "out", workers=1, plots=False, quiet=True))
    assert dict(found.statuses) == {"passed": 2, "failed": 2}
    study = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(study.replace('"a.gain"', '"a.gian"'))
    with pytest.raises(CosimError, match=r"case 0: the FMU `a` has no variable `gian`"):
        execute(Options(folder / "study.toml", folder / "out", workers=1, plots=False, quiet=True))
