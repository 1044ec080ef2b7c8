#include "../common/require_positive.hpp"

#include <tope/reference/exponential.hpp>

namespace tope {

Exponential::Exponential(const Options& options) : options_(options) {
  require_positive("Exponential: gain [1/s]", options.gain);
}

void Exponential::rate(double /*t*/, const VectorArg& error, Eigen::Ref<Vector> rate) const {
  rate.noalias() = -options_.gain * error;
}

void Exponential::acceleration(double /*t*/, const VectorArg& error, const VectorArg& error_rate,
                               Eigen::Ref<Vector> acceleration) const {
  acceleration = -options_.gain * (options_.gain * error + 2.0 * error_rate);
}

}  // namespace tope
