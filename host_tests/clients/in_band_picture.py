"""The README's picture of both in-band figures over the resonance, for some dampings.

usage: in_band_picture.py table PROGRAM TABLE.csv       asks the program for each figure, some seconds
       in_band_picture.py draw TABLE.csv PICTURE.svg    draws them with gnuplot
"""

import csv
import subprocess
import sys

import emax

DAMPINGS = ["0.02", "0.1", "0.3", "0.7"]
CUTOFF_HZ = 1000
# A third of an octave, nearly.
RATIOS = [1, 1.25, 1.6, 2, 2.5, 3.15, 4, 5, 6.3, 8, 10, 12.5, 16, 20, 25, 31.5, 40, 50, 63, 80, 100]
HEAD = ["f0/fc", "beta", "in_band_percent", "matched_percent"]


def figures(program: str, ratio: float, damping: str) -> tuple[float, float | None]:
    """Both in-band figures in percent of S a, of order 10 and T = 2 ms; None where the delay cannot be taken out."""
    model = f"1,{ratio * CUTOFF_HZ:g},{damping}"
    band = emax.run_report(program=program, model=model, criterion="band", reference_delay="none", trend="none")["band"]
    return band["rms_percent"], None if band["matched"] is None else band["matched"]["rms_percent"]


def write_table(program: str, path: str) -> None:
    with open(path, "w", encoding="ascii", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(HEAD)
        for damping in DAMPINGS:
            for ratio in RATIOS:
                band, matched = figures(program, ratio, damping)
                table.writerow([f"{ratio:g}", damping, f"{band:.6g}", "" if matched is None else f"{matched:.6g}"])


def blocks(path: str, column: str) -> str:
    """Data of gnuplot, a block for each damping."""
    with open(path, encoding="ascii", newline="") as file:
        rows = list(csv.DictReader(file))
    lines = []
    for damping in DAMPINGS:
        lines += [f"{row['f0/fc']} {row[column]}" for row in rows if row["beta"] == damping and row[column]]
        lines += ["", ""]
    return "\n".join(lines)


def draw(table: str, picture: str) -> None:
    colours = ["#d55e00", "#e69f00", "#009e73", "#0072b2"]
    curves = ", ".join(
        f"$DATA index {n} with lines linewidth 2 linecolor rgb '{colours[n]}' title 'β = {damping}'"
        for n, damping in enumerate(DAMPINGS))
    panels = [("in_band_percent", "in band, with the sensor's delay"),
              ("matched_percent", "in band, constant delay taken out")]
    script = f"""
set encoding utf8
set terminal svg size 960,400 dynamic font 'sans-serif,13' background rgb 'white'
set output '{picture}'
set multiplot layout 1,2
set logscale xy
set grid xtics ytics linecolor rgb '#dddddd'
set xrange [1:100]
set yrange [0.00003:200]
set ytics ('0.0001' 0.0001, '0.001' 0.001, '0.01' 0.01, '0.1' 0.1, '1' 1, '10' 10, '100' 100)
set xlabel 'natural frequency over cutoff, f_{{0}}/f_{{c}}'
set ylabel 'worst rms error in % of S a'
set key bottom left
"""
    for column, title in panels:
        script += f"$DATA << EOD\n{blocks(table, column)}\nEOD\nset title \"{title}\"\nplot {curves}\n"
    subprocess.run(["gnuplot"], input=script.encode(), check=True)


def main() -> int:
    if len(sys.argv) == 4 and sys.argv[1] == "table":
        write_table(sys.argv[2], sys.argv[3])
    elif len(sys.argv) == 4 and sys.argv[1] == "draw":
        draw(sys.argv[2], sys.argv[3])
    else:
        print(__doc__, end="", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
