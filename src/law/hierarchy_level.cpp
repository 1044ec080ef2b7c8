#include <tope/law/hierarchy_level.hpp>

namespace tope {

HierarchyLevel::HierarchyLevel(int n, int max_rows)
    : given_(n, max_rows),
      metric_(max_rows, max_rows),
      metric_factor_(max_rows),
      projected_(max_rows, n),
      gram_(max_rows, max_rows),
      clear_factor_(max_rows),
      factor_(max_rows),
      spectrum_(max_rows, n),
      directions_(Matrix::Zero(PanelMatrix::padded(n), n)),
      along_(Vector::Zero(PanelMatrix::padded(max_rows))),
      weights_(along_),
      excess_(max_rows, max_rows) {}

void HierarchyLevel::gather(const Stack& stack, const Selection& selection, std::size_t first) {
  given_.gather(stack, selection, first);
  ready_ = true;
  factorised_ = false;
}

void HierarchyLevel::set_metric(const PanelMatrix& rows, double epsilon) {
  epsilon_ = epsilon;
  multiply_rows(rows, metric_);
  for (Eigen::Index i = 0; i < metric_.rows(); ++i) {
    metric_(i, i) += epsilon * epsilon;
  }
}

const Cholesky& HierarchyLevel::metric() {
  if (!factorised_) {
    metric_factor_.factorise(metric_);
    factorised_ = true;
  }
  return metric_factor_;
}

void HierarchyLevel::start(int closed_before) {
  closed_before_ = closed_before;
  closed_since_ = 0;
  by_rows_ = false;
  clear_ = false;
}

void HierarchyLevel::project(const PanelMatrix& rows, ClosedRows& closed) {
  by_rows_ = true;
  whitened_ = false;
  decomposed_ = false;
  if (closed.size() > 0) {
    closed.project(rows, projected_);
    multiply_rows(projected_, gram_);
    return;
  }
  projected_.assign(rows);
  gram_.assign(metric_);  // A A^T + eps^2 I
  for (Eigen::Index i = 0; i < gram_.rows(); ++i) {
    gram_(i, i) -= epsilon_ * epsilon_;
  }
}

void HierarchyLevel::set_projected(const PanelMatrix& in_basis) {
  by_rows_ = false;
  whitened_ = false;
  decomposed_ = false;
  if (&in_basis != &projected_) {
    projected_.assign(in_basis);
  }
  multiply_rows(projected_, gram_);
}

bool HierarchyLevel::close(double* direction, double damped_below) {
  auto closed = directions_.col(closed_since_++);
  closed = Eigen::Map<const Vector>(direction, closed.size());
  if (!by_rows_) {
    return false;
  }
  multiply(projected_, direction, along_.data());
  if ((along_.head(projected_.rows()).array() == 0.0).all()) {
    return true;
  }
  if (clear_) {
    weights_ = along_;
    factor_.solve(weights_.data());
    subtract_transposed_product(projected_, weights_.data(), direction);
  }
  subtract_outer(projected_, along_.data(), closed.data());
  subtract_outer(gram_, along_.data(), along_.data());
  decomposed_ = false;
  if (!clear_ || !factorise(damped_below)) {
    return false;
  }
  Eigen::Map<Vector>(direction, closed.size()).normalize();  // it has at least sqrt(rho_0) of its length
  return true;
}

bool HierarchyLevel::factorise(double damped_below) {
  subtract(gram_, damped_below, metric_, excess_);
  clear_ = clear_factor_.positive_definite(excess_) && factor_.factorise(gram_);
  return clear_;
}

RowSpectrum& HierarchyLevel::decompose(SymmetricEigen& eigen) {
  if (!whitened_) {
    metric().whiten(projected_);
    multiply_rows(projected_, gram_);
    whitened_ = true;
  }
  if (!decomposed_) {
    spectrum_.compute(projected_, gram_, eigen);
    decomposed_ = true;
  }
  return spectrum_;
}

}  // namespace tope
