#include "Registration/Landmarks.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>

#include "Core/Error.h"
#include "Transforms/Domains/CsvTable.h"

namespace crease {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

template <int Dim>
Point<Dim> point(const CsvTable& table, int row, const std::string& image) {
  Point<Dim> p;
  for (int a = 0; a < Dim; ++a) p[a] = table.number(row, image + "_" + kAxes[a]);
  return p;
}

// The cell's number; none when it is empty.
double optional_number(const CsvTable& table, int row, const std::string& name) {
  return table.text(row, name).empty() ? kNone : table.number(row, name);
}

// Shortest text that reads back as the same number; nothing for NaN.
std::string exact_text(double value) {
  if (value != value) return {};
  std::array<char, 32> text;
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

// CSV cells here know no escape: quotes inside become apostrophes.
std::string quoted(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  return '"' + text + '"';
}

template <int Dim>
void check_columns(const CsvTable& table, const std::filesystem::path& path) {
  std::vector<std::string> required;
  for (const char* image : {"fixed_", "moving_"}) {
    for (int a = 0; a < Dim; ++a) required.push_back(std::string(image) + kAxes[a]);
  }
  std::vector<std::string> optional = {"sigma_mm", "name"};
  if (Dim == 2) {
    optional.insert(optional.end(), {"fixed_angle", "moving_angle"});
    if (table.has_column("fixed_z") && table.has_column("moving_z")) {
      throw InvalidInput(message(path.string(), ": holds landmarks in 3D, but the images are 2D; ",
                                 "remove the columns 'fixed_z' and 'moving_z'."));
    }
  }
  table.check_columns(required, optional);
  if (table.has_column("fixed_angle") != table.has_column("moving_angle")) {
    throw InvalidInput(message(path.string(),
                               ": 'fixed_angle' and 'moving_angle' belong together; ",
                               "one of the columns is missing."));
  }
}

double read_sigma(const CsvTable& table, int row) {
  const double sigma = optional_number(table, row, "sigma_mm");
  if (sigma <= 0) {
    throw InvalidInput(message(table.place(row), ", column 'sigma_mm': ", sigma,
                               " is not positive; leave the cell empty for an exact landmark."));
  }
  return sigma;
}

}  // namespace

template <int Dim>
Landmarks<Dim> read_landmarks(const std::filesystem::path& path) {
  const CsvTable table(path);
  check_columns<Dim>(table, path);
  Landmarks<Dim> landmarks;
  for (int row = 0; row < table.num_rows(); ++row) {
    landmarks.fixed.push_back(point<Dim>(table, row, "fixed"));
    landmarks.moving.push_back(point<Dim>(table, row, "moving"));
    if (table.has_column("sigma_mm")) landmarks.sigma_mm.push_back(read_sigma(table, row));
    if (table.has_column("fixed_angle")) {
      landmarks.fixed_angle.push_back(optional_number(table, row, "fixed_angle"));
      landmarks.moving_angle.push_back(optional_number(table, row, "moving_angle"));
      if (std::isnan(landmarks.fixed_angle.back()) != std::isnan(landmarks.moving_angle.back())) {
        throw InvalidInput(message(table.place(row), ": only one of 'fixed_angle' and ",
                                   "'moving_angle' is given; fill in both or neither."));
      }
    }
    if (table.has_column("name")) landmarks.names.push_back(table.text(row, "name"));
  }
  if (landmarks.empty()) {
    throw InvalidInput(message(path.string(), ": holds no landmarks below the column names."));
  }
  return landmarks;
}

template <int Dim>
void write_landmarks(const std::filesystem::path& path, const Landmarks<Dim>& landmarks) {
  std::ofstream stream(path);
  const char* separator = "";
  const auto cell = [&](const std::string& text) {
    stream << separator << text;
    separator = ",";
  };
  if (!landmarks.names.empty()) cell("name");
  for (const char* image : {"fixed_", "moving_"}) {
    for (int a = 0; a < Dim; ++a) cell(std::string(image) + kAxes[a]);
  }
  if (!landmarks.sigma_mm.empty()) cell("sigma_mm");
  if (!landmarks.fixed_angle.empty()) cell("fixed_angle");
  if (!landmarks.moving_angle.empty()) cell("moving_angle");
  for (int j = 0; j < landmarks.size(); ++j) {
    stream << '\n';
    separator = "";
    if (!landmarks.names.empty()) cell(quoted(landmarks.names[j]));
    for (double x : landmarks.fixed[j]) cell(exact_text(x));
    for (double x : landmarks.moving[j]) cell(exact_text(x));
    if (!landmarks.sigma_mm.empty()) cell(exact_text(landmarks.sigma_mm[j]));
    if (!landmarks.fixed_angle.empty()) cell(exact_text(landmarks.fixed_angle[j]));
    if (!landmarks.moving_angle.empty()) cell(exact_text(landmarks.moving_angle[j]));
  }
  stream << '\n';
  if (!stream.flush()) throw FileError(message(path.string(), ": cannot be written."));
}

template Landmarks<2> read_landmarks<2>(const std::filesystem::path&);
template Landmarks<3> read_landmarks<3>(const std::filesystem::path&);
template void write_landmarks<2>(const std::filesystem::path&, const Landmarks<2>&);
template void write_landmarks<3>(const std::filesystem::path&, const Landmarks<3>&);

}  // namespace crease
