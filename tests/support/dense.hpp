#pragma once

#include <tope/law/panel_matrix.hpp>

namespace tope::test {

/// The same matrix as Eigen's.
inline Matrix dense(const PanelMatrix& m) {
  Matrix result(m.rows(), m.cols());
  m.copy_to(result);
  return result;
}

}  // namespace tope::test
