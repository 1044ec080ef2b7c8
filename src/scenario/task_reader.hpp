#pragma once

#include "../common/yaml_reader.hpp"

#include <tope/scenario/scenario.hpp>

namespace tope {

/// Reads what a task is, without its name and level, and leaves finish() to the caller. Errors: ConfigError naming file,
/// line and key.
std::shared_ptr<const Task> read_goal(const YamlReader& yaml, const Robot& robot);

/// Reads `level`. Errors: ConfigError for one below 1.
int read_level(const YamlReader& yaml);

/// Reads one item of a scenario's `tasks`. Errors: ConfigError naming file, line and key.
ScenarioTask read_task(const YamlReader& yaml, const Robot& robot);

}  // namespace tope
