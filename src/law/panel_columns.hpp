#pragma once

#include <tope/law/panel_matrix.hpp>

#include <array>

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

/// Writes column j of a panel by halves, as it is read: a processor forwards what it has just written only to reads that
/// one write covers, and a column written number by number would keep the next product waiting. Compilers do not see to it.
inline void set_column(double* panel, Eigen::Index j, double first, double second, double third,
                       double fourth) {
  using Half [[gnu::vector_size(16), gnu::aligned(8), gnu::may_alias]] = double;
  auto* halves = reinterpret_cast<Half*>(panel + height * j);
  halves[0] = Half{first, second};
  halves[1] = Half{third, fourth};
}
/// The same with at(0) to at(3).
template <typename At>
void set_column(double* panel, Eigen::Index j, At at) {
  set_column(panel, j, at(0), at(1), at(2), at(3));
}

/// Writes `size` numbers, at(0) and so on, and zeros to the end of the last column.
template <typename At>
void set_columns(double* out, Eigen::Index size, At at) {
  for (Eigen::Index p = 0; p < PanelMatrix::panels_of(size); ++p) {
    set_column(out, p, [&](Eigen::Index k) { return height * p + k < size ? at(height * p + k) : 0.0; });
  }
}

/// 1 for row i of a panel, if it has one, and 0 for the others.
inline Eigen::Map<const Column> unit(Eigen::Index i) {
  static constexpr std::array<double, 7> numbers{0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0};
  return Eigen::Map<const Column>(numbers.data() + (height - 1) - i);
}
/// 1 for the rows of a panel above row i of it.
inline Eigen::Map<const Column> above(Eigen::Index i) {
  static constexpr std::array<double, 8> numbers{1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0};
  return Eigen::Map<const Column>(numbers.data() + height - i);
}

}  // namespace tope
