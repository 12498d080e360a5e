#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "Core/Point.h"

namespace crease::testing {

/// The folder of test values with 50 digits: the environment variable CREASE_VECTORS_DIR, else
/// spec/vectors in the folder of shared data. Empty when there is none.
std::filesystem::path vectors_folder();

/// All its files of one `kind` and dimension, parsed, by name. Empty when there is no folder.
std::vector<nlohmann::json> reference_vectors(const std::string& kind, int dim);

/// A JSON array of numbers, or of strings that hold numbers.
std::vector<double> numbers(const nlohmann::json& array);

template <int Dim>
Point<Dim> point(const nlohmann::json& array) {
  return Eigen::Map<const Point<Dim>>(numbers(array).data());
}

template <int Dim>
std::vector<Point<Dim>> points(const nlohmann::json& array) {
  std::vector<Point<Dim>> result;
  for (const auto& entry : array) result.push_back(point<Dim>(entry));
  return result;
}

}  // namespace crease::testing
