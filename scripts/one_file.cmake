# For pack.cmake: one_file(SYSTEM NAME FILE) writes the C source of an FMU as one file, from the system's and the runtime's,
# in SOURCE, with the layer of FMI VERSION. Names that the linker sees, which NAMES lists as nm does, get the FMU's before them, so
# that several FMUs can be linked into one program.
cmake_minimum_required(VERSION 3.18)

# The text with each included file of the project in the place where it is first named; TEXT is a variable.
function(include_once variable)
  set(rest "${${variable}}")
  set(done "")
  set(included "")
  while(rest MATCHES "#include \"([a-z0-9_/]+\\.[ch])\"\n")
    set(line "${CMAKE_MATCH_0}")
    set(name ${CMAKE_MATCH_1})
    string(FIND "${rest}" "${line}" place)
    string(SUBSTRING "${rest}" 0 ${place} before)
    string(LENGTH "${line}" length)
    math(EXPR place "${place} + ${length}")
    string(SUBSTRING "${rest}" ${place} -1 rest)
    string(APPEND done "${before}")
    if(NOT name IN_LIST included)
      list(APPEND included ${name})
      file(GLOB file ${SOURCE}/include/${name} ${SOURCE}/src/runtime/${name})
      file(READ ${file} text)
      string(PREPEND rest "${text}")
    endif()
  endwhile()
  set(${variable} "${done}${rest}" PARENT_SCOPE)
endfunction()

function(one_file system name file)
  set(fmi FMI${VERSION})
  file(READ ${system} text)
  # The layer of the version stands beside the core.
  file(GLOB layer RELATIVE ${SOURCE}/src/runtime ${SOURCE}/src/runtime/fmi${VERSION}/*.c)
  list(TRANSFORM layer REPLACE "(.+)" "#include \"\\1\"\n")
  list(JOIN layer "" layer)
  string(REPLACE "#ifdef FMU_IN_ONE_FILE\n" "#ifdef FMU_IN_ONE_FILE\n${layer}" text "${text}")
  include_once(text)
  file(READ ${NAMES} symbols)
  string(REGEX MATCHALL "[A-Za-z0-9_]+ [A-Z] " symbols "${symbols}\nlagrangian D ")
  list(SORT symbols)
  set(names "")
  set(functions "")
  foreach(symbol ${symbols})
    string(REGEX REPLACE " .*" "" symbol "${symbol}")
    if(symbol MATCHES "^fmi${VERSION}")
      string(APPEND functions "#define ${symbol} ${fmi}_FULL_NAME(${fmi}_FUNCTION_PREFIX, ${symbol})\n")
    elseif(NOT symbol MATCHES "^fmi[0-9]")
      string(FIND "${text}" "${symbol}" place)
      if(place GREATER -1)
        string(APPEND names "#define ${symbol} ${name}_${symbol}\n")
      endif()
    endif()
  endforeach()
  file(READ ${SOURCE}/LICENSE license)
  string(STRIP "${license}" license)
  string(REPLACE "\n" "\n * " license "${license}")
  string(REPLACE " * \n" " *\n" license "${license}")
  file(WRITE ${file} "/*
 * ${license}
 */

/*
 * ${name} in C11, without any library but libm. Several FMUs can be linked into one program: compile each with
 * ${fmi}_FUNCTION_PREFIX defined as the FMU's name and _, here ${name}_, which the functions of FMI then begin with.
 * For a shared library, leave it undefined.
 */
#define FMU_IN_ONE_FILE
#ifdef __GNUC__ /* a system needs few of the functions and arguments */
#pragma GCC diagnostic ignored \"-Wunused-function\"
#pragma GCC diagnostic ignored \"-Wunused-parameter\"
#endif
${names}
#if defined(${fmi}_FUNCTION_PREFIX) && !defined(${fmi}_OVERRIDE_FUNCTION_PREFIX)
#define ${fmi}_PASTE(prefix, name) prefix##name
#define ${fmi}_FULL_NAME(prefix, name) ${fmi}_PASTE(prefix, name)
${functions}#endif

${text}")
endfunction()
