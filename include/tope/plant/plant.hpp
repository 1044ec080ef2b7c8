#pragma once

#include <tope/common/types.hpp>

namespace tope {

/// What the controller drives: holds the state and moves on by one period under a command that is held
/// constant.
class Plant {
 public:
  virtual ~Plant() = default;

  /// Starts at q (nq), at rest.
  virtual void reset(const Vector& q) = 0;
  /// Advances by dt [s] under the command u (nv).
  virtual void step(const Vector& u, double dt) = 0;

  virtual const Vector& position() const = 0;  ///< q (nq)
  virtual const Vector& velocity() const = 0;  ///< v (nv)
};

}  // namespace tope
