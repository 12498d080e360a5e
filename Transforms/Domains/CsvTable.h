#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace crease {

/// The rows of a small comma-separated file with one line of column names. Semicolons separate the cells
/// when the first line holds no comma.
///
/// Spaces round the cells, empty lines, lines that start with # and a byte order mark are ignored. Cells may be quoted.
class CsvTable {
 public:
  /// @throws FileError when the file cannot be read, InvalidInput when it has no header or a row with
  /// another number of cells; the message names file and row.
  explicit CsvTable(const std::filesystem::path& path);

  int num_rows() const { return static_cast<int>(rows_.size()); }
  bool has_column(const std::string& name) const { return column(name) >= 0; }
  /// @throws InvalidInput when a column is missing or an unknown one is there.
  void check_columns(const std::vector<std::string>& required,
                     const std::vector<std::string>& optional) const;
  /// The cell as text; empty when there is no such column.
  const std::string& text(int row, const std::string& name) const;
  /// The cell as a finite number. @throws InvalidInput naming file, row and column.
  double number(int row, const std::string& name) const;
  /// "file, row 7", counted in the file from 1.
  std::string place(int row) const;

 private:
  int column(const std::string& name) const;

  std::string file_;
  std::vector<std::string> names_;
  std::vector<std::vector<std::string>> rows_;
  std::vector<int> line_numbers_;
};

}  // namespace crease
