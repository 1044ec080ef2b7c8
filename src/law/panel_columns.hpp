#pragma once

#include <tope/law/panel_matrix.hpp>

namespace tope {

using Column = PanelMatrix::Column;
inline constexpr Eigen::Index height = PanelMatrix::height;

/// Column j of a panel, or elements 4 j to 4 j + 3 of a padded vector.
inline Eigen::Map<Column> column(double* panel, Eigen::Index j) {
  return Eigen::Map<Column>(panel + height * j);
}
inline Eigen::Map<const Column> column(const double* panel, Eigen::Index j) {
  return Eigen::Map<const Column>(panel + height * j);
}

}  // namespace tope
