#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// Places of one image, and all else that their file holds: other points can be put in their place and the
/// rest be written as it was.
///
///     .csv       columns x,y[,z][,name], mm
///     .fcsv      points of 3D Slicer
///     .mrk.json  points and curves of 3D Slicer: the control points that are placed
///     .vtk       the POINTS of a legacy VTK file of any kind, as text or binary; written in double
///                precision. Vectors and normals in its data are not turned.
///
/// Coordinates are LPS, mm; what a file of 3D Slicer says of RAS ("coordinateSystem", "SPACE=RAS" in a .vtk) is
/// obeyed in reading and in writing.
class PointFile {
 public:
  virtual ~PointFile() = default;
  /// Coordinates per point in the file: 2 or 3.
  virtual int dimension() const { return 3; }
  /// In the file's order; z = 0 where the file has none.
  const std::vector<Point<3>>& points() const { return points_; }
  /// Their names; empty where the file has none, else one per point.
  const std::vector<std::string>& names() const { return names_; }

  /// The file's contents with other points, as many as there are. A coordinate that is NaN makes a point of
  /// .mrk.json "undefined"; elsewhere it is written as it is.
  virtual std::string with_points(const std::vector<Point<3>>& points) const = 0;

 protected:
  /// RAS to LPS and back; p itself where `ras` is false.
  static Point<3> turned(const Point<3>& p, bool ras) {
    return ras ? Point<3>(0.0 - p[0], 0.0 - p[1], p[2]) : p;  // without -0
  }

  std::vector<Point<3>> points_;
  std::vector<std::string> names_;
};

/// Whether the file's ending is one of those above.
bool is_point_file(const std::filesystem::path& path);

/// @throws FileError when the file cannot be read; InvalidInput naming file, place in it and what is wrong, or
/// for another ending.
std::unique_ptr<PointFile> read_point_file(const std::filesystem::path& path);

/// Writes the file with other points (see PointFile::with_points), whole or not at all.
/// @throws InvalidInput when the ending is not that of the file that was read.
void write_point_file(const std::filesystem::path& path, const PointFile& file,
                      const std::filesystem::path& read_from, const std::vector<Point<3>>& points);

}  // namespace crease
