#pragma once

#include <urdf_model/model.h>

#include <filesystem>

namespace tope {

/// Parses a URDF and makes it fit the library's conventions: continuous joints become revolute ones without
/// bounds, so that every joint has one coordinate. Errors: ConfigError for a missing or malformed file, and for
/// joints with more than one degree of freedom.
urdf::ModelInterfaceSharedPtr load_urdf(const std::filesystem::path& file);

}  // namespace tope
