#include "jacobi_rotation.hpp"
#include "symmetric_three.hpp"

#include <tope/law/symmetric_eigen.hpp>

#include <Eigen/Householder>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace tope {
namespace {

/// Turns coordinates p and q so that M's element between them is zero, and V along with it; false where it was already.
/// The indices are known to the compiler, so that M and V stay in registers.
template <int p, int q, typename Small>
bool turn(Small& m, Small& v, double negligible) {
  const double off = m(q, p);
  if (!(std::abs(off) > negligible)) {
    return false;
  }
  const JacobiRotation rotation(m(q, q) - m(p, p), off);
  const auto mix = [&rotation](double& first, double& second) {
    const double old = first;
    first = rotation.cosine * old - rotation.sine * second;
    second = rotation.sine * old + rotation.cosine * second;
  };
  m(p, p) -= rotation.tangent * off;
  m(q, q) += rotation.tangent * off;
  m(q, p) = 0.0;
  for (int k = 0; k < Small::RowsAtCompileTime; ++k) {
    mix(v(k, p), v(k, q));
    if (k != p && k != q) {  // the lower triangle alone
      mix(k > p ? m(k, p) : m(p, k), k > q ? m(k, q) : m(q, k));
    }
  }
  return true;
}

/// Turns all pairs from (p, q) on, row by row; false when every one was negligible.
template <int p, int q, typename Small>
bool sweep(Small& m, Small& v, double negligible) {
  const bool turned = turn<p, q>(m, v, negligible);
  if constexpr (p + 1 < q) {
    return sweep<p + 1, q>(m, v, negligible) || turned;
  } else if constexpr (q + 1 < Small::RowsAtCompileTime) {
    return sweep<0, q + 1>(m, v, negligible) || turned;
  } else {
    return turned;
  }
}

}  // namespace

SymmetricEigen::Solver::Solver(Eigen::Index size)
    : reduced_(size, size),
      basis_(size, size),
      reflector_(size),
      diagonal_(size),
      subdiagonal_(size - 1),
      workspace_(size),
      tridiagonal_(size),
      values_(size),
      vectors_(Matrix::Identity(size, size)) {}

void SymmetricEigen::Solver::compute(const PanelMatrix& matrix) {
  if (values_.size() == 3) {
    split_off(matrix);
    return;
  }
  for (Eigen::Index j = 0; j < values_.size(); ++j) {
    for (Eigen::Index i = j; i < values_.size(); ++i) {
      reduced_(i, j) = matrix(i, j);
      reduced_(j, i) = matrix(i, j);
    }
  }
  switch (values_.size()) {
    case 1:
      values_[0] = reduced_(0, 0);
      break;
    case 2:
      rotate<2>();
      break;
    case 4:
      rotate<4>();
      break;
    default:
      reduce();
  }
}

/// In closed form: half the time of rotations.
void SymmetricEigen::Solver::split_off(const PanelMatrix& matrix) {
  Matrix3 m;
  for (Eigen::Index j = 0; j < 3; ++j) {
    for (Eigen::Index i = j; i < 3; ++i) {
      m(i, j) = matrix(i, j);
      m(j, i) = matrix(i, j);
    }
  }
  const SymmetricThree three(m);
  values_.head<3>() = three.values();
  vectors_.topLeftCorner<3, 3>() = three.vectors();
}

/// Jacobi's method: rotations, each of which makes one element zero, until all off the diagonal are.
template <int size>
void SymmetricEigen::Solver::rotate() {
  using Small = Eigen::Matrix<double, size, size>;
  constexpr int most_sweeps = 10;  // three or four are usual: convergence is quadratic
  constexpr double rounding = 1e-16;
  Small m = reduced_;
  Small v = Small::Identity();
  const double negligible = rounding * m.diagonal().cwiseAbs().maxCoeff();
  for (int i = 0; i < most_sweeps && sweep<0, 1>(m, v, negligible); ++i) {
  }
  std::array<int, size> order{};
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&m](int a, int b) { return m(a, a) < m(b, b); });
  for (int i = 0; i < size; ++i) {
    const int from = order[static_cast<std::size_t>(i)];
    values_[i] = m(from, from);
    vectors_.col(i) = v.col(from);
  }
}

/// To tridiagonal form by Householder's reflections, and on by Eigen.
void SymmetricEigen::Solver::reduce() {
  const Eigen::Index size = values_.size();
  basis_.setIdentity();
  for (Eigen::Index i = 0; i + 2 < size; ++i) {
    const Eigen::Index below = size - 1 - i;
    auto reflector = reflector_.head(below - 1);
    double tau = 0.0;
    double length = 0.0;
    reduced_.col(i).tail(below).makeHouseholder(reflector, tau, length);
    reduced_.bottomRows(below).applyHouseholderOnTheLeft(reflector, tau, workspace_.data());
    reduced_.rightCols(below).applyHouseholderOnTheRight(reflector, tau, workspace_.data());
    basis_.rightCols(below).applyHouseholderOnTheRight(reflector, tau, workspace_.data());
  }
  diagonal_ = reduced_.diagonal();
  subdiagonal_ = reduced_.diagonal<-1>();
  tridiagonal_.computeFromTridiagonal(diagonal_, subdiagonal_);
  values_ = tridiagonal_.eigenvalues();
  vectors_.noalias() = basis_ * tridiagonal_.eigenvectors();
}

SymmetricEigen::SymmetricEigen(int max_size) {
  solvers_.reserve(static_cast<std::size_t>(max_size));
  for (int size = 1; size <= max_size; ++size) {
    solvers_.emplace_back(size);
  }
}

const SymmetricEigen::Solver& SymmetricEigen::compute(const PanelMatrix& matrix) {
  Solver& solver = solvers_[static_cast<std::size_t>(matrix.rows() - 1)];
  solver.compute(matrix);
  return solver;
}

}  // namespace tope
