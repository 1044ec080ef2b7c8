#include "change_reader.hpp"

#include "task_reader.hpp"

#include <tope/common/names.hpp>

#include <algorithm>
#include <string>
#include <utility>

namespace tope {
namespace {

using Kind = TaskChange::Kind;

/// The key that says what a change is about, which names its task.
const std::vector<std::pair<std::string, Kind>>& kinds() {
  static const std::vector<std::pair<std::string, Kind>> all{
      {"add", Kind::add}, {"remove", Kind::remove}, {"move", Kind::move}, {"replace", Kind::replace}};
  return all;
}

std::pair<std::string, Kind> read_kind(const YamlReader& yaml) {
  std::pair<std::string, Kind> found;
  for (const auto& kind : kinds()) {
    if (!yaml.has(kind.first)) {
      continue;
    }
    if (!found.first.empty()) {
      yaml.fail(kind.first, "is one change, and " + found.first + " another: give each an item of its own");
    }
    found = kind;
  }
  if (found.first.empty()) {
    yaml.fail("", "says no change: expected add, remove, move or replace with the name of a task");
  }
  return found;
}

std::size_t read_task_number(const YamlReader& yaml, const std::string& key,
                             const std::vector<ScenarioTask>& tasks) {
  const std::string name = yaml.text(key);
  std::vector<std::string> names;
  for (const ScenarioTask& task : tasks) {
    if (task.name == name) {
      return names.size();
    }
    names.push_back(task.name);
  }
  yaml.fail(key, "no task is named '" + name + "'" + name_hint(name, names));
}

double not_negative(const YamlReader& yaml, const std::string& key, double value) {
  if (value < 0.0) {
    yaml.fail(key, "must not be negative [s], got " + std::to_string(value));
  }
  return value;
}

std::shared_ptr<const Task> read_replacement(const YamlReader& yaml, const Robot& robot,
                                             const ScenarioTask& replaced) {
  const YamlReader with = yaml.map("with");
  std::shared_ptr<const Task> task = read_goal(with, robot);
  with.finish();
  if (task->size() != replaced.task->size()) {
    yaml.fail("with", "has " + std::to_string(task->size()) + " rows, task '" + replaced.name + "' has " +
                          std::to_string(replaced.task->size()) +
                          ": add another task and remove this one instead");
  }
  return task;
}

/// Refuses a change of a task that is not there, or the arrival of one that is.
void require_order(const YamlReader& item, const std::string& key, const TaskChange& change,
                   const std::vector<TaskChange>& before) {
  const auto last = std::find_if(before.rbegin(), before.rend(),
                                 [&](const TaskChange& earlier) { return earlier.task == change.task; });
  if (last != before.rend() && change.kind == Kind::add && last->kind != Kind::remove) {
    item.fail(key, "the task is there already: only one that was removed can be added again");
  }
  if (last != before.rend() && change.kind != Kind::add && last->kind == Kind::remove) {
    item.fail(key, "the task was removed before");
  }
}

}  // namespace

std::vector<TaskChange> read_changes(const YamlReader& yaml, const Robot& robot,
                                     const std::vector<ScenarioTask>& tasks) {
  std::vector<TaskChange> changes;
  if (!yaml.has("changes")) {
    return changes;
  }
  for (const YamlReader& item : yaml.list_of_maps("changes")) {
    const auto [key, kind] = read_kind(item);
    TaskChange change;
    change.kind = kind;
    change.task = read_task_number(item, key, tasks);
    change.at = not_negative(item, "at", item.number("at"));
    change.over = not_negative(item, "over", item.number("over", 0.0));
    if (kind == Kind::move) {
      change.level = read_level(item);
    }
    if (kind == Kind::replace) {
      change.with = read_replacement(item, robot, tasks[change.task]);
    }
    if (!changes.empty() && change.at < changes.back().at) {
      item.fail("at", "is before the change above it: list changes in the order in which they happen");
    }
    require_order(item, key, change, changes);
    item.finish();
    changes.push_back(std::move(change));
  }
  return changes;
}

}  // namespace tope
