# lagc and the runtime as one module, which derives systems and simulates them. Before it: scripts/lagc.cmake.
set(laboratory_runtime ${core_sources} ${fmi2_sources} ${solver_sources})
list(FILTER laboratory_runtime EXCLUDE REGEX "/sundials/")
list(TRANSFORM laboratory_runtime PREPEND ${root}/)
file(GLOB laboratory_sources CONFIGURE_DEPENDS ${root}/src/laboratory/*.c)
# The system of the runtime is not there when it is compiled.
add_library(laboratory_runtime OBJECT EXCLUDE_FROM_ALL ${laboratory_runtime})
target_compile_definitions(laboratory_runtime PRIVATE "lagrangian=(*system_in_memory)")
target_include_directories(laboratory_runtime PRIVATE ${root}/include ${root}/src/runtime)
add_library(laboratory_parts OBJECT EXCLUDE_FROM_ALL ${laboratory_sources} ${root}/scripts/live_page/driver.c)
target_include_directories(laboratory_parts PRIVATE ${root}/src/laboratory ${root}/src/runtime)
target_link_libraries(laboratory_parts PRIVATE compiler)
