"""Any MJCF with any FMU: the example of the tutorials, FMUs of another tool and in C, both engines."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError

ROOT = Path(__file__).resolve().parents[2]
TUTORIALS = [
    (ROOT / f"docs/tutorials/{name}.md").read_text("utf-8") for name in ("run", "evaluate", "plot", "vary")
]
PROGRAMS = Path(sys.executable).parent
PROBED = """
title = "The crane with the probe"
loop = {step = 0.002, substeps = 2, duration = 0.4}
controller = {fmu = "probe", parameters = {gain = -30.0, bias = [3.0, 0.0]}}
plant = {name = "models/crane.xml"}
wire = [
    {from = "plant.position", to = "controller.in", scale = 1.0, delay = 1},
    {from = "controller.out", to = "plant.drive", quantum = 0.01},
]
[[metric]]
name = "travel"
value = "last(plant.slide.position)"
[[metric]]
name = "speed"
value = "max(derivative(plant.slide.position))"
[[metric]]
name = "work"
value = "integral(plant.drive.force * plant.slide.velocity)"
unit = "J"
"""
Write = Callable[..., Path]


def files(pages: int = len(TUTORIALS)) -> dict[str, str]:
    """Files after some pages of the tutorials: the block after a file name, appended to the blocks before."""
    found: dict[str, str] = {}
    for name, block in re.findall(
        r"`([\w-]+\.\w+)`[^`]*?:\n\n```\w+\n(.*?)```", "\n".join(TUTORIALS[:pages]), re.DOTALL
    ):
        found[name] = f"{found[name]}\n{block}" if name in found else block
    return found


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the files of the tutorials, and the FMU that PythonFMU builds."""
    folder = tmp_path_factory.mktemp("crane")
    for name, text in files().items():
        (folder / name).write_text(text, encoding="utf-8")
    assert "make" not in run(folder, "pythonfmu build -f pd.py")
    return folder


@pytest.fixture
def crane(folder: Path, example: Path) -> Path:
    """Folder of a user with the crane, its FMU and the probe."""
    shutil.copytree(example, folder, dirs_exist_ok=True)
    (folder / "models").mkdir()
    shutil.copy(example / "crane.xml", folder / "models" / "crane.xml")
    (folder / "probed.toml").write_text(PROBED)
    return folder


def run(folder: Path, line: str, status: int = 0) -> str:
    """Output of a command line of a tutorial."""
    program, *arguments = shlex.split(line)
    command = [str(PROGRAMS / program), *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stdout + done.stderr
    return done.stdout


def test_the_tutorials_run_step_by_step(
    example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COSIM_CACHE", str(tmp_path / "cache"))
    user = tmp_path / "crane"
    shutil.copytree(example, user)
    assert sorted(files()) == ["crane-study.toml", "crane.toml", "crane.xml", "pd.py"]
    assert len(files()["crane.xml"].splitlines()) <= 30
    assert len(files(1)["crane.toml"].splitlines()) <= 25
    # the weaker controller and some runs of the study fail, and their exit codes show it
    expected = {"--set controller.kp": 1, "sweep": 1, "--study": 1}
    printed = {}
    for number, page in enumerate(TUTORIALS, 1):
        for name, text in files(number).items():
            (user / name).write_text(text, encoding="utf-8")
        for line in re.findall(r"^cosim .*", page, re.MULTILINE):
            # a video needs what draws; its own tests check whether that is there
            if not line.startswith("cosim video"):
                code = next((code for part, code in expected.items() if part in line), 0)
                printed[line] = run(user, line, code)
    for name in ("joint.slide.damping", "drive", "position", "slide.velocity"):
        assert name in printed["cosim show crane.toml"]
    (table,) = re.findall(r"prints\n\n```text\n(.*?)```", TUTORIALS[1], re.DOTALL)
    assert [line.split() for line in table.splitlines()] == [
        line.replace("│", "").replace("┃", "").split()
        for line in printed["cosim run crane.toml"].splitlines()[2:]
        if re.search(r"(result|passed)$", line)
    ]
    assert "plant.drive" in (user / "draft.toml").read_text()
    assert (user / "crane.npz").stat().st_size > 1000
    assert (user / "crane.svg").stat().st_size > 1000
    assert "12 of 12 runs" in printed["cosim sweep crane-study.toml"]
    assert "12 of 12 runs" in (user / "crane.html").read_text()


def test_the_plant_in_python_runs_with_the_controller_of_the_tutorial(crane: Path) -> None:
    text = (ROOT / "docs/new-plant.md").read_text("utf-8")
    for language, name in (("python", "tank.py"), ("toml", "tank.toml")):
        (block,) = re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)
        (crane / name).write_text(block)
    result = cosim.run(cosim.load("tank.toml"))
    assert result.passed, result.metrics


@pytest.mark.parametrize("scenario", ["crane.toml", "probed.toml"])
@pytest.mark.parametrize("delay", [0, 1])
def test_both_engines_give_the_same_bytes(crane: Path, scenario: str, delay: int) -> None:
    loaded = cosim.load(scenario, set=[f"loop.compute_delay={delay}", "loop.duration=0.4"])
    reference = cosim.run(loaded, engine="reference")
    native = cosim.run(loaded, engine="native")
    assert (reference.engine, native.engine) == ("reference", "native")
    assert reference.trace is not None
    assert native.trace is not None
    assert reference.trace.tobytes() == native.trace.tobytes()
    assert np.ptp(reference.trace["plant.drive.command"]) > 0.0


def test_a_reset_fmu_of_another_tool_is_as_a_new_one(crane: Path) -> None:
    loaded = cosim.load("crane.toml", set=["loop.duration=0.4"])
    with cosim.Session(loaded, engine="native") as session:
        runs = [session.run(seed).trace for seed in (1, 2, 1)]
    fresh = cosim.run(loaded, seed=1, engine="native").trace
    first, other, again = [b"" if trace is None else trace.tobytes() for trace in runs]
    assert fresh is not None
    assert first == again == fresh.tobytes()
    assert first != other


def test_the_noise_and_the_limits_of_the_file_are_those_of_the_wires(crane: Path) -> None:
    wires = ["wire.controller.position.quantum=0", "wire.controller.position.delay=0"]
    trace = cosim.run(cosim.load("crane.toml", set=[*wires, "controller.kp=1000"])).trace
    assert trace is not None
    noise = trace["controller.position"] - trace["plant.position"]
    assert np.std(noise) == pytest.approx(1e-4, rel=0.1)
    assert (np.max(trace["controller.force"]), np.max(trace["plant.drive.command"])) == (
        pytest.approx(500, rel=0.1),
        20.0,
    )


def test_metrics_have_the_units_of_the_file(crane: Path) -> None:
    metrics = cosim.run(cosim.load("probed.toml")).metrics
    units = {name: metric.unit for name, metric in metrics.items()}
    assert units == {"travel": "m", "speed": "m/s", "work": "J"}
    # what the drive gives is in the motion of trolley and load, less what the damping takes
    assert 0.0 < metrics["work"].value < 3.0 * 3.0 / 30.0


MISTAKES = {
    "plant.name=crane.xm": r"there is no plant `crane.xm`\nhint: .*an MJCF file `name.xml`",
    "plant.name=models/crame.xml": r"the MJCF file `models/crame.xml` does not exist\nhint: .* `crane.xml`",
    "plant.body.trolly.mass=1": r"`plant.body.trolly.mass` is not a .*\nhint: .* `body.trolley.mass`",
    "plant.body.trolley.mass=0": r"`plant.body.trolley.mass` is `0.0`, it must be in 1e-15",
    "plant.timestep=0.01": r"`loop.substeps` = `10` plant steps of 0.01 s .*\nhint: Set `loop.substeps = 1`",
    "wire.controller.position.from=plant.positon": r"no measurement `positon`\nhint: Use `position`",
    "wire.controller.position.from=plant.slide.position": r"no measurement `slide.position`\n.* `position`",
    "wire.plant.drive.to=plant.drve": r"no command `drve`\nhint: Use `drive`",
    "metric.swing.value=max(plant.swing.postion)": r"names `plant.swing.postion`.*\nhint: .* `plant.swing",
}


@pytest.mark.parametrize("change", MISTAKES)
def test_mistakes_give_an_error_with_the_nearest_name(crane: Path, change: str) -> None:
    with pytest.raises(CosimError, match=MISTAKES[change]):
        cosim.run(cosim.load("crane.toml", set=[change]))


def test_a_file_without_named_sensors_is_reported(crane: Path) -> None:
    text = (crane / "crane.xml").read_text().replace('name="position" ', "").replace('name="velocity" ', "")
    (crane / "crane.xml").write_text(text)
    with pytest.raises(CosimError, match=r"no measurement `position`\nhint: It has no"):
        cosim.run(cosim.load("crane.toml"))


def test_a_file_that_mujoco_rejects_names_its_line(crane: Path) -> None:
    text = (crane / "crane.xml").read_text().replace("damping=", "dampin=", 1)
    (crane / "crane.xml").write_text(text)
    message = r"MuJoCo cannot load `crane.xml`: .*'dampin'.*line 5\nhint: Check .* MuJoCo's XML reference"
    with pytest.raises(CosimError, match=message):
        cosim.run(cosim.load("crane.toml"))
