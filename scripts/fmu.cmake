# lagrange_add_fmu, for CMakeLists.txt and for projects that find the installed package. Before it: the targets lagrange-fmu::lagc
# and lagrange-fmu::icon, the target lagrange_runtime, which this machine's libraries are linked with, and the variables
# lagrange_global_names, a file with what nm says of the runtime, and lagrange_sundials, a folder of cross.py (or none).
get_filename_component(lagrange_root ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
find_program(zip zip REQUIRED)

# What no FMU needs is left out: unused functions, and tables to unwind the stack by, which C has no use for.
set(lagrange_compact -ffunction-sections -fdata-sections -fno-asynchronous-unwind-tables)
set(lagrange_exports ${lagrange_root}/src/runtime/fmi2/exports.map)
file(GLOB_RECURSE lagrange_sources CONFIGURE_DEPENDS ${lagrange_root}/include/*.h ${lagrange_root}/src/runtime/*.[ch])

# append_named_files(list file): the files that a system's file names, and those that they name, each once.
function(append_named_files list file)
  set(space "[ \t\r\n]")
  file(READ ${file} text)
  string(REGEX REPLACE "[][;]" " " text "${text}") # would mean something in lists
  string(REGEX MATCHALL "<(include|table|linearization)${space}[^>]*" elements "${text}")
  get_filename_component(directory ${file} DIRECTORY)
  foreach(element IN LISTS elements)
    if(element MATCHES "${space}(file|of)${space}*=${space}*[\"']([^\"']+)[\"']")
      get_filename_component(named ${CMAKE_MATCH_2} ABSOLUTE BASE_DIR ${directory})
      if(EXISTS ${named} AND NOT IS_DIRECTORY ${named} AND NOT named IN_LIST ${list})
        list(APPEND ${list} ${named})
        append_named_files(${list} ${named})
      endif()
    endif()
  endforeach()
  set(${list} ${${list}} PARENT_SCOPE)
endfunction()

# find_platform(platform): sets lagrange_zig to a Python with the package ziglang, and lagrange_suffix_PLATFORM to what its libraries
# end in, once for all FMUs.
function(find_platform platform)
  find_program(LAGRANGE_PYTHON python3 HINTS ${lagrange_root}/build/venv/bin DOC "A Python with the package ziglang, for other platforms")
  if(NOT lagrange_suffix_${platform} OR NOT "${lagrange_zig}" STREQUAL LAGRANGE_PYTHON)
    execute_process(COMMAND ${LAGRANGE_PYTHON} ${lagrange_root}/scripts/cross.py suffix ${platform}
                    RESULT_VARIABLE status OUTPUT_VARIABLE suffix ERROR_VARIABLE words OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT status EQUAL 0)
      message(FATAL_ERROR "${words} (LAGRANGE_PYTHON is ${LAGRANGE_PYTHON})")
    endif()
    set(lagrange_zig ${LAGRANGE_PYTHON} CACHE INTERNAL "A Python with the package ziglang")
    set(lagrange_suffix_${platform} ${suffix} CACHE INTERNAL "What libraries of the platform end in")
  endif()
endfunction()

# add_platform_libraries(list name folder platforms): for each platform the library of folder/system.c by cross.py, added to the list.
function(add_platform_libraries list name folder platforms)
  if(EXISTS "${lagrange_sundials}")
    set(sundials --sundials ${lagrange_sundials})
  endif()
  foreach(platform ${platforms})
    find_platform(${platform})
    set(library ${folder}/platforms/${platform}/${name}${lagrange_suffix_${platform}})
    add_custom_command(OUTPUT ${library}
                       COMMAND ${lagrange_zig} ${lagrange_root}/scripts/cross.py fmu ${platform} ${folder}/system.c ${library} ${sundials}
                       DEPENDS ${folder}/system.c ${lagrange_sources} ${lagrange_root}/scripts/cross.py
                       COMMENT "Compiling ${name} for ${platform}" VERBATIM)
    list(APPEND ${list} ${library})
  endforeach()
  set(${list} ${${list}} PARENT_SCOPE)
endfunction()

# lagrange_add_fmu(NAME SYSTEM.xml [PLATFORMS platform...] [SOLVER method] [FORM form]) builds fmu/NAME.fmu in the folder that CMake builds
# the current one in; NAME is the one in SYSTEM.xml, as pack.cmake checks.
#   PLATFORMS  of linux64 (glibc 2.17 or newer), win64, darwin64 (both processors) and aarch64-linux, by zig; none: this machine alone, by
#              the project's compiler
#   SOLVER     a method of <solver> in place of the system's own, where there is anything that moves
#   FORM       statements or tables, in place of the form that follows from the system's size
# The targets are fmu_NAME and, for this machine's library, system_NAME, since a system may be named like another target.
function(lagrange_add_fmu name system)
  cmake_parse_arguments(PARSE_ARGV 2 fmu "" "SOLVER;FORM" "PLATFORMS")
  if(fmu_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "lagrange_add_fmu(${name}): unknown words '${fmu_UNPARSED_ARGUMENTS}'; expected PLATFORMS, SOLVER or FORM")
  endif()
  get_filename_component(system ${system} ABSOLUTE)
  if(NOT EXISTS ${system})
    message(FATAL_ERROR "lagrange_add_fmu(${name}): there is no ${system}; expected the file of a system")
  endif()
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/systems/${name})
  set(dependencies ${system})
  append_named_files(dependencies ${system})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${dependencies})
  set(text "")
  foreach(file IN LISTS dependencies)
    file(READ ${file} part)
    string(APPEND text "${part}")
  endforeach()
  if(fmu_SOLVER AND text MATCHES "<(coordinate|linearization|robot)[ \t\r\n]")
    set(solver --solver ${fmu_SOLVER})
  endif()
  if(fmu_FORM)
    set(form --form ${fmu_FORM})
  endif()
  add_custom_command(OUTPUT ${folder}/system.c
                     BYPRODUCTS ${folder}/modelDescription.xml ${folder}/documentation/index.html
                     COMMAND lagrange-fmu::lagc ${system} -o ${folder} ${solver} ${form}
                     DEPENDS lagrange-fmu::lagc ${dependencies}
                     COMMENT "Deriving ${name}" VERBATIM)

  # This machine's library also draws model.png.
  set(library system_${name})
  add_library(${library} MODULE ${folder}/system.c)
  set_target_properties(${library} PROPERTIES OUTPUT_NAME ${name} PREFIX "" C_VISIBILITY_PRESET hidden C_STANDARD 11
                        LIBRARY_OUTPUT_DIRECTORY ${folder}/binaries/linux64)
  # Generated functions of one type take arguments that not all of them need.
  target_compile_options(${library} PRIVATE -Wno-unused-parameter -falign-functions=64 ${lagrange_compact})
  target_link_libraries(${library} PRIVATE lagrange_runtime m)
  target_link_options(${library} PRIVATE -Wl,--gc-sections -Wl,--exclude-libs,ALL -Wl,--as-needed -Wl,--build-id=none
                      "SHELL:-Xlinker \"-Map=${folder}/link.map\"" "SHELL:-Xlinker \"--version-script=${lagrange_exports}\"")
  if(NOT SANITIZE)
    target_link_options(${library} PRIVATE -s -Wl,--no-undefined)
  endif()
  set_property(TARGET ${library} PROPERTY LINK_DEPENDS ${lagrange_exports})

  set(libraries)
  if(fmu_PLATFORMS)
    add_platform_libraries(libraries ${name} ${folder} "${fmu_PLATFORMS}")
  endif()
  set(fmu ${CMAKE_CURRENT_BINARY_DIR}/fmu/${name}.fmu)
  set(scripts ${lagrange_root}/scripts)
  add_custom_command(OUTPUT ${fmu}
                     COMMAND ${CMAKE_COMMAND} -D FOLDER=${folder} -D LIBRARY=$<TARGET_FILE:${library}> "-D LIBRARIES=${libraries}" -D FMU=${fmu}
                             -D SYSTEM=${system} -D SOURCE=${lagrange_root} -D ICON=$<TARGET_FILE:lagrange-fmu::icon> -D ZIP=${zip}
                             -D NAMES=${lagrange_global_names} -P ${scripts}/pack.cmake
                     DEPENDS lagrange-fmu::icon ${library} ${libraries} ${folder}/system.c ${lagrange_global_names} ${scripts}/pack.cmake
                             ${scripts}/archive.cmake ${scripts}/one_file.cmake
                     COMMENT "Packing ${name}.fmu" VERBATIM)
  add_custom_target(fmu_${name} ALL DEPENDS ${fmu})
endfunction()
