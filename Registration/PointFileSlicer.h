#pragma once

#include <memory>

#include "Registration/PointFile.h"

namespace crease {

/// A list of 3D Slicer up to version 4: lines id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,... below comments, one
/// of which names the coordinate system.
class SlicerTable final : public PointFile {
 public:
  explicit SlicerTable(const std::filesystem::path& path);
  std::string with_points(const std::vector<Point<3>>& points) const override;

 private:
  struct Row {
    std::size_t line;  // of lines_
    bool ras;
  };
  std::vector<std::string> lines_;
  std::vector<Row> rows_;  // one per point
};

/// A markups file of 3D Slicer since version 4.11. Control points that are not placed are passed over.
class SlicerMarkups final : public PointFile {
 public:
  /// @param only_first_list  the control points of the first list of points ("Fiducial"), for landmarks;
  /// else those of all markups.
  /// @throws InvalidInput also when the file holds no such list.
  explicit SlicerMarkups(const std::filesystem::path& path, bool only_first_list = false);
  ~SlicerMarkups() override;
  std::string with_points(const std::vector<Point<3>>& points) const override;

 private:
  struct Contents;
  std::unique_ptr<const Contents> contents_;
};

}  // namespace crease
