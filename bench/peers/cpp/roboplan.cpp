// RoboPlan's OInK in C++; configurations and settings as in ../roboplan_peer.py.
#include "closed_loop.hpp"

#include <memory>
#include <roboplan_oink/constraints/position_limit.hpp>
#include <roboplan_oink/constraints/velocity_limit.hpp>
#include <roboplan_oink/optimal_ik.hpp>
#include <roboplan_oink/tasks/configuration.hpp>
#include <roboplan_oink/tasks/frame.hpp>
#include <string>

namespace {

using peers::Vector;

constexpr double posture_cost = 1e-3;
constexpr double regularisation = 1e-3;

class Roboplan {
 public:
  Roboplan(const peers::Setup& setup, const std::string& configuration)
      : setup_(setup),
        ranked_(configuration == "priorities"),
        orientation_cost_(configuration == "weights" ? peers::orientation_weight : 1.0),
        scene_("youbot", roboplan::loadUrdfSceneDescription(setup.urdf)) {}

  void start(const peers::Pose& goal, double dt) {
    const Eigen::Index n = setup_.start.size();
    dt_ = dt;
    tasks_.clear();
    constraints_.clear();
    oink_ = std::make_unique<roboplan::Oink>(scene_);
    if (ranked_) {
      add_frame_task(goal, 0.0, 1.0, 1);
      add_frame_task(goal, 1.0, 0.0, 2);
    } else {
      add_frame_task(goal, 1.0, orientation_cost_, 1);
    }
    roboplan::ConfigurationTaskOptions options;
    options.task_gain = setup_.posture_gain * dt;
    options.priority = ranked_ ? 3 : 1;
    tasks_.push_back(std::make_shared<roboplan::ConfigurationTask>(
        *oink_, setup_.start, Vector(Vector::Constant(n, posture_cost)), options));
    constraints_.push_back(std::make_shared<roboplan::PositionLimit>(*oink_, setup_.limit_gain * dt));
    constraints_.push_back(std::make_shared<roboplan::VelocityLimit>(*oink_, dt, setup_.velocity));
    motion_ = Vector::Zero(n);
  }

  void prepare(const Vector&) const {}

  bool command(const Vector& q, const Vector&, Vector& u) {
    if (!oink_->solveIk(q, tasks_, constraints_, barriers_, motion_, regularisation)) {
      return false;
    }
    u = motion_ / dt_;
    return true;
  }

 private:
  void add_frame_task(const peers::Pose& goal, double position, double orientation, int priority) {
    roboplan::CartesianConfiguration there;
    there.base_frame = "world";
    there.tip_frame = "ee";
    there.tform.topLeftCorner<3, 3>() = goal.rotation;
    there.tform.topRightCorner<3, 1>() = goal.position;
    roboplan::FrameTaskOptions options;
    options.position_cost = position;
    options.orientation_cost = orientation;
    options.task_gain = setup_.gain * dt_;
    options.priority = priority;
    tasks_.push_back(std::make_shared<roboplan::FrameTask>(*oink_, scene_, there, options));
  }

  const peers::Setup& setup_;
  bool ranked_;
  double orientation_cost_;
  double dt_ = 0.0;
  roboplan::Scene scene_;
  std::unique_ptr<roboplan::Oink> oink_;
  std::vector<std::shared_ptr<roboplan::Task>> tasks_;
  std::vector<std::shared_ptr<roboplan::Constraints>> constraints_;
  std::vector<std::shared_ptr<roboplan::Barrier>> barriers_;
  Vector motion_;
};

}  // namespace

int main(int, char** arguments) {
  const peers::Setup setup = peers::read(arguments[1]);
  const std::string configuration = arguments[2];
  Roboplan peer(setup, configuration);
  const std::string priorities = configuration == "priorities" ? "priorities by projected costs"
                                 : configuration == "weights"  ? "weights 1e4:1"
                                                               : "weights 1:1";
  peers::measure(peer, setup,
                 {"roboplan", ROBOPLAN_VERSION, priorities, "regularisation 0.001, posture cost 0.001"});
}
