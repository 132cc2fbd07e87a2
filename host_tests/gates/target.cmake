# Proof that the gates on images refuse bad ones: each is a good image with one fault.

if(NOT TARGET emax_board_test)
  return()
endif()

set(sections ${EMAX_BOARD_COMMON}/sections.ld)
set(memory ${EMAX_BOARD_FOLDER}/memory.ld)
set(images "")
set(CMAKE_CXX_STANDARD_LIBRARIES "-lc -lgcc")

# Of a board, but for the fault.
foreach(image IN ITEMS 
    good_image bad_array bad_depth bad_growth bad_hidden_depth bad_member_pointer bad_pointer bad_recursion bad_semihosting
    bad_virtual_recursion)
  add_executable(${image} ${image}.cpp)
  target_link_libraries(${image} PRIVATE emax_board emax_firmware)
  target_link_options(${image} PRIVATE -nodefaultlibs -T${memory} -T${sections} LINKER:--emit-relocs)
  if(image STREQUAL "bad_semihosting")
    target_link_libraries(${image} PRIVATE emax_board_test)
  else()
    target_sources(${image} PRIVATE ${EMAX_BOARD_COMMON}/src/stop_and_wait.cpp)
  endif()
  list(APPEND images $<TARGET_FILE:${image}>)
endforeach()

# What these need is given by name only, and the board's linker script would refuse some of them. No flags of ours: a
# freestanding build would not even compile some of them.
set(needed_by_bad_exception __cxa_allocate_exception __cxa_throw _ZTIi)
set(needed_by_bad_heap _Znwj)
set(needed_by_bad_libm exp)
set(needed_by_bad_static __cxa_guard_acquire __cxa_guard_release)
set(needed_by_bad_stdio printf)
foreach(image IN ITEMS
    bad_contraction bad_exception bad_heap bad_initialiser bad_libm bad_operator_new bad_static bad_stdio
    bad_thread_local)
  add_executable(${image} ${image}.cpp)
  list(TRANSFORM needed_by_${image} REPLACE "(.+)" "LINKER:--defsym=\\1=0" OUTPUT_VARIABLE needed)
  target_link_options(${image} PRIVATE
    -nostartfiles -nostdlib -T${CMAKE_CURRENT_SOURCE_DIR}/bad_image.ld ${needed}
    LINKER:--entry=0x80000000,--no-gc-sections,--unresolved-symbols=ignore-all,--no-warn-rwx-segments)
  list(APPEND images $<TARGET_FILE:${image}>)
endforeach()
# With interrupts of its own, which the board's vectors have no place for.
add_executable(bad_nesting bad_nesting.cpp)
target_compile_options(bad_nesting PRIVATE -O2 -ffreestanding -fcallgraph-info=su)
target_link_options(bad_nesting PRIVATE -nostartfiles -nostdlib -T${CMAKE_CURRENT_SOURCE_DIR}/bad_image.ld
  LINKER:--entry=main,--no-gc-sections,--emit-relocs,--no-warn-rwx-segments)
list(APPEND images $<TARGET_FILE:bad_nesting>)
target_compile_options(bad_contraction PRIVATE -O2 -ffp-contract=fast)

set(folders "")
emax_collect_callgraphs(emax_board folders)
set(test ${EMAX_CONFIGURATION}.gates.refuse_bad_images)
add_test(NAME ${test}
  COMMAND ${EMAX_PYTHON} -B ${CMAKE_CURRENT_SOURCE_DIR}/test_images.py --gates ${EMAX_GATES} --objdump ${CMAKE_OBJDUMP}
    --levels ${EMAX_BOARD_INTERRUPT_LEVELS} --callgraph ${folders} --images ${images}
  COMMAND_EXPAND_LISTS)
set_tests_properties(${test} PROPERTIES TIMEOUT ${EMAX_TEST_TIMEOUT} LABELS ${EMAX_CONFIGURATION})
