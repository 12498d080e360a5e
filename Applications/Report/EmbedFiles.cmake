# cmake -D FOLDER=<of report.html, report.css, report.js> -D OUTPUT=<file.cpp> -P EmbedFiles.cmake: a C++
# file that holds them as texts.
cmake_minimum_required(VERSION 3.25)

set(text "#include \"Applications/Report/ReportFiles.h\"\n\nnamespace crease {\n\n")
foreach(ending Html Css Js)
  string(TOLOWER ${ending} lower)
  file(READ ${FOLDER}/report.${lower} content)
  if(content MATCHES "\\)report\"")
    message(FATAL_ERROR "report.${lower} holds the end mark of its raw string")
  endif()
  string(APPEND text
    "constinit const std::string_view kReport${ending} = R\"report(${content})report\";\n\n")
endforeach()
file(WRITE ${OUTPUT} "${text}}  // namespace crease\n")
