# Handles the licences of libraries that are linked into FMUs: collect_licenses() at configuration, copy_licenses() for each FMU.

# collect_licenses(FOLDER): copies sundials.txt, suitesparse.txt and LGPL-2.1.txt, the licence of KLU, from the distribution.
function(collect_licenses folder)
  foreach(library sundials suitesparse)
    if(EXISTS /usr/share/doc/lib${library}-dev/copyright)
      configure_file(/usr/share/doc/lib${library}-dev/copyright ${folder}/${library}.txt COPYONLY)
    endif()
  endforeach()
  if(EXISTS /usr/share/common-licenses/LGPL-2.1)
    configure_file(/usr/share/common-licenses/LGPL-2.1 ${folder}/LGPL-2.1.txt COPYONLY)
  endif()
endfunction()

# copy_licenses(FILE TARGET FOLDER): copies lagc's license.txt, and the files of FOLDER that it names, to TARGET.
function(copy_licenses file target folder)
  file(COPY ${file} DESTINATION ${target})
  file(STRINGS ${file} lines REGEX " is linked into it: ")
  string(REGEX MATCHALL "[A-Za-z0-9.-]+\\.txt" names "${lines}")
  foreach(name IN LISTS names)
    if(EXISTS ${folder}/${name})
      file(COPY ${folder}/${name} DESTINATION ${target})
    else()
      message(WARNING "${target}/${name} is missing: put the licence of the library into ${folder}/${name}")
    endif()
  endforeach()
endfunction()
