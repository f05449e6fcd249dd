# The runtime's sources, for CMakeLists.txt, lagc's and the wheel's, with paths from the root: core_sources, which every FMU has, and
# fmi2_sources or fmi3_sources, of its version of FMI; solver_sources, of which it has those that its system names.
get_filename_component(root ${CMAKE_CURRENT_LIST_DIR} DIRECTORY)
set(core_rooms instance evaluation stepping fmi)
set(solver_rooms support methods methods/sundials events contacts planes timing)
set(fmi2_rooms fmi2)
set(fmi3_rooms fmi3)
foreach(part core solver fmi2 fmi3)
  list(TRANSFORM ${part}_rooms REPLACE "(.+)" "${root}/src/runtime/\\1/*.c" OUTPUT_VARIABLE patterns)
  file(GLOB ${part}_sources RELATIVE ${root} CONFIGURE_DEPENDS ${patterns})
endforeach()
