#pragma once

#include "Transforms/ItkFiles/ItkTransform.h"

namespace crease {

/// Whether a file is one of ITK's transform files, or by its ending should be: text (.tfm, .txt), HDF5
/// (.h5, .hdf5) or Matlab 4 (.mat, as ANTs writes it). The contents decide; the ending does where they say
/// nothing.
bool is_itk_file(const std::filesystem::path& file);

/// Reads such a file. Nothing is checked but the form: see ItkConversion.h.
/// @throws FileError when the file is missing, damaged, cut off or of another form; says which, and where.
ItkTransformList read_itk_file(const std::filesystem::path& file);

// By form.
std::vector<ItkTransform> read_itk_text(const std::filesystem::path& file);
std::vector<ItkTransform> read_itk_matlab(const std::filesystem::path& file);
std::vector<ItkTransform> read_itk_hdf5(const std::filesystem::path& file);

}  // namespace crease
