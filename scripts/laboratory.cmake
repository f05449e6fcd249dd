# What is the laboratory's own, as objects; with lagc's and the runtime's it derives systems and simulates them. Before it: scripts/lagc.cmake.
file(GLOB laboratory_sources CONFIGURE_DEPENDS ${root}/src/laboratory/*.c)
add_library(laboratory_parts OBJECT EXCLUDE_FROM_ALL ${laboratory_sources} ${root}/scripts/live_page/driver.c)
target_include_directories(laboratory_parts PRIVATE ${root}/src/laboratory ${root}/src/runtime)
target_link_libraries(laboratory_parts PRIVATE compiler)
