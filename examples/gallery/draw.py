"""Draws the pictures of the README and of the lessons with the program itself.

    python examples/gallery/draw.py target/release/photosurface [FILE...]

Each picture is one command of pictures.json, which is printed; the test `gallery` notices when a picture is no longer what
its command draws.
"""

import json
import pathlib
import shlex
import subprocess
import sys

GALLERY = pathlib.Path(__file__).parent

# The flag with which a command is told where to write.
OUTPUT = {"flight": "--diagram", ".webp": "--film"}


def draw(binary: str, file: str, command: str) -> None:
    """Writes gallery/FILE."""
    words = shlex.split(command)
    flag = OUTPUT.get(words[0]) or OUTPUT.get(pathlib.Path(file).suffix) or "-o"
    line = [binary, *words, "-q", flag, str(GALLERY / file)]
    print(shlex.join(line))
    subprocess.run(line, check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    binary, *files = sys.argv[1:]
    for picture in json.loads((GALLERY / "pictures.json").read_text()):
        if picture["file"] in files or not files:
            draw(binary, **picture)
