# RV32IMAFDC with riscv64-unknown-elf-gcc and picolibc: floating point in double precision.

set(EMAX_CORE_OPTIMISATION -O2)
include(${CMAKE_CURRENT_LIST_DIR}/core_optimisation.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/arm_libstdcxx.cmake)
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR rv32)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_COMPILER riscv64-unknown-elf-g++)
# Exactly this -march: with _zicsr the compiler takes the library of another core.
set(core_flags "-march=rv32imafdc -mabi=ilp32d -mcmodel=medany")
set(CMAKE_CXX_FLAGS_INIT "${core_flags} --specs=picolibc.specs ${EMAX_LIBSTDCXX_FLAGS}")
# There is no libstdc++ to link.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostdlib")
set(CMAKE_CXX_STANDARD_LIBRARIES "-lc -lgcc")
