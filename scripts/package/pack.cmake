# Packs an FMU: cmake -D FOLDER=... -D LIBRARIES=... -D FMU=... -D VERSION=... -D SYSTEM=... -D SOURCE=... -D ZIP=... -D PYTHON=... -D NAMES=...
#                     -P pack.cmake
#   FOLDER     the folder that lagc wrote
#   LIBRARIES  the libraries to pack, each in a folder of its platform's name
#   FMU        the archive to write
#   VERSION    the version of FMI, 2 or 3
#   SYSTEM     the system's file, for messages
#   SOURCE     the root of the tree
#   NAMES      a file with the global names of the compiled runtime
#   LICENSES   the folder of collect_licenses()
cmake_minimum_required(VERSION 3.18)

include(${CMAKE_CURRENT_LIST_DIR}/archive.cmake)

# Importers look for the library by the modelIdentifier in modelDescription.xml.
list(GET LIBRARIES 0 library)
get_filename_component(name ${library} NAME_WE)
file(STRINGS ${FOLDER}/modelDescription.xml found REGEX " modelIdentifier=")
if(NOT found MATCHES " modelIdentifier=\"${name}\"")
  string(REGEX REPLACE ".* modelIdentifier=\"([^\"]*)\".*" "\\1" found "${found}")
  message(FATAL_ERROR "${SYSTEM}: the system is named '${found}'; expected '${name}', as its folder or lagrange_add_fmu() names it")
endif()

set(content ${FOLDER}/content${VERSION})
file(REMOVE_RECURSE ${FMU} ${content})
get_filename_component(archives ${FMU} DIRECTORY)
file(MAKE_DIRECTORY ${archives})
foreach(library ${LIBRARIES})
  get_filename_component(platform ${library} DIRECTORY)
  get_filename_component(platform ${platform} NAME)
  file(COPY ${library} DESTINATION ${content}/binaries/${platform})
  if(platform MATCHES "^wasm")
    # The first name is that of the draft FMI-LS-WASM, the second that of FMI 3.0 for all layered standards.
    foreach(manifest manifest.xml fmi-ls-manifest.xml)
      configure_file(${CMAKE_CURRENT_LIST_DIR}/wasm_component/manifest.xml ${content}/extra/org.modelica.fmi-ls-wasm/${manifest} COPYONLY)
    endforeach()
  endif()
endforeach()
file(COPY ${FOLDER}/documentation/index.html DESTINATION ${content}/documentation)
if(VERSION EQUAL 2)
  file(COPY ${FOLDER}/modelDescription.xml ${FOLDER}/model.png DESTINATION ${content})
else()
  file(COPY ${FOLDER}/fmi3/modelDescription.xml DESTINATION ${content})
  file(COPY ${FOLDER}/fmi3/terminalsAndIcons.xml ${FOLDER}/fmi3/icon.svg DESTINATION ${content}/terminalsAndIcons)
  configure_file(${FOLDER}/model.png ${content}/terminalsAndIcons/icon.png COPYONLY)
  file(GLOB flange ${FOLDER}/fmi3/flange.*)
  file(COPY ${flange} DESTINATION ${content}/terminalsAndIcons)
endif()
include(${CMAKE_CURRENT_LIST_DIR}/licenses.cmake)
copy_licenses(${FOLDER}/documentation/licenses/license.txt ${content}/documentation/licenses ${LICENSES})

# An FMU without external libraries contains its source as one file, in which each file that system.c includes appears once.
if(EXISTS ${FOLDER}/fmi3/buildDescription.xml)
  execute_process(COMMAND ${PYTHON} ${CMAKE_CURRENT_LIST_DIR}/one_file.py ${SOURCE} ${NAMES} ${VERSION} ${FOLDER}/system.c ${name}
                          ${content}/sources/${name}.c RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${name}.c cannot be written")
  endif()
  if(VERSION EQUAL 3)
    file(COPY ${FOLDER}/fmi3/buildDescription.xml DESTINATION ${content}/sources)
  endif()
endif()

archive(${FMU} modelDescription.xml)
