#pragma once

#include "Transforms/ItkFiles/ItkTransform.h"

/// The one function of libcrease_transforms_hdf5.so. HDF5 and what it needs are 20 shared libraries: they
/// would lengthen every start of a program, so this library is loaded when the first such file is read.
/// @throws crease::FileError.
extern "C" void crease_read_itk_hdf5(const std::filesystem::path& file,
                                     std::vector<crease::ItkTransform>& transforms);
