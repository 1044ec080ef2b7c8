#include <tope/common/error.hpp>
#include <tope/scenario/log.hpp>

#include <array>
#include <charconv>
#include <utility>

namespace tope {

Log::Log(std::vector<std::string> columns, const std::filesystem::path& file, bool keep)
    : columns_(std::move(columns)), file_(file), keep_(keep) {
  if (file_.empty()) {
    return;
  }
  stream_.open(file_);
  for (const std::string& column : columns_) {
    line_ += column + ",";
  }
  line_ += "status\n";
  write_line();
}

void Log::write(std::span<const double> values, const std::string& status) {
  if (keep_) {
    values_.insert(values_.end(), values.begin(), values.end());
    status_.push_back(status);
  }
  if (file_.empty()) {
    return;
  }
  line_.clear();
  std::array<char, 32> number{};
  for (const double value : values) {
    // ten digits resolve a micrometre in a kilometre, and halve the file
    const auto end =
        std::to_chars(number.data(), number.data() + number.size(), value, std::chars_format::general, 10)
            .ptr;
    line_.append(number.data(), end);
    line_ += ',';
  }
  line_ += status;
  line_ += '\n';
  write_line();
}

void Log::write_line() {
  if (!(stream_ << line_)) {
    throw Error("cannot write " + file_.string());
  }
}

}  // namespace tope
