# Defines the targets compiler and lagc, for the builds of the project and of the wheel. Requires LIBXML2_LIBRARIES and LIBXML2_INCLUDE_DIRS.
get_filename_component(root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
include(${CMAKE_CURRENT_LIST_DIR}/runtime.cmake)

# add_string(NAME FILE...): writes NAME.c, which defines the content of the files as a string: the schema, and the style and script of an FMU's
# page. The documentation in the schema is for editors and for the site, and left out; likewise comments and indents of scripts.
function(add_string name)
  set(text "")
  foreach(file ${ARGN})
    file(READ ${root}/${file} content)
    if(file MATCHES "[.]js$")
      string(REGEX REPLACE "\n *//[^\n]*" "" content "\n${content}")
      string(REGEX REPLACE "\n *" "\n" content "${content}")
    endif()
    string(APPEND text "${content}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${root}/${file})
  endforeach()
  string(REGEX REPLACE "\n *<xs:annotation>[^\n]*</xs:annotation>" "" text "${text}")
  string(HEX "${text}" bytes)
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
  file(CONFIGURE OUTPUT ${name}.c CONTENT "extern const char ${name}[];\nconst char ${name}[] = {${bytes}0};\n" @ONLY)
endfunction()
add_string(system_schema fmu/system.xsd)
add_string(page_style modelDescription/page/page.css)
add_string(page_script modelDescription/page/mathml.js modelDescription/page/sketch.js modelDescription/page/page.js)
add_string(license_text LICENSE)

# list_of_names(LIST VARIABLE): sets VARIABLE to C that defines LIST as an array of strings, which ends with a null pointer.
# FMUs that contain their sources need the names of the runtime's sources, and of the rooms that every FMU has.
function(list_of_names list variable)
  list(TRANSFORM ${list} REPLACE "(.+)" "\"\\1\", " OUTPUT_VARIABLE names)
  list(JOIN names "" names)
  set(${variable} "extern const char *const ${list}[];\nconst char *const ${list}[] = {${names}(const char *)0};\n" PARENT_SCOPE)
endfunction()
set(runtime_sources ${core_sources} ${solver_sources})
list(TRANSFORM runtime_sources REPLACE "^src/runtime/" "")
list_of_names(runtime_sources sources)
list_of_names(core_rooms rooms)
file(CONFIGURE OUTPUT runtime_sources.c CONTENT "${sources}${rooms}" @ONLY)

file(GLOB_RECURSE compiler_sources CONFIGURE_DEPENDS ${root}/src/import/*.c ${root}/src/compiler/*.c ${root}/modelDescription/*.c)
list(REMOVE_ITEM compiler_sources ${root}/src/compiler/main.c)
add_library(compiler STATIC EXCLUDE_FROM_ALL ${compiler_sources} ${CMAKE_BINARY_DIR}/system_schema.c
            ${CMAKE_BINARY_DIR}/page_style.c ${CMAKE_BINARY_DIR}/page_script.c
            ${CMAKE_BINARY_DIR}/license_text.c ${CMAKE_BINARY_DIR}/runtime_sources.c)
target_compile_definitions(compiler PUBLIC _XOPEN_SOURCE=700 LAGC_VERSION="${PROJECT_VERSION}")
target_include_directories(compiler PUBLIC ${root}/include ${root}/src/compiler ${root}/src/import ${root}/modelDescription)
target_include_directories(compiler SYSTEM PUBLIC ${LIBXML2_INCLUDE_DIRS})
target_link_libraries(compiler PUBLIC ${LIBXML2_LIBRARIES} m)

if(NOT LAGC)
  add_executable(lagc ${root}/src/compiler/main.c)
  target_link_libraries(lagc PRIVATE compiler)
endif()
