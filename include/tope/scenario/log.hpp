#pragma once

#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace tope {

/// Rows of numbers under named columns, closed by a column of text, "status". Goes to a CSV file row by row,
/// so that what was written stays readable if the run stops; to memory as well if asked.
class Log {
 public:
  /// Empty path: no file. Errors: Error when the file cannot be written.
  Log(std::vector<std::string> columns, const std::filesystem::path& file, bool keep);

  /// Errors: Error when the file cannot be written.
  void write(std::span<const double> values, const std::string& status);

  const std::vector<std::string>& columns() const { return columns_; }
  const std::vector<double>& values() const { return values_; }  ///< row after row
  const std::vector<std::string>& status() const { return status_; }

 private:
  void write_line();

  std::vector<std::string> columns_;
  std::filesystem::path file_;
  std::ofstream stream_;
  bool keep_;
  std::string line_;
  std::vector<double> values_;
  std::vector<std::string> status_;
};

}  // namespace tope
