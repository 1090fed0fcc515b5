"""Pictures and videos of a cart, checked by pixels."""

from __future__ import annotations

import base64
import importlib
import io
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import html

import cosim
from cosim.errors import CosimError
from cosim.physics import CHOICE
from cosim.replay import enlarge, renderer, video_file
from cosim.replay.motion import Recorded, motion, of_result
from cosim.replay.playback import RATE, ReplayOptions
from cosim.report.job import VIDEO_SECONDS, VIDEO_SIZE

from ..cli.commands import called
from ..cli.commands import cosim as command

SMALL = ReplayOptions((160, 120), seconds=0.4)


def recorded(file: Path) -> Recorded:
    scenario = cosim.load(file, ["loop.record_qpos=true"])
    return of_result(scenario, cosim.run(scenario))


def red(picture: Any) -> Any:
    """Columns in which the cart is seen."""
    colors = picture.astype(int)
    return np.flatnonzero(((colors[..., 0] > 90) & (colors[..., 1] < 60)).any(axis=0))


@pytest.mark.usefixtures("_drawing")
def test_the_machine_is_drawn_where_its_coordinates_say(cart: Path) -> None:
    moved = motion(recorded(cart))
    poses = np.array([[-0.3], [0.0], [0.3]])
    with renderer.Renderer(moved.model, moved.data, (160, 120), "side", poses) as drawer:
        left, middle, right = (red(drawer.picture(qpos)).mean() for qpos in poses)
    assert left < middle < right
    # meters to pixels by the camera: 3 m away less the half cart, 45 degrees high
    shift = 0.3 * 60.0 / np.tan(np.radians(22.5)) / 2.9
    assert right - middle == pytest.approx(shift, abs=2.0)


@pytest.mark.usefixtures("_drawing")
def test_the_free_camera_sees_all_of_it_before_a_background(cart: Path) -> None:
    moved = motion(recorded(cart))
    poses = np.array([[-0.3], [3.0]])
    sky = renderer.background(120, 160)
    with renderer.Renderer(moved.model, moved.data, (160, 120), "", poses) as drawer:
        for qpos in poses:
            picture = drawer.picture(qpos)
            assert red(picture).size
            for edge in (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1]):
                assert np.array_equal(picture[edge], sky[edge])


def test_what_is_written_is_above_where_no_player_hides_it() -> None:
    picture = np.full((120, 160, 3), 200, np.uint8)
    written = video_file.with_captions(picture, ["t = 1 s", "state: Run"], ["real time"])
    changed = np.flatnonzero((written != picture).any(axis=(1, 2)))
    (gap,) = np.flatnonzero(np.diff(changed) > 1)
    # two lines, below them one
    first, second = changed[: gap + 1], changed[gap + 1 :]
    assert first[0] == 0
    assert second[-1] < 0.75 * len(picture)
    assert len(first) > 1.3 * len(second)
    assert written.max() > 240


@pytest.mark.usefixtures("_drawing")
@pytest.mark.parametrize("ending", [*video_file.WRITERS])
def test_a_video_has_its_pictures(ending: str, cart: Path, folder: Path) -> None:
    file = folder / f"cart{ending}"
    seen: list[tuple[int, int]] = []
    video_file.save(recorded(cart), SMALL, file, lambda done, total: seen.append((done, total)))
    count = round(RATE * SMALL.seconds)
    assert seen == [(n, count) for n in range(1, count + 1)]
    if ending == ".mp4":
        with importlib.import_module("av").open(str(file)) as container:
            pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
            assert container.duration / 1e6 == pytest.approx(SMALL.seconds, abs=0.05)
    else:
        image = importlib.import_module("PIL.Image").open(file)
        pictures = []
        for n in range(image.n_frames):
            image.seek(n)
            pictures.append(np.asarray(image.convert("RGB")))
    assert len(pictures) == count
    assert pictures[0].shape == (120, 160, 3)
    assert np.abs(pictures[0].astype(int) - pictures[-1].astype(int)).max() > 60


MEMORY = """
import resource, sys
from pathlib import Path
import numpy as np
from cosim.replay.video_file import WRITERS

def pictures(count):
    for k in range(count):
        picture = np.zeros((480, 640, 3), np.uint8)
        picture[100:200, 3 * k : 3 * k + 100] = (200, 30, 30)
        yield picture

file = Path(sys.argv[1])
for count in (20, 120):
    WRITERS[file.suffix](pictures(count), count, (640, 480), file)
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1000)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="peak memory in kB")
@pytest.mark.parametrize("ending", [*video_file.WRITERS])
def test_the_memory_of_a_video_does_not_grow_with_its_pictures(ending: str, folder: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", MEMORY, f"x{ending}"], capture_output=True, text=True, check=True
    )
    few, many = map(float, done.stdout.split())
    # a picture has 0.9 MB
    assert many - few < 25.0


@pytest.mark.usefixtures("_drawing")
def test_the_command_records_a_trace_or_a_scenario(cart: Path, folder: Path) -> None:
    options = ("--seconds", "0.2", "--size", "64x48")
    done = called("run", "cart.toml", "--set", "loop.record_qpos=true", "--trace", "cart.npz", "-q")
    assert done.returncode == 0, done.stderr
    videos = []
    for source in (("cart.npz", "cart.toml"), ("cart.toml",)):
        done = command("video", *source, "-o", "cart.webp", "-q", *options)
        assert (done.returncode, done.stdout) == (0, "wrote cart.webp\n"), done.stderr
        videos.append(Path("cart.webp").read_bytes())
    assert videos[0] == videos[1]


@pytest.mark.usefixtures("_drawing", "cart")
def test_a_page_holds_the_video(folder: Path) -> None:
    done = command("report", "cart.toml", "-o", "cart.html", "-q")
    assert (done.returncode, done.stdout) == (0, "wrote cart.html\n"), done.stderr
    page = html.fromstring((folder / "cart.html").read_text())
    assert not page.find_class("note")
    (shown,) = page.iter("video")
    assert (int(shown.get("width")), int(shown.get("height"))) == VIDEO_SIZE
    content = base64.b64decode(shown.get("src").removeprefix("data:video/mp4;base64,"))
    with importlib.import_module("av").open(io.BytesIO(content)) as container:
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    assert len(pictures) == round(RATE * VIDEO_SECONDS)
    assert pictures[0].shape == (*VIDEO_SIZE[::-1], 3)
    assert red(pictures[0]).size
    assert np.abs(pictures[0].astype(int) - pictures[-1].astype(int)).max() > 60
    # still pictures cost little, so a page of many scenarios can be sent
    assert len(content) < 100_000
    (still,) = page.xpath("//img[@alt='the machine in motion']")
    content = base64.b64decode(still.get("src").removeprefix("data:image/jpeg;base64,"))
    picture = np.asarray(importlib.import_module("PIL.Image").open(io.BytesIO(content)))
    middle = pictures[len(pictures) // 2]
    assert picture.shape == middle.shape
    assert np.abs(picture.astype(int) - middle).mean() < 3.0


@pytest.mark.usefixtures("cart")
def test_what_cannot_draw_costs_the_picture_alone(folder: Path) -> None:
    # MuJoCo cannot even be imported with it
    lacking = {"MUJOCO_GL": "bogus"}
    done = command("report", "cart.toml", "-o", "cart.html", "-q", **lacking)
    assert (done.returncode, done.stdout) == (0, "wrote cart.html\n"), done.stderr
    (note,) = html.fromstring((folder / "cart.html").read_text()).find_class("note")
    assert note.text_content().startswith("No video: no picture can be drawn here: MUJOCO_GL is bogus")
    done = command("video", "cart.toml", "-o", "cart.mp4", "-q", **lacking)
    assert done.returncode == 2
    assert "no picture can be drawn here: `" in done.stderr
    assert "on Debian or Ubuntu" in done.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("cart.toml", "-o", "cart.avi"), "cannot write a video to `cart.avi`"),
        (("cart.toml", "-o", "nowhere/cart.mp4"), "cannot write `nowhere/cart.mp4`"),
        (("cart.toml", "--size", "63x48"), "`--size` is `63x48`"),
        (("cart.toml", "--size", "large"), "`--size` is `large`"),
        (("cart.toml", "cart.toml"), "`cart.toml` is not a trace"),
        (("gone.npz",), "cannot read `gone.npz`"),
        (("cart.toml", "--seconds", "-1"), "`--seconds` is `-1`"),
        (("cart.toml", "--seconds", "nan"), "`--seconds` is `nan`"),
        (("gone.npz", "--seconds", "inf"), "`--seconds` is `inf`, it must be above 0 and at most 3600"),
        (("cart.toml", "--enlarge", "x=2"), "no coordinate is named `x`"),
    ],
)
def test_what_cannot_be_recorded_is_one_message(
    arguments: tuple[str, ...], message: str, cart: Path, folder: Path
) -> None:
    done = called("video", *arguments, "-q")
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(folder.glob("*.mp4"))


@pytest.mark.usefixtures("_drawing")
def test_a_close_up_has_the_overview_in_its_corner(cart: Path) -> None:
    model = cart.with_name("cart.xml")
    text = model.read_text()
    near = '<camera name="closeup" pos="0 -1 0" xyaxes="1 0 0 0 0 1"/>'
    model.write_text(text.replace("<worldbody>", f"<worldbody>{near}").replace('"side"', '"overview"'))
    moved, poses = motion(recorded(cart)), np.array([[0.0]])
    pictures = {}
    for name, size in (("", (160, 120)), ("closeup", (160, 120)), ("overview", (58, 43))):
        with renderer.Renderer(moved.model, moved.data, size, name, poses) as drawer:
            pictures[name] = [drawer.picture(np.array([at])) for at in (0.0, *5 * [0.2])]
    small, frame = np.s_[:43, -58:], np.s_[:45, -60:]
    for number, (both, near_by) in enumerate(zip(pictures[""], pictures["closeup"], strict=True)):
        outside = np.ones(both.shape, dtype=bool)
        outside[frame] = False
        assert np.array_equal(both[outside], near_by[outside])
        # the overview is drawn in every fifth picture
        far = pictures["overview"][0 if number < renderer.SELDOM else number]
        assert np.array_equal(both[small], far)
    assert not np.array_equal(pictures["overview"][0], pictures["overview"][5])


def test_an_mjcf_names_what_may_be_drawn_larger(cart: Path) -> None:
    assert enlarge.automatic_factors(motion(recorded(cart)))
    model = cart.with_name("cart.xml")
    text = model.read_text()
    for said, found in (("-", False), ("sl*", True)):
        custom = f'<custom><text name="enlarge" data="{said}"/></custom>'
        model.write_text(text.replace("<worldbody>", f"{custom}<worldbody>"))
        assert bool(enlarge.automatic_factors(motion(recorded(cart)))) is found


@pytest.mark.usefixtures("_drawing")
def test_a_camera_that_is_not_there_is_reported(cart: Path) -> None:
    with pytest.raises(CosimError, match="no camera `sid`") as caught:
        video_file.save(recorded(cart), ReplayOptions((64, 48), camera="sid"), Path("cart.webp"))
    assert caught.value.hint == "Use `side`."


def test_without_a_renderer_there_is_a_hint(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(name: str) -> Any:
        raise AttributeError("no library `libEGL.so`")

    monkeypatch.delenv(CHOICE, raising=False)
    monkeypatch.setattr("cosim.extras.needed", lambda *_: None)
    monkeypatch.setattr("importlib.import_module", fails)
    with pytest.raises(CosimError, match=r"no picture can be drawn here: .* fails: no library") as caught:
        renderer.graphics((32, 32))
    assert "libegl1" in caught.value.hint
    monkeypatch.setenv(CHOICE, "wrong")
    with pytest.raises(CosimError, match="`MUJOCO_GL` is `wrong`"):
        renderer.graphics((32, 32))


def test_the_viewer_takes_no_endless_time(cart: Path) -> None:
    done = called("view", str(cart), "-q", "--seconds", "1e12")
    assert done.returncode == 2
    assert "`--seconds` is `1e+12`, it must be above 0 and at most 3600" in done.stderr


def test_the_viewer_needs_a_screen(cart: Path) -> None:
    hidden = {name: "" for name in ("DISPLAY", "WAYLAND_DISPLAY") if name in os.environ}
    done = command("view", "cart.toml", "-q", "--in-process", **hidden)
    assert done.returncode == 2
    assert "error: the viewer cannot open a window" in done.stderr
    assert json.dumps(done.stderr).count("error:") == 1
