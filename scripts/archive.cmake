# For scripts that pack archives from a folder named by the variable content, with the program in ZIP.

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${content} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${status}")
  endif()
endfunction()

# archive(FILE FIRST): all of the folder, FIRST as the first member. All members get one and the same time and no further
# attributes, so that the same content gives the same bytes.
function(archive file first)
  file(GLOB_RECURSE members RELATIVE ${content} ${content}/*)
  list(REMOVE_ITEM members ${first})
  list(SORT members)
  list(PREPEND members ${first})
  run(chmod 644 ${members})
  run(touch -d 2000-01-01T00:00:00Z ${members})
  run(${CMAKE_COMMAND} -E env TZ=UTC ${ZIP} -q -9 -X ${file} ${members})
endfunction()
