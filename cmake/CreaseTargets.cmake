# What every target of crease shares: the language, the warnings, kernels for several instruction
# sets, tests and installation.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
include(GNUInstallDirs)

add_library(crease_warnings INTERFACE)
add_library(crease::warnings ALIAS crease_warnings)
target_compile_options(crease_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
  -Wno-sign-conversion -Wno-float-conversion)

# crease_kernel(TARGET File.cpp ...): compiles each file twice, for the baseline and for AVX2 with
# FMA. The file puts its functions into `namespace crease::CREASE_ISA` (baseline or avx2), and the
# caller chooses by cpu_has_avx2(). Such a file includes no inline library code (Eigen, std
# containers): the linker might otherwise keep the AVX2 copy for everybody.
function(crease_kernel target)
  foreach(isa baseline avx2)
    set(objects ${target}_${isa})
    add_library(${objects} OBJECT ${ARGN})
    target_include_directories(${objects} PRIVATE ${PROJECT_SOURCE_DIR})
    target_compile_definitions(${objects} PRIVATE CREASE_ISA=${isa})
    target_compile_options(${objects} PRIVATE -O3 -fno-math-errno -fno-trapping-math -Wno-psabi)
    if(isa STREQUAL "avx2" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
      target_compile_options(${objects} PRIVATE -mavx2 -mfma)
    endif()
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:${objects}>)
  endforeach()
endfunction()

# crease_install(TARGET): the library and its headers, exported as crease::<name without crease_>.
function(crease_install target)
  string(REPLACE "crease_" "" name ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS ${target} crease_warnings EXPORT creaseTargets
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/crease
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/crease)
endfunction()

# crease_test(FOLDER SOURCES ... LIBRARIES ...): one test program per folder, its tests in CTest.
function(crease_test folder)
  cmake_parse_arguments(arg "" "" "SOURCES;LIBRARIES" ${ARGN})
  string(TOLOWER ${folder} name)
  add_executable(test_${name} ${arg_SOURCES})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(test_${name} PRIVATE ${arg_LIBRARIES} GTest::gmock GTest::gtest_main)
  target_compile_definitions(test_${name} PRIVATE
    CREASE_SHARED_DIR="${CREASE_SHARED_DIR}" CREASE_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(test_${name} DISCOVERY_TIMEOUT 120 PROPERTIES TIMEOUT 600)
endfunction()
