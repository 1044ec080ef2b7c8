#pragma once

#include <tope/common/types.hpp>

namespace tope::test {

/// The largest absolute value; 0 of no value.
inline double infinity_norm(const Vector& v) { return v.size() > 0 ? v.lpNorm<Eigen::Infinity>() : 0.0; }

}  // namespace tope::test
