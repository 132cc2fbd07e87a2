# The gates on the modules, and the page in a browser, beside the program of the PC and an emulated board.

include(${EMAX_BOARD_FOLDER}/interface.cmake)
set(tree ${PROJECT_SOURCE_DIR}/build/${configuration})
set(gate ${EMAX_PYTHON} -B ${PROJECT_SOURCE_DIR}/toolchains/gates/wasm_module.py)
# Far more memory than a board has, since the capacities are those of a PC. Flash is here the bytes of the module without
# names, and RAM its whole memory, stack and all.
set(budget --budget 400000 25165824 262144)
set(desk_budget --budget 270000 67108864 262144)
list(JOIN EMAX_WEB_EXPORTS "," exports)
list(JOIN EMAX_WEB_IMPORTS "," imports)
list(JOIN EMAX_WEB_DESK_EXPORTS "," desk_exports)
set(tests ${configuration}.gates.emax_web ${configuration}.gates.emax_web_desk)
add_test(NAME ${configuration}.gates.emax_web
  COMMAND ${gate} ${budget} --imports ${imports} --exports ${exports} ${tree}/emax_web.wasm)
add_test(NAME ${configuration}.gates.emax_web_desk
  COMMAND ${gate} ${desk_budget} --heap --exports ${desk_exports} ${tree}/emax_web_desk.wasm)

# No build of the PC has these sources, so they are looked at as they are compiled here.
file(GLOB sources RELATIVE ${PROJECT_SOURCE_DIR} ${EMAX_BOARD_FOLDER}/desk/*.cpp ${EMAX_BOARD_FOLDER}/instrument/*.cpp)
foreach(source IN LISTS sources)
  add_test(NAME style.tidy.${source}
    COMMAND ${EMAX_CLANG_TIDY} --quiet --checks=-clang-analyzer-* -p ${tree} ${PROJECT_SOURCE_DIR}/${source})
  list(APPEND tests style.tidy.${source})
endforeach()

set(folder ${PROJECT_SOURCE_DIR}/host_tests/web)
foreach(suite IN ITEMS test_page.py test_serial.py)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${folder}/${suite})
  file(STRINGS ${folder}/${suite} classes REGEX "^class [A-Za-z]+\\((Page|Serial)Test\\)")
  list(TRANSFORM classes REPLACE "^class ([A-Za-z]+).*" "\\1")
  list(REMOVE_ITEM classes SerialTest)
  foreach(class IN LISTS classes)
    add_test(NAME ${configuration}.page.${class}
      COMMAND ${EMAX_PYTHON} -B ${suite} ${host_program} ${PROJECT_SOURCE_DIR}/host_tests/data ${tree}/emax.html
        "${emulated_board}" ${class}
      WORKING_DIRECTORY ${folder})
    list(APPEND tests ${configuration}.page.${class})
  endforeach()
endforeach()
set_tests_properties(${tests} PROPERTIES TIMEOUT ${EMAX_TEST_TIMEOUT} LABELS ${configuration})
