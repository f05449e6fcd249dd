# lagc, for CMakeLists.txt and the wheel's. Before it: libxml2 found.
get_filename_component(root ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
include(${CMAKE_CURRENT_LIST_DIR}/runtime.cmake)

# The schema becomes a string in the program.
file(READ ${root}/fmu/system.xsd schema HEX)
string(REGEX REPLACE "(..)" "0x\\1," schema "${schema}")
file(CONFIGURE OUTPUT system_schema.c CONTENT
     "extern const char system_schema[];\nconst char system_schema[] = {${schema}0};\n" @ONLY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${root}/fmu/system.xsd)

# So do the names of the runtime's sources, and its rooms that every FMU has, for FMUs that carry their sources.
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

file(GLOB_RECURSE compiler_sources CONFIGURE_DEPENDS ${root}/src/compiler/*.c ${root}/modelDescription/*.c)
list(REMOVE_ITEM compiler_sources ${root}/src/compiler/main.c)
add_library(compiler STATIC EXCLUDE_FROM_ALL ${compiler_sources} ${CMAKE_BINARY_DIR}/system_schema.c
            ${CMAKE_BINARY_DIR}/runtime_sources.c)
target_compile_definitions(compiler PUBLIC _XOPEN_SOURCE=700)
target_include_directories(compiler PUBLIC ${root}/include ${root}/src/compiler ${root}/modelDescription)
target_include_directories(compiler SYSTEM PUBLIC ${LIBXML2_INCLUDE_DIRS})
target_link_libraries(compiler PUBLIC ${LIBXML2_LIBRARIES} m)

if(NOT LAGC)
  add_executable(lagc ${root}/src/compiler/main.c)
  target_link_libraries(lagc PRIVATE compiler)
  target_compile_definitions(lagc PRIVATE LAGC_VERSION="${PROJECT_VERSION}")
endif()
