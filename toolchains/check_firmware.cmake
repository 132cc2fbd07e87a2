# What needs the build trees of several cores at once: the tables in firmware/README.md, and the contraction of all
# libraries.

set(boards cortex-m4f cortex-m7 rv32)
foreach(board IN LISTS boards)
  if(NOT board IN_LIST configurations)
    return()
  endif()
endforeach()
set(trees ${boards})
list(TRANSFORM trees PREPEND ${PROJECT_SOURCE_DIR}/build/)
set(tables ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/gates/firmware_tables.py
  --readme ${PROJECT_SOURCE_DIR}/firmware/README.md
  --calls ${PROJECT_SOURCE_DIR}/toolchains/gates/indirect_calls.txt ${trees})

# cmake --build build/check --target cost_table: measures everything and writes the tables.
add_custom_target(cost_table COMMAND ${tables} --write USES_TERMINAL VERBATIM)
add_dependencies(cost_table ${boards})
add_test(NAME firmware.tables COMMAND ${tables} --check)
set_tests_properties(firmware.tables PROPERTIES TIMEOUT 600)

# emax_add_contraction_test(<configuration> <objdump>)
function(emax_add_contraction_test configuration objdump)
  set(tree ${PROJECT_SOURCE_DIR}/build/${configuration})
  add_test(NAME ${configuration}.gates.contraction
    COMMAND ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/gates/contraction.py --objdump ${objdump}
      ${tree}/algo/libemax_base.a ${tree}/algo/libemax_algo.a ${tree}/hal/libemax_hal.a
      ${tree}/hal/sim/libemax_sim.a ${tree}/firmware/app/libemax_app.a)
endfunction()

foreach(core IN ITEMS
    cortex-m0plus cortex-m3 cortex-m4f cortex-m7 cortex-m33 cortex-m55 cortex-m4f-clang cortex-m7-clang)
  emax_add_contraction_test(${core} arm-none-eabi-objdump)
endforeach()
emax_add_contraction_test(rv32 riscv64-unknown-elf-objdump)

# clang writes no call graph, but the rest holds for its product, too.
set(clang_product ${PROJECT_SOURCE_DIR}/build/cortex-m7-clang/emax_mps2_an500.elf)
set(gate ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/gates/)
add_test(NAME cortex-m7-clang.gates.emax_mps2_an500.symbols
  COMMAND ${gate}image_symbols.py --objdump arm-none-eabi-objdump ${clang_product})
add_test(NAME cortex-m7-clang.gates.emax_mps2_an500.footprint
  COMMAND ${gate}footprint.py --budgets ${PROJECT_SOURCE_DIR}/toolchains/budgets.txt ${clang_product})
