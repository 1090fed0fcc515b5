"""Videos: the pictures of a run with captions, as MP4, GIF or WebP."""

from __future__ import annotations

import io
import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cosim import extras
from cosim.errors import CosimError
from cosim.replay import caption, enlarge, pace
from cosim.replay.motion import Motion, Recorded, motion
from cosim.replay.pace import RATE, Pace
from cosim.writing import check_folder, whole

if TYPE_CHECKING:
    from cosim.replay.renderer import Picture

LARGEST = 4096
"""Maximum pixels of a side for MuJoCo's buffers and the formats."""
POSES = 32
"""Number of poses that the view must show completely."""


@dataclass(frozen=True)
class Shot:
    """Settings of a video.

    Parameters
    ----------
    size
        Width and height, pixels.
    seconds
        Duration of the video, s.
    begin, end
        Part of the run, s; None is its start or end.
    camera
        Name of a camera of the model, empty as for `Renderer`.
    enlarge
        Texts `COORDINATE=FACTOR`; default: automatic.
    """

    size: tuple[int, int] = (640, 480)
    seconds: float = 8.0
    begin: float | None = None
    end: float | None = None
    camera: str = ""
    enlarge: tuple[str, ...] = ()


def check(file: Path, shot: Shot) -> None:
    """Check before a long run that its video can be written.

    Raises
    ------
    CosimError
        Unknown ending, no such folder, an invalid size or duration, or a package is not installed.
    """
    if file.suffix not in WRITERS:
        endings = ", ".join(f"`{ending}`" for ending in WRITERS)
        raise CosimError(f"cannot write a video to `{file}`", f"Use a name that ends in {endings}.")
    check_folder(file)
    width, height = shot.size
    if not (16 <= width <= LARGEST and 16 <= height <= LARGEST) or width % 2 or height % 2:
        problem = f"`--size` is `{width}x{height}`"
        raise CosimError(problem, f"Use even numbers from 16 to {LARGEST}.")
    pace.check(shot.seconds)
    check_packages(file.suffix)


def check_packages(ending: str) -> None:
    """Check that the packages for an ending are installed; otherwise raise a `CosimError`."""
    if ending == ".mp4":
        library()
    extras.needed("PIL", "videos need Pillow, which is not installed", extras.hint("replay"))


def library() -> Any:
    """Return PyAV; raise a `CosimError` if it is not installed."""
    return extras.needed("av", "an MP4 file needs PyAV, which is not installed", extras.hint("replay"))


def save(
    recorded: Recorded, shot: Shot, file: Path, progress: Callable[[int, int], None] | None = None
) -> None:
    """Write the video of a run.

    Raises
    ------
    CosimError
        As for `check`; its coordinates are not in the trace; no rendering backend works.
    """
    check(file, shot)
    moved = motion(recorded)
    paced = pace.pace(moved.times, shot.seconds, shot.begin, shot.end)
    pictures = reported(filmed(recorded, moved, paced, shot), len(paced.rows), progress)
    with whole(file) as part:
        WRITERS[file.suffix](pictures, len(paced.rows), shot.size, part)


def still(film: Path) -> bytes:
    """Middle picture of an MP4 video, as JPEG."""
    with library().open(str(film)) as container:
        middle = container.streams.video[0].frames // 2
        picture = next(itertools.islice(container.decode(video=0), middle, None))
    content = io.BytesIO()
    picture.to_image().save(content, "JPEG", quality=85)
    return content.getvalue()


def filmed(recorded: Recorded, moved: Motion, paced: Pace, shot: Shot) -> Iterator[Picture]:
    """Pictures of a run with captions."""
    from cosim.replay.renderer import Renderer

    factors = enlarge.given(shot.enlarge, moved) if shot.enlarge else enlarge.chosen(moved)
    qpos, drawn = enlarge.enlarged(moved, factors), enlarge.one(moved, factors)
    always = [paced.words, *enlarge.words(factors)]
    lines = caption.lines(recorded)
    poses = qpos[paced.rows[:: max(1, len(paced.rows) // POSES)]]
    with Renderer(moved.model, moved.data, shot.size, shot.camera, poses) as renderer:
        for row in paced.rows:
            draw = partial(moved.draw, int(row), drawn)
            yield lettered(renderer.picture(qpos[row], draw), caption.written(lines, int(row)), always)


def lettered(picture: Picture, left: Sequence[str], below: Sequence[str]) -> Picture:
    """Write captions into a picture: changing texts, and below them those of the whole video.

    Both are at the top, where the controls of a player do not hide them.
    """
    from PIL import Image, ImageDraw, ImageFont

    image = Image.fromarray(picture)
    draw = ImageDraw.Draw(image, "RGBA")
    size = max(10, picture.shape[0] // 30)
    font = ImageFont.load_default(size)
    y = 0
    for texts in filter(None, (left, below)):
        box = draw.multiline_textbbox((0, 0), "\n".join(texts), font=font, spacing=size // 4)
        width, height = box[2] + size, box[3] + size
        draw.rectangle((0, y, width, y + height), fill=(16, 22, 28, 170))
        place = (size // 2, y + size // 2 - size // 8)
        draw.multiline_text(place, "\n".join(texts), font=font, spacing=size // 4, fill="white")
        y += height + size // 4
    return np.asarray(image)


def reported(
    pictures: Iterator[Picture], count: int, progress: Callable[[int, int], None] | None
) -> Iterator[Picture]:
    """Pictures, with a progress call for each."""
    for done, picture in enumerate(pictures, 1):
        if progress is not None:
            progress(done, count)
        yield picture


def write_mp4(pictures: Iterator[Picture], count: int, size: tuple[int, int], file: Path) -> None:
    """Write an MP4 file with H.264, which all browsers support."""
    av = library()
    with av.open(str(file), "w", format="mp4") as container:
        stream = container.add_stream("libx264", rate=RATE)
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        stream.options = {"crf": "27", "preset": "faster", "threads": "1"}
        for picture in pictures:
            frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="rgb24")
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))


def write_gif(pictures: Iterator[Picture], count: int, size: tuple[int, int], file: Path) -> None:
    """Write a looping GIF file, each picture with its own colors; Pillow would hold all pictures."""
    from PIL import GifImagePlugin, Image, ImageChops

    duration = 1000 // RATE
    before = None
    with file.open("wb") as stream:
        for image in map(Image.fromarray, pictures):
            box = ImageChops.difference(image, before).getbbox() or (0, 0, 1, 1) if before else (0, 0, *size)
            part = image.crop(box).convert("P", palette=Image.Palette.ADAPTIVE)
            if before is None:
                stream.writelines(GifImagePlugin.getheader(part, info={"loop": 0, "duration": duration})[0])
            options = {"duration": duration, "include_color_table": before is not None}
            stream.writelines(GifImagePlugin.getdata(part, box[:2], **options))
            before = image
        stream.write(b";")


def write_webp(pictures: Iterator[Picture], count: int, size: tuple[int, int], file: Path) -> None:
    """Write a looping WebP file."""
    from PIL import Image

    first = Image.fromarray(next(pictures))
    others: Any = [OnDemand(pictures, count - 1)]
    options: dict[str, Any] = {"duration": 1000 // RATE, "loop": 0, "quality": 70, "method": 2}
    first.save(file, "webp", save_all=True, append_images=others, **options)


class OnDemand:
    """Pictures as an animated image of Pillow, of which only one is in memory."""

    def __init__(self, pictures: Iterator[Picture], count: int) -> None:
        self.pictures, self.n_frames = pictures, count

    def seek(self, number: int) -> None:
        """Take the next picture; Pillow asks for them in their order."""
        from PIL import Image

        self.image = Image.fromarray(next(self.pictures))

    def __getattr__(self, name: str) -> Any:
        return getattr(self.image, name)


WRITERS = {".mp4": write_mp4, ".gif": write_gif, ".webp": write_webp}
