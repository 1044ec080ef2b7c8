// Run: build/Release/examples/example_09_safe_settings_and_status        Twin: 09_safe_settings_and_status.py
// Settings that cannot keep a limit are refused with what would; in the loop nothing is thrown, and a status says what
// acted in a cycle.
#include <tope/common/error.hpp>
#include <tope/controller/controller.hpp>
#include <tope/task/frame_position.hpp>

#include <cstdio>
#include <limits>

namespace {

bool refused(const tope::Robot& robot, const tope::ControllerOptions& options) {
  try {
    const tope::Controller controller{robot, options};
  } catch (const tope::ConfigError& error) {
    std::printf("refused: %s\n", error.what());
    return true;
  }
  return false;
}

}  // namespace

int main() {
  auto robot = tope::Robot::from_urdf("robots/youbot/youbot.urdf", "robots/youbot/youbot.yaml");
  tope::Vector upper = robot.position_upper();
  upper[robot.joint_index("base_x")] = 0.35;  // an obstacle on the floor
  robot.set_position_limits(robot.position_lower(), upper);

  const bool too_hard = refused(robot, {.dt = 0.02, .limits = {.rows = {.gain = 60.0}}});
  const bool too_narrow =
      refused(robot, {.dt = 0.02, .limits = {.method = tope::LimitMethod::chain, .rows = {.buffer = 0.01}}});

  const double dt = 1e-3;
  tope::Controller controller{robot, {.mode = tope::Mode::velocity, .dt = dt}};
  for (const tope::Condition& condition : controller.conditions()) {
    if (condition.joint.empty() || condition.joint == "base_x") {
      std::printf("%s: %s, %.4g <= %.4g\n", condition.name.c_str(), condition.expression.c_str(),
                  condition.value, condition.bound);
    }
  }

  const tope::Vector3 out_of_reach(1.4, 0.2, 0.4);
  controller.add(1, tope::FramePosition{robot, "ee", out_of_reach, tope::PredefinedTime{2.0}});
  tope::Vector q(robot.nq());
  q << 0, 0, 0, 0, 0.4, 0.9, 0.6, 1.8;
  tope::Vector v = tope::Vector::Zero(robot.nv());
  int limit = 0, held = 0;
  for (int cycle = 0; cycle < 4000; ++cycle) {
    const tope::Status& status = controller.update(q, v, cycle * dt, v);
    limit += status.has(tope::Event::limit) ? 1 : 0;
    held += status.has(tope::Event::held) ? 1 : 0;
    q += dt * v;
  }
  std::printf("of 4000 cycles: limit %d, held %d; at the end: %s\n", limit, held,
              tope::describe(controller.status(), robot).c_str());

  q.fill(std::numeric_limits<double>::quiet_NaN());  // a sensor fails
  const tope::Status& status = controller.update(q, v, 4.0, v);
  std::printf("state that is no number: command of norm %g, status %s\n", v.norm(),
              tope::event_names(status).c_str());
  const bool stopped = v.isZero(0.0) && status.has(tope::Event::bad_input);
  return too_hard && too_narrow && stopped && limit > 1000 && held > 1000 ? 0 : 1;
}
