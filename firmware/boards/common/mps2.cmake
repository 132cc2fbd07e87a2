# What the boards MPS2 have in common: all but the core.

include(${CMAKE_CURRENT_LIST_DIR}/images.cmake)

emax_add_board(
  INCLUDES
    ${CMAKE_CURRENT_LIST_DIR}/cmsdk/include
    ${CMAKE_CURRENT_LIST_DIR}/cortex_m/include
    ${CMAKE_CURRENT_LIST_DIR}/mps2/include
  SOURCES
    ${CMAKE_CURRENT_LIST_DIR}/cmsdk/src/cmsdk_clock.cpp
    ${CMAKE_CURRENT_LIST_DIR}/cmsdk/src/cmsdk_uart.cpp
    ${CMAKE_CURRENT_LIST_DIR}/cmsdk/src/cmsdk_watchdog.cpp
    ${CMAKE_CURRENT_LIST_DIR}/cortex_m/src/reset_cause.cpp
    ${CMAKE_CURRENT_LIST_DIR}/cortex_m/src/start.cpp
    ${CMAKE_CURRENT_LIST_DIR}/mps2/src/board.cpp)

emax_add_board_images()
