#pragma once

#include <tope/scenario/scenario.hpp>

#include <vector>

namespace tope {

struct BenchmarkOptions {
  int cycles = 200'000;  ///< timed, at least; the recorded states are gone through again and again
  /// States that take part: those in which so many limits act (unilateral: their bound presses; else: their row is in
  /// transition, 0 < xi < 1). Negative: all.
  int acting = -1;
};

/// What one cycle of a scenario's controller costs, beside the bare rigid-body terms that any controller of its mode
/// needs, timed at the same states in turn.
struct Benchmark {
  int states = 0;                       ///< that took part
  int largest_laws = 0;                 ///< laws evaluated in a cycle, at most
  std::vector<double> cycle_us{};       ///< of each Controller::update: all states, again and again
  std::vector<double> rigid_body_us{};  ///< of each evaluation of the terms
  /// Of waits for as long as the median cycle that only read the clock: what is longer, the machine took.
  std::vector<double> idle_us{};
};

/// Records the scenario's closed loop, then times along its states. The terms are Pinocchio's own algorithms: forward
/// kinematics and one frame's Jacobian in velocity mode; mass matrix, bias, one frame's Jacobian and drift in torque
/// mode. Errors: Error when no state has that many limits acting.
Benchmark benchmark(const Scenario& scenario, const BenchmarkOptions& options);

}  // namespace tope
