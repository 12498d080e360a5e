#include "Registration/PointFile.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <string_view>

#include "Core/Error.h"
#include "Core/WholeFile.h"
#include "Registration/PointFileSlicer.h"
#include "Registration/PointFileVtk.h"
#include "Transforms/Domains/CsvTable.h"

namespace crease {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> kEndings = {".csv", ".fcsv", ".mrk.json", ".vtk"};

std::string_view ending_of(const fs::path& path) {
  std::string name = path.filename().string();
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const std::string_view ending : kEndings) {
    if (name.ends_with(ending)) return ending;
  }
  return {};
}

std::string shortest(double number) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
  return {digits.data(), end};
}

class PointTable final : public PointFile {
 public:
  explicit PointTable(const fs::path& path) {
    const CsvTable table(path);
    if (table.has_column("z")) dimension_ = 3;
    const std::vector<std::string> axes = {"x", "y", "z"};
    table.check_columns({axes.begin(), axes.begin() + dimension_}, {"name"});
    for (int row = 0; row < table.num_rows(); ++row) {
      Point<3> p = Point<3>::Zero();
      for (int a = 0; a < dimension_; ++a) p[a] = table.number(row, axes[std::size_t(a)]);
      points_.push_back(p);
      if (table.has_column("name")) names_.push_back(table.text(row, "name"));
    }
    named_ = table.has_column("name");
  }

  int dimension() const override { return dimension_; }

  std::string with_points(const std::vector<Point<3>>& points) const override {
    std::string text = dimension_ == 2 ? "x,y" : "x,y,z";
    text += named_ ? ",name\n" : "\n";
    for (std::size_t k = 0; k < points.size(); ++k) {
      for (int a = 0; a < dimension_; ++a) text += (a > 0 ? "," : "") + shortest(points[k][a]);
      if (named_) text += "," + names_[k];
      text += "\n";
    }
    return text;
  }

 private:
  int dimension_ = 2;
  bool named_ = false;
};

}  // namespace

bool is_point_file(const fs::path& path) { return !ending_of(path).empty(); }

std::unique_ptr<PointFile> read_point_file(const fs::path& path) {
  const std::string_view ending = ending_of(path);
  if (ending == ".csv") return std::make_unique<PointTable>(path);
  if (ending == ".fcsv") return std::make_unique<SlicerTable>(path);
  if (ending == ".mrk.json") return std::make_unique<SlicerMarkups>(path);
  if (ending == ".vtk") return std::make_unique<VtkPoints>(path);
  throw InvalidInput(
      message(path.string(),
              ": the form of points is not known; known are .csv, .fcsv, .mrk.json and "
              ".vtk."));
}

void write_point_file(const fs::path& path, const PointFile& file, const fs::path& read_from,
                      const std::vector<Point<3>>& points) {
  if (ending_of(path) != ending_of(read_from)) {
    throw InvalidInput(message(path.string(), ": points of ", read_from.string(),
                               " are written in the same form; name a file that ends in ",
                               ending_of(read_from), "."));
  }
  write_whole_file(path, file.with_points(points));
}

}  // namespace crease
