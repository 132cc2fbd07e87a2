"""Tables of measured points of a known sensor, drawn with seeded noise; shares no code with the program."""

import cmath
import math
import random


def response(sensitivity: float, natural_hz: float, damping: float, frequency_hz: float) -> complex:
    """Sensitivity of a mass on a spring, in V/(m/s^2), at one frequency."""
    ratio = frequency_hz / natural_hz
    return sensitivity / complex(1 - ratio * ratio, 2 * damping * ratio)


def third_octaves(highest_hz: float, count: int) -> list[float]:
    return [highest_hz * 2 ** (-i / 3) for i in reversed(range(count))]


def table(device: tuple[float, float, float], chance: random.Random, percent: float = 1, degrees: float = 1) -> str:
    """20 third octaves up to 10 kHz with the noise that their expanded uncertainties (k = 2) say."""
    lines = ["f_hz,amplitude,phase_deg,u_amplitude,u_phase_deg"]
    for frequency_hz in third_octaves(10000, 20):
        true = response(*device, frequency_hz)
        amplitude = abs(true) * (1 + chance.gauss(0, 0.005 * percent))
        phase_deg = math.degrees(cmath.phase(true)) + chance.gauss(0, 0.5 * degrees)
        lines.append(f"{frequency_hz:.6g},{amplitude:.9g},{phase_deg:.9g},{0.01 * percent * abs(true):.6g},{degrees:g}")
    return "\n".join(lines) + "\n"
