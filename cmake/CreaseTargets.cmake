# What every target of crease shares: the language, the warnings, kernels for several instruction
# sets, tests and installation.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)  # for clang-tidy
include(GNUInstallDirs)

# A plain `cmake -B build` gives what the release preset gives, and ccache is used where it is.
if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE)
    set_property(CACHE CMAKE_BUILD_TYPE PROPERTY VALUE RelWithDebInfo)
  endif()
  find_program(CREASE_CCACHE ccache)
  mark_as_advanced(CREASE_CCACHE)
  if(CREASE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CREASE_CCACHE})
  endif()
endif()

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
    if(TARGET ${objects})  # a further call for the same target
      target_sources(${objects} PRIVATE ${ARGN})
      continue()
    endif()
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
# Inline functions stay inside each library, and calls within one need not reckon with a replacement
# from another: both shorten the start of a program.
function(crease_install target)
  string(REPLACE "crease_" "" name ${target})
  set_property(GLOBAL APPEND PROPERTY CREASE_COMPONENTS ${name})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -fno-semantic-interposition)
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    VERSION ${PROJECT_VERSION}
    VISIBILITY_INLINES_HIDDEN ON
    INSTALL_RPATH "$ORIGIN")
  install(TARGETS ${target} EXPORT creaseTargets
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/crease)
endfunction()

# crease_install_command(TARGET): a program that finds the libraries wherever both are moved to.
function(crease_install_command target)
  file(RELATIVE_PATH libraries /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN/${libraries}")
  install(TARGETS ${target})
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
