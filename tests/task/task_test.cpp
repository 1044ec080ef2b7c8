// Every task's Jacobian and feedforward against central finite differences along random motions, with fixed
// and moving targets; what tasks refuse. Not here: the rotation error itself (rotation_error_test).
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/task/center_of_mass.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_pose.hpp>
#include <tope/task/frame_position.hpp>
#include <tope/task/joint_group.hpp>
#include <tope/task/joint_position.hpp>
#include <tope/task/manipulability.hpp>
#include <tope/task/pointing.hpp>
#include <tope/task/posture.hpp>
#include <tope/task/relative_pose.hpp>
#include <tope/task/selected_rows.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(task)
namespace {

constexpr double kFarFromFlip = 2.0;  // rad
constexpr double kGain = 2.0;         // 1/s, of the default reference

Vector error_at(Task& task, RobotTerms& terms, const Vector& q, double t) {
  terms.update(q, Vector::Zero(q.size()));
  task.update(terms, t);
  return task.error();
}

/// Largest |J v - feedforward - de/dt| over random states and motions. Skips errors above `skip_above`, where steps are
/// too coarse.
double check_rates(const Robot& robot, Task& task, int seeds, double skip_above = INFINITY) {
  RobotTerms terms(robot);
  double largest = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    BOOST_TEST_CONTEXT(task.type() << ", seed " << seed) {
      Random random(seed);
      const Vector q = random_position(random, robot, 0.0);
      const Vector v = random.vector(robot.nv());
      const double t = random.uniform(0.0, 3.0);
      const double h = 1e-5;
      const Vector ahead = error_at(task, terms, q + h * v, t + h);
      const Vector behind = error_at(task, terms, q - h * v, t - h);
      error_at(task, terms, q, t);
      if (task.near_flip() || task.error().norm() > skip_above) {
        continue;  // the error may pass pi within the step
      }
      const Vector feedforward = task.rate() + kGain * task.error();
      const Vector expected = (ahead - behind) / (2.0 * h);
      const double error = (task.jacobian() * v - feedforward - expected).lpNorm<Eigen::Infinity>();
      BOOST_TEST(error <= 1e-7);
      largest = std::max(largest, error);
    }
  }
  BOOST_TEST_MESSAGE(task.type() << ": largest deviation " << largest);
  return largest;
}

const std::vector<std::string> kArm{"arm_joint_1", "arm_joint_2", "arm_joint_3", "arm_joint_4",
                                    "arm_joint_5"};

Target<RotationTarget> spinning_target(Random& random) {
  return spinning(random.rotation(), random.vector(3, 0.4));
}

}  // namespace

BOOST_AUTO_TEST_CASE(frame_position_rates) {
  const Robot robot = youbot();
  Random random(1);
  for (const char* frame : {"ee", "arm_link_3", "base_link"}) {
    FramePosition fixed(robot, frame, Vector3(random.vector(3)));
    check_rates(robot, fixed, 50);
  }
  FramePosition along_line(robot, "ee",
                           moving_along_line(Vector3(random.vector(3)), Vector3(random.vector(3))));
  check_rates(robot, along_line, 50);
  FramePosition along_sine(robot, "ee",
                           moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.5));
  check_rates(robot, along_sine, 50);
}

BOOST_AUTO_TEST_CASE(frame_orientation_rates) {
  const Robot robot = youbot();
  Random random(2);
  for (int i = 0; i < 5; ++i) {
    FrameOrientation fixed(robot, "ee", random.rotation());
    check_rates(robot, fixed, 50);
    FrameOrientation moving(robot, "arm_link_4", spinning_target(random));
    check_rates(robot, moving, 50);
  }
}

BOOST_AUTO_TEST_CASE(frame_pose_rates) {
  const Robot robot = youbot();
  Random random(3);
  FramePose fixed(robot, "ee", Vector3(random.vector(3)), random.rotation());
  check_rates(robot, fixed, 100);
  FramePose moving(robot, "ee", moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.3),
                   spinning_target(random));
  check_rates(robot, moving, 100);
}

BOOST_AUTO_TEST_CASE(joint_task_rates) {
  const Robot robot = youbot();
  Random random(4);
  Posture posture(robot, random.vector(robot.nq()));
  check_rates(robot, posture, 50);
  JointPosition joints(robot, {{"arm_joint_4", 0.2}, {"base_x", -1.0}, {"arm_joint_1", 0.5}});
  check_rates(robot, joints, 50);
}

BOOST_AUTO_TEST_CASE(pointing_rates) {
  const Robot robot = youbot();
  Random random(7);
  for (int i = 0; i < 5; ++i) {
    Pointing fixed(robot, "ee", Vector3(random.vector(3)), Vector3(8.0 * random.unit()));
    check_rates(robot, fixed, 50, kFarFromFlip);
    Pointing moving(robot, "arm_link_4", Vector3::UnitZ(),
                    moving_along_sine(Vector3(8.0 * random.unit()), Vector3(random.vector(3)), 0.5));
    check_rates(robot, moving, 50, kFarFromFlip);
  }
}

BOOST_AUTO_TEST_CASE(center_of_mass_rates) {
  const Robot robot = youbot();
  Random random(8);
  CenterOfMass fixed(robot, Vector3(random.vector(3)));
  check_rates(robot, fixed, 50);
  CenterOfMass moving(robot, moving_along_line(Vector3(random.vector(3)), Vector3(random.vector(3))));
  check_rates(robot, moving, 50);
}

BOOST_AUTO_TEST_CASE(relative_pose_rates) {
  const Robot robot = youbot();
  Random random(20);
  for (const auto& [frame, seen_from] :
       {std::pair{"ee", "base_link"}, {"arm_link_2", "ee"}, {"base_link", "arm_link_4"}}) {
    RelativePose fixed(
        robot, frame, seen_from,
        {.position = PointTarget{random.vector(3)}, .rotation = RotationTarget{random.rotation()}});
    check_rates(robot, fixed, 50);
    RelativePose moving(
        robot, frame, seen_from,
        {.position = moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.3),
         .rotation = spinning_target(random)});
    check_rates(robot, moving, 100);
  }
}

BOOST_AUTO_TEST_CASE(relative_pose_is_that_of_two_frames) {
  const Robot robot = youbot();
  Random random(21);
  RobotTerms terms(robot);
  terms.update(random_position(random, robot, 0.0), Vector::Zero(robot.nv()));
  Eigen::Isometry3d world_T_ee = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d world_T_base = Eigen::Isometry3d::Identity();
  for (auto& [pose, name] : {std::pair{&world_T_ee, "ee"}, {&world_T_base, "base_link"}}) {
    pose->linear() = terms.frame_rotation(robot.frame_index(name));
    pose->translation() = terms.frame_position(robot.frame_index(name));
  }
  const Eigen::Isometry3d base_T_ee = world_T_base.inverse() * world_T_ee;
  const Vector3 point = random.vector(3);
  RelativePose position(robot, "ee", "base_link", {.position = PointTarget{point}});
  position.update(terms, 0.0);
  BOOST_TEST((position.error() - (base_T_ee.translation() - point)).norm() <= 1e-14);
  BOOST_TEST(position.jacobian().leftCols(3).norm() <= 1e-14);  // the base carries both
  RelativePose rotation(robot, "ee", "base_link", {.rotation = RotationTarget{base_T_ee.linear()}});
  rotation.update(terms, 0.0);
  BOOST_TEST(rotation.error().norm() <= 1e-14);
  RelativePose both(robot, "ee", "base_link",
                    {.position = PointTarget{point}, .rotation = RotationTarget{base_T_ee.linear()}});
  both.update(terms, 0.0);
  BOOST_TEST((both.jacobian().topRows(3) - position.jacobian()).norm() == 0.0);
  BOOST_TEST((both.jacobian().bottomRows(3) - rotation.jacobian()).norm() == 0.0);
  BOOST_TEST(position.error_unit() == "m");
  BOOST_TEST(rotation.error_unit() == "rad");
  BOOST_TEST(both.error_unit() == "mixed");
}

BOOST_AUTO_TEST_CASE(joint_group_is_the_task_with_columns_left_out) {
  const Robot robot = youbot();
  Random random(22);
  FramePose pose(robot, "ee", moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.3),
                 spinning_target(random));
  JointGroup group(robot, SelectedRows(pose, {0, 1, 2, 5}),
                   {"arm_joint_1", "base_x", "arm_joint_3", "arm_joint_5"});
  RobotTerms terms(robot);
  const Vector no_acceleration = Vector::Zero(robot.nv());
  Vector member = Vector::Zero(robot.nv());
  for (const char* joint : {"arm_joint_1", "base_x", "arm_joint_3", "arm_joint_5"}) {
    member[robot.joint_index(joint)] = 1.0;
  }
  const std::vector<int> rows{0, 1, 2, 5};
  for (const double t : {1.0, 2.5}) {
    terms.update_dynamics(random_position(random, robot, 0.0), random.vector(robot.nv()));
    pose.update_second_order(terms, t, no_acceleration);
    group.update_second_order(terms, t, no_acceleration);
    const Matrix columns = pose.jacobian()(rows, Eigen::all) * member.asDiagonal();
    BOOST_TEST((group.jacobian() - columns).norm() == 0.0);
    BOOST_TEST((group.error() - pose.error()(rows)).norm() == 0.0);
    BOOST_TEST((group.error_rate() - pose.error_rate()(rows)).norm() <= 1e-13);  // of all joints
    BOOST_TEST((group.drift() - pose.drift()(rows)).norm() == 0.0);
  }
  BOOST_TEST(group.type() == "frame_pose");
  BOOST_TEST(group.clone()->size() == 4);
}

BOOST_AUTO_TEST_CASE(joint_group_of_joint_rows_keeps_those_of_its_joints) {
  const Robot robot = youbot();
  Random random(23);
  const Vector q = random_position(random, robot, 0.0);
  RobotTerms terms(robot);
  terms.update(q, Vector::Zero(robot.nv()));
  JointGroup arm(robot, Posture(robot, Vector::Constant(8, 0.1)), {"arm_joint_2", "arm_joint_1"});
  arm.update(terms, 0.0);
  BOOST_TEST(arm.size() == 2);
  BOOST_TEST((arm.error() - Vector(q(std::vector<int>{4, 3}).array() - 0.1)).norm() <= 1e-15);
  BOOST_TEST(arm.jacobian()(0, 4) == 1.0);
  BOOST_TEST(arm.jacobian().sum() == 2.0);
  BOOST_TEST(!arm.is_goal());
  BOOST_TEST(!arm.is_motion());
}

/// sqrt(det(J J^T)) of some rows and columns of a frame's Jacobian.
double yoshikawa(const RobotTerms& terms, int frame, const std::vector<int>& rows,
                 const std::vector<int>& columns) {
  Matrix jacobian(6, terms.velocity().size());
  terms.frame_jacobian(frame, jacobian);
  const Matrix part = jacobian(rows, columns);
  return std::sqrt((part * part.transpose()).determinant());
}

BOOST_AUTO_TEST_CASE(manipulability_is_yoshikawas) {
  const Robot robot = youbot();
  const int ee = robot.frame_index("ee");
  RobotTerms terms(robot);
  Manipulability all(robot, "ee", 0.5);
  Manipulability arm(robot, "ee", 0.02, {.rows = {2, 0, 1}, .joints = kArm});
  for (int seed = 0; seed < 20; ++seed) {
    Random random(seed);
    terms.update(random_position(random, robot, 0.0), Vector::Zero(robot.nv()));
    all.update(terms, 0.0);
    arm.update(terms, 0.0);
    const double expected = yoshikawa(terms, ee, {0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5, 6, 7});
    BOOST_TEST(all.measure() == expected, boost::test_tools::tolerance(1e-9));
    BOOST_TEST(arm.measure() == yoshikawa(terms, ee, {0, 1, 2}, {3, 4, 5, 6, 7}),
               boost::test_tools::tolerance(1e-9));
    // the target itself is where the error is zero
    Manipulability there(robot, "ee", expected);
    there.update(terms, 0.0);
    BOOST_TEST(std::abs(there.error()[0]) <= 1e-12);
  }
}

BOOST_AUTO_TEST_CASE(manipulability_rates) {
  const Robot robot = youbot();
  Manipulability all(robot, "ee", 0.5);
  check_rates(robot, all, 50);
  for (const char* frame : {"ee", "arm_link_4"}) {
    Manipulability position(robot, frame, 0.02, {.rows = {0, 1, 2}, .joints = kArm});
    check_rates(robot, position, 50);
    Manipulability mixed(robot, frame, 0.3, {.rows = {5, 1}});
    check_rates(robot, mixed, 50);
  }
}

BOOST_AUTO_TEST_CASE(manipulability_is_smooth_through_a_singularity) {
  const Robot robot = youbot();
  RobotTerms terms(robot);
  Manipulability task(robot, "ee", 0.02, {.rows = {0, 1, 2}, .joints = kArm});
  const Vector upright = Vector::Zero(robot.nv());
  const Vector bend = Vector::Unit(robot.nv(), 5);
  double nearest = 1.0;
  Vector last;
  for (int i = -1000; i <= 1000; ++i) {
    terms.update_dynamics(upright + 5e-5 * i * bend, bend);
    task.update_second_order(terms, 0.0, Vector::Zero(robot.nv()));
    nearest = std::min(nearest, task.measure());
    const Vector row = task.jacobian().row(0);
    BOOST_TEST(row.allFinite());
    BOOST_TEST(task.drift().allFinite());
    BOOST_TEST(task.rate().lpNorm<Eigen::Infinity>() <= 2.0);  // the gain
    if (last.size() > 0) {
      BOOST_TEST((row - last).norm() <= 5e-2);
    }
    last = row;
  }
  BOOST_TEST(nearest < 1e-6);
}

BOOST_AUTO_TEST_CASE(selected_rows_rates) {
  const Robot robot = youbot();
  Random random(9);
  const FramePose pose(robot, "ee",
                       moving_along_sine(Vector3(random.vector(3)), Vector3(random.vector(3)), 0.3),
                       spinning_target(random));
  SelectedRows rows(pose, {5, 2, 3});
  check_rates(robot, rows, 100);
}

BOOST_AUTO_TEST_CASE(selected_rows_are_those_of_the_task) {
  const Robot robot = youbot();
  Random random(10);
  FramePose pose(robot, "ee", Vector3(random.vector(3)), random.rotation(), PredefinedTime(2.0));
  const std::vector<int> chosen{4, 0};
  SelectedRows rows(pose, chosen);
  RobotTerms terms(robot);
  const Vector no_acceleration = Vector::Zero(robot.nv());
  for (const double t : {1.0, 2.5}) {  // the reference starts, and is under way
    terms.update_dynamics(random_position(random, robot, 0.0), random.vector(robot.nv()));
    pose.update_second_order(terms, t, no_acceleration);
    rows.update_second_order(terms, t, no_acceleration);
    BOOST_TEST((rows.error() - pose.error()(chosen)).norm() == 0.0);
    BOOST_TEST((rows.jacobian() - pose.jacobian()(chosen, Eigen::all)).norm() == 0.0);
    BOOST_TEST((rows.error_rate() - pose.error_rate()(chosen)).norm() <= 1e-13);
    BOOST_TEST((rows.drift() - pose.drift()(chosen)).norm() == 0.0);
    BOOST_TEST((rows.acceleration() - pose.acceleration()(chosen)).norm() <= 1e-12);
  }
  BOOST_TEST(*rows.duration() == 2.0);
  BOOST_TEST(rows.type() == "frame_pose");
  const auto copy = rows.clone();
  copy->update_second_order(terms, 3.0, no_acceleration);
  rows.update_second_order(terms, 3.0, no_acceleration);
  BOOST_TEST((copy->acceleration() - rows.acceleration()).norm() == 0.0);
  BOOST_TEST(!SelectedRows(Damping(robot), {1}).is_goal());
}

BOOST_AUTO_TEST_CASE(pointing_error_is_the_turn_of_the_axis) {
  const Robot robot = youbot();
  Random random(12);
  RobotTerms terms(robot);
  terms.update(random_position(random, robot, 0.0), Vector::Zero(robot.nv()));
  const int ee = robot.frame_index("ee");
  const Vector3 origin = terms.frame_position(ee);
  const Vector3 axis = random.unit();
  const Vector3 across = axis.unitOrthogonal();
  for (const double angle : {0.0, 1e-9, 1e-3, 0.4, 0.5, 1.6, 3.0, std::numbers::pi - 0.051,
                             std::numbers::pi - 0.049, std::numbers::pi - 0.011}) {
    const Vector3 direction = std::cos(angle) * axis + std::sin(angle) * across;
    Pointing pointing(robot, "ee", 3.0 * axis, Vector3(origin + terms.frame_rotation(ee) * 0.7 * direction));
    pointing.update(terms, 0.0);
    BOOST_TEST(std::abs(pointing.error().norm() - angle) <= 1e-9);
    BOOST_TEST(pointing.near_flip() == (angle > std::numbers::pi - 0.05));
    BOOST_TEST(pointing.jacobian().jacobiSvd().singularValues()[1] > 0.1);  // full rank
  }
}

BOOST_AUTO_TEST_CASE(pointing_stays_finite_where_it_is_undefined) {
  const Robot robot = youbot();
  Random random(13);
  RobotTerms terms(robot);
  terms.update_dynamics(random_position(random, robot, 0.0), random.vector(robot.nv()));
  const int ee = robot.frame_index("ee");
  const Vector3 origin = terms.frame_position(ee);
  const Vector3 behind = origin - terms.frame_rotation(ee).col(0);
  for (const Vector3& target : {behind, Vector3(behind + Vector3::Constant(1e-4)), origin}) {
    Pointing pointing(robot, "ee", Vector3::UnitX(), target);
    pointing.update_second_order(terms, 0.0, Vector::Zero(robot.nv()));
    BOOST_TEST(pointing.jacobian().lpNorm<Eigen::Infinity>() < 2e3);
    BOOST_TEST(pointing.drift().lpNorm<Eigen::Infinity>() < 1e8);
    const bool opposite = target != origin;
    BOOST_TEST(pointing.near_flip() == opposite);
    BOOST_TEST(pointing.error().norm() == (opposite ? std::numbers::pi - 0.01 : 0.0),
               boost::test_tools::tolerance(1e-9));
  }
}

BOOST_AUTO_TEST_CASE(damping_asks_for_rest) {
  const Robot robot = youbot();
  RobotTerms terms(robot);
  Damping damping(robot);
  damping.update(terms, 0.0);
  BOOST_TEST(damping.error().norm() == 0.0);
  BOOST_TEST(damping.rate().norm() == 0.0);
  BOOST_TEST((damping.jacobian() - Matrix::Identity(8, 8)).norm() == 0.0);
  BOOST_TEST(!damping.is_goal());
}

BOOST_AUTO_TEST_CASE(pose_is_position_over_orientation) {
  const Robot robot = youbot();
  Random random(5);
  const Vector3 point = random.vector(3);
  const Matrix3 rotation = random.rotation();
  FramePose pose(robot, "ee", point, rotation);
  FramePosition position(robot, "ee", point);
  FrameOrientation orientation(robot, "ee", rotation);
  RobotTerms terms(robot);
  const Vector q = random_position(random, robot, 0.0);
  error_at(pose, terms, q, 0.0);
  error_at(position, terms, q, 0.0);
  error_at(orientation, terms, q, 0.0);
  BOOST_TEST((pose.error().head(3) - position.error()).norm() == 0.0);
  BOOST_TEST((pose.error().tail(3) - orientation.error()).norm() == 0.0);
  BOOST_TEST((pose.jacobian().topRows(3) - position.jacobian()).norm() == 0.0);
  BOOST_TEST((pose.jacobian().bottomRows(3) - orientation.jacobian()).norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(orientation_warns_near_its_flip) {
  const Robot robot = youbot();
  Random random(6);
  RobotTerms terms(robot);
  const Vector q = random_position(random, robot, 0.0);
  terms.update(q, Vector::Zero(robot.nv()));
  const Matrix3 now = terms.frame_rotation(robot.frame_index("ee"));
  for (const double distance : {0.001, 0.049, 0.051, 1.0}) {
    const Eigen::AngleAxisd turn(std::numbers::pi - distance, random.unit());
    FrameOrientation orientation(robot, "ee", Matrix3(now * turn.toRotationMatrix().transpose()));
    orientation.update(terms, 0.0);
    BOOST_TEST(orientation.near_flip() == (distance < 0.05));
    BOOST_TEST(orientation.error().norm() == std::numbers::pi - distance, boost::test_tools::tolerance(1e-9));
    FramePose pose(robot, "ee", Vector3::Zero(), Matrix3(now * turn.toRotationMatrix().transpose()));
    pose.update(terms, 0.0);
    BOOST_TEST(pose.near_flip() == (distance < 0.05));
  }
}

BOOST_AUTO_TEST_CASE(reference_starts_with_the_first_update) {
  const Robot robot = youbot();
  RobotTerms terms(robot);
  FramePosition task(robot, "ee", Vector3(0.5, 0.5, 0.5), PredefinedTime(2.0));
  task.update(terms, 10.0);
  BOOST_TEST(task.rate().norm() <= 1e-12);  // begins from rest, at 10 s
  task.update(terms, 11.0);
  const Vector halfway = task.rate();
  BOOST_TEST(halfway.norm() > 0.1);
  task.restart();
  task.update(terms, 11.0);
  BOOST_TEST(task.rate().norm() <= 1e-12);
  BOOST_TEST(*task.duration() == 2.0);
}

BOOST_AUTO_TEST_CASE(clones_are_equal_and_apart) {
  const Robot robot = youbot();
  RobotTerms terms(robot);
  FramePosition task(robot, "ee", Vector3(0.5, 0.5, 0.5), PredefinedTime(2.0));
  task.update(terms, 0.0);
  const auto copy = task.clone();
  copy->update(terms, 1.0);
  BOOST_TEST(task.rate().norm() <= 1e-12);
  task.update(terms, 1.0);
  BOOST_TEST((copy->rate() - task.rate()).norm() == 0.0);
}

BOOST_AUTO_TEST_CASE(units_are_told) {
  const Robot robot = youbot();
  BOOST_TEST(JointPosition(robot, {{"base_x", 0.0}}).error_unit() == "m");
  BOOST_TEST(JointPosition(robot, {{"arm_joint_1", 0.0}}).error_unit() == "rad");
  BOOST_TEST(JointPosition(robot, {{"base_x", 0.0}, {"arm_joint_1", 0.0}}).error_unit() == "mixed");
}

BOOST_AUTO_TEST_CASE(bad_targets_are_refused) {
  const Robot robot = youbot();
  const Vector3 origin = Vector3::Zero();
  const Matrix3 upright = Matrix3::Identity();
  Matrix3 scaled = 1.01 * upright;
  Matrix3 mirrored = upright;
  mirrored(2, 2) = -1.0;
  check_error([&] { FramePosition(robot, "eee", origin); }, {"unknown frame 'eee'", "did you mean 'ee'?"});
  check_error([&] { FramePosition(robot, "ee", Vector3(0.0, NAN, 0.0)); },
              {"FramePosition: target", "finite"});
  check_error([&] { FrameOrientation(robot, "wrist", upright); }, {"unknown frame 'wrist'", "known:"});
  check_error([&] { FrameOrientation(robot, "ee", scaled); },
              {"FrameOrientation: target", "not a rotation", "1e-6"});
  check_error([&] { FrameOrientation(robot, "ee", mirrored); }, {"not a rotation", "det R = -1"});
  check_error([&] { FrameOrientation(robot, "ee", Matrix3::Constant(NAN)); }, {"not a rotation"});
  check_error([&] { FramePose(robot, "ee", origin, scaled); }, {"FramePose: rotation", "not a rotation"});
  check_error([&] { FramePose(robot, "ee", Vector3(INFINITY, 0.0, 0.0), upright); },
              {"FramePose: position", "finite"});
  check_error([&] { Posture(robot, Vector::Zero(7)); }, {"Posture: target", "expected 8 values, got 7"});
  check_error([&] { Posture(robot, Vector::Constant(8, NAN)); }, {"Posture: target", "finite"});
  check_error([&] { Pointing(robot, "eee", Vector3::UnitX(), origin); }, {"unknown frame 'eee'", "'ee'?"});
  check_error([&] { Pointing(robot, "ee", origin, origin); }, {"Pointing: axis", "must not be zero"});
  check_error([&] { Pointing(robot, "ee", Vector3(NAN, 0.0, 1.0), origin); }, {"Pointing: axis", "finite"});
  check_error([&] { Pointing(robot, "ee", Vector3::UnitX(), Vector3(0.0, INFINITY, 0.0)); },
              {"Pointing: target", "finite"});
  check_error([&] { CenterOfMass(robot, Vector3(NAN, 0.0, 0.0)); }, {"CenterOfMass: target", "finite"});
  const FramePosition position(robot, "ee", origin);
  check_error([&] { SelectedRows(position, {}); }, {"SelectedRows", "names no row"});
  check_error([&] { SelectedRows(position, {2, 3}); }, {"row 3: frame_position has rows 0 to 2"});
  check_error([&] { SelectedRows(position, {-1}); }, {"row -1", "rows 0 to 2"});
  check_error([&] { SelectedRows(position, {0, 1, 0}); }, {"row 0 is named twice"});
  check_error([&] { JointPosition(robot, {}); }, {"JointPosition", "names no joint"});
  check_error([&] { RelativePose(robot, "ee", "base_link", {}); }, {"RelativePose: target", "neither"});
  check_error([&] { RelativePose(robot, "ee", "base", {.position = PointTarget{origin}}); },
              {"unknown frame 'base'"});
  check_error([&] { RelativePose(robot, "ee", "arm_link_5", {.position = PointTarget{origin}}); },
              {"no joint moves frame 'ee' against frame 'arm_link_5'"});
  check_error([&] { RelativePose(robot, "ee", "base_link", {.rotation = RotationTarget{mirrored}}); },
              {"RelativePose: rotation", "det R = -1"});
  check_error([&] { RelativePose(robot, "ee", "base_link", {.position = PointTarget{{0.0, NAN, 0.0}}}); },
              {"RelativePose: position", "finite"});
  check_error([&] { Manipulability(robot, "ee", 0.0); }, {"Manipulability: target", "positive", "0.0"});
  check_error([&] { Manipulability(robot, "hand", 1.0); }, {"unknown frame 'hand'"});
  check_error([&] { Manipulability(robot, "ee", 1.0, {.rows = {}}); }, {"rows: names no row"});
  check_error([&] { Manipulability(robot, "ee", 1.0, {.rows = {6}}); }, {"rows 0 to 5, got 6"});
  check_error([&] { Manipulability(robot, "ee", 1.0, {.rows = {1, 1}}); }, {"row 1 is named twice"});
  check_error([&] { Manipulability(robot, "ee", 1.0, {.joints = {"arm_joint_6"}}); },
              {"unknown joint 'arm_joint_6'"});
  check_error([&] { Manipulability(robot, "ee", 1.0, {.joints = {"base_x", "base_x"}}); },
              {"'base_x' is named twice"});
  check_error([&] { Manipulability(robot, "ee", 1.0, {.joints = kArm}); },
              {"cannot move frame 'ee' along all of its 6 rows", "zero in every state"});
  check_error([&] { JointGroup(robot, position, {}); }, {"JointGroup", "names no joint"});
  check_error([&] { JointGroup(robot, Damping(robot), {}); }, {"JointGroup", "names no joint"});
  check_error([&] { JointGroup(robot, position, {"arm_joint_6"}); }, {"unknown joint 'arm_joint_6'"});
  check_error([&] { JointGroup(robot, position, {"base_x", "base_x"}); }, {"'base_x' is named twice"});
  check_error([&] { JointGroup(robot, position, {"base_x", "base_y"}); },
              {"no joint of the group moves row 2 of frame_position"});
  check_error([&] { JointPosition(robot, {{"arm_joint_6", 0.0}}); },
              {"unknown joint 'arm_joint_6'", "did you mean"});
  check_error([&] { JointPosition(robot, {{"base_x", 0.0}, {"base_x", 1.0}}); }, {"base_x", "named twice"});
  check_error([&] { JointPosition(robot, {{"base_x", NAN}}); }, {"JointPosition: target", "finite"});
}

BOOST_AUTO_TEST_CASE(robot_without_mass_has_no_centre_of_it) {
  const TemporaryFile urdf("ghost.urdf", R"(<robot name="ghost"><link name="a"/><link name="b"/>
    <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>)");
  const Robot ghost = Robot::from_urdf(urdf.path());
  check_error([&] { CenterOfMass(ghost, Vector3(Vector3::Zero())); },
              {"CenterOfMass: robot 'ghost' has no mass", "<inertial>"});
}

BOOST_AUTO_TEST_CASE(frame_tasks_tell_their_goal_and_can_be_aimed_anew) {
  const Robot robot = youbot();
  Random random(5);
  const Vector3 from = random.vector(3);
  const Vector3 to = random.vector(3);
  const Matrix3 turned = random.rotation();
  const Matrix3 other = random.rotation();
  const FramePosition position(robot, "ee", from);
  const FrameOrientation orientation(robot, "ee", turned);
  const FramePose pose(robot, "arm_link_3", from, turned);
  const SelectedRows height(position, {2});
  const JointGroup by_arm(robot, position, {"arm_joint_1", "arm_joint_2", "arm_joint_3"});
  BOOST_TEST((*position.frame_goal(0.0)->position == from));
  BOOST_TEST(!position.frame_goal(0.0)->rotation.has_value());
  BOOST_TEST((*orientation.frame_goal(0.0)->rotation == turned));
  BOOST_TEST(robot.frame_name(pose.frame_goal(0.0)->frame) == "arm_link_3");
  BOOST_TEST(!Damping(robot).frame_goal(0.0).has_value());
  for (const Task* task : {static_cast<const Task*>(&position), static_cast<const Task*>(&orientation),
                           static_cast<const Task*>(&pose), static_cast<const Task*>(&height),
                           static_cast<const Task*>(&by_arm)}) {
    const auto aimed = task->aimed_at(PointTarget{.position = to}, RotationTarget{.rotation = other});
    const FrameGoal goal = *aimed->frame_goal(0.0);
    BOOST_TEST((aimed->type() == task->type()));
    BOOST_TEST(aimed->size() == task->size());
    BOOST_TEST((goal.frame == task->frame_goal(0.0)->frame));
    BOOST_TEST((!goal.position || *goal.position == to));
    BOOST_TEST((!goal.rotation || *goal.rotation == other));
    BOOST_TEST((goal.position || goal.rotation));
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
