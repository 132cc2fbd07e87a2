# What is known of a board is in its own folder, in board.cmake: this reads it.

set(EMAX_BOARDS ${PROJECT_SOURCE_DIR}/firmware/boards)
set(EMAX_BOARD_COMMON ${EMAX_BOARDS}/common)

# emax_declare_board(<keyword> <value>... ...)
# What a board.cmake calls; sets EMAX_BOARD_<keyword> for each of these. Files are relative to the board's folder.
#
#   CORE <core>            The processor that the toolchain file must be for, as cortex-m4f.
#   CLOCK_HZ <n>           What the board's clock counts: macro EMAX_BOARD_CLOCK_HZ.
#   INTERRUPTS <n>         How many numbers its interrupts have: macro EMAX_BOARD_INTERRUPTS.
#   SOURCES <file>...      Startup and drivers.
#   PRODUCT <file>         Makes what the board runs where that is no image with startup and memory map: nothing of
#                          common/images.cmake is then made, and of the four above only CORE is needed.
#   BUDGET <flash> <ram> <stack>  The most bytes that an image may take, for the gates. Flash is code, constants and what
#                          variables start with; RAM is all variables, without the stack and without what stands in for a
#                          flash memory of records; stack is the deepest that the call graph proves, interrupts and faults
#                          included. Without it: 286720 122880 8192, a chip with 128 KiB of RAM.
#   INTERRUPT_LEVELS <handlers>...  For each level of priority one text with the interrupt handlers that never interrupt one
#                          another, as "*::on_console *::on_clock", with * for any characters. The proof of the stack takes
#                          handlers of a Cortex-M that are in no text for ones that interrupt all others: their stacks add
#                          up. A text is a claim about what the image writes into the interrupt controller.
#   CHECK <file>           Adds the tests of such a product, for preset `check`.
#   INCLUDES <folder>...   Their headers.
#   SIMULATED_BENCH        The analog side is hal/sim, and about() tells what that was built from.
#   WATCHDOG               It has one.
#   SEMIHOSTING            Test images may call an emulator or debugger: there are test images.
#   RUNNER <word>...       Begins a command line that runs an image as if it were a program of this PC:
#                          <word>... [--console null|tcp:PORT] [--instruction-ns N] IMAGE [ARGUMENT...]. Without it,
#                          nothing of the board is run in the tests. common/qemu.py makes one of QEMU.
#   TELNET_BREAK           RUNNER's --console telnet:PORT passes on the break of that protocol.
#   FLASH <word>...        The command that puts the product on the board, with @IMAGE@ for its path: target `flash`. Then
#                          there are a .bin and a .hex of it, too.
#   COUNTER <file>         Counts instructions for the image of the costs (emax/board/instruction_counter.hpp),
#   INSTRUCTION_NS <n>     while the runner lets each take so much of the machine's time.
#   CORE_TITLE <word>      In the tables of firmware/README.md: the core,
#   TABLE_CLOCK_MHZ <n>    the clock of a chip that has it,
#   TABLE_LEFT_OUT <part>...  and parts of the costs that would take the runner minutes.
#   EXTRA_JOBS <job>...    Reports that are compared with those of the PC beside the usual ones (check_boards.cmake).
#   GOOGLETEST_MEMORY <file>  Memory map for the PC's tests as images: regions `code` and `ram`, of megabytes.
#   SLOW_TEST_S <s>        What of these takes longer is left out; slow_tests.txt in the board's folder lists it.
function(emax_declare_board)
  set(flags SIMULATED_BENCH WATCHDOG SEMIHOSTING TELNET_BREAK)
  set(values CORE PRODUCT CHECK CLOCK_HZ INTERRUPTS COUNTER INSTRUCTION_NS CORE_TITLE TABLE_CLOCK_MHZ GOOGLETEST_MEMORY SLOW_TEST_S)
  set(lists BUDGET INTERRUPT_LEVELS SOURCES INCLUDES RUNNER FLASH TABLE_LEFT_OUT EXTRA_JOBS)
  cmake_parse_arguments(PARSE_ARGV 0 arg "${flags}" "${values}" "${lists}")
  set(file ${EMAX_BOARD_FOLDER}/board.cmake)
  if(arg_UNPARSED_ARGUMENTS OR arg_KEYWORDS_MISSING_VALUES)
    message(FATAL_ERROR "${file}: unknown, or without a value: ${arg_UNPARSED_ARGUMENTS} ${arg_KEYWORDS_MISSING_VALUES}")
  endif()
  set(needed CORE)
  if(NOT arg_PRODUCT)
    list(APPEND needed CLOCK_HZ INTERRUPTS SOURCES)
  endif()
  foreach(keyword IN LISTS needed)
    if(NOT arg_${keyword})
      message(FATAL_ERROR "${file} does not declare ${keyword}")
    endif()
  endforeach()
  if(NOT arg_BUDGET)
    set(arg_BUDGET 286720 122880 8192)
  endif()
  if(NOT "${arg_BUDGET}" MATCHES "^[0-9]+;[0-9]+;[0-9]+$")
    message(FATAL_ERROR "${file}: BUDGET takes three numbers, of bytes of flash, RAM and stack")
  endif()
  emax_demand_with(CHECK PRODUCT)
  emax_demand_with(RUNNER SEMIHOSTING)
  emax_demand_with(GOOGLETEST_MEMORY RUNNER SLOW_TEST_S)
  emax_demand_with(COUNTER RUNNER SIMULATED_BENCH INSTRUCTION_NS CORE_TITLE TABLE_CLOCK_MHZ)
  foreach(keyword IN ITEMS SOURCES PRODUCT CHECK INCLUDES COUNTER GOOGLETEST_MEMORY)
    set(files ${arg_${keyword}})
    set(arg_${keyword} "")
    foreach(file IN LISTS files)
      get_filename_component(file ${file} ABSOLUTE BASE_DIR ${EMAX_BOARD_FOLDER})
      list(APPEND arg_${keyword} ${file})
    endforeach()
  endforeach()
  foreach(keyword IN LISTS flags values lists)
    set(EMAX_BOARD_${keyword} ${arg_${keyword}} PARENT_SCOPE)
  endforeach()
endfunction()

# In emax_declare_board(): who declares the first keyword must declare the others, too.
macro(emax_demand_with keyword)
  foreach(needed IN ITEMS ${ARGN})
    if(arg_${keyword} AND NOT arg_${needed})
      message(FATAL_ERROR "${file} declares ${keyword} without ${needed}")
    endif()
  endforeach()
endmacro()

# emax_read_board(<board>)
# Sets EMAX_BOARD_FOLDER, EMAX_BOARD_NAME and what the board declares. <board> is a folder of firmware/boards, or the
# path of one that is elsewhere, absolute or from the project's folder.
macro(emax_read_board board)
  if("${board}" MATCHES "/")
    get_filename_component(EMAX_BOARD_FOLDER "${board}" ABSOLUTE BASE_DIR ${PROJECT_SOURCE_DIR})
  else()
    set(EMAX_BOARD_FOLDER ${EMAX_BOARDS}/${board})
  endif()
  get_filename_component(EMAX_BOARD_NAME ${EMAX_BOARD_FOLDER} NAME)
  if(NOT EXISTS ${EMAX_BOARD_FOLDER}/board.cmake)
    emax_list_boards(EMAX_BOARD_CHOICE)
    list(JOIN EMAX_BOARD_CHOICE ", " EMAX_BOARD_CHOICE)
    message(FATAL_ERROR "EMAX_BOARD is '${board}', but there is no ${EMAX_BOARD_FOLDER}/board.cmake. "
                        "It is ${EMAX_BOARD_CHOICE}, or the path of a folder that has such a file.")
  endif()
  include(${EMAX_BOARD_FOLDER}/board.cmake)
endmacro()

# emax_list_boards(<result>): the boards of firmware/boards.
function(emax_list_boards result)
  file(GLOB boards RELATIVE ${EMAX_BOARDS} ${EMAX_BOARDS}/*/board.cmake)
  list(TRANSFORM boards REPLACE "/board.cmake$" "")
  set(${result} ${boards} PARENT_SCOPE)
endfunction()

if(NOT EMAX_BOARD)
  return()
endif()
emax_read_board("${EMAX_BOARD}")
if(NOT CMAKE_CROSSCOMPILING OR NOT CMAKE_SYSTEM_PROCESSOR STREQUAL EMAX_BOARD_CORE)
  message(FATAL_ERROR "EMAX_BOARD is '${EMAX_BOARD}' with a ${EMAX_BOARD_CORE}, but the toolchain is for "
                      "${CMAKE_SYSTEM_PROCESSOR}: --toolchain toolchains/${EMAX_BOARD_CORE}.cmake")
endif()
# So that ctest runs images.
set(CMAKE_CROSSCOMPILING_EMULATOR ${EMAX_BOARD_RUNNER})
