# Packs an FMU: cmake -D FOLDER=... -D LIBRARY=... [-D LIBRARIES=...] -D FMU=... -D SYSTEM=... -D SOURCE=... -D ICON=... -D ZIP=...
#                     -D NAMES=... -P pack.cmake
# FOLDER holds what lagc wrote; LIBRARY is this machine's, LIBRARIES are those to pack, each in a folder of its platform's name,
# where that is not LIBRARY; NAMES lists the global names of the compiled runtime.

include(${CMAKE_CURRENT_LIST_DIR}/archive.cmake)

# Importers look for the library under the name in modelDescription.xml.
get_filename_component(name ${LIBRARY} NAME_WE)
file(STRINGS ${FOLDER}/modelDescription.xml found REGEX " modelIdentifier=")
if(NOT found MATCHES " modelIdentifier=\"${name}\"")
  string(REGEX REPLACE ".* modelIdentifier=\"([^\"]*)\".*" "\\1" found "${found}")
  message(FATAL_ERROR "${SYSTEM}: the system is named '${found}'; expected '${name}', as its folder or lagrange_add_fmu() names it")
endif()

set(content ${FOLDER}/content)
file(REMOVE_RECURSE ${FMU} ${content})
get_filename_component(archives ${FMU} DIRECTORY)
file(MAKE_DIRECTORY ${content} ${archives})
file(COPY ${FOLDER}/modelDescription.xml DESTINATION ${content})
file(COPY ${FOLDER}/documentation/index.html DESTINATION ${content}/documentation)
if(NOT LIBRARIES)
  set(LIBRARIES ${LIBRARY})
endif()
foreach(library ${LIBRARIES})
  get_filename_component(platform ${library} DIRECTORY)
  get_filename_component(platform ${platform} NAME)
  file(COPY ${library} DESTINATION ${content}/binaries/${platform})
endforeach()
run(${ICON} ${LIBRARY} ${FOLDER}/modelDescription.xml model.png)

# Where modelDescription.xml lists a source, it is one file: all that system.c includes, once each.
file(STRINGS ${FOLDER}/modelDescription.xml source REGEX "<File name=" LIMIT_COUNT 1)
if(source)
  string(REGEX REPLACE ".*name=\"(.*)\\.c\".*" "\\1" name "${source}")
  include(${CMAKE_CURRENT_LIST_DIR}/one_file.cmake)
  one_file(${FOLDER}/system.c ${name} ${content}/sources/${name}.c)
endif()

archive(${FMU} modelDescription.xml)
