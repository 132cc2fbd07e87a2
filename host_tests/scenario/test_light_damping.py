"""Lightly damped sensors far above their points: a whole report takes few searches, and holds the true energy.

usage: test_light_damping.py PROGRAM DATA_DIRECTORY [unittest arguments]

By hand, with a number of draws of each sensor (400 unless given):
       EMAX_DRAWS=40 test_light_damping.py PROGRAM DATA_DIRECTORY LightDampingByChance
"""

import json
import math
import os
import random
import re
import resource
import statistics

import sensor_draws
from program_test import DATA, ProgramTest, main

SENSORS = [(0.0102, 55000, 0.005), (0.0102, 55000, 0.01), (0.0102, 30000, 0.01)]
# A limit and a gain that do not follow the fit, so that energies of different fits are the same quantity.
COMMON = ["--limit", "1", "--gain", "0.0102"]


# Hundreds of draws.
ByHand = ProgramTest


def least_inside(draws: int, probability: float = 0.95, risk: float = 0.025) -> int:
    """Fewer of the draws are inside their intervals with at most this risk if the intervals are right."""
    below = 0.0
    for inside in range(draws + 1):
        below += math.comb(draws, inside) * probability**inside * (1 - probability) ** (draws - inside)
        if below > risk:
            return inside
    return draws


def stated(results) -> tuple[float, float]:
    """Where E is with 95 %: the range of the damping if that is open, else the interval of the trials."""
    if results["fit"]["determined"] == "all but beta":
        return tuple(results["fit"]["E_range"])
    return tuple(results["uncertainty"]["interval"])


def shortest(results) -> tuple[float, float]:
    """The same with the shortest interval, widened to hold the estimate's E."""
    if results["fit"]["determined"] == "all but beta":
        return stated(results)
    energy, (low, high) = results["energy"]["E"], results["uncertainty"]["shortest"]
    return min(low, energy), max(high, energy)


class LightDamping(ProgramTest):
    def assert_is_interpolated(self, text, most_percent):
        """All trials of the energy are values of a surface, and a handful of whole searches found nothing above it."""
        for title in ["UNCERTAINTY OF E", "MONTE CARLO OF THE PAPER"]:
            section = text[text.index("\n" + title):]
            found = re.search(r"\n  Interpolated +200000 trials, off by up to ([0-9.e-]+) % of u\(E\)\n", section)
            self.assertIsNotNone(found, section)
            self.assertLess(float(found[1]), most_percent)
            # Nine where trials are branches.
            self.assertIn("\n  Guard                     5 full searches, 0 disagreements\n", section)

    def test_draws_that_determine_the_damping(self):
        # Beta is above 2 u(beta) in these; 2 % is where the surface would have tried a higher degree.
        for device, seed in [(SENSORS[1], "b0"), (SENSORS[2], "c3")]:
            self.write(sensor_draws.table(device, random.Random(seed)).encode(), "drawn.csv")
            text = self.succeed("report", "--points", "drawn.csv", "--trend", "none", *COMMON)
            self.assert_is_interpolated(text, 2)

    def test_coupling(self):
        self.assert_is_interpolated(
            self.succeed("report", "--points", DATA / "tables" / "high_pass.csv", "--trend", "none"), 2)

    def test_a_damping_that_is_given(self):
        """Over f0 alone E changes little, and by steps that no degree follows; the first degree then stands."""
        self.assert_is_interpolated(
            self.succeed("report", "--points", DATA / "tables" / "mv_per_g.csv", "--trend", "none", "--damping", "0.0264",
                         "--time", "0.005"), 10)

    def test_limit_of_the_binomial(self):
        # Of 400 draws at 95 %, fewer than 371 happen in 1.90 % and fewer than 372 in 3.07 %.
        self.assertEqual(least_inside(400), 371)
        # One draw is outside in 5 %, both of two in 0.25 %, one or both of two in 9.75 %.
        self.assertEqual([least_inside(1), least_inside(2), least_inside(2, risk=0.0024)], [0, 1, 0])


class LightDampingByChance(ByHand):
    """Draws of each sensor; prints what they cost and how many of them hold the true energy."""

    DRAWS = int(os.environ.get("EMAX_DRAWS", "400"))

    def cpu_s(self, *arguments):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        results = json.loads(self.succeed("report", *arguments, "--json"))
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, results

    def test_every_draw_gives_a_report_with_the_truth_in_its_interval(self):
        for device in SENSORS:
            chance = random.Random(repr(device))
            true = self.cpu_s("--model", ",".join(map(str, device)), "--trend", "none", *COMMON)[1]["energy"]["E"]
            times_s, inside, in_shortest, is_open = [], 0, 0, 0
            for _ in range(self.DRAWS):
                self.write(sensor_draws.table(device, chance).encode(), "drawn.csv")
                time_s, results = self.cpu_s("--points", "drawn.csv", *COMMON)
                times_s.append(time_s)
                low, high = stated(results)
                inside += low <= true <= high
                low, high = shortest(results)
                in_shortest += low <= true <= high
                is_open += results["fit"]["determined"] == "all but beta"
            least = least_inside(self.DRAWS)
            print(f"{device}: {self.DRAWS} draws, CPU median {statistics.median(times_s):.2f} s, worst {max(times_s):.2f} s,"
                  f" {sum(time_s > 1 for time_s in times_s)} above 1 s; beta open in {is_open}; {inside} hold the true"
                  f" energy ({in_shortest} with shortest intervals), at least {least} must", flush=True)
            self.assertGreaterEqual(inside, least, device)


if __name__ == "__main__":
    main()
