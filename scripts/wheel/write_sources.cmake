# cmake -D SOURCE=... -D NAMES=... -D VERSION=... -D SYSTEM=system.c -D NAME=... -D FILE=... -P write_sources.cmake: see one_file.cmake.
include(${CMAKE_CURRENT_LIST_DIR}/one_file.cmake)
one_file(${SYSTEM} ${NAME} ${FILE})
