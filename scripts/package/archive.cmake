# Packs the folder ${content} into an archive with the program ${ZIP}. The including script sets both.

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${content} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${status}")
  endif()
endfunction()

# archive(FILE FIRST): packs all files of the folder, with FIRST as the first member. All members get the same time and no extra
# attributes, so that equal content gives equal bytes.
function(archive file first)
  file(GLOB_RECURSE members RELATIVE ${content} ${content}/*)
  list(REMOVE_ITEM members ${first})
  list(SORT members)
  list(PREPEND members ${first})
  run(chmod 644 ${members})
  run(touch -d 2000-01-01T00:00:00Z ${members})
  run(${CMAKE_COMMAND} -E env TZ=UTC ${ZIP} -q -9 -X ${file} ${members})
endfunction()
