#include <tope/controller/options.hpp>

namespace tope {

Unilateral::Options UnilateralOptions::resolved(Mode mode) const {
  // whitened rows of torque mode are in 1/sqrt(kg): a direction that the youBot's base serves has sigma 0.147
  Unilateral::Options options =
      mode == Mode::velocity
          ? Unilateral::Options{}
          : Unilateral::Options{.damping = 0.1, .headroom = 0.5, .inequality_headroom = 0.5};
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
