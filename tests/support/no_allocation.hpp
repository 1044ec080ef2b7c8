#pragma once

#include <string>

namespace tope::test {

/// Calls to the heap that this thread made so far: malloc, calloc, realloc, aligned_alloc, memalign,
/// posix_memalign, and free of anything but null. The executable replaces these functions, so calls from
/// shared libraries count as well.
long heap_calls() noexcept;

/// Fails the test when this thread calls the heap while the guard lives. Guards may be nested.
class NoAllocation {
 public:
  explicit NoAllocation(std::string what) : what_(std::move(what)), before_(heap_calls()) {}
  ~NoAllocation();
  NoAllocation(const NoAllocation&) = delete;
  NoAllocation& operator=(const NoAllocation&) = delete;

  long calls() const { return heap_calls() - before_; }

 private:
  std::string what_;
  long before_;
};

}  // namespace tope::test
