# Reads CMakePresets.json, so that `check` builds what stands there and nothing has to be listed twice.

file(READ ${PROJECT_SOURCE_DIR}/CMakePresets.json EMAX_PRESETS)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/CMakePresets.json)

# emax_list_presets(<kind> <result>): the names of all presets of a kind, as buildPresets.
function(emax_list_presets kind result)
  set(names "")
  string(JSON count LENGTH "${EMAX_PRESETS}" ${kind})
  math(EXPR last "${count} - 1")
  foreach(i RANGE ${last})
    string(JSON name GET "${EMAX_PRESETS}" ${kind} ${i} name)
    list(APPEND names ${name})
  endforeach()
  set(${result} ${names} PARENT_SCOPE)
endfunction()

# emax_list_configurations(<result>): what is built in a tree of its own name, in the order of the file; not `check`
# itself, nor what builds in the tree of another.
function(emax_list_configurations result)
  emax_list_presets(buildPresets presets)
  set(configurations "")
  foreach(preset IN LISTS presets)
    emax_read_preset(${preset} configuration cacheVariables EMAX_CONFIGURATION)
    if(configuration STREQUAL "\${presetName}")
      list(APPEND configurations ${preset})
    endif()
  endforeach()
  set(${result} ${configurations} PARENT_SCOPE)
endfunction()

# emax_read_preset(<name> <result> <member>...)
# A member of a configure preset, as `cacheVariables EMAX_TESTS`, from itself or from whom it inherits; empty if nobody
# sets it.
function(emax_read_preset name result)
  emax_list_presets(configurePresets names)
  list(FIND names ${name} at)
  string(JSON value ERROR_VARIABLE missing GET "${EMAX_PRESETS}" configurePresets ${at} ${ARGN})
  if(missing)
    set(value "")
    string(JSON parent ERROR_VARIABLE orphan GET "${EMAX_PRESETS}" configurePresets ${at} inherits)
    if(NOT orphan)
      emax_read_preset(${parent} value ${ARGN})
    endif()
  endif()
  string(REPLACE "\${sourceDir}" "${PROJECT_SOURCE_DIR}" value "${value}")
  set(${result} "${value}" PARENT_SCOPE)
endfunction()
