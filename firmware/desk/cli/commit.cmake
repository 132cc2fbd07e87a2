# Writes FILE, the source of desk/cli/commit.hpp, if it differs from what is there:
# cmake -D SOURCE=<of the project> -D FILE=<commit.cpp> -P commit.cmake
# Without git, or in a tree that is no repository of its own, there is no commit.

set(commit "")
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE} rev-parse --show-toplevel
    OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(top STREQUAL SOURCE)
    execute_process(COMMAND ${git} -C ${SOURCE} describe --always --dirty=\ and\ changes --abbrev=10 --exclude=*
      OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
    if(result EQUAL 0)
      set(commit "${described}")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT ${FILE} @ONLY CONTENT [[// Made by the build.
#include "desk/cli/commit.hpp"

namespace emax::desk {

const char* commit() noexcept { return "@commit@"; }

}  // namespace emax::desk
]])
