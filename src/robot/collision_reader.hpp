#pragma once

#include "../common/yaml_reader.hpp"

#include <tope/robot/collision_geometry.hpp>

namespace tope {

/// The spheres, exclusions and, under `key`, bodies of a `collisions` map. Errors: ConfigError with file, line and key.
CollisionGeometry read_collision_geometry(const YamlReader& yaml, const std::string& key);

}  // namespace tope
