# What takes a board's images and something else: the program on the PC, a client, or the images of the other boards.

set(table_trees "")
set(table_configurations "")
set(host_program ${PROJECT_SOURCE_DIR}/build/host/emax)
set(scenario ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/host_tests/scenario/)

# emax_add_product_gates(<configuration>)
# Where the build has no tests of its own: symbols and footprint of the product.
function(emax_add_product_gates configuration)
  set(product ${PROJECT_SOURCE_DIR}/build/${configuration}/emax_${EMAX_BOARD_NAME}.elf)
  set(gate ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/gates/)
  set(name ${configuration}.gates.emax_${EMAX_BOARD_NAME})
  add_test(NAME ${name}.symbols COMMAND ${gate}image_symbols.py
    --tree ${PROJECT_SOURCE_DIR}/build/${configuration} ${product})
  add_test(NAME ${name}.footprint COMMAND ${gate}footprint.py
    --budget ${EMAX_BOARD_BUDGET} ${product})
  set_tests_properties(${name}.symbols ${name}.footprint PROPERTIES TIMEOUT ${EMAX_TEST_TIMEOUT} LABELS ${configuration})
endfunction()

# emax_add_identical_tests(<configuration>)
# What the images of a board print must not depend on the processor: the same bytes as the program on the PC, for the
# report of known parameters, that of the default job and of further ones, and for the answers of the console. No line of
# a report names the board.
function(emax_add_identical_tests configuration)
  list(JOIN EMAX_BOARD_RUNNER "' '" runner)
  set(image ${PROJECT_SOURCE_DIR}/build/${configuration}/emax_${EMAX_BOARD_NAME})
  set(comparison ${scenario}identical_reports.py
    host='${host_program}' "${configuration}='${runner}' '${image}_report.elf'" --)
  set(tests identical.${configuration}.answers)
  add_test(NAME ${tests} COMMAND ${scenario}identical_answers.py ${host_program} "'${runner}' '${image}.elf'")
  foreach(job IN ITEMS model bench ${EMAX_BOARD_EXTRA_JOBS})
    add_test(NAME identical.${configuration}.${job} COMMAND ${comparison} ${${job}_job})
    list(APPEND tests identical.${configuration}.${job})
  endforeach()
  # Double in software takes the default job through about 10^10 instructions; the long ones are started first.
  set_tests_properties(${tests} PROPERTIES TIMEOUT 1200 COST 60 LABELS ${configuration})
endfunction()

# emax_add_client_tests(<configuration>)
# PyVISA takes the product through the whole job and compares with the program on the PC.
function(emax_add_client_tests configuration)
  set(directory ${PROJECT_SOURCE_DIR}/host_tests/clients)
  file(STRINGS ${directory}/test_pyvisa.py classes REGEX "^class [A-Za-z]+\\(ClientTest\\)")
  list(TRANSFORM classes REPLACE "^class ([A-Za-z]+).*" "\\1")
  foreach(class IN LISTS classes)
    add_test(NAME ${configuration}.clients.${class}
      COMMAND ${EMAX_PYTHON} -B test_pyvisa.py ${host_program}
        ${PROJECT_SOURCE_DIR}/build/${configuration}/emax_${EMAX_BOARD_NAME}.elf ${EMAX_BOARD_RUNNER} -- ${class}
      WORKING_DIRECTORY ${directory})
    # Double in software takes the whole job a minute.
    set_tests_properties(${configuration}.clients.${class} PROPERTIES TIMEOUT 1200 LABELS ${configuration})
  endforeach()
endfunction()

foreach(configuration IN LISTS cross)
  emax_read_preset(${configuration} board cacheVariables EMAX_BOARD)
  emax_read_preset(${configuration} has_tests cacheVariables EMAX_TESTS)
  if(NOT board)
    continue()
  endif()
  emax_read_board("${board}")
  if(EMAX_BOARD_PRODUCT)
    if(EMAX_BOARD_CHECK)
      include(${EMAX_BOARD_CHECK})
    endif()
    continue()
  endif()
  if(NOT has_tests)
    emax_add_product_gates(${configuration})
    continue()
  endif()
  list(APPEND table_trees ${PROJECT_SOURCE_DIR}/build/${configuration})
  list(APPEND table_configurations ${configuration})
  if(EMAX_BOARD_RUNNER AND EMAX_BOARD_SIMULATED_BENCH)
    emax_add_identical_tests(${configuration})
    emax_add_client_tests(${configuration})
    # For those who need any board: a command line that runs its product.
    list(JOIN EMAX_BOARD_RUNNER "' '" emulated_board)
    string(PREPEND emulated_board "'")
    string(APPEND emulated_board "' '${PROJECT_SOURCE_DIR}/build/${configuration}/emax_${EMAX_BOARD_NAME}.elf'")
  endif()
endforeach()

# The tables in firmware/README.md.
set(tables ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/gates/firmware_tables.py
  --readme ${PROJECT_SOURCE_DIR}/firmware/README.md
  --calls ${PROJECT_SOURCE_DIR}/toolchains/gates/indirect_calls.txt ${table_trees})
# cmake --build build/check --target cost_table: measures everything and writes the tables.
add_custom_target(cost_table COMMAND ${tables} --write USES_TERMINAL VERBATIM)
add_dependencies(cost_table ${table_configurations})
add_test(NAME firmware.tables COMMAND ${tables} --check)
set_tests_properties(firmware.tables PROPERTIES TIMEOUT 1200)
