#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "Core/Raster.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"

namespace crease::testing {

/// The images of points by ITK itself: itk_map_points, a program that links ITK alone.
/// @param file  a transform (.tfm) or a displacement field (.mha).
template <int Dim>
std::vector<Point<Dim>> mapped_by_itk(const std::filesystem::path& file,
                                      const std::vector<Point<Dim>>& points) {
  const TemporaryFolder folder;
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  for (const auto& x : points) {
    for (double c : x) text << c << ' ';
    text << '\n';
  }
  const std::string in = folder.write("in", text.str()), out = (folder / "out").string();
  const auto run = run_program(ITK_MAP_POINTS, {std::to_string(Dim), file.string(), in, out});
  EXPECT_EQ(run.code, 0) << run.err;
  std::ifstream stream(out);
  std::vector<Point<Dim>> mapped(points.size());
  for (auto& y : mapped) {
    for (double& c : y) stream >> c;
  }
  EXPECT_TRUE(stream) << "ITK mapped fewer points than it was given";
  return mapped;
}

template <int Dim>
double largest_distance(const std::vector<Point<Dim>>& a, const std::vector<Point<Dim>>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, (a[k] - b[k]).norm());
  return largest;
}

/// Random points whose index coordinates on the raster lie between margin and size - 1 - margin.
template <int Dim>
std::vector<Point<Dim>> points_within(const Raster<Dim>& raster, int count, double margin = 0) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Point<Dim>> points;
  for (int k = 0; k < count; ++k) {
    Vector<Dim> index;
    for (int a = 0; a < Dim; ++a) {
      index[a] = margin + uniform(engine) * (raster.size[a] - 1 - 2 * margin);
    }
    points.push_back(raster.point(index));
  }
  return points;
}

}  // namespace crease::testing
