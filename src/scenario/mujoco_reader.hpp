#pragma once

#include "../common/yaml_reader.hpp"

#include <tope/plant/mujoco.hpp>

namespace tope {

/// The keys of `plant: {type: mujoco, ...}` but its type.
MujocoOptions read_mujoco(const YamlReader& yaml);

}  // namespace tope
