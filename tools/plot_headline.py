#!/usr/bin/env python3
"""Draws docs/images/headline.png: what stiffness costs, three ways to solve one system.

    taut bench flatness --threads 2 --nodes 6561 --k-stretch 60 600 6000 60000 600000 6000000 \\
        --solver cholmod,upcg:projected_block_diagonal,auto --json out/flatness.json
    tools/plot_headline.py out/flatness.json docs/images/headline.png

Of the cell of the paper's setting (h = 3.67 ms, k_shear 0.3, k_bend 0.05); needs gnuplot.
"""
import json
import subprocess
import sys

METHODS = {
    "upcg:projected_block_diagonal": ("CG, 3x3 diagonal blocks", "#d95f02"),
    "cholmod": ("CHOLMOD, full matrix", "#7f7f7f"),
    "auto": ("Taut (auto)", "#54278f"),
}


def main():
    rows = json.load(open(sys.argv[1]))
    rows = rows["rows"] if isinstance(rows, dict) else rows
    curves = []
    for method in METHODS:
        points = sorted((r["k_stretch"], r["to_1e-3_ms"]) for r in rows
                        if r.get("solver") == method and "to_1e-3_ms" in r
                        and abs(r["h"] - 3.67e-3) < 1e-5 and r["k_shear"] == 0.3)
        curves.append("\n".join(f"{k} {ms}" for k, ms in points) + "\ne\n")
    plots = ", ".join(f"'-' with linespoints lw 3 pt 7 ps 1.3 lc rgb '{colour}' title '{name}'"
                      for name, colour in METHODS.values())
    script = f"""set terminal pngcairo size 900,480 font 'DejaVu Sans,12'
set output '{sys.argv[2]}'
set logscale xy
set format x '10^{{%T}}'
set xlabel 'stretch stiffness, N/m'
set ylabel 'milliseconds a solve, to an error of 1e-3'
set yrange [1:1000]
set xrange [40:1e7]
set grid lc rgb '#dddddd'
set key top left
plot {plots}
""" + "".join(curves)
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


if __name__ == "__main__":
    main()
