# Installs a build tree, builds firmware/example against it and runs that; the same with smaller tables.

# DESIGN: the best known energy for T = 2 ms.
set(expected "E = 0.005115251359876 V^2 s\n")

function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nended with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

# check_example(<name>): the example against the tree installed in <name>/installed.
function(check_example name)
  set(build ${WORK}/${name}/example)
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/firmware/example -B ${build} ${OPTIONS}
    -DCMAKE_PREFIX_PATH=${WORK}/${name}/installed)
  run(${CMAKE_COMMAND} --build ${build})
  if(NOT IS_CROSS)
    run(${build}/example)
    if(NOT output STREQUAL expected)
      message(FATAL_ERROR "${name}: the example prints\n${output}expected\n${expected}")
    endif()
  endif()
  run(${NM} --demangle --print-size ${build}/example)
  # In the library, but nothing of the example uses it.
  if(output MATCHES "[Cc]ertificate")
    message(FATAL_ERROR "${name}: the example has linked the certificate, which only a PC needs")
  endif()
  foreach(variable IN ITEMS workspace search model)
    if(NOT output MATCHES "[0-9a-f]+ ([0-9a-f]+) [bd] ${variable}\n")
      message(FATAL_ERROR "${name}: the example has no ${variable} in static memory:\n${output}")
    endif()
    math(EXPR bytes "0x${CMAKE_MATCH_1}")
    message(STATUS "${name}: ${variable} of ${bytes} bytes")
    set(${variable}_bytes ${bytes} PARENT_SCOPE)
  endforeach()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${TREE} --prefix ${WORK}/default/installed)
check_example(default)
file(READ ${SOURCE}/algo/README.md readme)
if(IS_CROSS)
  string(REGEX REPLACE "([0-9]) ([0-9])" "\\1\\2" readme "${readme}")
  set(sizes "the workspace takes ${workspace_bytes} bytes, the search ${search_bytes} and the model ${model_bytes},")
  string(FIND "${readme}" "${sizes}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "algo/README.md does not say that ${sizes}")
  endif()
  return()
endif()
set(default_bytes ${workspace_bytes})

run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE} -B ${WORK}/small/build ${OPTIONS} -DEMAX_WERROR=ON
  -DEMAX_MAX_SWITCHES=32 -DEMAX_MAX_CELLS=1024 -DEMAX_PHI_CELLS=48 -DEMAX_MAX_POINTS=16)
run(${CMAKE_COMMAND} --build ${WORK}/small/build --target emax_algo emax_hal)
run(${CMAKE_COMMAND} --install ${WORK}/small/build --prefix ${WORK}/small/installed)
check_example(small)
if(NOT workspace_bytes LESS default_bytes)
  message(FATAL_ERROR "smaller tables make no smaller workspace")
endif()

# A capacity outside its range is refused with its name.
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/small/build -DEMAX_MAX_SWITCHES=4 OUTPUT_QUIET)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/small/build --target emax_algo
  OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
if(result EQUAL 0 OR NOT output MATCHES "EMAX_MAX_SWITCHES is 8 to 4096")
  message(FATAL_ERROR "a capacity outside its range is not refused:\n${output}")
endif()

# Everybody's README shows the file that was built here.
file(READ ${SOURCE}/firmware/example/example.cpp example)
string(FIND "${readme}" "${example}" place)
if(place EQUAL -1)
  message(FATAL_ERROR "algo/README.md does not show firmware/example/example.cpp as it is")
endif()
