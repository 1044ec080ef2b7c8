// tope itself, through the loop that its peers go through. Configurations: ways to meet limits. Twin: ../tope_peer.py.
#include "rigid_body.hpp"

#include <tope/controller/controller.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/posture.hpp>

#include <string>

namespace {

class Tope {
 public:
  Tope(const peers::Setup& setup, tope::LimitMethod method)
      : setup_(setup), robot_(tope::Robot::from_urdf(setup.urdf, setup.config)), method_(method) {}

  void start(const peers::Pose& goal, double dt) {
    tope::ControllerOptions options{.mode = setup_.torque() ? tope::Mode::torque : tope::Mode::velocity,
                                    .dt = dt};
    options.limits.method = method_;
    const tope::Exponential reference{setup_.gain};
    controller_.emplace(robot_, options);
    controller_->add(1, tope::FrameOrientation{robot_, "ee", goal.rotation, reference});
    controller_->add(2, tope::FramePosition{robot_, "ee", goal.position, reference});
    controller_->add(3, tope::Posture{robot_, setup_.start, tope::Exponential{setup_.posture_gain}});
    t_ = 0.0;
    dt_ = dt;
  }

  void prepare(const peers::Vector&) const {}

  bool command(const peers::Vector& q, const peers::Vector& v, peers::Vector& u) {
    controller_->update(q, v, t_, u);
    t_ += dt_;
    return true;
  }

 private:
  const peers::Setup& setup_;
  tope::Robot robot_;
  tope::LimitMethod method_;
  std::optional<tope::Controller> controller_;
  double t_ = 0.0;
  double dt_ = 0.0;
};

}  // namespace

int main(int, char** arguments) {
  const peers::Setup setup = peers::read(arguments[1]);
  const bool chain = std::string(arguments[2]) == "chain";
  Tope peer(setup, chain ? tope::LimitMethod::chain : tope::LimitMethod::unilateral);
  peers::measure(peer, setup, {"tope", TOPE_VERSION, "strict levels", "defaults"},
                 setup.torque() ? peers::rigid_body(setup) : peers::Plant{});
}
