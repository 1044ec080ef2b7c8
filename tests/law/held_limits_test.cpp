// HeldLimits against dense algebra: the least y that meets the held rows, and the directions that they close. Not here: what
// a hierarchy does with them (hierarchy_test, motion_rows_test).
#include "support/panels.hpp"
#include "support/random_stack.hpp"

#include <tope/law/held_limits.hpp>

#include <Eigen/QR>
#include <boost/test/unit_test.hpp>

#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(held_limits)
namespace {

/// T^+ target of the rows of some joints.
Vector least_motion(const Stack& stack, const std::vector<Eigen::Index>& joints) {
  const Matrix rows = stack.motion(joints, Eigen::all);
  return rows.completeOrthogonalDecomposition().solve(stack.limit_target(joints).eval());
}

}  // namespace

BOOST_AUTO_TEST_CASE(meets_its_rows_with_the_least_motion) {
  for (int seed = 0; seed < 100; ++seed) {
    BOOST_TEST_CONTEXT("seed " << seed) {
      Random random(seed);
      Stack stack = random_stack(random, {.n = random.integer(3, 12)});
      stack.motion_is_y = stack.motion.isIdentity(0.0);
      HeldLimits limits(stack.size(), true);
      limits.release();
      std::vector<Eigen::Index> joints;
      Matrix closed(0, stack.size());
      for (Eigen::Index joint = stack.size() - 1; joint >= 0; joint -= 2) {
        BOOST_TEST(!limits.holds(joint));
        const Vector direction = limits.hold(stack, joint).head(stack.size());
        BOOST_TEST(limits.holds(joint));
        BOOST_TEST(std::abs(direction.norm() - 1.0) <= 1e-12);
        BOOST_TEST((closed * direction).norm() <= 1e-12);
        joints.push_back(joint);
        closed = dense(limits.closed().rows());
        BOOST_TEST((closed.bottomRows<1>().transpose() - direction).norm() == 0.0);

        Vector y = Vector::Zero(PanelMatrix::padded(stack.size()));
        limits.meet(stack.limit_target, y);
        BOOST_TEST((y.head(stack.size()) - least_motion(stack, joints)).norm() <= 1e-10);
        const Matrix z = dense(limits.open().columns());
        BOOST_TEST(
            (z * z.transpose() + closed.transpose() * closed - Matrix::Identity(stack.size(), stack.size()))
                .norm() <= 1e-11);
      }
      Selection selection = select_all_tasks(stack);
      selection.limits.assign(selection.limits.size(), 1);
      BOOST_TEST(limits.within(selection));
      selection.limits[static_cast<std::size_t>(joints.front())] = 0;
      BOOST_TEST(!limits.within(selection));
      limits.release();
      BOOST_TEST(limits.within(selection));
      BOOST_TEST(limits.closed().size() == 0);
      BOOST_TEST(limits.open().size() == stack.size());
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
