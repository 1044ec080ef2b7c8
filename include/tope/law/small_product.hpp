#pragma once

#include <tope/common/types.hpp>

namespace tope {

/// out = a b. The matrices of one robot are small, and Eigen's general product would spend most of its time on packing
/// them into blocks; from some dozens of joints on that pays.
template <typename A, typename B, typename Out>
void multiply(const A& a, const B& b, Out&& out) {
  constexpr Eigen::Index large = 32768;  // products of numbers: three matrices of 32 rows
  if (a.rows() * a.cols() * b.cols() < large) {
    out = a.lazyProduct(b);
  } else {
    out.noalias() = a * b;
  }
}

}  // namespace tope
