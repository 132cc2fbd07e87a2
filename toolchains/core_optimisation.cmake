# How the code of a core is optimised in a Release build, unless the command line says otherwise. EMAX_CORE_OPTIMISATION is
# set before: -Os where double is in software, since nearly all the time goes by in the compiler's library there and small
# code costs no speed. With CMake's own -O3 the product does not fit into an STM32G474.

set(CMAKE_CXX_FLAGS_RELEASE "${EMAX_CORE_OPTIMISATION}" CACHE STRING "Flags of a Release build")
