# Debian 12's packages. Those that a public header shows (Eigen) are found again by the installed
# package; the others stay inside the libraries.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(CGAL 5.5 REQUIRED)
# GDCM, below ITK, lists the programs of its own that Debian packs separately as if that were an error.
set(CMAKE_MESSAGE_LOG_LEVEL NOTICE)
find_package(ITK 5.2 REQUIRED COMPONENTS ITKCommon ITKIOImageBase ITKIOGDCM ITKIONIFTI ITKIOMeta
  ITKIONRRD ITKIOPNG ITKIOJPEG ITKIOTIFF ITKIOTransformBase ITKIOTransformInsightLegacy
  ITKIOTransformHDF5 ITKIOTransformMatlab)
unset(CMAKE_MESSAGE_LOG_LEVEL)
find_package(HDF5 1.10 REQUIRED COMPONENTS C)
find_package(OpenCV 4.6 REQUIRED COMPONENTS core imgproc video)
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(spdlog REQUIRED)
find_package(fmt REQUIRED)
find_package(Threads REQUIRED)
find_package(ZLIB REQUIRED)
find_package(JPEG REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Ceres 2.1 REQUIRED)
pkg_check_modules(GSL REQUIRED IMPORTED_TARGET gsl)

# CHOLMOD and SPQR have no CMake package of their own.
find_path(CREASE_SUITESPARSE_INCLUDE cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CREASE_CHOLMOD cholmod REQUIRED)
find_library(CREASE_SPQR spqr REQUIRED)
add_library(crease_suitesparse INTERFACE)
add_library(crease::suitesparse ALIAS crease_suitesparse)
target_include_directories(crease_suitesparse SYSTEM INTERFACE ${CREASE_SUITESPARSE_INCLUDE})
target_link_libraries(crease_suitesparse INTERFACE ${CREASE_SPQR} ${CREASE_CHOLMOD})

if(CREASE_BUILD_TESTING)
  find_package(GTest REQUIRED)
  find_package(benchmark REQUIRED)
  include(GoogleTest)
  # Real images and test vectors beside the checkout, if they are there; tests skip without them.
  set(CREASE_SHARED_DIR ${PROJECT_SOURCE_DIR}/../shared CACHE PATH "folder of optional test data")
endif()
