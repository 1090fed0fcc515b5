"""Videos: the pictures of a run with captions, as MP4, GIF or WebP."""

from __future__ import annotations

import io
import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cosim import extras
from cosim.errors import CosimError
from cosim.replay import caption
from cosim.replay.enlarge import enlargement
from cosim.replay.motion import Recorded, motion
from cosim.replay.playback import RATE, ReplayOptions, check_seconds, time_scale
from cosim.replay.renderer import Picture, Renderer
from cosim.writing import check_folder, whole

LARGEST = 4096
"""Maximum pixels of a side for MuJoCo's buffers and the formats."""
POSES = 32
"""Number of poses that the view must show completely."""


def check(file: Path, options: ReplayOptions) -> None:
    """Check before a long run that its video can be written: ending, folder, size, duration, packages."""
    if file.suffix not in WRITERS:
        endings = ", ".join(f"`{ending}`" for ending in WRITERS)
        raise CosimError(f"cannot write a video to `{file}`", f"Use a name that ends in {endings}.")
    check_folder(file)
    width, height = options.size
    if not all(16 <= side <= LARGEST and side % 2 == 0 for side in options.size):
        raise CosimError(f"`--size` is `{width}x{height}`", f"Use even numbers from 16 to {LARGEST}.")
    check_seconds(options.seconds)
    check_packages(file.suffix)


def check_packages(ending: str) -> None:
    """Check that the packages for an ending are installed."""
    if ending == ".mp4":
        library()
    extras.needed("PIL", "videos need Pillow, which is not installed", extras.hint("replay"))


def library() -> Any:
    """Return PyAV, which must be installed."""
    return extras.needed("av", "an MP4 file needs PyAV, which is not installed", extras.hint("replay"))


def save(
    recorded: Recorded,
    options: ReplayOptions,
    file: Path,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Write the video of a run, whose trace must hold the coordinates."""
    check(file, options)
    moved = motion(recorded)
    scale = time_scale(moved.times, options.seconds, options.begin, options.end)
    count = len(scale.rows)

    def pictures() -> Iterator[Picture]:
        larger = enlargement(moved, options.enlarge)
        lines = caption.lines(recorded)
        poses = larger.qpos[scale.rows[:: max(1, count // POSES)]]
        with Renderer(moved.model, moved.data, options.size, options.camera, poses) as renderer:
            for done, row in enumerate(map(int, scale.rows), 1):
                if progress is not None:
                    progress(done, count)
                picture = renderer.picture(larger.qpos[row], partial(moved.draw, row, larger.value))
                yield with_captions(picture, [line(row) for line in lines], [scale.text, *larger.texts])

    with whole(file) as part:
        WRITERS[file.suffix](pictures(), count, options.size, part)


def middle_picture(video: Path) -> bytes:
    """Middle picture of an MP4 video, as JPEG."""
    with library().open(str(video)) as container:
        middle = container.streams.video[0].frames // 2
        picture = next(itertools.islice(container.decode(video=0), middle, None))
    content = io.BytesIO()
    picture.to_image().save(content, "JPEG", quality=85)
    return content.getvalue()


def with_captions(picture: Picture, current: Sequence[str], constant: Sequence[str]) -> Picture:
    """Write captions into a picture: changing texts, and below them those of the whole video.

    Both are at the top, where the controls of a player do not hide them.
    """
    from PIL import Image, ImageDraw, ImageFont

    image = Image.fromarray(picture)
    draw = ImageDraw.Draw(image, "RGBA")
    size = max(10, picture.shape[0] // 30)
    font = ImageFont.load_default(size)
    y = 0
    options: Any = {"font": font, "spacing": size // 4}
    for text in filter(None, map("\n".join, (current, constant))):
        _, _, width, height = draw.multiline_textbbox((0, 0), text, **options)
        draw.rectangle((0, y, width + size, y + height + size), fill=(16, 22, 28, 170))
        draw.multiline_text((size // 2, y + size // 2 - size // 8), text, **options, fill="white")
        y += height + size + size // 4
    return np.asarray(image)


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
