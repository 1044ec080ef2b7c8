// CollisionLimits: distances against closed forms, rows and drift against central differences for every shape, fixed,
// carried by a link and moving; which pairs there are; refusals; no allocation. Not here: what the law makes of the rows
// (law room), closed loops (controller room).
#include "support/no_allocation.hpp"
#include "support/random.hpp"
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/limit/collision_limits.hpp>

#include <Eigen/Geometry>
#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(collision_limits)
namespace {

constexpr double kRadius = 0.03;
constexpr double kGain = 4.0;
constexpr double kServoGain = 9.0;
const Vector3 half_size{0.15, 0.10, 0.05};

/// The youBot without the spheres and bodies of its file.
Robot bare_youbot() {
  RobotConfig config;
  config.locked_joints = {{"gripper_finger_joint_l", 0.0}, {"gripper_finger_joint_r", 0.0}};
  return Robot::from_urdf(source_path("robots/youbot/youbot.urdf"), config);
}

shape::ConvexHull box_corners() {
  shape::ConvexHull hull;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        hull.points.push_back(half_size.cwiseProduct(Vector3(x, y, z)));
      }
    }
  }
  hull.points.emplace_back(0.01, 0.02, -0.01);  // inside
  return hull;
}

struct NamedShape {
  std::string name;
  Shape shape;
};

const std::array<NamedShape, 6> shapes{{{"sphere", shape::Sphere{0.12}},
                                        {"box", shape::Box{2.0 * half_size}},
                                        {"capsule", shape::Capsule{0.08, 0.3}},
                                        {"cylinder", shape::Cylinder{0.1, 0.3}},
                                        {"half_space", shape::HalfSpace{}},
                                        {"convex_hull", box_corners()}}};

/// Signed distance of the shapes above, from textbook formulas.
double closed_form(const std::string& name, const Vector3& x) {
  const double rho = x.head<2>().norm();
  const auto outside = [](const auto& excess) {
    return excess.cwiseMax(0.0).norm() + std::min(excess.maxCoeff(), 0.0);
  };
  if (name == "sphere") {
    return x.norm() - 0.12;
  }
  if (name == "capsule") {
    return (x - Vector3(0.0, 0.0, std::clamp(x.z(), -0.15, 0.15))).norm() - 0.08;
  }
  if (name == "cylinder") {
    return outside(Eigen::Vector2d(rho - 0.1, std::abs(x.z()) - 0.15));
  }
  if (name == "half_space") {
    return x.z();
  }
  return outside((x.cwiseAbs() - half_size).eval());
}

/// A sphere on the end-effector and a body, which a link carries or the world.
struct Scene {
  Robot robot = bare_youbot();
  RobotTerms terms{robot};
  Vector q;
  Vector v;
  CollisionBody body;
  Vector3 center{0.01, -0.02, 0.03};
  BodyMotion motion;  // of a body in the world, at t = 0

  Scene(Random& random, const Shape& shape, const std::string& carrier)
      : q(random_position(random, robot, 0.1)), v(random.vector(robot.nv(), 0.5)) {
    body = {.name = "body", .frame = carrier, .shape = shape};
    if (carrier.empty()) {
      motion.velocity = 0.3 * random.vector(3);
      motion.angular_velocity = 0.7 * random.vector(3);
    }
  }

  Vector3 sphere_position() { return frame_position("ee") + frame_rotation("ee") * center; }

  /// Puts the body where the sphere's centre has these coordinates in it, at q.
  void place(Random& random, const Vector3& local) {
    terms.update(q, v);
    motion.rotation = random.rotation();
    motion.position = sphere_position() - motion.rotation * local;
    body.position = motion.position;
    body.rotation = motion.rotation;
    if (!body.frame.empty()) {
      const Matrix3 frame = frame_rotation(body.frame);
      body.position = frame.transpose() * (motion.position - frame_position(body.frame));
      body.rotation = frame.transpose() * motion.rotation;
    }
  }

  CollisionLimits limits() const {
    CollisionOptions options;
    options.geometry.spheres.push_back({.name = "ball", .frame = "ee", .center = center, .radius = kRadius});
    options.geometry.bodies.push_back(body);
    return {robot, options, kGain, kServoGain};
  }

  /// Of an obstacle that goes on as at t = 0.
  BodyMotion motion_at(double t) const {
    BodyMotion moved = motion;
    moved.position += t * motion.velocity;
    const double rate = motion.angular_velocity.norm();
    if (rate > 0.0) {
      moved.rotation = Eigen::AngleAxisd(t * rate, motion.angular_velocity / rate) * motion.rotation;
    }
    return moved;
  }

  /// Distance at a position of the joints and time of the obstacle.
  double distance(CollisionLimits& limits, const Vector& position, double t) {
    if (body.frame.empty()) {
      BOOST_REQUIRE(limits.move(0, motion_at(t)));
    }
    terms.update(position, v);
    limits.update(terms);
    return limits.distance()[0];
  }

  /// The sphere's centre in the body, at a position of the joints and time of the obstacle.
  Vector3 local_at(const Vector& position, double t) {
    terms.update(position, v);
    if (body.frame.empty()) {
      const BodyMotion moved = motion_at(t);
      return moved.rotation.transpose() * (sphere_position() - moved.position);
    }
    const Matrix3 frame = frame_rotation(body.frame);
    const Vector3 origin = frame_position(body.frame) + frame * body.position;
    return (frame * body.rotation).transpose() * (sphere_position() - origin);
  }

 private:
  Vector3 frame_position(const std::string& frame) { return terms.frame_position(robot.frame_index(frame)); }
  Matrix3 frame_rotation(const std::string& frame) { return terms.frame_rotation(robot.frame_index(frame)); }
};

const std::array<std::string, 3> carriers{"", "base_link", "arm_link_2"};

/// A point outside of the shape, at least 2 cm from it; at an edge or corner of a box, to a nanometre, if asked.
Vector3 outside_point(Random& random, const std::string& name, bool at_edge) {
  for (;;) {
    Vector3 x = 0.3 * random.vector(3);
    if (at_edge) {
      for (const int axis : {0, 1, 2}) {
        if (random.chance(0.6)) {
          x[axis] = std::copysign(half_size[axis], x[axis]) + 1e-9 * random.normal();
        }
      }
    }
    if (closed_form(name, x) > 0.02) {
      return x;
    }
  }
}

/// True where the shape's distance has three continuous derivatives for a centimetre around.
bool is_smooth(const std::string& name, const Vector3& x) {
  constexpr double clear = 0.01;
  const auto off = [](double value, double edge) { return std::abs(std::abs(value) - edge) > clear; };
  if (name == "capsule") {
    return off(x.z(), 0.15);
  }
  if (name == "cylinder") {
    return off(x.z(), 0.15) && off(x.head<2>().norm(), 0.1);
  }
  if (name == "box" || name == "convex_hull") {
    return off(x.x(), half_size.x()) && off(x.y(), half_size.y()) && off(x.z(), half_size.z());
  }
  return true;
}

/// Calls check(scene, name, random) for every shape and carrier.
template <typename Check>
void on_scenes(int seeds, Check check) {
  for (const NamedShape& named : shapes) {
    for (const std::string& carrier : carriers) {
      for (int seed = 0; seed < seeds; ++seed) {
        BOOST_TEST_CONTEXT(named.name << " on '" << carrier << "', seed " << seed) {
          Random random(seed);
          Scene scene(random, named.shape, carrier);
          check(scene, named.name, random);
        }
      }
    }
  }
}

}  // namespace

BOOST_AUTO_TEST_CASE(distances_equal_closed_forms) {
  double largest = 0.0;
  on_scenes(40, [&](Scene& scene, const std::string& name, Random& random) {
    const Vector3 local = 0.3 * random.vector(3);  // inside too
    scene.place(random, local);
    CollisionLimits limits = scene.limits();
    const double error =
        std::abs(scene.distance(limits, scene.q, 0.0) - (closed_form(name, local) - kRadius));
    BOOST_TEST(error <= 1e-12);
    largest = std::max(largest, error);
  });
  BOOST_TEST_MESSAGE("largest error " << largest << " m");
}

BOOST_AUTO_TEST_CASE(rows_equal_central_differences) {
  double largest = 0.0;
  on_scenes(40, [&](Scene& scene, const std::string& name, Random& random) {
    scene.place(random, outside_point(random, name, random.chance(0.5)));
    CollisionLimits limits = scene.limits();
    scene.distance(limits, scene.q, 0.0);
    const Vector row = limits.jacobian().row(0);
    constexpr double h = 1e-7;
    for (int j = 0; j < scene.robot.nv(); ++j) {
      const Vector step = h * Vector::Unit(scene.robot.nv(), j);
      const double slope =
          (scene.distance(limits, scene.q + step, 0.0) - scene.distance(limits, scene.q - step, 0.0)) /
          (2.0 * h);
      BOOST_TEST(std::abs(row[j] - slope) <= 1e-6);
      largest = std::max(largest, std::abs(row[j] - slope));
    }
  });
  BOOST_TEST_MESSAGE("largest error " << largest);
}

/// c qdot at the bound makes the distance shrink by gain (d - margin), whatever the obstacle does.
BOOST_AUTO_TEST_CASE(bound_of_velocity_mode_is_a_rate_of_the_distance) {
  on_scenes(20, [&](Scene& scene, const std::string& name, Random& random) {
    scene.place(random, outside_point(random, name, false));
    CollisionLimits limits = scene.limits();
    const double distance = scene.distance(limits, scene.q, 0.0);
    const Vector row = limits.jacobian().row(0);
    const double bound = limits.motion_lower()[0];
    const Vector motion = scene.v + (bound - row.dot(scene.v)) / row.squaredNorm() * row;
    constexpr double h = 1e-6;
    const double rate =
        (scene.distance(limits, scene.q + h * motion, h) - scene.distance(limits, scene.q - h * motion, -h)) /
        (2.0 * h);
    BOOST_TEST(std::abs(rate + kGain * (distance - limits.margin())) <= 1e-5);
  });
}

/// c qddot at the bound gives the distance the acceleration that it says, and what the shape's curvature adds.
BOOST_AUTO_TEST_CASE(bound_of_torque_mode_is_an_acceleration_of_the_distance) {
  double largest = 0.0;
  double curved = 0.0;
  on_scenes(20, [&](Scene& scene, const std::string& name, Random& random) {
    Vector3 local = outside_point(random, name, false);
    while (!is_smooth(name, local)) {
      local = outside_point(random, name, false);
    }
    scene.place(random, local);
    CollisionLimits limits = scene.limits();
    scene.terms.update_dynamics(scene.q, scene.v);
    BOOST_REQUIRE((!scene.body.frame.empty() || limits.move(0, scene.motion)));
    limits.update_second_order(scene.terms);
    const double distance = limits.distance()[0];
    const double bound = limits.motion_lower()[0];
    const Vector row = limits.jacobian().row(0);
    const Vector free = random.vector(scene.robot.nv());
    const Vector motion = free + (bound - row.dot(free)) / row.squaredNorm() * row;

    const auto at = [&](double t) -> Vector { return scene.q + t * scene.v + 0.5 * t * t * motion; };
    constexpr double h = 1e-4;
    const double ahead = scene.distance(limits, at(h), h);
    const double behind = scene.distance(limits, at(-h), -h);
    const double rate = (ahead - behind) / (2.0 * h);
    const double acceleration = (ahead - 2.0 * distance + behind) / (h * h);
    // the same for a point on a straight line at the same relative velocity: the curvature alone
    const Vector3 step = 0.5 * (scene.local_at(at(h), h) - scene.local_at(at(-h), -h));
    const double curvature =
        (closed_form(name, local + step) - 2.0 * closed_form(name, local) + closed_form(name, local - step)) /
        (h * h);
    const double asked = -(kGain + kServoGain) * rate - kGain * kServoGain * (distance - limits.margin());
    const double error = std::abs(acceleration - curvature - asked);
    BOOST_TEST(error <= 1e-4 * (1.0 + std::abs(asked)));
    BOOST_TEST(curvature >= -1e-6);
    largest = std::max(largest, error / (1.0 + std::abs(asked)));
    curved = std::max(curved, curvature);
  });
  BOOST_TEST(curved >= 1.0);
  BOOST_TEST_MESSAGE("largest error " << largest << ", largest curvature left out " << curved << " m/s2");
}

/// From one side of an edge or corner to the other, rows change as little as the path is long.
BOOST_AUTO_TEST_CASE(rows_are_continuous_across_edges) {
  for (const NamedShape& named : shapes) {
    BOOST_TEST_CONTEXT(named.name) {
      Random random(3);
      Scene scene(random, named.shape, "");
      scene.place(random, outside_point(random, "box", true));
      CollisionLimits limits = scene.limits();
      double last = std::numeric_limits<double>::infinity();
      for (const double step : {1e-2, 1e-4, 1e-6, 1e-8}) {
        const Vector direction = Vector::Ones(scene.robot.nv());
        scene.distance(limits, scene.q + step * direction, 0.0);
        const Vector ahead = limits.jacobian().row(0);
        scene.distance(limits, scene.q - step * direction, 0.0);
        const double change = (ahead - limits.jacobian().row(0).transpose()).norm();
        BOOST_TEST(change <= std::max(0.05 * last, 1e-12));
        last = change;
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(pairs_leave_out_neighbours_and_exclusions) {
  const Robot robot = bare_youbot();
  CollisionOptions options;
  const auto ball = [](const std::string& frame) {
    return CollisionSphere{.name = frame, .frame = frame, .center = Vector3::Zero(), .radius = 0.05};
  };
  for (const char* frame : {"base_link", "arm_link_1", "arm_link_2", "gripper_base_link"}) {
    options.geometry.spheres.push_back(ball(frame));
  }
  options.geometry.bodies.push_back(
      {.name = "chassis", .frame = "base_link", .shape = shape::Box{Vector3::Ones()}});
  options.geometry.bodies.push_back({.name = "elbow", .frame = "arm_link_3", .shape = shape::Sphere{0.05}});
  options.geometry.bodies.push_back({.name = "floor", .shape = shape::HalfSpace{}});
  options.geometry.exclude = {{.sphere = "base_link", .body = "floor"},
                              {.sphere = "arm_link_1", .body = "floor"}};
  const CollisionLimits limits(robot, options, 1.0, 1.0);
  const std::vector<std::string> expected{
      "base_link.elbow",           "arm_link_1.elbow",        "arm_link_2.chassis",     "arm_link_2.floor",
      "gripper_base_link.chassis", "gripper_base_link.elbow", "gripper_base_link.floor"};
  BOOST_TEST(limits.names() == expected, boost::test_tools::per_element());
}

BOOST_AUTO_TEST_CASE(names_the_pair_inside_its_margin_and_the_one_pressed) {
  Random random(4);
  Scene scene(random, shape::Sphere{0.12}, "");
  scene.place(random, Vector3(0.0, 0.0, 0.12 + kRadius + 0.02));
  CollisionLimits limits = scene.limits();
  scene.motion.velocity.setZero();
  scene.motion.angular_velocity.setZero();
  scene.distance(limits, scene.q, 0.0);
  BOOST_TEST(limits.inside() == -1);
  const Vector row = limits.jacobian().row(0);
  const Vector along = row / row.squaredNorm();               // the distance grows by 1 m/s
  BOOST_TEST(limits.pressed_by(-0.01 * along, 0.029) == -1);  // of 4 1/s times 1 cm, 0.03 m/s are left
  BOOST_TEST(limits.pressed_by(-0.01 * along, 0.031) == 0);
  scene.motion.position += 0.011 * scene.motion.rotation.col(2);
  scene.distance(limits, scene.q, 0.0);
  BOOST_TEST(limits.inside() == 0);
}

BOOST_AUTO_TEST_CASE(moves_obstacles_alone) {
  Random random(5);
  const Scene scene(random, shape::Sphere{0.1}, "");
  CollisionLimits limits = scene.limits();
  BodyMotion motion{.position = Vector3::Ones()};
  BOOST_TEST(limits.move(0, motion));
  BOOST_TEST(!limits.move(1, motion));
  BOOST_TEST(!limits.move(-1, motion));
  motion.velocity.x() = NAN;
  BOOST_TEST(!limits.move(0, motion));
  motion.velocity.x() = 0.0;
  motion.rotation(0, 0) = 1.1;
  BOOST_TEST(!limits.move(0, motion));
  CollisionLimits carried = Scene(random, shape::Sphere{0.1}, "base_link").limits();
  BOOST_TEST(!carried.move(0, BodyMotion{.position = Vector3::Ones()}));
  BOOST_TEST(limits.body_index("body") == 0);
  check_error([&] { limits.body_index("bodi"); }, {"unknown body 'bodi'", "body"});
}

BOOST_AUTO_TEST_CASE(never_allocates) {
  for (const NamedShape& named : shapes) {
    for (const std::string& carrier : carriers) {
      for (const bool inside : {false, true}) {
        BOOST_TEST_CONTEXT(named.name << " on '" << carrier << "'") {
          Random random(6);
          Scene scene(random, named.shape, carrier);
          scene.place(random, inside ? Vector3(0.01, 0.02, -0.03) : Vector3(0.3, 0.2, 0.4));
          CollisionLimits limits = scene.limits();
          scene.terms.update_dynamics(scene.q, scene.v);
          {
            const NoAllocation guard(named.name);
            limits.update(scene.terms);
            limits.update_second_order(scene.terms);
            static_cast<void>(limits.move(0, scene.motion));
            static_cast<void>(limits.pressed_by(scene.v, 1.0));
          }
          BOOST_TEST(limits.motion_lower().allFinite());
          BOOST_TEST((limits.distance()[0] < 0.0) == inside);
        }
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(refuses_bad_geometry) {
  const Robot robot = bare_youbot();
  CollisionOptions good;
  good.geometry.spheres.push_back({.name = "ball", .frame = "ee", .center = Vector3::Zero(), .radius = 0.05});
  good.geometry.bodies.push_back({.name = "post", .shape = shape::Cylinder{0.1, 1.0}});
  const auto refuse = [&](auto change, std::initializer_list<std::string> parts) {
    CollisionOptions bad = good;
    change(bad);
    check_error([&] { const CollisionLimits limits(robot, bad, 1.0, 1.0); }, parts);
  };
  using O = CollisionOptions;
  refuse([](O& o) { o.margin = 0.0; }, {"collisions: margin must be positive"});
  refuse([](O& o) { o.gain = -1.0; }, {"collisions: gain must be positive"});
  refuse([](O& o) { o.servo_gain = NAN; }, {"collisions: servo_gain must be positive"});
  refuse([](O& o) { o.geometry.spheres[0].radius = 0.0; }, {"sphere ball: radius must be positive"});
  refuse([](O& o) { o.geometry.spheres[0].center.x() = NAN; }, {"sphere ball", "center must be finite"});
  refuse([](O& o) { o.geometry.spheres[0].frame = "eee"; }, {"sphere ball", "unknown frame 'eee'", "ee"});
  refuse([](O& o) { o.geometry.bodies[0].frame = "base"; }, {"body post", "unknown frame 'base'"});
  refuse([](O& o) { o.geometry.bodies[0].shape = shape::Box{Vector3(1.0, 0.0, 1.0)}; },
         {"body post: size must be positive"});
  refuse([](O& o) { o.geometry.bodies[0].shape = shape::ConvexHull{{Vector3::Zero(), Vector3::Ones()}}; },
         {"body post: points", "at least four"});
  refuse([](O& o) { o.geometry.bodies[0].rotation *= 2.0; }, {"body post", "rotation"});
  refuse([](O& o) { o.geometry.bodies.push_back(o.geometry.bodies[0]); }, {"second body is named 'post'"});
  refuse([](O& o) { o.geometry.spheres.clear(); }, {"no sphere is given"});
  refuse([](O& o) { o.geometry.bodies.clear(); }, {"no body is given"});
  refuse([](O& o) { o.geometry.exclude = {{.sphere = "bal", .body = "post"}}; },
         {"exclude: unknown sphere or frame 'bal'", "ball"});
  refuse([](O& o) { o.geometry.exclude = {{.sphere = "ball", .body = "pots"}}; },
         {"unknown body 'pots'", "post"});
  refuse([](O& o) { o.geometry.exclude = {{.sphere = "ee", .body = "post"}}; }, {"no distance is left"});
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
