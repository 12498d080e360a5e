#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "Core/Point.h"

namespace crease {

/// Pairs of points that belong together: fixed[j] in the fixed image corresponds to moving[j], mm
/// (LPS). The other vectors are empty or have one entry per landmark.
template <int Dim>
struct Landmarks {
  std::vector<Point<Dim>> fixed;
  std::vector<Point<Dim>> moving;
  std::vector<double> sigma_mm;  ///< uncertainty of a soft landmark; NaN: exact
  std::vector<double>
      fixed_angle;  ///< direction of a line through it, radians modulo pi; NaN: none
  std::vector<double> moving_angle;  ///< likewise
  std::vector<std::string> names;

  int size() const { return static_cast<int>(fixed.size()); }
  bool empty() const { return fixed.empty(); }
};

/// Reads pairs from a CSV file with a line of column names, in any order:
/// `fixed_x,fixed_y[,fixed_z], moving_x,moving_y[,moving_z]` in mm; optional `sigma_mm` (empty
/// cell: exact), `fixed_angle,moving_angle` (radians, 2D, both or neither) and `name`. Separators
/// are commas or semicolons; empty lines and lines that start with # are skipped.
/// @throws FileError when the file cannot be read; InvalidInput naming file, row, column and value.
template <int Dim>
Landmarks<Dim> read_landmarks(const std::filesystem::path& path);

/// Reads the fixed and the moving points from two files of 3D Slicer (`.mrk.json` or `.fcsv`). They
/// are paired by name where both files use the same names, each once; else by order. Slicer's RAS
/// coordinates become LPS. In 2D the third coordinate is dropped.
/// @throws FileError, InvalidInput as above; InvalidInput when the numbers of points differ.
template <int Dim>
Landmarks<Dim> read_slicer_landmarks(const std::filesystem::path& fixed,
                                     const std::filesystem::path& moving);

/// Writes the CSV form, numbers with all their digits.
/// @throws FileError when it cannot be written.
template <int Dim>
void write_landmarks(const std::filesystem::path& path, const Landmarks<Dim>& landmarks);

extern template Landmarks<2> read_landmarks<2>(const std::filesystem::path&);
extern template Landmarks<3> read_landmarks<3>(const std::filesystem::path&);
extern template Landmarks<2> read_slicer_landmarks<2>(const std::filesystem::path&,
                                                      const std::filesystem::path&);
extern template Landmarks<3> read_slicer_landmarks<3>(const std::filesystem::path&,
                                                      const std::filesystem::path&);
extern template void write_landmarks<2>(const std::filesystem::path&, const Landmarks<2>&);
extern template void write_landmarks<3>(const std::filesystem::path&, const Landmarks<3>&);

}  // namespace crease
