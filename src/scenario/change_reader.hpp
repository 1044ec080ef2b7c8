#pragma once

#include "../common/yaml_reader.hpp"

#include <tope/scenario/scenario.hpp>

#include <vector>

namespace tope {

/// Reads a scenario's `changes` of its tasks, sorted by time. Errors: ConfigError naming file, line and key.
std::vector<TaskChange> read_changes(const YamlReader& yaml, const Robot& robot,
                                     const std::vector<ScenarioTask>& tasks);

}  // namespace tope
