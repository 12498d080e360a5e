#pragma once

#include <string>

#include "Applications/OutputFolder.h"
#include "Images/ImageFile.h"

namespace crease {

/// Writes a warped image in the moving image's format, and as MetaImage beside it where that format knows no
/// pixel size or cannot be written. What is not a number becomes 0.
/// @param name       without ending.
/// @param file_name  of the moving image.
template <int Dim>
void write_warped(const OutputFolder& output, const std::string& name, const std::string& file_name,
                  const ReadImage<Dim>& moving, Image<float, Dim> warped);

}  // namespace crease
