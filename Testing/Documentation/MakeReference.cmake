# cmake -D ROOT=<source tree> -D "PUBLIC=<installed headers, from ROOT, blanks between them>" -D FOLDER=<where to>
# -D VERSION=<of crease> -D DOXYGEN=<program> -P MakeReference.cmake: makes FOLDER/html; fails when a comment is
# wrong, or a type or a function of the namespace has none. Members of classes need none where their names tell.
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})
string(REGEX REPLACE "([^ ]+)" "${ROOT}/\\1" headers "${PUBLIC}")
set(ENV{CREASE_HEADERS} "${headers}")
set(ENV{CREASE_REFERENCE} ${FOLDER})
set(ENV{CREASE_ROOT} ${ROOT})
set(ENV{CREASE_VERSION} ${VERSION})
execute_process(COMMAND ${DOXYGEN} ${ROOT}/Documentation/Doxyfile WORKING_DIRECTORY ${FOLDER}
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "doxygen exited with ${result}:\n${output}")
endif()

file(STRINGS ${FOLDER}/complaints.txt complaints)
set(faults)
foreach(complaint IN LISTS complaints)
  if(NOT complaint MATCHES "Member .* of (class|struct) .* is not documented")
    string(REPLACE "${ROOT}/" "" complaint "${complaint}")
    string(APPEND faults "\n  ${complaint}")
  endif()
endforeach()
if(faults)
  message(FATAL_ERROR "Comments to mend:${faults}")
endif()
message(STATUS "the reference is in ${FOLDER}/html/index.html")
