# Sets EMAX_PYTHON, a Python 3 that has NumPy: the first python3 on PATH need not be the one that has it.

function(emax_python_has_numpy result interpreter)
  execute_process(COMMAND ${interpreter} -c "import numpy" RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
  if(NOT status EQUAL 0)
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

find_program(EMAX_PYTHON NAMES python3 PATHS /usr/bin VALIDATOR emax_python_has_numpy NO_DEFAULT_PATH)
find_program(EMAX_PYTHON NAMES python3 VALIDATOR emax_python_has_numpy)
if(NOT EMAX_PYTHON)
  message(FATAL_ERROR "The tests need a python3 that can import numpy, and none was found; "
                      "run toolchains/install.sh, or set EMAX_PYTHON to one.")
endif()
