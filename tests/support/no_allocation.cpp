#include "support/no_allocation.hpp"

#include <boost/test/unit_test.hpp>

#include <cerrno>
#include <cstddef>

namespace {

thread_local long calls = 0;

}  // namespace

#ifdef __SANITIZE_ADDRESS__  // which replaces the heap itself, and tells of every call

// of <sanitizer/allocator_interface.h>, which not every compiler brings
extern "C" int __sanitizer_install_malloc_and_free_hooks(  // NOLINT(bugprone-reserved-identifier)
    void (*malloc_hook)(const volatile void*, std::size_t), void (*free_hook)(const volatile void*));

namespace {

const int hooks = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++calls; },
    [](const volatile void* memory) { calls += memory == nullptr ? 0 : 1; });

}  // namespace

#else

// glibc's own functions under the names it keeps for replacements
extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* memory, std::size_t size);            // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT(bugprone-reserved-identifier)
void __libc_free(void* memory);                                  // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept {
  ++calls;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  ++calls;
  return __libc_calloc(count, size);
}

void* realloc(void* memory, std::size_t size) noexcept {
  ++calls;
  return __libc_realloc(memory, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++calls;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++calls;
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  ++calls;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}

void free(void* memory) noexcept {
  calls += memory == nullptr ? 0 : 1;
  __libc_free(memory);
}
}

#endif

namespace tope::test {

long heap_calls() noexcept { return calls; }

NoAllocation::~NoAllocation() {
  if (const long made = this->calls(); made > 0) {
    BOOST_ERROR(what_ << ": " << made << " calls to the heap");
  }
}

}  // namespace tope::test
