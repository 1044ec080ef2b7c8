#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace tope {

/// N numbers that one thread writes and others read without waiting: the sequence number is odd during a write, and a read
/// counts only if it is even and the same before and after (Boehm, "Can seqlocks get along with programming language memory
/// models?", 2012).
template <int N>
class SequenceLock {
 public:
  using Numbers = std::array<double, N>;
  static_assert(std::atomic<double>::is_always_lock_free);

  void write(const Numbers& numbers) noexcept {
    const std::uint64_t before = sequence_.load(std::memory_order_relaxed);
    sequence_.store(before + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    for (std::size_t i = 0; i < N; ++i) {
      numbers_[i].store(numbers[i], std::memory_order_relaxed);
    }
    sequence_.store(before + 2, std::memory_order_release);
  }

  /// True where the numbers are another write's than the one numbered `seen`; then `seen` and `numbers` are its own. False
  /// too where every one of a few tries met a write.
  bool read(std::uint64_t& seen, Numbers& numbers) const noexcept {
    constexpr int tries = 4;
    for (int i = 0; i < tries; ++i) {
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if (before == seen) {
        return false;
      }
      Numbers copy;
      for (std::size_t k = 0; k < N; ++k) {
        copy[k] = numbers_[k].load(std::memory_order_relaxed);
      }
      std::atomic_thread_fence(std::memory_order_acquire);
      if (before % 2 == 0 && sequence_.load(std::memory_order_relaxed) == before) {
        seen = before;
        numbers = copy;
        return true;
      }
    }
    return false;
  }

 private:
  std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<double>, N> numbers_{};
};

}  // namespace tope
