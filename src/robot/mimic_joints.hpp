#pragma once

#include <urdf_model/model.h>

#include <map>
#include <string>

namespace tope {

/// Holds the joints that mimic a held one where that one puts them: adds them to `locked` and makes them joints like
/// others in the tree. Errors: ConfigError, beginning with `where`, for a joint that mimics one that moves.
void hold_mimic_joints(const std::string& where, urdf::ModelInterface& tree,
                       std::map<std::string, double>& locked);

}  // namespace tope
