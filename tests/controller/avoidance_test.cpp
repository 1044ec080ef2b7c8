// Distances kept in closed loop, in both modes: obstacles at rest and moving, the robot's own links; continuity in the
// period; status; refusals; no allocation. Not here: the rows themselves (limit room), the law (law room).
#include "support/jump.hpp"
#include "support/loop.hpp"
#include "support/no_allocation.hpp"
#include "support/path.hpp"
#include "support/robots.hpp"
#include "support/text.hpp"

#include <tope/controller/controller.hpp>
#include <tope/task/damping.hpp>
#include <tope/task/frame_orientation.hpp>
#include <tope/task/frame_position.hpp>

#include <boost/test/unit_test.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(avoidance)
namespace {

constexpr std::array modes{Mode::velocity, Mode::torque};

CollisionBody post(const Vector3& position) {
  return {.name = "post", .shape = shape::Cylinder{0.05, 1.0}, .position = position};
}

CollisionBody crate(Random& random, const Vector3& position) {
  return {.name = "crate",
          .shape = shape::Box{Vector3(0.2, 0.3, 0.2)},
          .position = position,
          .rotation = random.rotation()};
}

ControllerOptions options(Mode mode, std::vector<CollisionBody> obstacles, double dt = 1e-3) {
  ControllerOptions options{.mode = mode, .dt = dt};
  options.limits.collisions.emplace();
  options.limits.collisions->geometry.bodies = std::move(obstacles);
  return options;
}

/// A loop that keeps its distances and the least of each.
struct Avoiding : Loop {
  explicit Avoiding(const ControllerOptions& chosen) : Loop(youbot(), chosen), least(distances()) {
    if (chosen.mode == Mode::torque) {
      controller.add(9, Damping(robot));
    }
  }

  void reach(const Vector3& goal, const Matrix3& orientation) {
    controller.add(1, FramePosition(robot, "ee", goal, Exponential{{.gain = 2.0}}));
    controller.add(2, FrameOrientation(robot, "ee", orientation, Exponential{{.gain = 2.0}}));
  }

  Vector distances() {
    command();
    return controller.collisions()->distance();
  }

  void observe() { least = least.cwiseMin(controller.collisions()->distance()); }

  Vector least;
};

/// A goal for the end-effector with a post and a crate about the way.
struct Course {
  Vector3 goal;
  Matrix3 orientation;
  std::vector<CollisionBody> obstacles;

  /// Drawn again until nothing is near at the start.
  static Course draw(Random& random) {
    for (;;) {
      const Vector3 start{0.55, 0.0, 0.3};
      const Vector3 goal{random.uniform(-1.0, 1.5), random.uniform(-1.0, 1.0), random.uniform(0.05, 0.5)};
      const auto on_the_way = [&] {
        return Vector3(start + random.uniform(0.2, 1.0) * (goal - start) + 0.1 * random.vector(3));
      };
      Vector3 foot = on_the_way();
      foot.z() = 0.5;
      Course course{.goal = goal,
                    .orientation = random.rotation(),
                    .obstacles = {post(foot), crate(random, on_the_way())}};
      if (Avoiding(options(Mode::velocity, course.obstacles)).least.minCoeff() > 0.03) {
        return course;
      }
    }
  }
};

/// The largest change of the command from one cycle to the next in a second, over the joint's bound, and where.
struct Steepest {
  Steepest(Mode mode, const Course& course, double dt) {
    Avoiding loop(options(mode, course.obstacles, dt));
    loop.reach(course.goal, course.orientation);
    Jump watched(loop);
    Vector here = loop.q;
    loop.run(1.0, [&] {  // the command belongs to the state before the step
      watched();
      if (watched.largest > jump) {
        jump = watched.largest;
        before = last;
        after = here;
      }
      last = here;
      here = loop.q;
    });
  }

  double jump = 0.0;
  Vector before;
  Vector after;

 private:
  Vector last;
};

}  // namespace

BOOST_AUTO_TEST_CASE(keeps_every_distance_on_the_way_to_random_goals) {
  for (const Mode mode : modes) {
    double least = 1.0;
    double beyond = -1.0;
    int avoided = 0;
    for (int seed = 0; seed < 20; ++seed) {
      BOOST_TEST_CONTEXT("mode " << static_cast<int>(mode) << ", seed " << seed) {
        Random random(seed);
        const Course course = Course::draw(random);
        Avoiding loop(options(mode, course.obstacles));
        loop.reach(course.goal, course.orientation);
        bool avoiding = false;
        loop.run(4.0, [&] {
          loop.observe();
          avoiding = avoiding || loop.controller.status().has(Event::avoiding);
        });
        BOOST_TEST(loop.least.minCoeff() > 0.0);
        BOOST_TEST(loop.beyond() < 0.0);
        least = std::min(least, loop.least.minCoeff());
        beyond = std::max(beyond, loop.beyond());
        avoided += avoiding ? 1 : 0;
      }
    }
    BOOST_TEST(avoided >= 15);
    BOOST_TEST_MESSAGE("mode " << static_cast<int>(mode) << ": least distance " << least
                               << " m, margin 0.01 m, " << avoided
                               << " runs with avoidance, furthest beyond a joint limit " << beyond);
  }
}

/// Ten times shorter a period, ten times smaller a jump. The steepest spots of velocity mode last microseconds: there the
/// command is followed between the two states instead.
BOOST_AUTO_TEST_CASE(jumps_of_the_command_fall_with_the_period) {
  for (const Mode mode : modes) {
    const double period = mode == Mode::torque ? 1e-3 : 1e-4;
    std::vector<double> ratios;
    for (int seed = 0; seed < 6; ++seed) {
      BOOST_TEST_CONTEXT("mode " << static_cast<int>(mode) << ", seed " << seed) {
        Random random(seed);
        const Course course = Course::draw(random);
        const Steepest coarse(mode, course, period);
        const Steepest fine(mode, course, 0.1 * period);
        BOOST_TEST_MESSAGE(coarse.jump << " -> " << fine.jump);
        ratios.push_back(coarse.jump / fine.jump);
        if (mode == Mode::velocity && ratios.back() < 3.0) {
          Avoiding loop(options(mode, course.obstacles, period));
          loop.reach(course.goal, course.orientation);
          const auto command = [&](double share) {
            loop.q = fine.before + share * (fine.after - fine.before);
            loop.command();
            return loop.u;
          };
          const std::vector<double> changes = zoomed_changes(command, 100, 5);
          BOOST_TEST(changes.back() <= 1e-3 * changes.front());
        } else {
          BOOST_TEST(ratios.back() >= 3.0);
        }
      }
    }
    std::sort(ratios.begin(), ratios.end());
    BOOST_TEST(ratios[ratios.size() / 2] >= 8.0);
  }
}

/// The goal is inside the robot's own chassis.
BOOST_AUTO_TEST_CASE(keeps_the_arm_off_its_own_base) {
  for (const Mode mode : modes) {
    BOOST_TEST_CONTEXT("mode " << static_cast<int>(mode)) {
      ControllerOptions chosen = options(mode, {});
      Avoiding loop(chosen);
      const int fixed[] = {0, 1, 2};
      Vector lower = loop.robot.position_lower();
      Vector upper = loop.robot.position_upper();
      for (const int joint : fixed) {  // so that the base does not drive away from under the goal
        lower[joint] = -0.15;
        upper[joint] = 0.15;
      }
      loop.robot.set_position_limits(lower, upper);
      loop.controller = Controller(loop.robot, chosen);
      loop.controller.add(
          1, FramePosition(loop.robot, "ee", Vector3(0.2, 0.0, 0.1), Exponential{{.gain = 2.0}}));
      if (mode == Mode::torque) {
        loop.controller.add(9, Damping(loop.robot));
      }
      bool avoiding = false;
      loop.run(4.0, [&] {
        loop.observe();
        avoiding = avoiding || loop.controller.status().has(Event::avoiding);
      });
      BOOST_TEST(loop.least.minCoeff() > 0.0);
      BOOST_TEST(avoiding);
      BOOST_TEST_MESSAGE("least distance " << loop.least.minCoeff());
    }
  }
}

/// A post comes at half the base's speed, from the front; the robot has nothing else to do.
BOOST_AUTO_TEST_CASE(makes_way_for_an_obstacle_that_moves) {
  for (const Mode mode : modes) {
    BOOST_TEST_CONTEXT("mode " << static_cast<int>(mode)) {
      const Vector3 start{1.2, 0.05, 0.5};
      const Vector3 velocity{-0.3, 0.0, 0.0};
      Avoiding loop(options(mode, {post(start)}));
      const int obstacle = loop.controller.collisions()->body_index("post");
      double moved = 0.0;
      for (int cycle = 0; cycle < 5000; ++cycle) {
        BOOST_REQUIRE(loop.controller.move_obstacle(
            obstacle, {.position = start + loop.t * velocity, .velocity = velocity}));
        loop.step();
        loop.observe();
        moved = std::max(moved, std::abs(loop.q[0]));
      }
      BOOST_TEST(loop.least.minCoeff() > 0.0);
      BOOST_TEST(moved > 0.3);
      BOOST_TEST_MESSAGE("least distance " << loop.least.minCoeff() << ", moved " << moved);
    }
  }
}

BOOST_AUTO_TEST_CASE(leads_a_sphere_out_of_its_margin_and_says_so) {
  for (const Mode mode : modes) {
    BOOST_TEST_CONTEXT("mode " << static_cast<int>(mode)) {
      Avoiding loop(options(mode, {post(Vector3(5.0, 0.0, 0.5))}));
      const Vector3 ee = [&] {
        RobotTerms terms(loop.robot);
        terms.update(loop.q, loop.v);
        return terms.frame_position(loop.robot.frame_index("ee"));
      }();
      // the fingers' sphere is about the frame ee
      BOOST_REQUIRE(loop.controller.move_obstacle(loop.controller.collisions()->body_index("post"),
                                                  {.position = Vector3(ee.x() + 0.07, ee.y(), 0.5)}));
      const double before = loop.distances().minCoeff();
      BOOST_TEST(before < 0.01);
      const Status& status = loop.controller.status();
      BOOST_TEST(status.has(Event::too_near));
      BOOST_TEST(status.has(Event::avoiding));
      const std::string said = loop.controller.status_text();
      BOOST_TEST(said.find(".post is below its margin") != std::string::npos, said);
      BOOST_TEST(event_names(status).find("avoiding|too_near") != std::string::npos);
      loop.run(3.0);
      BOOST_TEST(loop.distances().minCoeff() >= 0.01);
      BOOST_TEST(!loop.controller.status().has(Event::too_near));
    }
  }
}

BOOST_AUTO_TEST_CASE(never_allocates) {
  for (const Mode mode : modes) {
    for (const NullSpace null_space : {NullSpace::compensated, NullSpace::zero_torque}) {
      Random random(2);
      const Course course = Course::draw(random);
      ControllerOptions chosen = options(mode, course.obstacles);
      chosen.null_space = null_space;
      Avoiding loop(chosen);
      loop.reach(course.goal, course.orientation);
      long calls = 0;
      int avoiding = 0;
      loop.command();
      for (int cycle = 0; cycle < 1500; ++cycle) {
        const long before = heap_calls();
        static_cast<void>(loop.controller.move_obstacle(3, {.position = course.obstacles[0].position}));
        loop.command();
        calls += heap_calls() - before;
        avoiding += loop.controller.status().has(Event::avoiding) ? 1 : 0;
        loop.follow();
      }
      BOOST_TEST(calls == 0);
      BOOST_TEST(avoiding > 100);
    }
  }
}

BOOST_AUTO_TEST_CASE(refuses_what_it_cannot_keep) {
  const Robot robot = youbot();
  for (const std::string& method : limit_method_names()) {
    if (method != "unilateral") {
      ControllerOptions bad = options(Mode::velocity, {post(Vector3::Ones())});
      bad.limits.method = limit_method_from(method);
      check_error([&] { const Controller controller(robot, bad); },
                  {"collisions", "'" + method + "'", "'unilateral'"});
    }
  }
  ControllerOptions fast = options(Mode::velocity, {});
  fast.limits.collisions->gain = 1100.0;
  check_error([&] { const Controller controller(robot, fast); },
              {"distance servo within one period", "lower collisions.gain to at most 1000"});
  ControllerOptions hard = options(Mode::torque, {});
  hard.limits.collisions->gain = 9.9;
  check_error([&] { const Controller controller(robot, hard); },
              {"drives strong enough for the distances", "lower collisions.gain"});
  ControllerOptions thin = options(Mode::velocity, {});
  thin.limits.collisions->margin = 1e-4;
  check_error([&] { const Controller controller(robot, thin); },
              {"margin covers a period", "raise collisions.margin to at least 0.000", "lower dt to at most"});
  const Controller plain(robot, {.mode = Mode::velocity});
  BOOST_TEST(plain.collisions() == nullptr);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
