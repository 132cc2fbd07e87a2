# The image that counts instructions, of whichever board includes this.

set(cost ${CMAKE_CURRENT_LIST_DIR})
if(EMAX_BOARD MATCHES "^mps2_")
  set(counter ${cost}/cmsdk_counter.cpp)
else()
  set(counter ${cost}/riscv_counter.cpp)
endif()
emax_add_image(emax_${EMAX_BOARD}_cost
  ${cost}/cost_main.cpp
  ${cost}/energies.cpp
  ${cost}/evaluations.cpp
  ${cost}/kernels.cpp
  ${cost}/sweep_cost.cpp
  ${counter}
  LIBRARIES emax_board_test)
target_include_directories(emax_${EMAX_BOARD}_cost PRIVATE ${cost})
