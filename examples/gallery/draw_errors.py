"""Draws the error of positions seen against the rapidity, from the table that a test prints.

    python examples/gallery/draw_errors.py

needs matplotlib and cargo. Errors are in units in the last place of the distance seen; what has no digit right, or is
no number, stands on the upper line.
"""

import pathlib
import re
import subprocess

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402  (after the choice of the backend)

GALLERY = pathlib.Path(__file__).parent
COMMAND = ["cargo", "test", "--test", "it", "positions_seen", "--", "--nocapture"]
ROW = re.compile(r"^ *(\S+) +(\S+)  rapidity ([^,]+),", re.MULTILINE)
NO_DIGIT = 2.0**52
EXACT = 0.02


def main() -> None:
    output = subprocess.run(COMMAND, check=True, capture_output=True, text=True).stdout
    rows = [(float(rapidity), float(ours), float(naive)) for ours, naive, rapidity in ROW.findall(output)]
    assert len(rows) > 200, "the test prints another table"

    def shown(error: float) -> float:
        return min(max(error, EXACT), NO_DIGIT) if error == error else NO_DIGIT

    rapidities = [row[0] for row in rows]
    figure, axes = pyplot.subplots(figsize=(8, 3.6), dpi=100)
    axes.scatter(rapidities, [shown(row[2]) for row in rows], s=14, c="#c0392b", label="textbook formula")
    axes.scatter(rapidities, [shown(row[1]) for row in rows], s=14, c="#1f618d", label="photosurface")
    axes.axhline(8, color="#1f618d", linewidth=0.8, linestyle="--")
    axes.text(352, 8, "8 units", color="#1f618d", fontsize=8, va="bottom", ha="right")
    axes.axhline(NO_DIGIT, color="#c0392b", linewidth=0.8, linestyle="--")
    axes.text(0, NO_DIGIT, "no digit left", color="#c0392b", fontsize=8, va="bottom", ha="left")
    axes.set_xscale("symlog", linthresh=1)
    axes.set_xlim(-0.1, 420)
    axes.set_xticks([0, 1, 3, 10, 20, 50, 100, 350], ["0", "1", "3", "10", "20", "50", "100", "350"])
    axes.set_yscale("log")
    axes.set_ylim(top=1e17)
    axes.set_xlabel("rapidity")
    axes.set_ylabel("error / units in the last place")
    axes.legend(loc="center left")
    figure.tight_layout()
    figure.savefig(GALLERY / "errors.png")


if __name__ == "__main__":
    main()
