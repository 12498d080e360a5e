# cmake -D ROOT=<source tree> -D EXAMPLE=<program> -D PAGE=<page> -P CheckExample.cmake: fails unless the page
# holds the program's lines, indented alike or not. The README's program has at most twenty of them.
cmake_minimum_required(VERSION 3.25)

file(STRINGS ${ROOT}/${EXAMPLE} lines)
file(READ ${ROOT}/${PAGE} page)
list(LENGTH lines count)
if(PAGE STREQUAL "README.md" AND count GREATER 20)
  message(FATAL_ERROR "${EXAMPLE} has ${count} lines; it must fit in 20")
endif()
foreach(line IN LISTS lines)
  string(FIND "${page}" "${line}\n" position)
  if(position EQUAL -1)
    message(FATAL_ERROR "${PAGE} lacks this line of ${EXAMPLE}:\n${line}")
  endif()
endforeach()
