# What of the tests does not run on an emulated core, and why.

# Compares with libquadmath, and Arm has no __float128.
emax_leave_out(test_elementary_accuracy)

# The certificate is for a PC, in memory and time.
emax_leave_out(test_box_curvature)
emax_leave_out(test_certificate_grid)
emax_leave_out(test_energy_certificate)

# The surface of lightly damped sensors is for a PC: the boards' workspace keeps too few switches for it.
emax_leave_out(test_resonance_surface)

# Hundreds of fits.
emax_leave_out(test_fit_diagnosis)
emax_leave_out(test_fit_judgement Magnitudes.UncertaintiesAreThoseOfRepeatedFits)

# What they expect takes a long double, or a __float128, that is wider than double.
emax_leave_out(test_decimal DecimalParse.ExactMiddlesBetweenNeighbours)
emax_leave_out(test_frequency_response InverseCovariance.AgainstDifferences)

# newlib 3.3 is wrong there: %g leaves a zero at the end where a tie is rounded to it ("1.0e+02" for 105 with %.2g), and
# strtod takes no exponent beyond 19999.
emax_leave_out(test_decimal
  DecimalFormat.OrdinaryNumbersLikePrintf
  DecimalFormat.TiesGoToEven
  DecimalParse.ThousandsOfDigits)

# Keep more numbers than fit in the 16 MB of the board.
emax_leave_out(test_monte_carlo
  MonteCarlo.SortingAgreesAtTwoHundredThousandTrials
  MonteCarlo.SortingAgreesAtMillionsOfTrials
  AdaptiveTrials.AgreesWithTheRuleByHand)
emax_leave_out(test_sim_noise
  SimNoise.Moments
  SimNoise.DensityIsNormal
  SimNoise.IsWhite)

# Hundreds of sweeps, and whole evaluations with all their guards.
emax_leave_out(test_sweep_limit)
emax_leave_out(test_sweep_faults)
emax_leave_out(test_sweep
  Sweep.ALevelOfFewStepsIsNamedWithTheLeastLevel
  Sweep.AQuietBenchHasNoFlags
  Sweep.ExchangedChannelsAreNotSeenInNoise
  Sweep.SharpResonancesAreMeasured
  Sweep.WhatIsStatedIsNoMisfit
  Sweep.ResonanceThatIsTooSharpIsNamed)
emax_leave_out(test_evaluation_figures
  EvaluationFigures.DefaultTrendLeavesOutWhatHasNoRoom
  EvaluationFigures.GuardsEachUncertainty
  EvaluationFigures.PercentagesAreOfEachTrialsOwnSensitivity
  EvaluationFigures.RelativeIntervalsAreTheSameFromAStore)

emax_leave_out(test_instrument_work InstrumentSweep.BeginsAnewRightAfterAnAbort)
emax_leave_out(test_loopback
  Loopback.FindsRatioAndSkewWithinWhatItStates
  Loopback.RefusesGainsThatAreNotSteady
  InstrumentLoopback.IsNotKeptWhileASweepRuns
  InstrumentLoopback.KeepsTheCorrectionsWhereGainsAreNotSteady
  InstrumentLoopback.CorrectionsTakeTheErrorsOut)

# Slow ones, measured; the board's limit keeps all the others together at a minute or so.
get_property(left_out GLOBAL PROPERTY EMAX_LEFT_OUT_TESTS)
list(JOIN left_out "\n" left_out)
file(WRITE ${PROJECT_BINARY_DIR}/left_out.txt "${left_out}\n")
set(EMAX_SLOW_TESTS ${EMAX_BOARD_FOLDER}/slow_tests.txt)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${EMAX_SLOW_TESTS})
file(STRINGS ${EMAX_SLOW_TESTS} lines REGEX "^test_")
foreach(line IN LISTS lines)
  string(REGEX MATCH "^([^ ]+) ([^ ]+)" line "${line}")
  if(CMAKE_MATCH_2 STREQUAL "*")
    set_property(GLOBAL APPEND PROPERTY EMAX_SLOW_PROGRAMS ${CMAKE_MATCH_1})
  else()
    emax_leave_out(${CMAKE_MATCH_1} ${CMAKE_MATCH_2})
  endif()
endforeach()
