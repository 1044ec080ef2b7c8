// Run: build/Release/examples/example_08_own_task        No twin: Python has no tasks of one's own.
// A new task is a class with evaluate() and clone(); torque mode needs evaluate_drift() too. This one keeps a frame at
// a distance from a point, on a sphere round it, while the gripper follows a swinging point as far as that lets it.
#include <tope/controller/controller.hpp>
#include <tope/plant/rigid_body.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_position.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

/// Keeps the origin p of a frame at a distance d from a point c: e = |p - c| - d [m], 1 row. p must not be at c.
class FrameDistance final : public tope::Task {
 public:
  FrameDistance(const tope::Robot& robot, const std::string& frame, const tope::Vector3& centre,
                double distance, tope::Reference reference = tope::Exponential{})
      : Task(1, robot.nv(), std::move(reference)),
        frame_(robot.frame_index(frame)),
        centre_(centre),
        distance_(distance) {}

  std::string_view type() const override { return "frame_distance"; }
  std::string_view error_unit() const override { return "m"; }
  std::unique_ptr<Task> clone() const override { return std::make_unique<FrameDistance>(*this); }

 private:
  void evaluate(const tope::RobotTerms& terms, double /*t*/) override {
    const tope::Vector3 out = terms.frame_position(frame_) - centre_;
    error_[0] = out.norm() - distance_;
    outward_ = out.normalized();
    jacobian_.noalias() = outward_.transpose() * terms.frame_jacobian(frame_).topRows<3>();
  }

  /// d2e/dt2 if no joint accelerated: along the sphere, the frame would leave it.
  void evaluate_drift(const tope::RobotTerms& terms, double /*t*/) override {
    tope::Vector3 along = terms.frame_jacobian(frame_).topRows<3>() * terms.velocity();
    along -= outward_.dot(along) * outward_;
    drift_[0] =
        outward_.dot(terms.frame_drift(frame_).head<3>()) + along.squaredNorm() / (error_[0] + distance_);
  }

  int frame_;
  tope::Vector3 centre_;
  double distance_;
  tope::Vector3 outward_ = tope::Vector3::UnitZ();
};

}  // namespace

int main() {
  const auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  const double dt = 1e-3;
  // Not half a period ahead: below, the derivatives are compared with differences of the plant's states.
  tope::Controller controller{robot, {.mode = tope::Mode::torque, .dt = dt, .midpoint = false}};
  const tope::Exponential stiff{10.0};
  const auto keep = controller.add(1, FrameDistance{robot, "ee", tope::Vector3(1.0, 0.0, 0.3), 0.3, stiff});
  const auto swinging =
      tope::moving_along_sine(tope::Vector3(0.8, 0.0, 0.35), tope::Vector3(0.0, 0.2, 0.0), 0.2);
  const auto follow = controller.add(2, tope::FramePosition{robot, "ee", swinging, stiff});
  controller.add(3, tope::Damping{robot});

  tope::RigidBody plant{robot, {}, dt};
  tope::Vector q(robot.nq());
  q << 0, 0, 0, 0, 0.4, 0.9, 0.6, 0.3;
  plant.reset(q);
  tope::Vector torque(robot.nv());
  tope::Vector v = plant.velocity();
  const tope::Task& task = controller.task(keep);
  double off = 0.0, wrong_rate = 0.0, wrong_drift = 0.0, last_error = 0.0, last_rate = 0.0;
  std::printf("time [s], distance from the sphere [mm], from the swinging point [mm]\n");
  for (int cycle = 0; cycle <= 10000; ++cycle) {
    controller.update(plant.position(), plant.velocity(), cycle * dt, torque);
    const double error = task.error()[0];
    const double rate = task.error_rate()[0];
    if (cycle % 250 == 0) {
      std::printf("%5.2f %9.4f %9.2f\n", cycle * dt, 1e3 * error,
                  1e3 * controller.task(follow).error().norm());
    }
    if (cycle >= 2000) {  // the derivatives against differences from cycle to cycle
      const double bend = (task.jacobian() * (plant.velocity() - v))(0) / dt + task.drift()[0];
      wrong_rate = std::max(wrong_rate, std::abs((error - last_error) / dt - 0.5 * (rate + last_rate)));
      wrong_drift = std::max(wrong_drift, std::abs((rate - last_rate) / dt - bend));
      off = std::max(off, std::abs(error));
    }
    last_error = error;
    last_rate = rate;
    v = plant.velocity();
    plant.step(torque, dt);
  }
  std::printf("on the sphere within %.2f mm; de/dt within %.1e m/s, d2e/dt2 within %.1e m/s2\n", 1e3 * off,
              wrong_rate, wrong_drift);
  return off < 1e-3 && wrong_rate < 1e-6 && wrong_drift < 1e-3 ? 0 : 1;
}
