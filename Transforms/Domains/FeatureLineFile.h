#pragma once

#include <filesystem>
#include <vector>

#include "Transforms/Domains/FeatureLine.h"

namespace crease {

/// Reads feature lines.
///
/// - `.csv` with the columns `line,x,y[,kind][,body][,corner]` in any order: mm, LPS; rows of equal
///   `line` (a number or a name) are its points in order; closed if the first point is repeated. `kind` is
///   crease (default), slide or slit and belongs to the edge that starts at the row's point; `body` is left,
///   right or none (default: inside a closed line); `corner` is blunt (default) or collapse.
/// - `.json` (3D Slicer's markups: curves and lines, RAS turned into LPS, the first two coordinates).
///
/// @throws FileError when the file cannot be read; InvalidInput naming file, row and column.
std::vector<FeatureLine> read_feature_lines(const std::filesystem::path& path);

/// Writes the CSV form; reading it gives the same lines (body numbers are not part of the file).
/// @throws FileError when it cannot be written.
void write_feature_lines(const std::filesystem::path& path, const std::vector<FeatureLine>& lines);

/// Curves and lines of a file of 3D Slicer's markups; `read_feature_lines` calls it by extension.
std::vector<FeatureLine> read_slicer_curves(const std::filesystem::path& path);

}  // namespace crease
