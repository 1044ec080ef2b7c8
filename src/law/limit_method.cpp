#include <tope/common/error.hpp>
#include <tope/common/names.hpp>
#include <tope/law/limit_method.hpp>

#include <algorithm>

namespace tope {

const std::vector<std::string>& limit_method_names() {
  static const std::vector<std::string> names{"unilateral", "chain",  "multilinear",     "intermediate",
                                              "paper",      "switch", "potential_field", "none"};
  return names;
}

const std::string& to_string(LimitMethod method) {
  return limit_method_names()[static_cast<std::size_t>(method)];
}

LimitMethod limit_method_from(const std::string& name) {
  const std::vector<std::string>& names = limit_method_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw ConfigError("unknown limit method '" + name + "'" + name_hint(name, names));
  }
  return static_cast<LimitMethod>(found - names.begin());
}

}  // namespace tope
