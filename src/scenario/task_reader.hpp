#pragma once

#include "../common/yaml_reader.hpp"

#include <tope/scenario/scenario.hpp>

namespace tope {

/// Reads one item of a scenario's `tasks`. Errors: ConfigError naming file, line and key.
ScenarioTask read_task(const YamlReader& yaml, const Robot& robot);

}  // namespace tope
