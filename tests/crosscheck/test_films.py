"""Films in Pillow and in ffmpeg: number of frames, times, pixels."""

import json
import os
import subprocess

import imageio_ffmpeg
import numpy
import pytest
from PIL import Image

SCENE = {
    "observer": {"velocity": {"beta": 0.8, "direction": [1, 0, 0]}},
    "steps": [-2, 2],
    "objects": [{"name": "cube", "shape": {"box": {"size": [2, 2, 2]}}, "position": [0, 3, 0], "color": "#e08030"}],
}
FRAMES, RATE = 15, 12


@pytest.fixture(scope="module")
def films(photosurface, tmp_path_factory):
    """A folder with the film in each format and its frames as PNG; ffmpeg is on the path under its own name."""
    folder = tmp_path_factory.mktemp("films")
    (folder / "scene.json").write_text(json.dumps(SCENE))
    (folder / "bin").mkdir()
    (folder / "bin/ffmpeg").symlink_to(imageio_ffmpeg.get_ffmpeg_exe())
    path = os.environ["PATH"]
    os.environ["PATH"] = f"{folder / 'bin'}:{path}"
    try:
        # An odd size: the last row and column of an MP4 are there twice.
        common = ["render", folder / "scene.json", "--size", "121x81", "--samples", "2", "--caption", "none"]
        common.append(f"--steps=-2..2/{FRAMES}")
        photosurface(*common, "-o", folder / "frame.png")
        for kind in ["gif", "png", "webp", "mp4"]:
            photosurface(*common, "--fps", RATE, "--film", folder / f"film.{kind}")
    finally:
        os.environ["PATH"] = path
    return folder


@pytest.fixture(scope="module")
def frames(films):
    files = sorted(films.glob("frame_step*.png"))
    assert len(files) == FRAMES
    return numpy.array([numpy.asarray(Image.open(file).convert("RGB")) for file in files]).astype(int)


@pytest.mark.parametrize("kind", ["gif", "png", "webp"])
def test_pillow_shows_the_frames(films, frames, kind):
    with Image.open(films / f"film.{kind}") as film:
        assert film.n_frames == FRAMES and film.size == (121, 81)
        assert film.info["loop"] == 0
        shown, milliseconds = [], 0
        for number in range(FRAMES):
            film.seek(number)
            shown.append(numpy.asarray(film.convert("RGB")).astype(int))
            milliseconds += film.info["duration"]
    # Half of a hundredth of a second of a GIF, half a thousandth of a WebP.
    assert milliseconds == pytest.approx(1000 * FRAMES / RATE, abs=5.01 if kind == "gif" else 0.51)
    off = numpy.abs(numpy.array(shown) - frames)
    if kind == "gif":
        # 256 colours for shades of one hue and a background.
        assert off.max() <= 12 and off.mean() < 0.5
    else:
        assert off.max() == 0


def test_ffmpeg_shows_the_frames(films, frames):
    ffmpeg = imageio_ffmpeg.get_ffmpeg_exe()
    about = subprocess.run([ffmpeg, "-i", films / "film.mp4"], capture_output=True, text=True).stderr
    assert f"{RATE} fps" in about and "122x82" in about, about
    assert "h264" in about and "yuv420p(tv, bt709" in about and "unknown" not in about.split("yuv420p")[1][:30], about
    # The head is in front, so that players begin before they have all of it.
    data = (films / "film.mp4").read_bytes()
    assert data.index(b"moov") < data.index(b"mdat")
    raw = subprocess.run(
        [ffmpeg, "-v", "error", "-i", films / "film.mp4", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
        capture_output=True,
        check=True,
    ).stdout
    shown = numpy.frombuffer(raw, numpy.uint8).reshape(-1, 82, 122, 3).astype(int)
    assert len(shown) == FRAMES
    # Colours are shared by squares of two by two: only away from edges are they those of the frame.
    padded = numpy.pad(frames, [(0, 0), (0, 1), (0, 1), (0, 0)], mode="edge")
    smooth = numpy.ones(padded.shape[:3], bool)
    for axis, shift in [(1, 1), (1, -1), (2, 1), (2, -1), (1, 2), (1, -2), (2, 2), (2, -2)]:
        smooth &= numpy.abs(numpy.roll(padded, shift, axis) - padded).max(axis=3) <= 4
    off = numpy.abs(shown - padded).max(axis=3)
    assert smooth.mean() > 0.5
    # Rounding to 8 bits of luma and chroma, 219 and 224 levels, and the loss of the codec.
    assert off[smooth].mean() < 2.5 and numpy.percentile(off[smooth], 99) <= 8, (off[smooth].mean(), off.max())
    # The object itself, not only the background, has its colour.
    colourful = smooth & (numpy.ptp(padded, axis=3) > 60)
    assert colourful.sum() > 500
    difference = (shown - padded)[colourful].mean(axis=0)
    assert numpy.abs(difference).max() < 3, difference
