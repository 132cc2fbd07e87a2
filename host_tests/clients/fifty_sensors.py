"""The largest errors of fifty sensors, some seconds: ten natural frequencies with five dampings."""

import numpy

import emax

F0_HZ = numpy.geomspace(2000, 50000, 10).round(-2)
DAMPINGS = [0.02, 0.1, 0.3, 0.5, 0.7]

energy = numpy.empty((len(F0_HZ), len(DAMPINGS)))  # V^2 s, for signals within 1 m/s^2.
percent = numpy.empty_like(energy)  # Worst rms error in the band, constant delay taken out, in % of S a.
for row, f0 in enumerate(F0_HZ):
    for column, damping in enumerate(DAMPINGS):
        result = emax.run_report(model=(1, f0, damping), limit=1, time=0.002, trend="none")
        energy[row, column] = result["energy"]["E"]
        percent[row, column] = result["band"]["matched"]["rms_percent"]

print("    f0/Hz" + "".join(f"{f'{damping:g}':>9}" for damping in DAMPINGS) + "   damping")
for f0, figures in zip(F0_HZ, percent):
    print(f"{f0:9.0f}" + "".join(f"{figure:9.3g}" for figure in figures) + "   %")
best = numpy.unravel_index(percent.argmin(), percent.shape)
print(f"The best: f0 = {F0_HZ[best[0]]:.0f} Hz with damping {DAMPINGS[best[1]]:g}, {percent[best]:.2g} % of S a.")
print(f"The energies of all: {1e3 * energy.min():.3f}e-3 to {1e3 * energy.max():.3f}e-3 V^2 s.")
