#pragma once

#include <string>
#include <vector>

namespace tope {

/// How joint limits enter the control law.
enum class LimitMethod {
  unilateral,       ///< true inequalities under strict priority, the default
  chain,            ///< limit rows blended along the chain of their sorted activations
  multilinear,      ///< limit rows blended over every subset, 2^r laws: the reference for tests
  intermediate,     ///< intermediate desired values with all levels in the law without row j, (16)-(18)
  paper,            ///< intermediate desired values from the limit rows alone, (26)-(29) to the letter
  switching,        ///< a limit row is absent outside its buffer and complete inside
  potential_field,  ///< a repulsive field (Khatib 1986) for some joints, switching for the others
  none,             ///< no limits
};

/// Names a user writes, in the order of the enum: "unilateral", "chain", "multilinear", "intermediate",
/// "paper", "switch", "potential_field", "none".
const std::vector<std::string>& limit_method_names();
const std::string& to_string(LimitMethod method);
/// Errors: ConfigError for an unknown name, with the nearest known one.
LimitMethod limit_method_from(const std::string& name);

}  // namespace tope
