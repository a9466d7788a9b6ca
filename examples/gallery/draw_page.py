"""Makes the sample page of the gallery, and a film of it for the README.

    python examples/gallery/draw_page.py target/release/photosurface

flight.html is what `photosurface page` writes of its default scene; the test `gallery` notices when it is no longer that.
page.webp shows it in Chromium, with the flight of the scene from its beginning to its end. Needs Node, Playwright
(`npm ci` in tests/page), Chromium (CHROMIUM=PATH if it is not /usr/bin/chromium) and Pillow; `--page` makes flight.html
alone and needs nothing of that.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

GALLERY = pathlib.Path(__file__).parent
PAGE = GALLERY / "flight.html"

# Frames of the flight, milliseconds of each, and of the last one, in which the ring is that the observer has passed.
FRAMES, FRAME_MS, LAST_MS = 84, 80, 1000


def film(binary: str, path: pathlib.Path) -> None:
    """Writes a film of the page that loops."""
    from PIL import Image

    with tempfile.TemporaryDirectory() as folder:
        line = ["node", str(GALLERY / "page_frames.mjs"), str(PAGE.resolve()), folder, str(FRAMES)]
        subprocess.run(line, check=True, env={**os.environ, "PHOTOSURFACE_BINARY": binary})
        first, *others = [Image.open(frame).convert("RGB") for frame in sorted(pathlib.Path(folder).iterdir())]
        durations = [FRAME_MS] * len(others) + [LAST_MS]
        first.save(path, save_all=True, append_images=others, duration=durations, loop=0, quality=55, method=6)


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--page"]):
        sys.exit(__doc__)
    binary = sys.argv[1]
    subprocess.run([binary, "page", "--example", "flight", "-q", "-o", str(PAGE)], check=True)
    if not sys.argv[2:]:
        film(binary, GALLERY / "page.webp")
