#!/usr/bin/env python3
"""Runs the NumPy lines of docs/formats.md on a small result: they must work as they stand.

    read_frames.py TAUT
"""
import io
import os
import re
import subprocess
import sys
import tempfile
from contextlib import redirect_stdout
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SKIPPED = 77
SCENE = """
[time]
step = 1e-2
frames = 3
[[cloth]]
name = "a"
grid = { nodes = [4, 3], origin = [0, 0, 1], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.1
k_stretch = 10
[[cloth]]
name = "b"
grid = { nodes = [2, 2], origin = [5, 0, 1], u = [1, 0, 0], v = [0, 1, 0] }
density = 0.1
k_stretch = 10
"""


def lines_of_the_page():
    page = (ROOT / "docs/formats.md").read_text()
    block = re.search(r"\n## frames/ with NumPy\n\n((?:    .*\n)+)", page).group(1)
    lines = [line[4:] for line in block.splitlines()]
    assert len(lines) <= 10, "the page promises ten lines"
    return "\n".join(lines)


def main():
    code = lines_of_the_page()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "scene.toml").write_text(SCENE)
        run = [sys.argv[1], "run", "scene.toml", "--out", "r", "--quiet", "--no-picture"]
        subprocess.run(run, cwd=folder, check=True)
        names, printed = {}, io.StringIO()
        with redirect_stdout(printed):
            exec(code.replace("out/ball", f"{folder}/r"), names)
    x, triangles, uv = names["x"], names["triangles"], names["uv"]
    assert x.shape == (4, 16, 3) and x.dtype == "float32", x.shape
    assert triangles.shape == (2 * 3 * 2 + 2, 3) and triangles.max() == 15
    assert uv.shape == (16, 2)
    words = printed.getvalue().split("\n")
    assert words[0].startswith("a (4, 12, 3) [") and words[1].startswith("b (4, 4, 3) ["), words
    # Free fall of cloths at rest: z = 1 - g h^2 k (k + 1) / 2 after k steps.
    assert abs(x[3, :, 2] - (1 - 9.81 * 1e-4 * 6)).max() < 1e-6, x[3, :, 2]


if __name__ == "__main__":
    try:
        import numpy  # noqa: F401
    except ImportError:
        python = ROOT / "build/test-python/bin/python"
        if python.exists() and Path(sys.prefix).resolve() != python.parent.parent.resolve():
            os.execv(python, [str(python), *sys.argv])
        print("skipped: there is no NumPy (Debian: python3-numpy)")
        sys.exit(SKIPPED)
    main()
