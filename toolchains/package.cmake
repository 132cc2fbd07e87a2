# Installs the libraries for other people's firmware: find_package(emax CONFIG), then emax::algo and emax::hal.

include(CMakePackageConfigHelpers)

# The version that reports and files carry.
file(STRINGS ${PROJECT_SOURCE_DIR}/firmware/app/include/emax/app/base/version.hpp version_line REGEX "kVersion")
string(REGEX MATCH "[0-9]+[.][0-9]+[.][0-9]+" version "${version_line}")

set_target_properties(emax_arithmetic PROPERTIES EXPORT_NAME arithmetic)
install(TARGETS emax_arithmetic emax_base emax_algo emax_hal EXPORT emax)
install(DIRECTORY algo/include/ hal/include/ DESTINATION include)

set(package lib/cmake/emax)
install(EXPORT emax NAMESPACE emax:: FILE emax-targets.cmake DESTINATION ${package})
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/emax-config.cmake @ONLY CONTENT
  [[include("${CMAKE_CURRENT_LIST_DIR}/emax-targets.cmake")
]])
write_basic_package_version_file(${PROJECT_BINARY_DIR}/emax-config-version.cmake
  VERSION ${version} COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/emax-config.cmake ${PROJECT_BINARY_DIR}/emax-config-version.cmake
  DESTINATION ${package})
