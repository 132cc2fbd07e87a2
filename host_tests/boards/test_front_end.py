"""Computes what the front end of a board's README does, from its bill of materials, and compares with what is said there.

usage: test_front_end.py README.MD SWEEP_BUDGET.CPP

The drive is held between two frames, so the pin also puts out the images of a frequency f, at n rate +- f. They come
back as f when the inputs are sampled, and where device and reference answer them differently, the ratio is wrong by as
much as they are left over. All of it in closed form: hold, filters, shaker, device, and the mean of the conversions.
"""

import cmath
import itertools
import math
import re
import sys
from typing import Callable

RATE_HZ = 50e3
CONVERSIONS = 32
CONVERSION_S = 25 / 42.5e6
SUPPLY_V = 3.3
HIGHEST_HZ = 6000.0  # Of the default sweep.
IMAGES = range(-8, 9)
LOOPBACK_HZ = RATE_HZ / 32  # The highest of a loopback.
# Of what makes the two channels differ, as the README's list of parts has it.
TOLERANCE = {"R1": 1e-3, "R2": 1e-3, "R3": 1e-3, "R4": 1e-3, "C1": 1e-2, "C2": 1e-2}
UNITS = {"Ω": 1.0, "kΩ": 1e3, "pF": 1e-12, "nF": 1e-9}

Response = Callable[[float], complex]


def parts_of(readme: str) -> dict[str, float]:
    """R1 and so on, in ohms and farads."""
    parts = {}
    for names, value, unit in re.findall(r"^\| ((?:[RC]\d+,? ?)+)\| ([\d.]+) (kΩ|Ω|pF|nF)", readme, re.MULTILINE):
        for name in re.findall(r"[RC]\d+", names):
            parts[name] = float(value) * UNITS[unit]
    return parts


def follower_low_pass(first_ohm: float, second_ohm: float, back_f: float, ground_f: float) -> Response:
    """Second order, around a follower: two resistors in series, a capacitor back to their middle, one to ground."""

    def response(frequency_hz: float) -> complex:
        s = 2j * math.pi * frequency_hz
        return 1 / (1 + s * (first_ohm + second_ohm) * ground_f + s * s * first_ohm * second_ohm * back_f * ground_f)

    return response


def resonance(frequency_hz: float, natural_hz: float, damping: float) -> complex:
    x = frequency_hz / natural_hz
    return 1 / (1 - x * x + 2j * damping * x)


def device(frequency_hz: float) -> complex:
    return resonance(frequency_hz, 4073.0, 0.3182)


def armature(frequency_hz: float) -> complex:
    return resonance(frequency_hz, 14e3, 0.05)


def stiff(_: float) -> complex:
    return 1.0


def hold(frequency_hz: float) -> complex:
    x = math.pi * frequency_hz / RATE_HZ
    return cmath.exp(-1j * x) * (math.sin(x) / x)


def mean_of_conversions(frequency_hz: float) -> complex:
    turn = cmath.exp(-2j * math.pi * frequency_hz * CONVERSION_S)
    return sum(turn**k for k in range(CONVERSIONS)) / CONVERSIONS


def butterworth4(corner_hz: float) -> Response:
    return lambda f: resonance(f, corner_hz, math.cos(math.pi / 8)) * resonance(f, corner_hz, math.sin(math.pi / 8))


def error_by_images(frequency_hz: float, drive: Response, shaker: Response, inputs: Response) -> complex:
    """Of the ratio of device and reference, relative."""
    reference = both = 0j
    for n in IMAGES:
        f = frequency_hz + n * RATE_HZ
        part = hold(f) * drive(f) * shaker(f) * inputs(f) * mean_of_conversions(f)
        reference += part
        both += part * device(f)
    return both / reference / device(frequency_hz) - 1


def worst(drive: Response, shaker: Response, inputs: Response) -> tuple[float, float]:
    """Up to the highest frequency: percent and degrees."""
    errors = [error_by_images(f, drive, shaker, inputs) for f in range(100, int(HIGHEST_HZ) + 1, 100)]
    return 100 * max(abs(e.real) for e in errors), math.degrees(max(abs(e.imag) for e in errors))


def corner_hz(response: Response, low_hz: float = 1e3, high_hz: float = 1e5) -> float:
    for _ in range(60):
        middle_hz = math.sqrt(low_hz * high_hz)
        low_hz, high_hz = (middle_hz, high_hz) if abs(response(middle_hz)) > math.sqrt(0.5) else (low_hz, middle_hz)
    return low_hz


def input_gain(p: dict[str, float], frequency_hz: float) -> complex:
    """Of one channel, from its socket to the converter's pin."""
    divider_ohm = 1 / (1 / p["R1"] + 1 / p["R2"] + 1 / p["R3"])
    return divider_ohm / p["R1"] * follower_low_pass(divider_ohm, p["R4"], p["C1"], p["C2"])(frequency_hz)


def worst_difference(p: dict[str, float], frequency_hz: float, corrected_hz: float = 0.0) -> tuple[float, float]:
    """Between two channels whose parts are as far off as they may be: percent and degrees.

    What is left of it where gain and delay are corrected as they are at a lower frequency, if there is one.
    """
    logs = []
    for signs in itertools.product((-1, 1), repeat=len(TOLERANCE)):
        off = {name: p[name] * (1 + sign * TOLERANCE[name]) for name, sign in zip(TOLERANCE, signs)}
        log = cmath.log(input_gain(off, frequency_hz))
        if corrected_hz > 0.0:
            lower = cmath.log(input_gain(off, corrected_hz))
            log -= complex(lower.real, lower.imag * frequency_hz / corrected_hz)
        logs.append(log)
    amplitudes = [log.real for log in logs]
    phases = [log.imag for log in logs]
    return 100 * (max(amplitudes) - min(amplitudes)), math.degrees(max(phases) - min(phases))


def bias_times_s(p: dict[str, float]) -> tuple[float, float]:
    """How late the undriven pin's half of the supply comes to U2 through the low pass, and R13's and R14's through C5."""
    source_ohm = p["R6"] / 2
    drive_s = (source_ohm + p["R8"] + p["R15"]) * p["C4"] + (p["R16"] + p["R17"]) * p["C7"]
    return drive_s, p["R13"] / 2 * p["C5"]


def bias_kick_v(p: dict[str, float], rise_s: float) -> float:
    """Greatest volts behind U2 while the supply rises evenly and the pin is not driven; amplifiers without faults."""
    step_s = 1e-7
    middle = first = second_middle = second = bias = kick = 0.0  # Voltages; the middles are those of C6 and C8.
    source_ohm = p["R6"] / 2 + p["R8"]
    for i in range(round((rise_s + 2e-3) / step_s)):
        half_v = SUPPLY_V / 2 * min(1.0, i * step_s / rise_s)
        into_first = middle / p["R15"]
        into_second = second_middle / p["R17"]
        d_middle = ((half_v - middle - first) / source_ohm - into_first) / p["C6"]
        d_second = ((first - second_middle - second) / p["R16"] - into_second) / p["C8"]
        middle += step_s * d_middle
        second_middle += step_s * d_second
        first += step_s * into_first / p["C4"]
        second += step_s * into_second / p["C7"]
        bias += step_s * (half_v - bias) / (p["R13"] / 2 * p["C5"])
        kick = max(kick, abs(second - bias))
    return kick * p["R12"] / p["R10"]


def rest_v(p: dict[str, float]) -> float:
    """Volts behind U2 at rest, at most: dividers and difference amplifier of 0.1 %, 10 mV of offset of U2, and 0.5 mV
    of each of the three amplifiers before it (MCP6021 and MCP6024, industrial)."""
    gain = p["R12"] / p["R10"]
    dividers_v = 2 * gain * SUPPLY_V / 2 * 1e-3
    common_v = SUPPLY_V / 2 * gain / (1 + gain) * 4e-3
    return dividers_v + common_v + (1 + gain) * 10e-3 + gain * 3 * 0.5e-3


def main() -> int:
    with open(sys.argv[1], encoding="utf-8") as file:
        readme = file.read()
    with open(sys.argv[2], encoding="utf-8") as file:
        budget = dict(re.findall(r"constexpr double (kImages|kImageSkew) = ([\d.e-]+);", file.read()))
    p = parts_of(readme)
    divider_ohm = 1 / (1 / p["R1"] + 1 / p["R2"] + 1 / p["R3"])
    inputs = follower_low_pass(divider_ohm, p["R4"], p["C1"], p["C2"])
    first = follower_low_pass(p["R8"], p["R15"], p["C6"], p["C4"])
    second = follower_low_pass(p["R16"], p["R17"], p["C8"], p["C7"])

    def drive(f: float) -> complex:
        return first(f) * second(f)

    allowed_percent = 100 * float(budget["kImages"]) * (HIGHEST_HZ / RATE_HZ) ** 2
    allowed_deg = math.degrees(2 * math.pi * HIGHEST_HZ * float(budget["kImageSkew"]) / RATE_HZ)
    left_percent, left_deg = worst(drive, armature, inputs)
    stiff_percent, stiff_deg = worst(drive, stiff, inputs)
    wide_percent, wide_deg = worst(butterworth4(25e3), armature, stiff)
    print(f"images: {left_percent:.2g} %, {left_deg:.2g} deg; stiff {stiff_percent:.2g} %, {stiff_deg:.2g} deg")
    print(f"budget: {allowed_percent:.2g} %, {allowed_deg:.2g} deg; filter of 25 kHz {wide_percent:.2g} %, {wide_deg:.2g} deg")

    # A filter for twice the rate is what the budget does not allow for.
    assert left_percent <= allowed_percent and left_deg <= allowed_deg
    assert stiff_percent <= 2 * allowed_percent and stiff_deg <= allowed_deg
    assert wide_deg > 10 * allowed_deg
    # The difference amplifier has the same gain for both of its inputs, so that half of the supply is zero volts.
    assert p["R9"] == p["R10"] and p["R11"] == p["R12"] and p["R6"] == p["R7"] and p["R13"] == p["R14"]

    # Half of the supply comes by both ways at the same time, or nearly so.
    drive_s, bias_s = bias_times_s(p)
    kick_v, fast_kick_v = bias_kick_v(p, 1e-3), bias_kick_v(p, 1e-4)
    print(f"bias: {1e6 * drive_s:.0f} us and {1e6 * bias_s:.0f} us; {kick_v:.3f} V, {fast_kick_v:.2f} V; rest {rest_v(p):.3f} V")
    assert abs(drive_s - bias_s) < 0.05 * drive_s and rest_v(p) < 0.1 and kick_v < 0.1
    low_percent, low_deg = worst_difference(p, 100.0)
    high_percent, high_deg = worst_difference(p, 5000.0)
    rest_percent, rest_deg = worst_difference(p, 5000.0, corrected_hz=LOOPBACK_HZ)
    skew_s = worst_difference(p, LOOPBACK_HZ)[1] / 360 / LOOPBACK_HZ
    print(f"channels: skew {skew_s:.1e} s; corrected, at 5 kHz: {rest_percent:.2f} %, {rest_deg:.3f} deg")

    in_db = -20 * math.log10(abs(inputs(10e3) * mean_of_conversions(10e3)))
    middle_v = SUPPLY_V * divider_ohm / p["R2"]
    sentences = [
        f"{SUPPLY_V / 2 * p['R1'] / divider_ohm:.2f} V are full scale",
        f"±10 V into {middle_v:.2f} ± {10 * divider_ohm / p['R1']:.1f} V",
        f"low pass of second order at {corner_hz(inputs) / 1e3:.0f} kHz",
        f"take {in_db:.1f} dB off both",
        f"are ±{SUPPLY_V / 2 * p['R12'] / p['R10']:.2f} V behind U2 (R12/R10 = {p['R12'] / p['R10']:.2f})",
        f"fourth order at {corner_hz(drive) / 1e3:.1f} kHz",
        f"{left_percent:.4f} % and {left_deg:.5f}°",
        f"{stiff_percent:.3f} % and {stiff_deg:.4f}°",
        f"{allowed_percent:.3f} % and {allowed_deg:.4f}°",
        f"{wide_deg:.3f}°",
        f"{1e6 * drive_s:.0f} µs through the low pass and {1e6 * bias_s:.0f} µs through C5",
        f"{1e3 * kick_v:.0f} mV where the supply rises evenly in 1 ms, {fast_kick_v:.1f} V in 0.1 ms",
        f"{1e3 * rest_v(p):.0f} mV at rest",
        f"{rest_percent:.2f} % and {rest_deg:.2f}° at 5 kHz are left",
        f"skew within {math.ceil(1e7 * skew_s)}e-7 s",
        f"{low_percent:.2f} % and {low_deg:.2f}° at 100 Hz, {high_percent:.1f} % and {high_deg:.1f}° at 5 kHz",
    ]
    words = " ".join(readme.split())
    missing = [sentence for sentence in sentences if sentence not in words]
    for sentence in missing:
        print(f"{sys.argv[1]}: should say '{sentence}'")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
