# Lists the runtime's sources, relative to the root, for the builds of the project, of lagc and of the wheel:
#   core_sources                in every FMU
#   fmi2_sources, fmi3_sources  in FMUs of this version of FMI
#   solver_sources              in FMUs whose system refers to them
get_filename_component(root ${CMAKE_CURRENT_LIST_DIR}/../.. ABSOLUTE)
set(core_rooms instance evaluation stepping fmi)
set(solver_rooms support methods methods/sundials detection nonsmooth nonsmooth/contacts nonsmooth/frictions nonsmooth/planes nonsmooth/cones nonsmooth/cones/interior nonsmooth/rests nonsmooth/sliding events time_steps timing)
set(fmi2_rooms fmi2)
set(fmi3_rooms fmi3)
foreach(part core solver fmi2 fmi3)
  list(TRANSFORM ${part}_rooms REPLACE "(.+)" "${root}/src/runtime/\\1/*.c" OUTPUT_VARIABLE patterns)
  file(GLOB ${part}_sources RELATIVE ${root} CONFIGURE_DEPENDS ${patterns})
endforeach()
