#include <tope/law/symmetric_eigen.hpp>

#include <Eigen/Householder>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace tope {
namespace {

/// Turns coordinates p and q so that M's element between them is zero, and V along with it.
template <typename Small>
void turn(Small& m, Small& v, int p, int q) {
  const double off = m(p, q);
  const double difference = m(q, q) - m(p, p);
  const double radius = std::sqrt(difference * difference + 4.0 * off * off);
  const double sum = std::abs(difference) + radius;
  const double tangent = std::copysign(2.0, difference) * off / sum;  // of the smaller angle
  const double cosine = std::sqrt(sum / (2.0 * radius));
  const double sine = tangent * cosine;
  m(p, p) -= tangent * off;
  m(q, q) += tangent * off;
  m(p, q) = 0.0;
  m(q, p) = 0.0;
  for (int k = 0; k < Small::RowsAtCompileTime; ++k) {
    const double first = v(k, p);
    v(k, p) = cosine * first - sine * v(k, q);
    v(k, q) = sine * first + cosine * v(k, q);
    if (k == p || k == q) {
      continue;
    }
    const double other = m(k, p);
    m(k, p) = cosine * other - sine * m(k, q);
    m(k, q) = sine * other + cosine * m(k, q);
    m(p, k) = m(k, p);
    m(q, k) = m(k, q);
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
    case 3:
      rotate<3>();
      break;
    case 4:
      rotate<4>();
      break;
    default:
      reduce();
  }
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
  bool diagonal = false;
  for (int sweep = 0; sweep < most_sweeps && !diagonal; ++sweep) {
    diagonal = true;
    for (int q = 1; q < size; ++q) {
      for (int p = 0; p < q; ++p) {
        if (std::abs(m(p, q)) > negligible) {
          turn(m, v, p, q);
          diagonal = false;
        }
      }
    }
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
