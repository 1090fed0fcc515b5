"""FMU files: accepted and rejected ones, the cache, values of every type."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import pytest

import cosim
from cosim.errors import FmuError
from cosim.fmu import archive
from cosim.fmu.archive import open_fmu
from cosim.fmu.instance import Instance

from .conftest import DATA, compiled, pack

Write = Callable[..., Path]
LIBRARY = f"binaries/{fmpy.platform}/probe{fmpy.sharedLibraryExtension}"


def description(*replacements: tuple[str, str]) -> str:
    text = (DATA / "probe.xml").read_text()
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    return text


def test_an_fmu_is_described(folder: Path) -> None:
    file = open_fmu(folder / "probe.fmu")
    assert (file.name, file.identifier) == ("Probe", "probe")
    assert [variable.name for variable in file.named("input")] == ["in", "count", "mode", "flag"]
    gain = file.variables["gain"]
    assert (gain.kind, gain.start, gain.maximum, gain.variability) == ("Real", "1", "10", "tunable")
    assert file.variables["in"].unit == "m"
    assert file.variables["mode"].items == (("Off", 1), ("Slow", 2), ("Fast", 4))


def test_a_file_that_is_no_zip_is_rejected(folder: Path) -> None:
    (folder / "bad.fmu").write_text("no zip")
    with pytest.raises(FmuError, match=r"`bad.fmu` is not an FMU: it is not a zip file\nhint: "):
        open_fmu(folder / "bad.fmu")


def test_a_zip_without_description_is_rejected(folder: Path) -> None:
    with zipfile.ZipFile(folder / "bad.fmu", "w") as empty:
        empty.writestr("readme.txt", "hello")
    with pytest.raises(FmuError, match=r"it holds no `modelDescription.xml`"):
        open_fmu(folder / "bad.fmu")


def test_an_fmu_for_another_platform_is_rejected(folder: Path) -> None:
    members = {"binaries/win32/probe.dll": b"", "binaries/darwin64/probe.dylib": b""}
    pack(folder / "bad.fmu", description(), members)
    expected = (
        rf"`bad.fmu` has no binary for this platform, `{fmpy.platform}`; it has `darwin64`, `win32`\nhint: "
    )
    with pytest.raises(FmuError, match=expected):
        open_fmu(folder / "bad.fmu")


def test_an_fmu_for_model_exchange_is_rejected(folder: Path) -> None:
    exchange = ('<CoSimulation modelIdentifier="probe" canHandleVariableCommunicationStepSize="true"/>',
                '<ModelExchange modelIdentifier="probe"/>')  # fmt: skip
    pack(folder / "bad.fmu", description(exchange), {LIBRARY: b""})
    with pytest.raises(FmuError, match=r"`bad.fmu` offers only ModelExchange, not co-simulation\nhint: "):
        open_fmu(folder / "bad.fmu")


@pytest.mark.parametrize("version", ["1.0", "3.0-beta.2", "4.0"])
def test_an_fmu_of_another_version_is_rejected(folder: Path, version: str) -> None:
    pack(folder / "bad.fmu", description(('fmiVersion="2.0"', f'fmiVersion="{version}"')), {LIBRARY: b""})
    with pytest.raises(FmuError, match=rf"`bad.fmu` is an FMI {version} FMU, only FMI 2.0 and 3.0"):
        open_fmu(folder / "bad.fmu")


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("<ModelStructure>", "<ModelStrcture>", "mismatch: ModelStrcture line"),
        ('causality="input"', 'causality="inpt"', "'inpt'"),
        ('<Real unit="m" start="0"/>', '<Real unit="m" start="0,5"/>', "'0,5'"),
    ],
)
def test_a_broken_description_is_rejected_with_the_problem(
    folder: Path, old: str, new: str, problem: str
) -> None:
    pack(folder / "bad.fmu", description((old, new)), {LIBRARY: b""})
    expected = rf"the model description of `bad.fmu` is not valid:\n  .*{problem}.*(\n  .*)*\nhint: List all"
    with pytest.raises(FmuError, match=expected):
        open_fmu(folder / "bad.fmu")


def test_the_problems_of_a_description_are_reported_in_a_line_each(folder: Path) -> None:
    twice = ('valueReference="1" causality="parameter"', 'valueReference="1" causality="parametr"')
    pack(folder / "bad.fmu", description(('causality="input"', 'causality="inpt"'), twice), {LIBRARY: b""})
    with pytest.raises(FmuError) as caught:
        open_fmu(folder / "bad.fmu")
    reported = caught.value.message.splitlines()[1:]
    assert len([line for line in reported if "'inpt'" in line]) == 4
    assert len([line for line in reported if "'parametr'" in line]) == 1


def test_a_flaw_that_repeats_fills_no_screen(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    pack(folder / "bad.fmu", description(("<ScalarVariable", "<ScalarVariable wrong='1'")), {LIBRARY: b""})
    with caplog.at_level("WARNING", "cosim"):
        open_fmu(folder / "bad.fmu")
    reported = caplog.records[0].getMessage().splitlines()[1:]
    more = description().count("<ScalarVariable ") - archive.MAX_PROBLEMS
    assert (len(reported), reported[-1]) == (archive.MAX_PROBLEMS + 1, f"  and {more} more")


def test_a_library_that_cannot_be_loaded_is_rejected_and_the_folder_put_back(folder: Path) -> None:
    pack(folder / "bad.fmu", description(), {LIBRARY: b"not a library"})
    file = open_fmu(folder / "bad.fmu")
    with pytest.raises(FmuError, match=r"`bad.fmu`: the library `.*` in it is not a Linux library\nhint: "):
        Instance(file, [], [])
    assert Path.cwd() == folder


def test_a_library_without_a_function_is_rejected(folder: Path, tmp_path: Path) -> None:
    source = tmp_path / "empty.c"
    source.write_text("int fmi2GetNothing(void) { return 0; }\n")
    pack(folder / "bad.fmu", description(), {LIBRARY: compiled(tmp_path, source)})
    with pytest.raises(FmuError, match=r"the library of `Probe` lacks an FMI function: .*fmi2"):
        Instance(open_fmu(folder / "bad.fmu"), [], [])


def test_an_fmu_that_does_not_instantiate_shows_why(folder: Path, probe_library: bytes) -> None:
    pack(folder / "bad.fmu", description(("probe-guid", "other-guid")), {LIBRARY: probe_library})
    with pytest.raises(FmuError, match=r"cannot instantiate the FMU `Probe`: wrong GUID"):
        Instance(open_fmu(folder / "bad.fmu"), [], [])


def parameters(write: Write, *overrides: str) -> cosim.Result:
    return cosim.run(cosim.load(write(), set=["loop.duration=0.002", *overrides]))


def last(result: cosim.Result, name: str) -> float:
    assert result.trace is not None
    return float(result.trace[f"controller.{name}"][-1])


def test_values_of_every_type_are_set(write: Write) -> None:
    given = ["bias=[1, 2.5]", "mode=Slow", "flag=true", "count=3", "label=any text", "gain=0"]
    result = parameters(write, *(f"controller.{entry}" for entry in given))
    names = ("out", "mode_out", "flag_out", "count_out")
    assert [last(result, name) for name in names] == [3.5, 2.0, 0.0, 4.0]
    assert last(parameters(write, "controller.mode=4"), "mode_out") == 4.0
    assert last(parameters(write, "controller.flag=1"), "flag_out") == 0.0


def test_a_rejected_parameter_is_explained(write: Write) -> None:
    with pytest.raises(FmuError, match="the FMU has no variable `gian`\nhint: Use `gain`"):
        parameters(write, "controller.gian=1")


def test_a_missing_fmu_says_how_to_build_it(write: Write) -> None:
    with pytest.raises(
        FmuError, match=r"`fmu-none.fmu` does not exist\nhint: Build it with `cargo xtask fmu none`"
    ):
        parameters(write, "controller.fmu=fmu-none")
    with pytest.raises(FmuError, match=r"the FMU file `none.fmu` does not exist\nhint: Searched: `[^`]*`$"):
        parameters(write, "controller.fmu=none.fmu")


def test_fmus_are_found_by_path_and_environment(
    write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write()
    (folder / "elsewhere").mkdir()
    (folder / "probe.fmu").rename(folder / "elsewhere" / "probe.fmu")
    overrides = ["controller.fmu=elsewhere/probe.fmu"]
    assert cosim.run(cosim.load(file, set=overrides)).simulated_s == 0.05
    monkeypatch.setenv("COSIM_FMU_PATH", str(folder / "elsewhere"))
    assert cosim.run(cosim.load(file)).simulated_s == 0.05


def test_a_thousand_instances_leave_nothing(folder: Path) -> None:
    file = open_fmu(folder / "probe.fmu")

    def cycle() -> None:
        with Instance(file, file.named("input"), []) as instance:
            instance.initialise({"gain": 2.0}, 1.0, instance.read_inputs)

    cycle()
    before = mappings()
    for _ in range(1000):
        cycle()
    assert mappings() == before


def mappings() -> int:
    """Count the mappings of the probe's library in this process (0 if the system does not report them)."""
    maps = Path("/proc/self/maps")
    return maps.read_text().count("/probe.so") if maps.exists() else 0
