#pragma once
// The robot that torques act on, by Pinocchio.

#include "closed_loop.hpp"

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/parsers/urdf.hpp>

#include <memory>

namespace peers {

/// Links and rotors without friction.
inline Plant rigid_body(const Setup& setup) {
  auto model = std::make_shared<pinocchio::Model>();
  pinocchio::urdf::buildModel(setup.urdf, *model);
  model->armature = setup.rotor_inertia;
  auto data = std::make_shared<pinocchio::Data>(*model);
  return [model, data](const Vector& q, const Vector& v, const Vector& tau) {
    return Vector(pinocchio::aba(*model, *data, q, v, tau));
  };
}

}  // namespace peers
