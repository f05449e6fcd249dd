# Defines laboratory_parts, the laboratory's own objects; linked with lagc and the runtime they derive and simulate systems.
# Requires scripts/package/lagc.cmake.
file(GLOB laboratory_sources CONFIGURE_DEPENDS ${root}/src/laboratory/*.c)
add_library(laboratory_parts OBJECT EXCLUDE_FROM_ALL ${laboratory_sources} ${root}/scripts/library/live_page/driver.c)
target_include_directories(laboratory_parts PRIVATE ${root}/src/laboratory ${root}/src/runtime)
target_link_libraries(laboratory_parts PRIVATE compiler)
