# The image that counts instructions, with the board's counter.

set(cost ${CMAKE_CURRENT_LIST_DIR})
emax_add_image(${product}_cost
  ${cost}/cost_main.cpp
  ${cost}/energies.cpp
  ${cost}/evaluations.cpp
  ${cost}/kernels.cpp
  ${cost}/sweep_cost.cpp
  ${EMAX_BOARD_COUNTER}
  LIBRARIES emax_board_test)
target_include_directories(${product}_cost PRIVATE ${cost})
