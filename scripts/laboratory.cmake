# lagc and the runtime as one module, which derives systems and simulates them: the objects of the target laboratory_parts. Before
# it: scripts/lagc.cmake.
set(laboratory_runtime ${core_sources} ${fmi2_sources} ${solver_sources})
list(FILTER laboratory_runtime EXCLUDE REGEX "/sundials/")
list(TRANSFORM laboratory_runtime PREPEND ${root}/)
file(GLOB laboratory_sources CONFIGURE_DEPENDS ${root}/src/laboratory/*.c)
add_library(laboratory_parts OBJECT EXCLUDE_FROM_ALL ${laboratory_runtime} ${laboratory_sources} ${root}/scripts/live_page/driver.c)
# When the runtime is compiled there is no system yet.
set_source_files_properties(${laboratory_runtime} PROPERTIES COMPILE_DEFINITIONS "lagrangian=(*system_in_memory)")
target_include_directories(laboratory_parts PRIVATE ${root}/src/laboratory ${root}/src/runtime)
target_link_libraries(laboratory_parts PRIVATE compiler)
