# What `cmake --install` leaves behind: the libraries and headers (crease_install), the command, the
# package that find_package(crease) reads, and the licences. `crease::crease` is all of it.

get_property(components GLOBAL PROPERTY CREASE_COMPONENTS)
add_library(crease_everything INTERFACE)
add_library(crease::crease ALIAS crease_everything)
list(TRANSFORM components PREPEND crease_ OUTPUT_VARIABLE libraries)
foreach(library IN LISTS libraries)  # a test checks what they show
  get_target_property(headers ${library} HEADER_SET)
  foreach(header IN LISTS headers)
    cmake_path(RELATIVE_PATH header BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_property(GLOBAL APPEND PROPERTY CREASE_PUBLIC_HEADERS ${header})
  endforeach()
endforeach()
target_link_libraries(crease_everything INTERFACE ${libraries})
set_target_properties(crease_everything PROPERTIES EXPORT_NAME crease)
install(TARGETS crease_everything EXPORT creaseTargets)

include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/crease)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/creaseConfig.cmake.in
  ${PROJECT_BINARY_DIR}/creaseConfig.cmake INSTALL_DESTINATION ${package_dir}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/creaseConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(EXPORT creaseTargets NAMESPACE crease:: DESTINATION ${package_dir})
install(FILES ${PROJECT_BINARY_DIR}/creaseConfig.cmake
  ${PROJECT_BINARY_DIR}/creaseConfigVersion.cmake DESTINATION ${package_dir})
install(FILES LICENSE LICENSE.GPL-3.0 NOTICE README.md CHANGELOG.md
  DESTINATION ${CMAKE_INSTALL_DOCDIR})
