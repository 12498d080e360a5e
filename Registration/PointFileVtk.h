#pragma once

#include "Registration/PointFile.h"

namespace crease {

/// A legacy VTK file, kept byte by byte but for its POINTS.
///
///     # vtk DataFile Version 4.2
///     a title
///     ASCII                          or BINARY: numbers with the high byte first
///     DATASET POLYDATA               or another kind that has POINTS
///     POINTS 3 float                 or double
///
/// Source: VTK User's Guide, "VTK File Formats", legacy formats.
class VtkPoints final : public PointFile {
 public:
  explicit VtkPoints(const std::filesystem::path& path);
  std::string with_points(const std::vector<Point<3>>& points) const override;

 private:
  std::string before_, after_;  // the file up to "POINTS", and from what follows the points on
  bool binary_ = false;
  bool ras_ = false;
};

}  // namespace crease
