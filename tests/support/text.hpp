#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>

namespace tope::test {

/// Runs `action`, expects a tope::Error, and checks that its message holds every one of `parts`.
void check_error(const std::function<void()>& action, std::initializer_list<std::string> parts);

/// A file in a folder of its own that vanishes with this object.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& name, const std::string& content);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A path in the source tree.
std::filesystem::path source_path(const std::string& relative);
std::string read_text(const std::filesystem::path& file);
/// `text` with the first `from` replaced. Throws when there is none.
std::string replaced(std::string text, const std::string& from, const std::string& to);

}  // namespace tope::test
