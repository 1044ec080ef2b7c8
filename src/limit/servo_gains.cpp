#include "../common/require_positive.hpp"

#include <tope/limit/servo_gains.hpp>

#include <cmath>
#include <string>

namespace tope {

ServoGains ServoGains::from_paper(double lambda_p, double lambda_v) {
  require_positive("limits: lambda_p [1/s2]", lambda_p);
  require_positive("limits: lambda_v [1/s]", lambda_v);
  const double discriminant = lambda_v * lambda_v - 4.0 * lambda_p;
  if (discriminant < 0.0) {
    throw ConfigError("limits: lambda_v^2 < 4 lambda_p (" + std::to_string(lambda_v * lambda_v) + " < " +
                      std::to_string(4.0 * lambda_p) +
                      "): the limit servo would overshoot; raise lambda_v to at least " +
                      std::to_string(2.0 * std::sqrt(lambda_p)) + " or lower lambda_p to at most " +
                      std::to_string(0.25 * lambda_v * lambda_v));
  }
  const double faster = 0.5 * (lambda_v + std::sqrt(discriminant));
  return {.gain = lambda_p / faster, .servo_gain = faster};
}

}  // namespace tope
