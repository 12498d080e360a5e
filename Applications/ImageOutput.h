#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "Applications/OutputFolder.h"
#include "Images/ImageFile.h"
#include "Registration/Pictures.h"

namespace crease {

/// Writes a warped image in the moving image's format, and as MetaImage beside it where that format knows no
/// pixel size or cannot be written. What is not a number becomes 0.
/// @param name       without ending.
/// @param file_name  of the moving image.
template <int Dim>
void write_warped(const OutputFolder& output, const std::string& name, const std::string& file_name,
                  const ReadImage<Dim>& moving, Image<float, Dim> warped);

/// A picture for people: its name without ending, and how it is drawn.
using NamedPicture = std::pair<const char*, std::function<Picture()>>;

/// Writes pictures/NAME.png for each, and does further jobs at the same time, in parallel.
void write_all(const OutputFolder& output, const std::vector<NamedPicture>& pictures,
               std::vector<std::function<void()>> further_jobs);

}  // namespace crease
