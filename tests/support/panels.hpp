#pragma once

#include <tope/law/panel_matrix.hpp>

namespace tope::test {

/// The same matrix as Eigen's.
inline Matrix dense(const PanelMatrix& m) {
  Matrix result(m.rows(), m.cols());
  m.copy_to(result);
  return result;
}

/// The vector as products with panels take it: whole panels, zero beyond.
inline Vector padded(const Vector& v) {
  Vector result = Vector::Zero(PanelMatrix::padded(v.size()));
  result.head(v.size()) = v;
  return result;
}

}  // namespace tope::test
