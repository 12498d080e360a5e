# cmake -D FOLDER=<scratch> -P CheckFloorsTest.cmake: CheckFloors.cmake must pass a good tree and
# must name each fault that is put into it.
cmake_minimum_required(VERSION 3.25)

function(good_tree)
  file(REMOVE_RECURSE ${FOLDER})
  file(WRITE ${FOLDER}/Core/Point.h "#pragma once\n#include <Eigen/Core>\n#include <vector>\n")
  file(WRITE ${FOLDER}/Core/Parallel.cpp "#include <tbb/parallel_for.h>\n#include \"Core/Point.h\"\n")
  file(WRITE ${FOLDER}/Images/Image.h "#include \"Core/Point.h\"\n")
  file(WRITE ${FOLDER}/Images/OpenCvView.h "#include <opencv2/core.hpp>\n#include \"Images/Image.h\"\n")
  file(WRITE ${FOLDER}/Images/Reader.cpp "#include <itkImage.h>\n#include \"Images/Image.h\"\n")
  file(WRITE ${FOLDER}/Images/Lanes.h "#include <immintrin.h>\n")  # not installed
  file(WRITE ${FOLDER}/Transforms/Transform.h "#include \"Core/Point.h\"\n")
  file(WRITE ${FOLDER}/Transforms/Splines/Basis.h "#include \"Transforms/Transform.h\"\n")
  file(WRITE ${FOLDER}/Transforms/Domains/Mesh.h "#include \"Transforms/Splines/Basis.h\"\n")
  file(WRITE ${FOLDER}/Metrics/Metric.h "#include \"Images/Image.h\"\n")
  file(WRITE ${FOLDER}/Registration/Register.h "#include \"Metrics/Metric.h\"\n")
  file(WRITE ${FOLDER}/Testing/Metrics/MetricTest.cpp
    "#include \"Metrics/Metric.h\"\n#include \"itkImage.h\"\n#include <gtest/gtest.h>\n")
endfunction()

set(public Core/Point.h Images/Image.h Images/OpenCvView.h Metrics/Metric.h Registration/Register.h)

function(run_check)
  execute_process(COMMAND ${CMAKE_COMMAND} -D ROOT=${FOLDER} -D "PUBLIC=${public}"
      -P ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/CheckFloors.cmake
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  set(result ${result} PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
endfunction()

# Adds an include line to one file of the good tree; the check must fail and say `expected`.
function(expect_fault file line expected)
  good_tree()
  file(APPEND ${FOLDER}/${file} "#include ${line}\n")
  run_check()
  string(FIND "${output}" "${expected}" position)
  if(result EQUAL 0 OR position EQUAL -1)
    message(SEND_ERROR "${file} with ${line}: expected the fault\n  ${expected}\nbut got\n  ${output}")
  endif()
endfunction()

good_tree()
run_check()
if(NOT result EQUAL 0)
  message(SEND_ERROR "The good tree must pass, but: ${output}")
endif()

expect_fault(Core/Point.h [["Images/Image.h"]] "Core/Point.h includes Images/Image.h")  # upward
expect_fault(Images/Image.h [["Transforms/Transform.h"]] "Images stands on nothing but [Core]")  # sideways
expect_fault(Metrics/Metric.h [["Transforms/Transform.h"]] "Metrics/Metric.h includes Transforms/Transform.h")
expect_fault(Registration/Register.h [["Testing/Metrics/MetricTest.cpp"]] "Registration stands on nothing but")
expect_fault(Core/Parallel.cpp [["Metrics/Metric.h"]] "Core/Parallel.cpp includes Metrics/Metric.h")
expect_fault(Images/Image.h [["Image.h"]] "no file counted from the root")
expect_fault(Images/Image.h [[<Core/Point.h>]] "our own headers go in quotes")
expect_fault(Images/Image.h [["Images/Image.h"]] "Images/Image.h -> Images/Image.h")
expect_fault(Transforms/Transform.h [["Transforms/Domains/Mesh.h"]]
  "a circle of includes: Transforms/Domains/Mesh.h -> Transforms/Splines/Basis.h -> Transforms/Transform.h -> Transforms/Domains/Mesh.h")
expect_fault(Images/Image.h [["Images/Lanes.h"]] "Images/Image.h is installed, but includes Images/Lanes.h")
expect_fault(Images/Image.h [["Images/OpenCvView.h"]] "shows opencv2 to every user")
expect_fault(Images/OpenCvView.h [[<itkImage.h>]] "Images/OpenCvView.h is installed and shows <itkImage.h>")
foreach(header opencv2/core.hpp ceres/ceres.h fftw3.h gsl/gsl_math.h itkImage.h CGAL/Kernel.h cholmod.h
    nlohmann/json.hpp)
  expect_fault(Images/Image.h <${header}> "Images/Image.h is installed and shows <${header}>")
endforeach()
expect_fault(Core/Point.h <tbb/tbb.h> "Core/Point.h is installed and shows <tbb/tbb.h>")
expect_fault(Metrics/Metric.h <tbb/tbb.h> "threads live in Core/Parallel.h alone")

# Two folders of one floor that include each other, without a circle of files.
good_tree()
file(WRITE ${FOLDER}/Transforms/Splines/Knots.h "#include \"Transforms/Domains/Box.h\"\n")
file(WRITE ${FOLDER}/Transforms/Domains/Box.h "")
run_check()
if(result EQUAL 0 OR NOT output MATCHES
    "a circle of includes: Transforms/Domains -> Transforms/Splines -> Transforms/Domains")
  message(SEND_ERROR "Two folders that include each other must be named, but: ${output}")
endif()
file(REMOVE_RECURSE ${FOLDER})
