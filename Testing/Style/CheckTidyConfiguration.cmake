# cmake -D ROOT=<source tree> -P CheckTidyConfiguration.cmake: fails when .clang-tidy is not valid.
cmake_minimum_required(VERSION 3.25)

find_program(clang_tidy NAMES clang-tidy-14 clang-tidy NO_CACHE)
if(NOT clang_tidy)
  message("skipped: clang-tidy is not installed (Debian 12: apt-get install clang-tidy)")
  return()
endif()
execute_process(COMMAND ${clang_tidy} --list-checks --config-file=${ROOT}/.clang-tidy
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT result EQUAL 0 OR NOT output MATCHES "readability-identifier-naming")
  message(FATAL_ERROR ".clang-tidy: ${output}")
endif()
