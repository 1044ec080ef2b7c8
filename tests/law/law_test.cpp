// Law: which phi over which activations each limit method takes; the methods' names; small numerical
// helpers. Not here: what each law computes; they have files of their own.
#include "support/infinity_norm.hpp"
#include "support/phi.hpp"
#include "support/random_stack.hpp"
#include "support/text.hpp"

#include <tope/law/law.hpp>
#include <tope/law/smooth_step.hpp>

#include <boost/test/unit_test.hpp>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(law)
namespace {

Vector solve(const Stack& stack, LimitMethod method) {
  Law law(stack, {.method = method});
  Solution solution(stack.size());
  law.solve(stack, solution);
  return solution.y;
}

}  // namespace

BOOST_AUTO_TEST_CASE(without_transitions_every_equality_method_is_the_same) {
  Random random(1);
  const Stack stack = random_stack(random, {.n = 8, .levels = 2, .complete_limits = 0.3, .deficient = 0.0});
  const Vector expected = phi(stack, select_complete(stack));
  for (const LimitMethod method :
       {LimitMethod::chain, LimitMethod::multilinear, LimitMethod::intermediate, LimitMethod::paper,
        LimitMethod::switching, LimitMethod::potential_field}) {
    BOOST_TEST_CONTEXT(to_string(method)) {
      BOOST_TEST(infinity_norm(solve(stack, method) - expected) <= 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(switching_takes_every_row_that_has_begun) {
  Random random(2);
  const Stack stack = random_stack(random, {.n = 8, .levels = 2, .limit_transitions = 2});
  Selection begun = select_complete(stack);
  for (std::size_t j = 0; j < begun.limits.size(); ++j) {
    begun.limits[j] = stack.limit_activation[static_cast<Eigen::Index>(j)] > 0.0 ? 1 : 0;
  }
  BOOST_TEST(infinity_norm(solve(stack, LimitMethod::switching) - phi(stack, begun)) <= 1e-12);
}

BOOST_AUTO_TEST_CASE(none_takes_no_row) {
  Random random(3);
  const Stack stack = random_stack(random, {.n = 8, .levels = 2, .limit_transitions = 2});
  Selection no_limits = select_complete(stack);
  std::fill(no_limits.limits.begin(), no_limits.limits.end(), 0);
  BOOST_TEST(infinity_norm(solve(stack, LimitMethod::none) - phi(stack, no_limits)) <= 1e-12);
}

BOOST_AUTO_TEST_CASE(tasks_in_transition_are_blended_by_every_method) {
  Random random(4);
  Stack stack = random_stack(random, {.n = 8, .levels = 2, .complete_limits = 0.0, .deficient = 0.0});
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST_CONTEXT(name) {
      const LimitMethod method = limit_method_from(name);
      const auto with_activation = [&](double activation) {
        stack.tasks.back().activation = activation;
        return solve(stack, method);
      };
      const Vector blend = 0.7 * with_activation(0.0) + 0.3 * with_activation(1.0);
      BOOST_TEST(infinity_norm(with_activation(0.3) - blend) <= 1e-12);
    }
  }
}

BOOST_AUTO_TEST_CASE(empty_stacks_are_solved) {
  const Stack stack(4);
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST(solve(stack, limit_method_from(name)).norm() == 0.0);
  }
}

BOOST_AUTO_TEST_CASE(names_of_methods_round_trip) {
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST(to_string(limit_method_from(name)) == name);
  }
  check_error([] { limit_method_from("unilatral"); },
              {"unknown limit method 'unilatral'", "did you mean 'unilateral'?"});
}

BOOST_AUTO_TEST_CASE(smooth_step_of_an_array_is_that_of_each_number) {
  const Eigen::Array4d x(-0.5, 0.25, 0.8, 1.5);
  for (int i = 0; i < 4; ++i) {
    BOOST_TEST(smooth_step(x)[i] == smooth_step(x[i]));
  }
}

BOOST_AUTO_TEST_CASE(smooth_step_is_smooth) {
  BOOST_TEST(smooth_step(-1.0) == 0.0);
  BOOST_TEST(smooth_step(0.5) == 0.5);
  BOOST_TEST(smooth_step(2.0) == 1.0);
  const double h = 1e-5;
  BOOST_TEST(smooth_step(h) / h <= 4.0 * h);
  BOOST_TEST((1.0 - smooth_step(1.0 - h)) / h <= 4.0 * h);
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
