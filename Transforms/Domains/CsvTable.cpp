#include "Transforms/Domains/CsvTable.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "Core/Error.h"

namespace crease {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  text = text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  return std::string(text);
}

std::vector<std::string> split(std::string_view line, char separator) {
  std::vector<std::string> cells;
  bool quoted = false;
  std::size_t start = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i == line.size() || (line[i] == separator && !quoted)) {
      cells.push_back(trimmed(line.substr(start, i - start)));
      start = i + 1;
    }
  }
  return cells;
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& path) : file_(path.string()) {
  std::ifstream stream(path);
  if (!stream)
    throw FileError(message(file_, ": cannot be opened; check the name and the rights."));
  std::string line;
  char separator = ',';
  for (int number = 1; std::getline(stream, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const std::string content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    if (names_.empty() && line.find(',') == std::string::npos) separator = ';';
    auto cells = split(line, separator);
    if (names_.empty()) {
      names_ = std::move(cells);
      continue;
    }
    if (cells.size() != names_.size()) {
      throw InvalidInput(message(file_, ", row ", number, ": ", cells.size(), " cells, but the ",
                                 "header names ", names_.size(), " columns."));
    }
    rows_.push_back(std::move(cells));
    line_numbers_.push_back(number);
  }
  if (stream.bad()) throw FileError(message(file_, ": reading failed."));
  if (names_.empty()) {
    throw InvalidInput(message(file_, ": is empty; the first row must name the columns."));
  }
}

void CsvTable::check_columns(const std::vector<std::string>& required,
                             const std::vector<std::string>& optional) const {
  for (const auto& name : required) {
    if (!has_column(name)) {
      throw InvalidInput(message(file_, ": column '", name, "' is missing in the first row."));
    }
  }
  for (const auto& name : names_) {
    const bool known = std::count(required.begin(), required.end(), name) +
                           std::count(optional.begin(), optional.end(), name) >
                       0;
    if (!known) {
      throw InvalidInput(message(file_, ": unknown column '", name, "' in the first row."));
    }
    if (std::count(names_.begin(), names_.end(), name) > 1) {
      throw InvalidInput(message(file_, ": column '", name, "' is given twice."));
    }
  }
}

int CsvTable::column(const std::string& name) const {
  const auto it = std::find(names_.begin(), names_.end(), name);
  return it == names_.end() ? -1 : static_cast<int>(it - names_.begin());
}

const std::string& CsvTable::text(int row, const std::string& name) const {
  static const std::string none;
  const int c = column(name);
  return c < 0 ? none : rows_[row][c];
}

double CsvTable::number(int row, const std::string& name) const {
  const std::string& cell = text(row, name);
  double value = 0;
  const char* begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) {
    throw InvalidInput(message(place(row), ", column '", name, "': '", cell,
                               "' is not a finite number; correct or delete the row."));
  }
  return value;
}

std::string CsvTable::place(int row) const { return message(file_, ", row ", line_numbers_[row]); }

}  // namespace crease
