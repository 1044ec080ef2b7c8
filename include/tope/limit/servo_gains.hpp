#pragma once

namespace tope {

/// Gains of a limit row of second order as the library uses them: poles of (19).
struct ServoGains {
  double gain;        ///< gamma_1, the slower pole [1/s]
  double servo_gain;  ///< gamma_2, the faster one [1/s]

  /// The poles of the paper's pair lambda_p = gamma_1 gamma_2 [1/s2], lambda_v = gamma_1 + gamma_2 [1/s].
  /// Errors: ConfigError unless both are positive and lambda_v^2 >= 4 lambda_p: an underdamped servo overshoots, and no
  /// predicted position protects the limit.
  static ServoGains from_paper(double lambda_p, double lambda_v);
};

}  // namespace tope
