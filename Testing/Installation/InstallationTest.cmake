# Called by CTest, see CMakeLists.txt. Everything happens in FOLDER.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "${command}\nexited with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${FOLDER})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${FOLDER}/first)
file(RENAME ${FOLDER}/first ${FOLDER}/prefix)  # an installation may be moved as a whole

# Private needs of the libraries must stay private: the package names no target but ours and Eigen.
file(GLOB_RECURSE package ${FOLDER}/prefix/*/creaseTargets.cmake)
file(READ "${package}" text)
foreach(word TBB:: CGAL:: ITK itk opencv cholmod spqr nlohmann GSL spdlog LINK_ONLY)
  if(text MATCHES "INTERFACE_LINK_LIBRARIES[^\n]*${word}")
    message(FATAL_ERROR "${package} asks its users for ${word}: ${CMAKE_MATCH_0}")
  endif()
endforeach()

file(GLOB consumer ${CMAKE_CURRENT_LIST_DIR}/Consumer/*)
file(COPY ${consumer} DESTINATION ${FOLDER}/consumer)
run(${CMAKE_COMMAND} -S ${FOLDER}/consumer -B ${FOLDER}/build -G ${GENERATOR}
  -D CMAKE_CXX_COMPILER=${CXX} -D CMAKE_BUILD_TYPE=${BUILD_TYPE} "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
  -D CMAKE_PREFIX_PATH=${FOLDER}/prefix -D CREASE_INCLUDE=${FOLDER}/prefix/include/crease)
run(${CMAKE_COMMAND} --build ${FOLDER}/build)
run(${FOLDER}/build/everything)
run(${FOLDER}/build/consumer)
if(NOT output STREQUAL "crease is installed\n")
  message(FATAL_ERROR "The consumer printed: ${output}")
endif()

foreach(component IN LISTS COMPONENTS)
  if(NOT text MATCHES "add_library\\(crease::${component} SHARED")
    message(FATAL_ERROR "crease::${component} is missing in ${package}")
  endif()
endforeach()
foreach(file LICENSE LICENSE.GPL-3.0 NOTICE)
  if(NOT EXISTS ${FOLDER}/prefix/share/doc/crease/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()

if(HAS_COMMAND)
  run(${FOLDER}/prefix/${COMMAND_PATH} --version)
  if(NOT output MATCHES "crease")
    message(FATAL_ERROR "crease --version printed: ${output}")
  endif()
endif()
file(REMOVE_RECURSE ${FOLDER})
