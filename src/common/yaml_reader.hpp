#pragma once

#include <tope/common/error.hpp>
#include <tope/common/types.hpp>

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tope {

/// One "--set key=value": a dotted path (list items by number) and a YAML value.
using Overrides = std::map<std::string, std::string>;

class YamlReader;

/// Place of `value` among `names`. Errors: ConfigError at `key`, with the nearest known name.
std::size_t choice(const YamlReader& yaml, const std::string& key, const std::string& value,
                   const std::vector<std::string>& names);

/// Strict view of one YAML map. Reads typed values, remembers which keys were asked for, and finish() refuses
/// the rest. Every error names file, line and key. Errors: ConfigError.
class YamlReader {
 public:
  static YamlReader load(const std::filesystem::path& file, const Overrides& overrides = {});

  /// True when the key is given; from then on finish() knows it.
  bool has(const std::string& key) const;
  YamlReader map(const std::string& key) const;
  std::optional<YamlReader> optional_map(const std::string& key) const;
  std::vector<YamlReader> list_of_maps(const std::string& key) const;

  double number(const std::string& key) const;
  double number(const std::string& key, double fallback) const;
  double positive(const std::string& key) const;
  double positive(const std::string& key, double fallback) const;
  std::optional<double> optional_positive(const std::string& key) const;
  bool flag(const std::string& key, bool fallback) const;
  int integer(const std::string& key) const;
  int integer(const std::string& key, int fallback) const;
  std::string text(const std::string& key) const;
  std::string text(const std::string& key, const std::string& fallback) const;
  /// Numbers of a list; size < 0 takes any length.
  Vector vector(const std::string& key, int size) const;
  /// The rotation of a quaternion [w, x, y, z].
  Matrix3 rotation(const std::string& key) const;
  std::vector<std::string> texts(const std::string& key) const;
  /// All entries of a map of numbers, in the order of the file.
  std::vector<std::pair<std::string, double>> numbers(const std::string& key) const;
  std::vector<std::string> keys() const;
  /// A path that is relative to this file's folder; package://NAME/... stays as it is.
  std::filesystem::path path(const std::string& key) const;

  /// Refuses every key that was never asked for, naming the nearest known one.
  void finish() const;

  [[noreturn]] void fail(const std::string& key, const std::string& message) const;
  const std::filesystem::path& file() const;

 private:
  struct Source {
    std::filesystem::path file;
    Overrides overrides;
  };

  YamlReader(const YAML::Node& node, std::string prefix, std::shared_ptr<const Source> source);

  YAML::Node require(const std::string& key) const;
  void refuse_misspelling(const std::string& key) const;
  YAML::Node find(const std::string& key) const;
  std::string where(const std::string& path, const YAML::Node& node) const;
  std::string full_key(const std::string& key) const;
  template <typename T>
  T scalar(const std::string& key, const YAML::Node& node, const char* expected) const;
  YamlReader child(const std::string& key, const YAML::Node& node) const;

  YAML::Node node_;
  std::string prefix_;
  std::shared_ptr<const Source> source_;
  std::shared_ptr<std::vector<std::string>> known_;
};

/// Runs `build` and gives an error that names no file the place of `key`.
template <typename Build>
auto located(const YamlReader& yaml, const std::string& key, Build build) {
  try {
    return build();
  } catch (const ConfigError& error) {
    yaml.fail(key, error.what());
  }
}

}  // namespace tope
