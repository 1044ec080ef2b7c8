#include <tope/controller/options.hpp>

#include <algorithm>
#include <cmath>

namespace tope {

Unilateral::Options UnilateralOptions::resolved(Mode mode, double heaviest) const {
  Unilateral::Options options{};
  if (mode == Mode::torque) {
    // whitened rows are in 1/sqrt(kg): what moves the heaviest joint alone has this sigma, 0.147 for the youBot's base
    const double least = 1.0 / std::sqrt(heaviest);
    options.damping = std::min(0.1, 0.7 * least);
    options.fine_damping = std::min(options.fine_damping, 0.2 * options.damping);
    options.lock = std::min(0.06, 0.45 * least);
    options.headroom = 0.1;
    options.inequality_headroom = 0.5;
  }
  options.damping = damping.value_or(options.damping);
  options.fine_damping = fine_damping.value_or(options.fine_damping);
  options.fine_below = fine_below.value_or(options.fine_below);
  options.lock = lock.value_or(options.lock);
  options.headroom = headroom.value_or(options.headroom);
  options.inequality_headroom = inequality_headroom.value_or(options.inequality_headroom);
  options.softness = softness.value_or(options.softness);
  return options;
}

}  // namespace tope
