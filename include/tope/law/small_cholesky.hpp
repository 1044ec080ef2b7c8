#pragma once

#include <tope/common/types.hpp>

#include <Eigen/Cholesky>

#include <cmath>

namespace tope {

/// From this size on Eigen's blocked algorithms pay; the usual three to eight rows are quicker by plain loops.
inline constexpr Eigen::Index large_factor = 24;

/// Replaces the lower triangle of `m` by its Cholesky factor L, M = L L^T. False, with `m` spoilt, when a pivot falls
/// to `least` or below.
template <typename Derived>
bool factorise_in_place(Eigen::MatrixBase<Derived>& m, double least = 0.0) {
  const Eigen::Index n = m.rows();
  if (n >= large_factor && least == 0.0) {
    return Eigen::LLT<Eigen::Ref<Matrix>>(m.derived()).info() == Eigen::Success;
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    double pivot = m(j, j);
    for (Eigen::Index k = 0; k < j; ++k) {
      pivot -= m(j, k) * m(j, k);
    }
    if (!(pivot > least)) {
      return false;
    }
    pivot = std::sqrt(pivot);
    m(j, j) = pivot;
    const double inverse = 1.0 / pivot;
    for (Eigen::Index i = j + 1; i < n; ++i) {
      double value = m(i, j);
      for (Eigen::Index k = 0; k < j; ++k) {
        value -= m(i, k) * m(j, k);
      }
      m(i, j) = value * inverse;
    }
  }
  return true;
}

/// x <- L^-1 x.
template <typename Factor, typename X>
void solve_lower(const Factor& l, X&& x) {
  if (l.rows() >= large_factor) {
    l.template triangularView<Eigen::Lower>().solveInPlace(x);
    return;
  }
  for (Eigen::Index i = 0; i < l.rows(); ++i) {
    double value = x[i];
    for (Eigen::Index k = 0; k < i; ++k) {
      value -= l(i, k) * x[k];
    }
    x[i] = value / l(i, i);
  }
}

/// x <- L^-T x.
template <typename Factor, typename X>
void solve_upper(const Factor& l, X&& x) {
  if (l.rows() >= large_factor) {
    l.transpose().template triangularView<Eigen::Upper>().solveInPlace(x);
    return;
  }
  for (Eigen::Index i = l.rows() - 1; i >= 0; --i) {
    double value = x[i];
    for (Eigen::Index k = i + 1; k < l.rows(); ++k) {
      value -= l(k, i) * x[k];
    }
    x[i] = value / l(i, i);
  }
}

}  // namespace tope
