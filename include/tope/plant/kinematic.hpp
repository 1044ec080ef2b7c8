#pragma once

#include <tope/plant/plant.hpp>
#include <tope/robot/robot.hpp>

namespace tope {

/// A robot that follows velocity commands exactly: dq/dt = u.
class Kinematic final : public Plant {
 public:
  explicit Kinematic(const Robot& robot);

  void reset(const Vector& q) override;
  void step(const Vector& u, double dt) override;
  const Vector& position() const override { return position_; }
  const Vector& velocity() const override { return velocity_; }

 private:
  Vector position_;
  Vector velocity_;
};

}  // namespace tope
