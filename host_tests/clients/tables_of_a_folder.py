"""What emax finds for each table of a folder: in-band errors in % of S a, largest energy, number of warnings.

usage: tables_of_a_folder.py FOLDER
"""

import pathlib
import sys

import emax


def percent(figure) -> str:
    """A figure that the filter or the points do not allow is None."""
    return f"{figure['rms_percent']:10.4g}" if figure else f"{'-':>10}"


def line_of(table: pathlib.Path) -> str:
    try:
        result = emax.run_report(points=table, limit=1, trend="none")
    except emax.EmaxError as error:
        return f"{table.name}: {error}"  # Refused: the line says what was expected.
    if not result["energy"]:
        return f"{table.name}: the points determine S alone"
    band = result["band"]
    columns = percent(band and band["matched"]) + percent(band)
    return f"{columns}{result['energy']['E']:11.4g}{len(result['warnings']):10d}  {table.name}"


print(f"{'delay out':>10}{'with it':>10}{'E, V^2 s':>11}{'warnings':>10}  table")
for path in sorted(pathlib.Path(sys.argv[1]).glob("*.csv")):
    print(line_of(path))
