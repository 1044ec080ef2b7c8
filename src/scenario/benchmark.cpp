#include "../robot/robot_model.hpp"

#include <tope/common/error.hpp>
#include <tope/scenario/benchmark.hpp>
#include <tope/scenario/closed_loop.hpp>

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace tope {
namespace {

struct State {
  double t;
  Vector q;
  Vector v;
};

int acting_limits(const Controller& controller) {
  const bool unilateral = controller.options().limits.method == LimitMethod::unilateral;
  const auto acts = [unilateral](double xi) { return unilateral ? xi > 0.5 : xi > 0.0 && xi < 1.0; };
  int count = 0;
  for (Eigen::Index j = 0; j < controller.upper_activation().size(); ++j) {
    count += acts(controller.upper_activation()[j]) || acts(controller.lower_activation()[j]) ? 1 : 0;
  }
  return count;
}

std::vector<State> record(const Scenario& scenario, int acting) {
  ClosedLoop loop(scenario);
  std::vector<State> states;
  const auto cycles = std::lround(scenario.duration / scenario.controller.dt);
  for (long i = 0; i < cycles; ++i) {
    const State state{
        .t = loop.time(), .q = loop.plant().measured_position(), .v = loop.plant().measured_velocity()};
    loop.control();
    if (acting < 0 || acting_limits(loop.controller()) == acting) {
      states.push_back(state);
    }
    loop.move();
  }
  return states;
}

/// Pinocchio's algorithms as their documentation calls them.
class BareTerms {
 public:
  BareTerms(const Robot& robot, Mode mode)
      : model_(robot.model().model),
        data_(model_),
        torque_(mode == Mode::torque),
        frame_(static_cast<pinocchio::FrameIndex>(model_.nframes - 1)),
        no_acceleration_(Vector::Zero(robot.nv())),
        jacobian_(Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, robot.nv())) {}

  void evaluate(const VectorArg& q, const VectorArg& v) {
    if (torque_) {
      pinocchio::crba(model_, data_, q, pinocchio::Convention::WORLD);
      pinocchio::nonLinearEffects(model_, data_, q, v);
      pinocchio::forwardKinematics(model_, data_, q, v, VectorArg(no_acceleration_));
      pinocchio::computeJointJacobians(model_, data_);
    } else {
      pinocchio::computeJointJacobians(model_, data_, q);
    }
    pinocchio::updateFramePlacement(model_, data_, frame_);
    pinocchio::getFrameJacobian(model_, data_, frame_, pinocchio::LOCAL_WORLD_ALIGNED, jacobian_);
    if (torque_) {
      drift_ =
          pinocchio::getFrameClassicalAcceleration(model_, data_, frame_, pinocchio::LOCAL_WORLD_ALIGNED);
    }
  }

 private:
  const pinocchio::Model& model_;
  pinocchio::Data data_;
  bool torque_;
  pinocchio::FrameIndex frame_;
  Vector no_acceleration_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian_;
  pinocchio::Motion drift_;
};

using Clock = std::chrono::steady_clock;
using Microseconds = std::chrono::duration<double, std::micro>;

template <typename Action>
double timed_us(Action action) {
  const auto begin = Clock::now();
  action();
  return Microseconds(Clock::now() - begin).count();
}

void wait(Microseconds length) {
  const auto begin = Clock::now();
  while (Clock::now() - begin < length) {
  }
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Benchmark benchmark(const Scenario& scenario, const BenchmarkOptions& options) {
  const std::vector<State> states = record(scenario, options.acting);
  if (states.empty()) {
    throw Error("benchmark: in no state of '" + scenario.name + "' do " + std::to_string(options.acting) +
                " limits act");
  }
  Controller controller = scenario.build_controller();
  BareTerms terms(*scenario.robot, scenario.controller.mode);
  Vector u = Vector::Zero(scenario.robot->nv());
  controller.update(scenario.initial, Vector::Zero(scenario.robot->nv()), 0.0, u);  // starts the references

  const auto size = static_cast<int>(states.size());
  const int rounds = std::max(1, (options.cycles + size - 1) / size);
  Benchmark result{.states = size};
  const std::size_t timed = static_cast<std::size_t>(rounds) * states.size();
  result.cycle_us.reserve(timed);
  result.rigid_body_us.reserve(timed);
  result.idle_us.reserve(timed);
  const auto go_through = [&](Benchmark& into, Microseconds usual) {
    for (const State& state : states) {
      into.rigid_body_us.push_back(timed_us([&] { terms.evaluate(state.q, state.v); }));
      into.cycle_us.push_back(timed_us([&] { controller.update(state.q, state.v, state.t, u); }));
      into.idle_us.push_back(timed_us([usual] { wait(usual); }));
      into.largest_laws = std::max(into.largest_laws, controller.status().laws);
    }
  };
  Benchmark warm_up;
  go_through(warm_up, Microseconds(0.0));
  const Microseconds usual(median(warm_up.cycle_us));
  for (int round = 0; round < rounds; ++round) {
    go_through(result, usual);
  }
  return result;
}

}  // namespace tope
