// The MuJoCo plant: that it follows speeds and torques as the rigid-body model says, stops where the model has stops
// and obstacles, shows what fails, repeats, and refuses models that do not fit. Not here: the model's figures and its
// wheels against theory (test_mujoco_model.py), sensors (sensors_test), whole experiments (test_experiment.py).
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/plant/mujoco.hpp>
#include <tope/plant/rigid_body.hpp>
#include <tope/robot/robot_terms.hpp>

#include <boost/test/unit_test.hpp>

#include <cmath>
#include <limits>

namespace tope::test {
namespace mujoco {

constexpr double kPeriod = 1e-3;
using Drive = MujocoOptions::Drive;

std::filesystem::path model_path() { return source_path("robots/youbot/youbot_rollers.xml"); }

struct Fixture {
  Robot robot = youbot();
  Vector start = (Vector(8) << 0.0, 0.0, 0.0, 0.0, 0.4, 0.9, 0.6, 1.8).finished();

  MujocoOptions options(Drive drive, const MujocoFaults& faults = {}) const {
    return {.model = model_path(), .drive = drive, .faults = faults};
  }
  std::unique_ptr<Mujoco> plant(const MujocoOptions& chosen, double dt = kPeriod) const {
    auto made = std::make_unique<Mujoco>(robot, chosen, dt);
    made->reset(start);
    return made;
  }
  static void run(Mujoco& plant, const Vector& u, double duration, double dt = kPeriod) {
    for (auto i = std::lround(duration / dt); i > 0; --i) {
      plant.step(u, dt);
    }
  }
  /// Torques that hold the robot where it is.
  Vector holding(const Vector& q) const {
    RobotTerms terms(robot);
    terms.update_dynamics(q, Vector::Zero(8));
    return terms.bias();
  }
  /// The model with one word replaced throughout.
  static std::string changed_model(const std::string& from, const std::string& to) {
    std::string text = read_text(model_path());
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
    return text;
  }
  static void check_refused(const std::string& from, const std::string& to,
                            std::initializer_list<std::string> parts) {
    const TemporaryFile file("model.xml", changed_model(from, to));
    check_error([&] { Mujoco(youbot(), {.model = file.path()}, kPeriod); }, parts);
  }
};

}  // namespace mujoco

BOOST_FIXTURE_TEST_SUITE(mujoco, Fixture)

BOOST_AUTO_TEST_CASE(servos_hold_the_robot_from_the_start) {
  const auto held = plant(options(Drive::velocity));
  run(*held, Vector::Zero(8), 1.0);
  BOOST_TEST((held->position() - start).cwiseAbs().maxCoeff() <= 1e-4);
  BOOST_TEST(held->velocity().norm() <= 1e-4);
  BOOST_TEST(held->contacts().empty());
}

BOOST_AUTO_TEST_CASE(servos_follow_speeds_in_the_world) {
  start[2] = 0.7;
  const auto driven = plant(options(Drive::velocity));
  Vector u = Vector::Zero(8);
  u << 0.1, 0.05, 0.0, 0.3, -0.2, 0.2, -0.3, 0.4;
  run(*driven, u, 0.5);
  const Vector before = driven->position();
  run(*driven, u, 0.6);
  const Vector moved = (driven->position() - before) / 0.6;
  BOOST_TEST((moved - u).tail(5).cwiseAbs().maxCoeff() <= 2e-3);
  // ahead as commanded, aside what six rollers leave of it
  const auto ahead = [&](const Vector& motion) {
    return std::cos(0.7) * motion[0] + std::sin(0.7) * motion[1];
  };
  const auto aside = [&](const Vector& motion) {
    return -std::sin(0.7) * motion[0] + std::cos(0.7) * motion[1];
  };
  BOOST_TEST(std::abs(ahead(moved) / ahead(u) - 1.0) <= 0.01);
  BOOST_TEST(std::abs(aside(moved) / aside(u) - 0.955) <= 0.03);  // a stretch of the roller's ripple
}

BOOST_AUTO_TEST_CASE(the_bias_of_the_controllers_model_holds_the_arm) {
  const auto held = plant(options(Drive::torque));
  run(*held, holding(start), 1.0);
  BOOST_TEST((held->position() - start).cwiseAbs().maxCoeff() <= 1e-3);
  const auto fallen = plant(options(Drive::torque));
  run(*fallen, Vector::Zero(8), 0.5);
  BOOST_TEST((fallen->position() - start).cwiseAbs().maxCoeff() > 0.1);
}

BOOST_AUTO_TEST_CASE(wheel_torques_push_the_base_as_a_force_would) {
  const auto pushed = plant(options(Drive::torque));
  Vector u = holding(start);
  u[0] = 42.0;
  run(*pushed, u, 0.6);
  RobotTerms terms(robot);
  terms.update_dynamics(start, Vector::Zero(8));
  // the wheels' own spin, 1.12e-3 kg m2 each, is not in the controller's model
  const double mass = terms.mass_matrix()(0, 0) + 4.0 * 1.12e-3 / (0.0475 * 0.0475);
  const double share = pushed->velocity()[0] / 0.6 * mass / 42.0;
  BOOST_TEST(std::abs(share - 1.0) <= 0.04);  // rollers and contacts take some
  BOOST_TEST_MESSAGE("share of the force that arrives " << share);
}

BOOST_AUTO_TEST_CASE(wheels_share_a_wrench_as_told) {
  const auto pushed = [&](WheelDistribution distribution) {
    MujocoOptions chosen = options(Drive::torque);
    chosen.wheel_distribution = distribution;
    const auto robot_pushed = plant(chosen);
    Vector u = holding(start);
    u.head(3) << 30.0, 10.0, 8.0;
    run(*robot_pushed, u, 0.6);
    return Vector(robot_pushed->velocity().head(3));
  };
  const Vector norm = pushed(WheelDistribution::minimum_norm);
  const Vector peak = pushed(WheelDistribution::minimum_peak);
  BOOST_TEST(norm.norm() > 0.3);
  BOOST_TEST((norm - peak).norm() > 1e-6);
  BOOST_TEST((norm - peak).norm() <= 0.1 * norm.norm());  // the same wrench, but for what rollers lose
}

BOOST_AUTO_TEST_CASE(motors_give_no_more_than_they_have) {
  const auto pushed = plant(options(Drive::torque));
  Vector u = holding(start);
  u[0] = 1e4;
  run(*pushed, u, 0.2);
  BOOST_TEST(pushed->velocity()[0] < 0.2 * robot.effort_limit()[0] / 45.0);
  BOOST_TEST(pushed->velocity()[0] > 0.1);
}

BOOST_AUTO_TEST_CASE(joints_stop_at_their_stops) {
  const auto driven = plant(options(Drive::velocity));
  Vector u = Vector::Zero(8);
  u[7] = 1.5;
  run(*driven, u, 2.0);
  const double stop = 167.5 / 180.0 * std::acos(-1.0);
  BOOST_TEST(driven->position()[7] > robot.position_upper()[7]);
  BOOST_TEST(std::abs(driven->position()[7] - stop) <= 5e-3);
  BOOST_TEST(driven->contacts().size() == 1U);
  BOOST_TEST(driven->contacts().at("arm_joint_5 at its stop") > 1.0);
}

BOOST_AUTO_TEST_CASE(servos_do_not_wind_up_at_a_stop) {
  const auto driven = plant(options(Drive::velocity));
  Vector u = Vector::Zero(8);
  u[7] = 1.5;
  run(*driven, u, 2.0);
  u[7] = -1.5;
  run(*driven, u, 0.1);
  BOOST_TEST(std::abs(driven->velocity()[7] + 1.5) <= 0.1);  // it turns back at once
}

BOOST_AUTO_TEST_CASE(the_obstacle_stands_where_the_limit_of_base_x_says) {
  for (const double gap : {0.005, -0.005}) {
    const auto driven = plant(options(Drive::velocity));
    Vector u = Vector::Zero(8);
    u[0] = 0.1;
    run(*driven, u, (0.35 - gap) / 0.1);
    BOOST_TEST(driven->contacts().count("base_link on obstacle") == (gap < 0.0 ? 1U : 0U));
  }
}

BOOST_AUTO_TEST_CASE(the_true_tip_is_where_the_joints_say) {
  const auto driven = plant(options(Drive::velocity));
  RobotTerms terms(robot);
  Vector u = Vector::Zero(8);
  u << -0.2, 0.2, 0.5, 0.4, -0.3, 0.2, -0.3, 0.4;
  double furthest = 0.0;
  for (int i = 0; i < 100; ++i) {
    run(*driven, u, 0.02);
    terms.update(driven->position(), driven->velocity());
    furthest = std::max(furthest,
                        (driven->site_position("ee") - terms.frame_position(robot.frame_index("ee"))).norm());
  }
  BOOST_TEST(furthest > 1e-6);
  BOOST_TEST(furthest < 1.5e-3);  // the base bounces and tilts on its rollers
  BOOST_TEST_MESSAGE("tip off by at most " << furthest << " m");
  check_error([&] { driven->site_position("tip"); }, {"no site 'tip'", "ee"});
}

BOOST_AUTO_TEST_CASE(yaw_counts_past_a_full_turn) {
  start[2] = 6.0;
  const auto driven = plant(options(Drive::velocity));
  Vector u = Vector::Zero(8);
  u[2] = 1.0;
  run(*driven, u, 1.0);
  BOOST_TEST(driven->position()[2] > 6.8);
  BOOST_TEST(driven->position()[2] < 7.1);
  BOOST_TEST(std::abs(driven->measured_position()[2] - driven->position()[2]) <= 1e-9);
}

BOOST_AUTO_TEST_CASE(a_stalled_controller_changes_nothing) {
  const auto driven = plant(options(Drive::velocity, {.stall = {.start = 0.1, .duration = 0.1}}));
  Vector u = Vector::Zero(8);
  u[3] = 0.5;
  run(*driven, u, 0.1);
  run(*driven, Vector::Zero(8), 0.1);
  BOOST_TEST(driven->velocity()[3] > 0.45);
  run(*driven, Vector::Zero(8), 0.2);
  BOOST_TEST(std::abs(driven->velocity()[3]) < 0.02);
}

BOOST_AUTO_TEST_CASE(a_payload_weighs_on_the_arm) {
  // without friction, which the rigid-body plant models in another way
  start << 0.0, 0.0, 0.0, 0.0, 1.4, 0.0, 0.0, 0.0;
  const Vector torque = holding(start);
  const MujocoFaults faults{.payload = {.start = 0.5}, .payload_mass = 0.5};
  const TemporaryFile smooth("model.xml", replaced(changed_model("frictionloss=", "margin=\"0\" user="),
                                                   "damping=\"0.1\"", "damping=\"0\""));
  MujocoOptions chosen = options(Drive::torque, faults);
  chosen.model = smooth.path();
  const auto loaded = plant(chosen);
  run(*loaded, torque, 0.5);
  BOOST_TEST((loaded->position() - start).norm() <= 1e-3);
  run(*loaded, torque, 0.05);
  RigidBody falling(robot, {.payload = 0.5}, kPeriod);
  falling.reset(start);
  for (int i = 0; i < 50; ++i) {
    falling.step(torque, kPeriod);
  }
  BOOST_TEST(falling.velocity().norm() > 0.2);
  BOOST_TEST((loaded->velocity() - falling.velocity()).tail(5).norm() <= 0.02 * falling.velocity().norm());
  loaded->reset(start);
  run(*loaded, torque, 0.4);
  BOOST_TEST((loaded->position() - start).norm() <= 1e-3);  // it hangs there no more
}

BOOST_AUTO_TEST_CASE(a_wheel_without_grip_pushes_less) {
  const auto reached = [&](const MujocoFaults& faults) {
    const auto pushed = plant(options(Drive::torque, faults));
    Vector u = holding(start);
    u[0] = 80.0;
    run(*pushed, u, 0.3);
    return pushed->position();
  };
  const Vector all = reached({});
  const Vector three = reached({.lost_grip = {.start = 0.0, .duration = 0.3}, .lost_grip_wheel = 0});
  const Vector none = reached({.lost_grip = {.start = 1.0, .duration = 0.3}, .lost_grip_wheel = 0});
  BOOST_TEST(all == none);
  BOOST_TEST(three[0] < 0.9 * all[0]);
  BOOST_TEST(std::abs(three[2]) > 10.0 * std::abs(all[2]));
}

BOOST_AUTO_TEST_CASE(the_obstacle_comes) {
  const MujocoFaults faults{.obstacle = {.start = 0.0, .duration = 4.0}, .obstacle_velocity = -0.1};
  const auto waiting = plant(options(Drive::velocity, faults));
  run(*waiting, Vector::Zero(8), 3.4);
  BOOST_TEST(waiting->contacts().empty());
  run(*waiting, Vector::Zero(8), 0.2);
  BOOST_TEST(waiting->contacts().count("base_link on obstacle") == 1U);
}

BOOST_AUTO_TEST_CASE(repeats_bit_for_bit) {
  const auto driven = plant(options(Drive::velocity));
  const Vector u = Vector::Constant(8, 0.2);
  run(*driven, u, 0.3);
  const Vector first = driven->position();
  driven->reset(start);
  run(*driven, u, 0.3);
  BOOST_TEST(driven->position() == first);
}

BOOST_AUTO_TEST_CASE(periods_of_any_length_are_cut_into_steps) {
  const Vector u = Vector::Constant(8, 0.2);
  const auto usual = plant(options(Drive::velocity));
  run(*usual, u, 0.3);
  for (const double dt : {1e-4, 1.5e-3, 5e-3}) {
    const auto other = plant(options(Drive::velocity), dt);
    run(*other, u, 0.3, dt);
    BOOST_TEST((other->position() - usual->position()).norm() <= 5e-3, "dt " << dt);
  }
}

BOOST_AUTO_TEST_CASE(a_diverging_simulation_is_an_error) {
  const auto sound = plant(options(Drive::torque));
  const Vector nan = Vector::Constant(8, std::numeric_limits<double>::quiet_NaN());
  check_error([&] { sound->step(nan, kPeriod); }, {"command", "finite"});
  const TemporaryFile wild("model.xml",
                           replaced(read_text(model_path()), "damping=\"0.1\"", "damping=\"-1e5\""));
  MujocoOptions chosen = options(Drive::torque);
  chosen.model = wild.path();
  const auto broken = plant(chosen);
  check_error([&] { run(*broken, Vector::Zero(8), 1.0); }, {"diverged at", "s:"});
}

BOOST_AUTO_TEST_CASE(models_that_do_not_fit_are_refused) {
  check_error([&] { plant({.model = "/no/such/model.xml"}); }, {"/no/such/model.xml: no such file"});
  const TemporaryFile broken("model.xml", "<mujoco><worldbody></mujoco>");
  check_error([&] { plant({.model = broken.path()}); }, {"model.xml: MuJoCo refuses it"});
  check_refused("wheel_fl", "wheel_front", {"model.xml: it has no joint 'wheel_fl'", "did you mean"});
  check_refused("<freejoint name=\"base\" />", "", {"model.xml: it has no free joint"});
  check_refused("type=\"hinge\" limited", "type=\"slide\" limited", {"'arm_joint_1' is not a hinge"});
  check_refused("group=\"1\"", "group=\"2\"", {"has no actuator in group 1, the velocity servos"});
}

BOOST_AUTO_TEST_CASE(robots_and_faults_that_do_not_fit_are_refused) {
  const Robot no_wheels = Robot::from_urdf(source_path("robots/youbot/youbot.urdf"));
  check_error([&] { Mujoco(no_wheels, options(Drive::velocity), kPeriod); }, {"no mecanum_base"});
  const MujocoFaults faults{.stall = {.start = 1.0, .duration = -1.0}};
  check_error([&] { plant(options(Drive::velocity, faults)); }, {"faults: stall", "positive"});
  const TemporaryFile bare("model.xml",
                           replaced(read_text(model_path()), "name=\"payload\"", "name=\"hook\""));
  MujocoOptions loaded = options(Drive::velocity, {.payload = {.start = 1.0}, .payload_mass = 0.5});
  loaded.model = bare.path();
  check_error([&] { plant(loaded); }, {"no body 'payload'"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
