# Sets EMAX_LIBSTDCXX_FLAGS: the C++ headers of arm-none-eabi-gcc, for compilers that have none for a microcontroller.
# Only the permitted headers are for them: these need nothing of a core and no library.

execute_process(
  COMMAND arm-none-eabi-g++ -dumpversion
  OUTPUT_VARIABLE version
  RESULT_VARIABLE result
  OUTPUT_STRIP_TRAILING_WHITESPACE)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "The C++ headers come from arm-none-eabi-g++, which is not installed; run toolchains/install.sh.")
endif()
set(headers /usr/include/newlib/c++/${version})
set(EMAX_LIBSTDCXX_FLAGS "-nostdinc++ -isystem ${headers} -isystem ${headers}/arm-none-eabi/thumb/nofp")
