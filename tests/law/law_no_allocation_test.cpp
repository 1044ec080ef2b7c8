// No law touches the heap once it is built: every method, up to 40 unknowns, with transitions and deficient
// ranks. Also the guard itself. Not here: the robot around the law (controller room).
#include "support/no_allocation.hpp"
#include "support/path.hpp"
#include "support/random_stack.hpp"

#include <tope/law/law.hpp>

#include <boost/test/unit_test.hpp>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace tope::test {

BOOST_AUTO_TEST_SUITE(law_no_allocation)
namespace {

/// The same pointer, but the compiler cannot know, and must not leave the allocation out.
template <typename T>
T* kept(T* memory) {
  asm volatile("" : "+r"(memory) : : "memory");
  return memory;
}

}  // namespace

BOOST_AUTO_TEST_CASE(guard_sees_every_way_to_the_heap) {
  const auto counted = [](auto action) {
    const long before = heap_calls();
    action();
    return heap_calls() - before;
  };
  BOOST_TEST(counted([] {}) == 0);
  BOOST_TEST(counted([] { delete kept(new double(1.0)); }) == 2);
  BOOST_TEST(counted([] { const Vector v = Vector::Zero(100); }) == 2);
  BOOST_TEST(counted([] { std::free(kept(std::realloc(kept(std::calloc(1, 10)), 100000))); }) >= 3);
  BOOST_TEST(counted([] { std::free(kept(std::aligned_alloc(64, 128))); }) == 2);
  BOOST_TEST(counted([] {
               void* memory = nullptr;
               if (posix_memalign(&memory, 64, 128) == 0) {
                 std::free(kept(memory));
               }
             }) == 2);
  BOOST_TEST(counted([] { std::free(realpath("/", nullptr)); }) >= 2);  // from inside a shared library
}

BOOST_AUTO_TEST_CASE(guards_nest) {
  long inside = 0;
  long outside = 0;
  {
    const NoAllocation outer("outer");
    {
      const NoAllocation inner("inner");
      inside = inner.calls();
    }
    outside = outer.calls();
  }
  BOOST_TEST(inside == 0);
  BOOST_TEST(outside == 0);
}

BOOST_AUTO_TEST_CASE(no_method_allocates) {
  for (const std::string& name : limit_method_names()) {
    for (int seed = 0; seed < 12; ++seed) {
      BOOST_TEST_CONTEXT(name << ", seed " << seed) {
        Random random(seed);
        const int n = seed % 4 == 0 ? 40 : random.integer(3, 20);
        const Stack stack = random_stack(random, {.n = n,
                                                  .levels = 3,
                                                  .limit_transitions = seed % 3,
                                                  .task_transitions = seed % 2,
                                                  .beyond = true,
                                                  .inequalities = seed % 3 * n});
        Law law(stack, {.method = limit_method_from(name)});
        Solution solution(n);
        {
          const NoAllocation guard(name);
          law.solve(stack, solution);
        }
        BOOST_TEST(solution.y.allFinite());
      }
    }
  }
}

BOOST_AUTO_TEST_CASE(smoothing_does_not_allocate) {
  for (int seed = 0; seed < 12; ++seed) {
    Random random(seed);
    const Stack stack =
        random_stack(random, {.n = 8, .levels = 3, .task_transitions = seed % 2, .beyond = true});
    Law law(stack, {.smoothing = Smoothing{}});
    Solution solution(8);
    {
      const NoAllocation guard("smoothing");
      law.solve(stack, solution);
    }
    BOOST_TEST(solution.laws >= Smoothing{}.solutions, "seed " << seed);
    BOOST_TEST(solution.y.allFinite(), "seed " << seed);
  }
}

BOOST_AUTO_TEST_CASE(no_method_allocates_at_a_singularity) {
  Random random(1);
  const StackPath path(random, 7, true);
  for (const std::string& name : limit_method_names()) {
    BOOST_TEST_CONTEXT(name) {
      Law law(path.at(0.0), {.method = limit_method_from(name)});
      Solution solution(7);
      for (const double s : {0.3, 0.5, 0.7}) {
        Stack stack = path.at(s);
        for (TaskRows& task : stack.tasks) {
          task.activation = 1.0;
        }
        {
          const NoAllocation guard(name);
          law.solve(stack, solution);
        }
        BOOST_TEST(solution.y.allFinite());
      }
    }
  }
}

BOOST_AUTO_TEST_SUITE_END()

}  // namespace tope::test
