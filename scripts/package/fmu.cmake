# Defines lagrange_add_fmu(), for CMakeLists.txt and for projects that find the installed package. Requires
#   lagrange-fmu::lagc     the target of lagc
#   lagrange_runtime       the target with which this machine's libraries are linked
#   lagrange_global_names  a file with the output of nm for the runtime
#   lagrange_licenses      the folder of collect_licenses()
#   lagrange_sundials      the folder of cross.py sundials, which may be missing
get_filename_component(lagrange_root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
find_program(python python3 REQUIRED)
set(lagrange_pack ${python} -B -m scripts.package.pack) # in ${lagrange_root}

# Removes unused functions, and tables for unwinding the stack, which C does not need.
set(lagrange_compact -ffunction-sections -fdata-sections -fno-asynchronous-unwind-tables)
file(GLOB_RECURSE lagrange_sources CONFIGURE_DEPENDS ${lagrange_root}/include/*.h ${lagrange_root}/src/runtime/*.[ch])

# append_named_files(LIST FILE): appends the files that a system's file names, and recursively those that they name, each once.
function(append_named_files list file)
  set(space "[ \t\r\n]")
  file(READ ${file} text)
  string(REGEX REPLACE "[][;]" " " text "${text}") # brackets and semicolons have a meaning in lists
  string(REGEX MATCHALL "<(include|table|linearization|shape|mesh)${space}[^>]*" elements "${text}")
  get_filename_component(directory ${file} DIRECTORY)
  foreach(element IN LISTS elements)
    if(element MATCHES "${space}(file|of|filename)${space}*=${space}*[\"']([^\"']+)[\"']")
      get_filename_component(named ${CMAKE_MATCH_2} ABSOLUTE BASE_DIR ${directory})
      if(EXISTS ${named} AND NOT IS_DIRECTORY ${named} AND NOT named IN_LIST ${list})
        list(APPEND ${list} ${named})
        if(NOT named MATCHES "\\.([Ss][Tt][Ll]|[Oo][Bb][Jj])$")
          append_named_files(${list} ${named})
        endif()
      endif()
    endif()
  endforeach()
  set(${list} ${${list}} PARENT_SCOPE)
endfunction()

# find_platform(PLATFORM VERSION): sets lagrange_zig to a Python with the package ziglang, and lagrange_libraries_PLATFORM_VERSION to the
# paths in binaries/ of the platform's libraries of an FMU named NAME; computed once for all FMUs.
function(find_platform platform version)
  find_program(LAGRANGE_PYTHON python3 HINTS ${lagrange_root}/build/venv/bin DOC "A Python with the package ziglang, for other platforms")
  if(NOT lagrange_libraries_${platform}_${version} OR NOT "${lagrange_zig}" STREQUAL LAGRANGE_PYTHON)
    execute_process(COMMAND ${LAGRANGE_PYTHON} ${lagrange_root}/scripts/package/cross.py libraries ${platform} NAME --fmi ${version}
                    RESULT_VARIABLE status OUTPUT_VARIABLE libraries ERROR_VARIABLE words OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT status EQUAL 0)
      message(FATAL_ERROR "${words} (LAGRANGE_PYTHON is ${LAGRANGE_PYTHON})")
    endif()
    set(lagrange_zig ${LAGRANGE_PYTHON} CACHE INTERNAL "A Python with the package ziglang")
    set(lagrange_libraries_${platform}_${version} "${libraries}" CACHE INTERNAL "The platform's libraries of FMUs")
  endif()
endfunction()

# add_platform_libraries(LIST NAME VERSION FOLDER PLATFORMS): compiles FOLDER/system.c with cross.py for each platform, and appends the
# libraries to LIST.
function(add_platform_libraries list name version folder platforms)
  if(EXISTS "${lagrange_sundials}")
    set(sundials --sundials ${lagrange_sundials})
  endif()
  file(GLOB adapter ${lagrange_root}/scripts/package/wasm_component/*)
  foreach(platform ${platforms})
    find_platform(${platform} ${version})
    set(binaries ${folder}/platforms${version})
    string(REPLACE NAME ${name} outputs "${lagrange_libraries_${platform}_${version}}")
    list(TRANSFORM outputs PREPEND ${binaries}/)
    add_custom_command(OUTPUT ${outputs}
                       COMMAND ${lagrange_zig} ${lagrange_root}/scripts/package/cross.py fmu ${platform} ${folder}/system.c ${binaries} ${name}
                               --fmi ${version} ${sundials}
                       DEPENDS ${folder}/system.c ${lagrange_sources} ${lagrange_root}/scripts/package/cross.py ${adapter}
                       COMMENT "Compiling ${name} of FMI ${version} for ${platform}" VERBATIM)
    list(APPEND ${list} ${outputs})
  endforeach()
  set(${list} ${${list}} PARENT_SCOPE)
endfunction()

# add_library_here(NAME VERSION FOLDER): compiles this machine's library of an FMU of this version of FMI, with the project's compiler.
function(add_library_here name version folder)
  set(library system_${name})
  set(binaries linux64)
  set(map link.map)
  if(version EQUAL 3)
    set(library system_3_${name})
    set(binaries x86_64-linux)
    set(map link3.map)
  endif()
  set(exports ${lagrange_root}/src/runtime/fmi${version}/exports.map)
  add_library(${library} MODULE $<TARGET_OBJECTS:equations_${name}>)
  set_target_properties(${library} PROPERTIES OUTPUT_NAME ${name} PREFIX "" LINKER_LANGUAGE C C_VISIBILITY_PRESET hidden C_STANDARD 11
                        LIBRARY_OUTPUT_DIRECTORY ${folder}/binaries/${binaries})
  target_compile_options(${library} PRIVATE ${lagrange_compact})
  target_link_libraries(${library} PRIVATE lagrange_runtime lagrange_fmi${version} m)
  target_link_options(${library} PRIVATE -Wl,--gc-sections -Wl,--exclude-libs,ALL -Wl,--as-needed -Wl,--build-id=none
                      "SHELL:-Xlinker \"-Map=${folder}/${map}\"" "SHELL:-Xlinker \"--version-script=${exports}\"")
  if(NOT SANITIZE)
    target_link_options(${library} PRIVATE -s -Wl,--no-undefined)
  endif()
  set_property(TARGET ${library} PROPERTY LINK_DEPENDS ${exports})
endfunction()

# add_archive(NAME VERSION FOLDER SYSTEM PLATFORMS): packs fmu/NAME.fmu, or fmi3/NAME.fmu.
function(add_archive name version folder system platforms)
  set(library system_${name})
  set(target fmu_${name})
  set(fmu ${CMAKE_CURRENT_BINARY_DIR}/fmu/${name}.fmu)
  if(version EQUAL 3)
    set(library system_3_${name})
    set(target fmu_3_${name})
    set(fmu ${CMAKE_CURRENT_BINARY_DIR}/fmi3/${name}.fmu)
  endif()
  if(platforms)
    add_platform_libraries(libraries ${name} ${version} ${folder} "${platforms}")
  else()
    set(libraries $<TARGET_FILE:${library}>)
  endif()
  set(scripts ${lagrange_root}/scripts/package)
  add_custom_command(OUTPUT ${fmu}
                     COMMAND ${lagrange_pack} fmu ${folder} ${version} ${fmu} --libraries ${libraries} --names ${lagrange_global_names}
                             --licenses ${lagrange_licenses} --system ${system}
                     DEPENDS ${libraries} ${folder}/system.c ${lagrange_global_names} ${scripts}/pack.py ${scripts}/one_file.py
                             ${lagrange_root}/LICENSE
                     WORKING_DIRECTORY ${lagrange_root} COMMENT "Packing ${name}.fmu of FMI ${version}" VERBATIM)
  add_custom_target(${target} ALL DEPENDS ${fmu})
  add_dependencies(${target} derive_${name}) # otherwise each FMU would derive the system
endfunction()

# lagrange_add_fmu(NAME SYSTEM.xml [PLATFORMS platform...] [FMI_VERSIONS version...] [SOLVER method] [FORM form] [ARRAYS] [ROBOT word=value...])
# builds fmu/NAME.fmu for FMI 2, and fmi3/NAME.fmu for FMI 3, in the current binary folder. NAME must be the name in SYSTEM.xml; pack.py
# checks this.
#   PLATFORMS     linux64 (glibc 2.17 or newer), win64, darwin64 (both processors), aarch64-linux, and for FMI 3 wasm32, compiled by zig;
#                 default: this machine, by the project's compiler
#   FMI_VERSIONS  2, 3 or both; default: 2
#   SOLVER        a method of <solver> in place of the own one of a system with coordinates or states
#   FORM          statements or tables; default: chosen by the system's size
#   ARRAYS        variables that <for> repeats are arrays in FMI 3.0, not scalars
#   ROBOT         options for the file of a robot, such as base=floating
# The targets are fmu_NAME, fmu_3_NAME and, for this machine's library, system_NAME; the prefixes avoid clashes with other targets.
function(lagrange_add_fmu name system)
  cmake_parse_arguments(PARSE_ARGV 2 fmu "ARRAYS" "SOLVER;FORM" "PLATFORMS;FMI_VERSIONS;ROBOT")
  if(fmu_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "lagrange_add_fmu(${name}): unknown words '${fmu_UNPARSED_ARGUMENTS}'; expected PLATFORMS, FMI_VERSIONS, SOLVER, FORM, ARRAYS or ROBOT")
  endif()
  if(NOT fmu_FMI_VERSIONS)
    set(fmu_FMI_VERSIONS 2)
  endif()
  list(REMOVE_DUPLICATES fmu_FMI_VERSIONS)
  foreach(version ${fmu_FMI_VERSIONS})
    if(NOT version MATCHES "^[23]$")
      message(FATAL_ERROR "lagrange_add_fmu(${name}): there is no version ${version} of FMI here; expected 2, 3 or both")
    endif()
  endforeach()
  get_filename_component(system ${system} ABSOLUTE)
  if(NOT EXISTS ${system})
    message(FATAL_ERROR "lagrange_add_fmu(${name}): there is no ${system}; expected the file of a system")
  endif()
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/systems/${name})
  set(dependencies ${system})
  append_named_files(dependencies ${system})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${dependencies})
  if(fmu_SOLVER)
    set(solver --solver ${fmu_SOLVER})
  endif()
  if(fmu_FORM)
    set(form --form ${fmu_FORM})
  endif()
  if(fmu_ARRAYS)
    set(arrays --arrays)
  endif()
  set(robot)
  foreach(word ${fmu_ROBOT})
    list(APPEND robot --robot ${word})
  endforeach()
  add_custom_command(OUTPUT ${folder}/system.c
                     BYPRODUCTS ${folder}/modelDescription.xml ${folder}/documentation/index.html ${folder}/model.png
                     COMMAND lagrange-fmu::lagc ${system} -o ${folder} ${solver} ${form} ${arrays} ${robot}
                     DEPENDS lagrange-fmu::lagc ${dependencies}
                     COMMENT "Deriving ${name}" VERBATIM)
  add_custom_target(derive_${name} DEPENDS ${folder}/system.c)

  add_library(equations_${name} OBJECT ${folder}/system.c)
  add_dependencies(equations_${name} derive_${name})
  set_target_properties(equations_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON C_VISIBILITY_PRESET hidden C_STANDARD 11)
  # Generated functions of one type have the same arguments, which some of them do not use.
  target_compile_options(equations_${name} PRIVATE -Wno-unused-parameter -falign-functions=64 ${lagrange_compact})
  target_link_libraries(equations_${name} PRIVATE lagrange_runtime)

  add_library_here(${name} 2 ${folder})
  if(3 IN_LIST fmu_FMI_VERSIONS AND NOT fmu_PLATFORMS)
    add_library_here(${name} 3 ${folder})
  endif()
  foreach(version ${fmu_FMI_VERSIONS})
    add_archive(${name} ${version} ${folder} ${system} "${fmu_PLATFORMS}")
  endforeach()
endfunction()
