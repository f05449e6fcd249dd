# Packs a coupled system: cmake -D STRUCTURE=FILE.ssd -D FMUS=... -D SSP=... -D ZIP=... -P pack_ssp.cmake

include(${CMAKE_CURRENT_LIST_DIR}/archive.cmake)

set(content ${SSP}.content)
file(REMOVE_RECURSE ${SSP} ${content})
file(MAKE_DIRECTORY ${content})
file(COPY ${STRUCTURE} DESTINATION ${content})
file(COPY ${FMUS} DESTINATION ${content}/resources)
archive(${SSP} SystemStructure.ssd)
file(REMOVE_RECURSE ${content})
