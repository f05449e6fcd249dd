# Packs an FMU: cmake -D FOLDER=... -D LIBRARY=... -D FMU=... -D SOURCE=... -D ICON=... -D ZIP=... -P pack.cmake
# FOLDER holds what lagc wrote.

include(${CMAKE_CURRENT_LIST_DIR}/archive.cmake)

set(content ${FOLDER}/content)
file(REMOVE_RECURSE ${FMU} ${content})
file(MAKE_DIRECTORY ${content})
file(COPY ${FOLDER}/modelDescription.xml DESTINATION ${content})
file(COPY ${FOLDER}/documentation/index.html DESTINATION ${content}/documentation)
file(COPY ${LIBRARY} DESTINATION ${content}/binaries/linux64)
run(${ICON} ${LIBRARY} ${FOLDER}/modelDescription.xml model.png)

# Where modelDescription.xml lists sources, these and all headers go with it, in one folder: their names are unique.
file(STRINGS ${FOLDER}/modelDescription.xml files REGEX "<File name=")
if(files)
  file(GLOB headers ${SOURCE}/include/*.h ${SOURCE}/src/runtime/*.h ${SOURCE}/src/runtime/*/*.h)
  list(FILTER headers EXCLUDE REGEX "sundials|bdf_support")
  if(NOT files MATCHES "instructions.c")
    list(FILTER headers EXCLUDE REGEX "instructions")
  endif()
  file(COPY ${headers} ${FOLDER}/system.c DESTINATION ${content}/sources)
  foreach(file ${files})
    string(REGEX REPLACE ".*name=\"([^\"]*)\".*" "\\1" file "${file}")
    if(NOT file STREQUAL system.c)
      file(GLOB source ${SOURCE}/src/runtime/${file} ${SOURCE}/src/runtime/*/${file})
      file(COPY ${source} DESTINATION ${content}/sources)
    endif()
  endforeach()
endif()

archive(${FMU} modelDescription.xml)
