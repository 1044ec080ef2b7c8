#include <tope/common/error.hpp>
#include <tope/common/names.hpp>
#include <tope/robot/robot_terms.hpp>
#include <tope/scenario/live_simulation.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace tope {
namespace {

using Goals = std::map<std::string, std::shared_ptr<LiveGoal>>;

/// One goal for each frame that tasks are about, those that changes bring included where no other is about the frame; what
/// no task asks for is as the robot stands at first.
Goals goals_of(const Scenario& scenario) {
  RobotTerms terms(*scenario.robot);
  terms.update(scenario.initial, Vector::Zero(scenario.robot->nv()));
  Goals goals;
  const auto add = [&](const Task& task) {
    const auto goal = task.frame_goal(0.0);
    if (!goal) {
      return;
    }
    auto& live = goals[scenario.robot->frame_name(goal->frame)];
    if (!live) {
      live = std::make_shared<LiveGoal>(terms.frame_position(goal->frame), terms.frame_rotation(goal->frame));
    }
    *live = LiveGoal(goal->position.value_or(live->put_position()),
                     goal->rotation.value_or(live->put_rotation()));
  };
  for (const TaskChange& change : scenario.changes) {
    if (change.with) {
      add(*change.with);
    }
  }
  for (const ScenarioTask& task : scenario.tasks) {
    add(*task.task);
  }
  return goals;
}

std::vector<std::string> task_names(const Scenario& scenario) {
  std::vector<std::string> names;
  names.reserve(scenario.tasks.size());
  for (const ScenarioTask& task : scenario.tasks) {
    names.push_back(task.name);
  }
  return names;
}

/// What a running simulation cannot change.
void require_same(const Scenario& now, const Scenario& next) {
  const auto require = [](bool same, const std::string& what) {
    if (!same) {
      throw ConfigError(what + " cannot change while the simulation runs: start it anew");
    }
  };
  require(now.urdf == next.urdf && now.robot->joint_names() == next.robot->joint_names(), "robot");
  require(now.controller.mode == next.controller.mode, "mode");
  require(now.controller.dt == next.controller.dt, "dt");
  require(now.plant == next.plant, "plant.type");
  require(task_names(now) == task_names(next), "tasks");
  require(now.changes.size() == next.changes.size(), "changes");
}

}  // namespace

LiveSimulation::LiveSimulation(const Scenario& scenario)
    : goals_(goals_of(scenario)), loop_(with_live_goals(scenario)) {
  loop_.control();
}

Scenario LiveSimulation::with_live_goals(Scenario scenario) const {
  const auto follow = [&](std::shared_ptr<const Task>& task) {
    const auto aim = task ? task->frame_goal(0.0) : std::nullopt;
    if (!aim) {
      return;
    }
    const auto found = goals_.find(scenario.robot->frame_name(aim->frame));
    if (found == goals_.end()) {
      throw ConfigError("frames of tasks cannot change while the simulation runs: start it anew");
    }
    const std::shared_ptr<LiveGoal> goal = found->second;
    task = task->aimed_at(Target<PointTarget>([goal](double) { return goal->point(); }),
                          Target<RotationTarget>([goal](double) { return goal->rotation(); }));
  };
  for (ScenarioTask& task : scenario.tasks) {
    follow(task.task);
  }
  for (TaskChange& change : scenario.changes) {
    follow(change.with);
  }
  return scenario;
}

void LiveSimulation::advance(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0.0) {
    throw Error("advance: must be zero or positive and finite [s], got " + std::to_string(seconds));
  }
  const double dt = loop_.scenario().controller.dt;
  left_over_ += seconds;
  while (left_over_ >= dt) {
    left_over_ -= dt;
    for (const auto& [frame, goal] : goals_) {
      goal->advance(dt);
    }
    loop_.control();
    loop_.move();
  }
}

void LiveSimulation::put_goal(const std::string& frame, const Vector3& position, const Matrix3& rotation) {
  const auto found = goals_.find(frame);
  if (found == goals_.end()) {
    throw Error("no task is about a frame '" + frame + "'");
  }
  if (!position.allFinite() || !rotation.allFinite()) {
    throw Error("the goal of frame '" + frame + "' must be finite");
  }
  found->second->put(position, rotation);
}

void LiveSimulation::adopt(const Scenario& scenario) {
  require_same(loop_.scenario(), scenario);
  loop_.adopt(with_live_goals(scenario));
}

std::size_t LiveSimulation::task_index(const std::string& name) const {
  const std::vector<std::string> names = task_names(loop_.scenario());
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw Error("no task is named '" + name + "'" + name_hint(name, names));
  }
  return static_cast<std::size_t>(found - names.begin());
}

void LiveSimulation::insert(const std::string& task, double over) { loop_.insert(task_index(task), over); }

void LiveSimulation::remove(const std::string& task, double over) { loop_.remove(task_index(task), over); }

}  // namespace tope
