#include "support/text.hpp"

#include <tope/common/error.hpp>

#include <boost/test/unit_test.hpp>

#include <fstream>
#include <sstream>
#include <stdexcept>
#include <unistd.h>

namespace tope::test {

void check_error(const std::function<void()>& action, std::initializer_list<std::string> parts) {
  try {
    action();
  } catch (const Error& error) {
    const std::string message = error.what();
    for (const std::string& part : parts) {
      BOOST_TEST(message.find(part) != std::string::npos, "'" << part << "' is not in: " << message);
    }
    return;
  }
  BOOST_ERROR("no error; expected one that says '" << *parts.begin() << "'");
}

TemporaryFile::TemporaryFile(const std::string& name, const std::string& content) {
  static int count = 0;
  const auto folder = std::filesystem::temp_directory_path() /
                      ("tope_test_" + std::to_string(getpid()) + "_" + std::to_string(count++));
  std::filesystem::create_directories(folder);
  path_ = folder / name;
  std::ofstream(path_) << content;
}

TemporaryFile::~TemporaryFile() {
  std::error_code ignored;
  std::filesystem::remove_all(path_.parent_path(), ignored);
}

std::filesystem::path source_path(const std::string& relative) {
  return std::filesystem::path(TOPE_SOURCE_DIR) / relative;
}

std::string read_text(const std::filesystem::path& file) {
  const std::ifstream stream(file);
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) {
    throw std::runtime_error("no '" + from + "' to replace");
  }
  return text.replace(at, from.size(), to);
}

}  // namespace tope::test
