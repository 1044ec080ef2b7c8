#pragma once

#include <tope/common/types.hpp>

#include <map>
#include <string>

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

  /// What the robot's sensors make of q and v: all that a controller may see. The truth, unless a plant has sensors.
  virtual const Vector& measured_position() const { return position(); }
  virtual const Vector& measured_velocity() const { return velocity(); }

  /// What the robot touched since reset() that it should not, with the largest force [N or Nm] of each; nothing where a
  /// plant knows no contacts.
  virtual std::map<std::string, double> contacts() const { return {}; }
};

}  // namespace tope
