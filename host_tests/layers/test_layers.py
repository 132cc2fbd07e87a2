"""Shows that layers.py reports what it should, on trees of a few files.

usage: test_layers.py
"""

import tempfile
import unittest
from pathlib import Path

from layers import check

TABLE = """
algo/base                        # Everybody's.
algo/model          algo/base
algo/energy         algo/base algo/model
hal                 algo/base
hal/sim             algo/base hal
firmware/app/store  hal
firmware/app/scpi   algo/*
firmware/boards     algo/* hal
"""

GOOD = {
    "algo/include/emax/base/span.hpp": "#include <cstddef>\n",
    "algo/include/emax/model/mode.hpp": '#include "emax/base/span.hpp"\n',
    "algo/src/model/mode.cpp": '#include "emax/model/mode.hpp"\n#include "mode_parts.hpp"\n',
    "algo/src/model/mode_parts.hpp": "",
    "hal/include/emax/hal/clock.hpp": '#include "emax/base/span.hpp"\n',
    "hal/sim/src/bench.cpp": '#include "emax/hal/clock.hpp"\n',
    "firmware/app/include/emax/app/store/slot.hpp": '#include "emax/hal/clock.hpp"\n',
    "firmware/app/src/scpi/call.cpp": '  #  include "emax/model/mode.hpp"\n',
    "firmware/boards/one/src/deep/port.cpp": '#include "emax/board/port.hpp"\n#include "emax/hal/clock.hpp"\n',
    "firmware/boards/one/include/emax/board/port.hpp": "",
}


class Layers(unittest.TestCase):
    def problems(self, more: dict[str, str], table: str = TABLE) -> list[str]:
        with tempfile.TemporaryDirectory() as folder:
            for name, text in {**GOOD, **more}.items():
                file = Path(folder, name)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text, encoding="utf-8")
            return check(Path(folder), table)

    def test_a_good_tree(self) -> None:
        self.assertEqual(self.problems({}), [])

    def test_an_include_against_the_order(self) -> None:
        file = "algo/include/emax/base/units.hpp"
        for include in ('"emax/model/mode.hpp"', "<emax/model/mode.hpp>"):
            self.assertEqual(
                self.problems({file: f"#pragma once\n\n#include {include}\n"}),
                [f"{file}: algo/base may not include emax/model/mode.hpp of algo/model"],
            )

    def test_a_source_counts_as_its_wing(self) -> None:
        self.assertEqual(
            self.problems({"firmware/app/src/store/slot.cpp": '#include "emax/base/span.hpp"\n'}),
            ["firmware/app/src/store/slot.cpp: firmware/app/store may not include emax/base/span.hpp of algo/base"],
        )

    def test_the_bench_knows_no_model_of_the_sensor(self) -> None:
        file = "hal/sim/include/emax/sim/plant.hpp"
        self.assertEqual(
            self.problems({file: '#include "emax/model/mode.hpp"\n'}),
            [f"{file}: hal/sim may not include emax/model/mode.hpp of algo/model"],
        )

    def test_the_row_of_a_folder_is_not_that_of_its_subfolder(self) -> None:
        noise = {"hal/sim/include/emax/sim/noise.hpp": ""}
        file = "firmware/boards/one/board.cpp"
        self.assertEqual(
            self.problems({**noise, file: '#include "emax/sim/noise.hpp"\n'}),
            [f"{file}: firmware/boards may not include emax/sim/noise.hpp of hal/sim"],
        )

    def test_a_path_cannot_go_round_the_table(self) -> None:
        file = "algo/src/model/mode_more.cpp"
        self.assertEqual(
            self.problems({file: '#include "../energy/search.hpp"\n', "algo/src/energy/search.hpp": ""}),
            [f"{file}: ../energy/search.hpp is no file of the tree"],
        )

    def test_a_folder_without_a_row(self) -> None:
        self.assertEqual(
            self.problems({"firmware/app/src/menu/menu.cpp": ""}),
            ["firmware/app/src/menu/menu.cpp: no row of the table covers its folder"],
        )

    def test_a_table_that_runs_in_a_circle(self) -> None:
        self.assertEqual(
            self.problems({}, TABLE.replace("algo/model          algo/base", "algo/model   algo/base algo/energy")),
            ["the table: algo/model names algo/energy, which does not stand above it"],
        )

    def test_a_tree_that_is_not_there(self) -> None:
        self.assertEqual(check(Path("nowhere"), TABLE), ["no files"])


if __name__ == "__main__":
    unittest.main()
