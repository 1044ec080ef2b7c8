#include "pose_loop.hpp"

#include <tope/task/frame_pose.hpp>
#include <tope/task/posture.hpp>

#include <functional>

namespace tope_ros2_example {
namespace {

constexpr double kLate = 2.0;  // periods after which a cycle is late: the safety inequalities hold for one

tope::Robot load(const PoseLoop::Options& options) {
  return options.config.empty() ? tope::Robot::from_urdf(options.urdf)
                                : tope::Robot::from_urdf(options.urdf, options.config);
}

}  // namespace

PoseLoop::PoseLoop(const Options& options)
    : options_(options), robot_(load(options)), goal_(tope::Vector3::Zero(), tope::Matrix3::Identity()) {
  start(tope::Vector::Zero(robot_.nq()));  // finds mistakes now
  controller_.reset();
}

void PoseLoop::start(const tope::VectorArg& q) {
  tope::RobotTerms terms(robot_);
  terms.update(q, tope::Vector::Zero(robot_.nv()));
  const int frame = robot_.frame_index(options_.frame);
  goal_ = tope::LiveGoal(terms.frame_position(frame), terms.frame_rotation(frame));

  controller_.emplace(robot_, tope::ControllerOptions{.mode = tope::Mode::velocity, .dt = options_.dt});
  const std::function<tope::PointTarget(double)> point = [this](double) { return goal_.point(); };
  const std::function<tope::RotationTarget(double)> rotation = [this](double) { return goal_.rotation(); };
  controller_->add(1, tope::FramePose{robot_, options_.frame, tope::Target<tope::PointTarget>(point),
                                      tope::Target<tope::RotationTarget>(rotation)});
  controller_->add(2, tope::Posture{robot_, q});
  status_ = {};
  time_ = 0.0;
  bad_cycles_ = 0;
}

bool PoseLoop::is_pose(const tope::Vector3& position, const tope::Matrix3& rotation) noexcept {
  return position.allFinite() &&
         (rotation * rotation.transpose() - tope::Matrix3::Identity()).norm() < 1e-6 &&
         rotation.determinant() > 0.0;
}

void PoseLoop::aim(const tope::Vector3& position, const tope::Matrix3& rotation) noexcept {
  if (is_pose(position, rotation)) {
    goal_.put(position, rotation);
  }
}

bool PoseLoop::step(const tope::VectorArg& q, const tope::VectorArg& v, double period,
                    Eigen::Ref<tope::Vector> u) noexcept {
  if (!controller_ || bad_cycles_ > options_.patience) {
    u.setZero();
    return false;
  }
  time_ += options_.dt;
  goal_.advance(options_.dt);
  status_ = controller_->update(q, v, time_, u);
  const bool late = !(period <= kLate * options_.dt);
  const bool bad = late || status_.has(tope::Event::bad_input);
  bad_cycles_ = bad ? bad_cycles_ + 1 : 0;
  if (bad_cycles_ > options_.patience) {
    u.setZero();
    return false;
  }
  return true;
}

}  // namespace tope_ros2_example
