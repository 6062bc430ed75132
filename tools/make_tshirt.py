#!/usr/bin/env python3
"""Writes scenes/meshes/tshirt.obj: a T-shirt of two layers.

They are sewn together at the sides, the shoulders and along the sleeves, open at the neck, the hem
and the cuffs. Lengths in m; it lies in the plane z = 0, the front above, the neck towards +y.

    tools/make_tshirt.py [FILE]
"""
import sys
from collections import deque
from pathlib import Path

CELL = 0.0168              # m, between nodes
BODY, HEIGHT = 28, 38      # cells: across the chest, hem to shoulder
SLEEVE, CUFF = 12, 12      # cells: length and width of a sleeve
NECK = 5                   # cells from the middle to where the shoulder seam begins
# m: half the greatest distance of the layers, and how fast they part from a seam
FULL, SLOPE = 0.03, 0.4


def cells():
    for j in range(HEIGHT):
        for i in range(-BODY // 2 - SLEEVE, BODY // 2 + SLEEVE):
            if abs(2 * i + 1) < BODY or j >= HEIGHT - CUFF:
                yield i, j


def is_open(i: int, j: int) -> bool:
    hem = j == 0 and abs(i) < BODY // 2
    cuff = abs(i) == BODY // 2 + SLEEVE and HEIGHT - CUFF < j < HEIGHT
    neck = j == HEIGHT and abs(i) < NECK
    return hem or cuff or neck


def main() -> None:
    corners = {(i + a, j + b) for i, j in cells() for a in (0, 1) for b in (0, 1)}
    nodes = sorted(corners, key=lambda n: (n[1], n[0]))
    filled = set(cells())
    around = {n: sum((n[0] - a, n[1] - b) in filled for a in (0, 1) for b in (0, 1)) for n in nodes}
    seam = {n for n in nodes if around[n] < 4 and not is_open(*n)}
    distance = {n: 0 for n in seam}
    queue = deque(sorted(seam))
    while queue:
        i, j = queue.popleft()
        for n in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if n in around and n not in distance:
                distance[n] = distance[i, j] + 1
                queue.append(n)
    lines = ["# T-shirt, made by tools/make_tshirt.py: m, the front above z = 0, open at neck "
             "(+y), hem and cuffs"]
    texture, faces, index = [], [], {}
    for side in (1, -1):
        for n in nodes:
            if side < 0 and n in seam:
                index[n, side] = index[n, 1]
                continue
            index[n, side] = len(texture) + 1
            z = side * min(FULL, SLOPE * CELL * distance[n])
            lines.append(f"v {n[0] * CELL:.5f} {(n[1] - HEIGHT / 2) * CELL:.5f} {z:.5f}")
            texture.append(f"vt {n[0] / (BODY + 2 * SLEEVE) + 0.5:.5f} {n[1] / HEIGHT:.5f}")
    for side in (1, -1):
        for i, j in cells():
            a, b, c, d = (index[n, side] for n in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
            two = ((a, b, c), (a, c, d)) if (i + j) % 2 == 0 else ((a, b, d), (b, c, d))
            faces += [t if side > 0 else t[::-1] for t in two]
    lines += texture
    lines += ["f " + " ".join(f"{k}/{k}" for k in t) for t in faces]
    default = Path(__file__).resolve().parent.parent / "scenes" / "meshes" / "tshirt.obj"
    Path(sys.argv[1] if len(sys.argv) > 1 else default).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
