# Installs lagc, its man page, and a CMake package; the folder of the package has the needed files of the tree under the same paths.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_DATADIR}/lagrange-fmu)
install(PROGRAMS $<TARGET_FILE:lagc> DESTINATION ${CMAKE_INSTALL_BINDIR})
install(FILES src/compiler/lagc.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES LICENSE DESTINATION ${package})
install(DIRECTORY include DESTINATION ${package} FILES_MATCHING PATTERN "*.h")
install(DIRECTORY src/runtime DESTINATION ${package}/src FILES_MATCHING PATTERN "*.[ch]" PATTERN "*.map")
file(GLOB pages fmu/*.md)
install(FILES fmu/system.xsd ${pages} DESTINATION ${package}/fmu)
foreach(file fmu.cmake pack.py one_file.py cross.py)
  install(FILES scripts/package/${file} DESTINATION ${package}/scripts/package)
endforeach()
install(FILES scripts/requirements/platforms.txt DESTINATION ${package}/scripts/requirements)
install(DIRECTORY scripts/package/wasm_component DESTINATION ${package}/scripts/package PATTERN __pycache__ EXCLUDE)
install(FILES ${lagrange_global_names} DESTINATION ${package})
install(DIRECTORY ${lagrange_licenses} DESTINATION ${package})
# SUNDIALS for all platforms, for erk and bdf, if scripts/package/sundials-all has built it.
install(DIRECTORY ${lagrange_sundials} DESTINATION ${package} OPTIONAL)
configure_package_config_file(scripts/package/lagrange-fmu-config.cmake.in lagrange-fmu-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/lagrange-fmu
                              PATH_VARS package CMAKE_INSTALL_BINDIR)
write_basic_package_version_file(lagrange-fmu-config-version.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${CMAKE_BINARY_DIR}/lagrange-fmu-config.cmake ${CMAKE_BINARY_DIR}/lagrange-fmu-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/lagrange-fmu)
