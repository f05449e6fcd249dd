# Packs an FMU: cmake -D FOLDER=... -D LIBRARY=... -D FMU=... -D SOURCE=... -D ICON=... -D ZIP=... -P pack.cmake
# FOLDER holds what lagc wrote. All members get one and the same time and no further attributes, so that the same
# content gives the same bytes.

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${content} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${status}")
  endif()
endfunction()

set(content ${FOLDER}/content)
file(REMOVE_RECURSE ${FMU} ${content})
file(MAKE_DIRECTORY ${content})
file(COPY ${FOLDER}/modelDescription.xml DESTINATION ${content})
file(COPY ${FOLDER}/documentation/index.html DESTINATION ${content}/documentation)
file(COPY ${LIBRARY} DESTINATION ${content}/binaries/linux64)
run(${ICON} ${LIBRARY} ${FOLDER}/modelDescription.xml model.png)

# Where modelDescription.xml lists sources, these and all headers go with it.
file(STRINGS ${FOLDER}/modelDescription.xml files REGEX "<File name=")
if(files)
  file(GLOB headers ${SOURCE}/include/*.h ${SOURCE}/src/runtime/*.h)
  list(FILTER headers EXCLUDE REGEX "sundials")
  file(COPY ${headers} ${FOLDER}/system.c DESTINATION ${content}/sources)
  foreach(file ${files})
    string(REGEX REPLACE ".*name=\"([^\"]*)\".*" "\\1" file "${file}")
    if(NOT file STREQUAL system.c)
      file(COPY ${SOURCE}/src/runtime/${file} DESTINATION ${content}/sources)
    endif()
  endforeach()
endif()

file(GLOB_RECURSE members RELATIVE ${content} ${content}/*)
list(REMOVE_ITEM members modelDescription.xml)
list(SORT members)
list(PREPEND members modelDescription.xml)
run(chmod 644 ${members})
run(touch -d 2000-01-01T00:00:00Z ${members})
run(${CMAKE_COMMAND} -E env TZ=UTC ${ZIP} -q -X ${FMU} ${members})
