#include "Transforms/Domains/FeatureLineFile.h"

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <limits>
#include <optional>

#include "Core/Error.h"
#include "Transforms/Domains/CsvTable.h"

namespace crease {
namespace {

/// The cell as one of the words; `fallback` when it is empty.
template <typename Word>
Word parse_word(const CsvTable& table, int row, const std::string& column, Word fallback,
                std::initializer_list<Word> words) {
  const std::string& cell = table.text(row, column);
  if (cell.empty()) return fallback;
  std::string choices;
  for (const Word word : words) {
    if (cell == to_string(word)) return word;
    choices += (choices.empty() ? "" : ", ") + to_string(word);
  }
  throw InvalidInput(message(table.place(row), ", column '", column, "': '", cell,
                             "' is not one of ", choices, "."));
}

/// A line while its rows are read.
struct RowsOfLine {
  FeatureLine line;
  std::vector<FeatureKind> kinds;  // per point
  int first_row = 0;
};

void add_row(const CsvTable& table, int row, RowsOfLine& rows) {
  rows.line.points.emplace_back(table.number(row, "x"), table.number(row, "y"));
  rows.kinds.push_back(parse_word(table, row, "kind", FeatureKind::kCrease,
                                  {FeatureKind::kCrease, FeatureKind::kSlide, FeatureKind::kSlit}));
  const BodySide body = parse_word(table, row, "body", BodySide::kAutomatic,
                                   {BodySide::kLeft, BodySide::kRight, BodySide::kNone});
  const CornerRule corner = parse_word(table, row, "corner", CornerRule::kBlunt,
                                       {CornerRule::kBlunt, CornerRule::kCollapse});
  if (rows.line.points.size() == 1) {
    rows.line.body = body;
    rows.line.corner = corner;
  } else if (body != rows.line.body || corner != rows.line.corner) {
    throw InvalidInput(message(table.place(row), ": 'body' or 'corner' of line ", rows.line.name,
                               " differs from its first row; they belong to the whole line."));
  }
}

FeatureLine finished(const CsvTable& table, RowsOfLine rows) {
  FeatureLine& line = rows.line;
  if (line.points.size() < 2) {
    throw InvalidInput(message(table.place(rows.first_row), ": line ", line.name,
                               " has a single point; a line needs at least two."));
  }
  line.closed = line.points.front() == line.points.back();
  if (line.closed) line.points.pop_back();
  if (line.closed && line.points.size() < 3) {
    throw InvalidInput(message(table.place(rows.first_row), ": line ", line.name,
                               " is closed but has fewer than three edges."));
  }
  rows.kinds.resize(static_cast<std::size_t>(line.num_edges()));
  line.kind = rows.kinds.front();
  const bool mixed = std::any_of(rows.kinds.begin(), rows.kinds.end(),
                                 [&](FeatureKind kind) { return kind != line.kind; });
  if (mixed) line.edge_kinds = std::move(rows.kinds);
  return std::move(line);
}

std::vector<FeatureLine> read_csv(const std::filesystem::path& path) {
  const CsvTable table(path);
  table.check_columns({"line", "x", "y"}, {"kind", "body", "corner"});
  std::vector<RowsOfLine> all;
  for (int row = 0; row < table.num_rows(); ++row) {
    const std::string& name = table.text(row, "line");
    if (name.empty()) throw InvalidInput(message(table.place(row), ", column 'line' is empty."));
    auto it = std::find_if(all.begin(), all.end(),
                           [&](const RowsOfLine& rows) { return rows.line.name == name; });
    if (it == all.end()) {
      all.emplace_back().line.name = name;
      it = all.end() - 1;
      it->first_row = row;
    }
    add_row(table, row, *it);
  }
  if (all.empty()) {
    throw InvalidInput(message(path.string(), ": holds no points, only the column names."));
  }
  std::vector<FeatureLine> lines;
  for (auto& rows : all) lines.push_back(finished(table, std::move(rows)));
  return lines;
}

}  // namespace

std::vector<FeatureLine> read_feature_lines(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".json" ? read_slicer_curves(path) : read_csv(path);
}

void write_feature_lines(const std::filesystem::path& path, const std::vector<FeatureLine>& lines) {
  std::ofstream stream(path);
  stream << std::setprecision(std::numeric_limits<double>::max_digits10)
         << "line,x,y,kind,body,corner\n";
  for (std::size_t l = 0; l < lines.size(); ++l) {
    const FeatureLine& line = lines[l];
    const int num_points = static_cast<int>(line.points.size());
    for (int i = 0; i < num_points + (line.closed ? 1 : 0); ++i) {
      const Point<2>& p = line.points[i % num_points];
      stream << l + 1 << ',' << p.x() << ',' << p.y() << ','
             << to_string(line.edge_kind(std::min(i, line.num_edges() - 1))) << ','
             << to_string(body_side(line)) << ',' << to_string(line.corner) << '\n';
    }
  }
  stream.close();
  if (!stream) throw FileError(message(path.string(), ": cannot be written."));
}

}  // namespace crease
