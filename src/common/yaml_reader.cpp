#include "yaml_reader.hpp"

#include <tope/common/names.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace tope {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = text.find(separator); end != std::string::npos; end = text.find(separator, begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

/// Step into a list by number, or by the `name` its items carry; into a map by key.
YAML::Node step_into(const YAML::Node& node, const std::string& part, const std::string& path) {
  if (!node.IsSequence()) {
    return YAML::Node(node)[part];
  }
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error == std::errc{} && end == part.data() + part.size() && index < node.size()) {
    return node[index];
  }
  for (const YAML::Node& item : node) {
    if (item.IsMap() && item["name"] && item["name"].Scalar() == part) {
      return item;
    }
  }
  throw ConfigError("--set " + path + ": '" + part + "' is neither a name nor a number below " +
                    std::to_string(node.size()) + " in that list");
}

void apply_override(const YAML::Node& root, const std::string& path, const std::string& value) {
  const std::vector<std::string> parts = split(path, '.');
  YAML::Node node = root;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    YAML::Node next = step_into(node, parts[i], path);
    if (next.IsDefined() && next.IsScalar()) {
      throw ConfigError("--set " + path + ": '" + parts[i] + "' holds a single value, not a map");
    }
    node.reset(next);
  }
  try {
    step_into(node, parts.back(), path) = YAML::Load(value);
  } catch (const YAML::Exception& error) {
    throw ConfigError("--set " + path + ": '" + value + "' is not YAML: " + error.msg);
  }
}

}  // namespace

std::size_t choice(const YamlReader& yaml, const std::string& key, const std::string& value,
                   const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), value);
  if (found == names.end()) {
    yaml.fail(key, "unknown value '" + value + "'" + name_hint(value, names));
  }
  return static_cast<std::size_t>(found - names.begin());
}

YamlReader::YamlReader(const YAML::Node& node, std::string prefix, std::shared_ptr<const Source> source)
    : node_(node),
      prefix_(std::move(prefix)),
      source_(std::move(source)),
      known_(std::make_shared<std::vector<std::string>>()) {}

YamlReader YamlReader::load(const std::filesystem::path& file, const Overrides& overrides) {
  YAML::Node root;
  std::error_code no_error;
  if (std::filesystem::is_directory(file, no_error)) {
    throw ConfigError(file.string() + ": is a folder, expected a file");
  }
  try {
    root = YAML::LoadFile(file.string());
  } catch (const YAML::BadFile&) {
    throw ConfigError(file.string() + ": no such file, or it cannot be read");
  } catch (const YAML::Exception& error) {
    throw ConfigError(file.string() + ":" + std::to_string(error.mark.line + 1) + ": not YAML: " + error.msg);
  }
  if (!root.IsMap()) {
    throw ConfigError(file.string() + ": expected a map of keys at the top");
  }
  for (const auto& [path, value] : overrides) {
    apply_override(root, path, value);
  }
  return {root, "", std::make_shared<const Source>(Source{file, overrides})};
}

const std::filesystem::path& YamlReader::file() const { return source_->file; }

std::string YamlReader::full_key(const std::string& key) const {
  if (prefix_.empty() || key.empty()) {
    return prefix_ + key;
  }
  return prefix_ + "." + key;
}

std::string YamlReader::where(const std::string& path, const YAML::Node& node) const {
  for (const auto& [override_path, value] : source_->overrides) {
    if (path == override_path || path.starts_with(override_path + ".")) {
      return "--set " + override_path + "=" + value + ": " + path;
    }
  }
  const int line = node.IsDefined() ? node.Mark().line : -1;
  return source_->file.string() + (line < 0 ? "" : ":" + std::to_string(line + 1)) + ": " + path;
}

void YamlReader::fail(const std::string& key, const std::string& message) const {
  const YAML::Node node = key.empty() ? node_ : find(key);
  throw ConfigError(where(full_key(key), node.IsDefined() ? node : node_) + ": " + message);
}

YAML::Node YamlReader::find(const std::string& key) const {
  known_->push_back(key);
  const YAML::Node& constant = node_;  // the const operator[] does not insert the key
  return constant[key];
}

YAML::Node YamlReader::require(const std::string& key) const {
  YAML::Node node = find(key);
  if (!node.IsDefined()) {
    refuse_misspelling(key);
  }
  if (!node.IsDefined() || node.IsNull()) {
    fail(key, "is missing");
  }
  return node;
}

/// A needed key that is missing may stand there misspelled: then that is what to tell.
void YamlReader::refuse_misspelling(const std::string& key) const {
  for (const auto& entry : node_) {
    const std::string given = entry.first.Scalar();
    const bool known = std::find(known_->begin(), known_->end(), given) != known_->end();
    if (key.size() > 1 && !known && !nearest_name(given, {&key, 1}).empty()) {
      throw ConfigError(where(full_key(given), entry.first) + ": unknown key; did you mean '" + key + "'?");
    }
  }
}

bool YamlReader::has(const std::string& key) const { return find(key).IsDefined(); }

template <typename T>
T YamlReader::scalar(const std::string& key, const YAML::Node& node, const char* expected) const {
  T value{};
  if (!node.IsScalar() || !YAML::convert<T>::decode(node, value)) {
    const std::string got = node.IsScalar() ? "'" + node.Scalar() + "'" : "a list or a map";
    throw ConfigError(where(full_key(key), node) + ": expected " + expected + ", got " + got);
  }
  return value;
}

YamlReader YamlReader::child(const std::string& key, const YAML::Node& node) const {
  if (!node.IsMap()) {
    throw ConfigError(where(full_key(key), node) + ": expected a map of keys");
  }
  return {node, full_key(key), source_};
}

YamlReader YamlReader::map(const std::string& key) const { return child(key, require(key)); }

std::optional<YamlReader> YamlReader::optional_map(const std::string& key) const {
  if (!has(key)) {
    return std::nullopt;
  }
  return map(key);
}

std::vector<YamlReader> YamlReader::list_of_maps(const std::string& key) const {
  const YAML::Node node = require(key);
  if (!node.IsSequence()) {
    fail(key, "expected a list");
  }
  std::vector<YamlReader> items;
  items.reserve(node.size());
  for (std::size_t i = 0; i < node.size(); ++i) {
    items.push_back(child(key + "." + std::to_string(i), node[i]));
  }
  return items;
}

double YamlReader::number(const std::string& key) const {
  const auto value = scalar<double>(key, require(key), "a number");
  if (!std::isfinite(value)) {
    fail(key, "expected a finite number");
  }
  return value;
}

double YamlReader::number(const std::string& key, double fallback) const {
  return has(key) ? number(key) : fallback;
}

double YamlReader::positive(const std::string& key) const {
  const double value = number(key);
  if (value <= 0.0) {
    fail(key, "must be positive, got '" + require(key).Scalar() + "'");
  }
  return value;
}

double YamlReader::positive(const std::string& key, double fallback) const {
  return has(key) ? positive(key) : fallback;
}

std::optional<double> YamlReader::optional_positive(const std::string& key) const {
  return has(key) ? std::optional(positive(key)) : std::nullopt;
}

bool YamlReader::flag(const std::string& key, bool fallback) const {
  return choice(*this, key, text(key, fallback ? "true" : "false"), {"false", "true"}) == 1;
}

int YamlReader::integer(const std::string& key) const {
  return scalar<int>(key, require(key), "a whole number");
}

int YamlReader::integer(const std::string& key, int fallback) const {
  return has(key) ? integer(key) : fallback;
}

std::string YamlReader::text(const std::string& key) const {
  return scalar<std::string>(key, require(key), "text");
}

std::string YamlReader::text(const std::string& key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

Vector YamlReader::vector(const std::string& key, int size) const {
  const YAML::Node node = require(key);
  if (!node.IsSequence()) {
    fail(key, "expected a list of numbers");
  }
  if (size >= 0 && static_cast<int>(node.size()) != size) {
    fail(key, "expected " + std::to_string(size) + " numbers, got " + std::to_string(node.size()));
  }
  Vector values(static_cast<Eigen::Index>(node.size()));
  for (std::size_t i = 0; i < node.size(); ++i) {
    const auto value = scalar<double>(key + "." + std::to_string(i), node[i], "a number");
    if (!std::isfinite(value)) {
      fail(key, "item " + std::to_string(i) + " is not finite");
    }
    values[static_cast<Eigen::Index>(i)] = value;
  }
  return values;
}

/// Quaternions are given in a few digits and normalised; one that is not nearly of unit length is a mistake.
Matrix3 YamlReader::rotation(const std::string& key) const {
  const Vector wxyz = vector(key, 4);
  if (std::abs(wxyz.norm() - 1.0) > 1e-2) {
    fail(key, "not a rotation: its norm is " + std::to_string(wxyz.norm()) +
                  "; expected a unit quaternion [w, x, y, z]");
  }
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

std::vector<std::string> YamlReader::texts(const std::string& key) const {
  const YAML::Node node = require(key);
  if (!node.IsSequence()) {
    fail(key, "expected a list of names");
  }
  std::vector<std::string> values;
  values.reserve(node.size());
  for (std::size_t i = 0; i < node.size(); ++i) {
    values.push_back(scalar<std::string>(key + "." + std::to_string(i), node[i], "text"));
  }
  return values;
}

std::vector<std::pair<std::string, double>> YamlReader::numbers(const std::string& key) const {
  const YamlReader reader = map(key);
  std::vector<std::pair<std::string, double>> values;
  for (const std::string& name : reader.keys()) {
    values.emplace_back(name, reader.number(name));
  }
  return values;
}

std::vector<std::string> YamlReader::keys() const {
  std::vector<std::string> names;
  for (const auto& entry : node_) {
    names.push_back(entry.first.Scalar());
  }
  return names;
}

std::filesystem::path YamlReader::path(const std::string& key) const {
  const std::string given = text(key);
  return given.starts_with("package://") ? std::filesystem::path(given)
                                         : (source_->file.parent_path() / given).lexically_normal();
}

void YamlReader::finish() const {
  for (const auto& entry : node_) {
    const std::string key = entry.first.Scalar();
    if (std::find(known_->begin(), known_->end(), key) == known_->end()) {
      throw ConfigError(where(full_key(key), entry.first) + ": unknown key" + name_hint(key, *known_));
    }
  }
}

}  // namespace tope
