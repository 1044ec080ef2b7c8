#include "panel_columns.hpp"

#include <tope/law/cholesky.hpp>

#include <algorithm>
#include <array>

namespace tope {
namespace {

/// 1 for the rows of a panel that are below row i of it.
Column below(Eigen::Index i) {
  constexpr std::array<double, 7> steps{0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0};
  return Eigen::Map<const Column>(steps.data() + (height - 1) - i);
}

/// Eliminates column j of a diagonal block and goes on to the next. Recursion rather than a loop, so that the block
/// stays in registers.
template <int j>
bool eliminate(Eigen::Matrix4d& block, int rows, double shift, double least, double* factor,
               std::array<double, height>& inverse_pivots) {
  if constexpr (j < height) {
    double inverse = 0.0;
    if (j < rows) {
      const double pivot = block(j, j) + shift;
      if (!(pivot > least)) {
        return false;
      }
      inverse = 1.0 / pivot;
    }
    std::get<j>(inverse_pivots) = inverse;
    const Column scaled = inverse * block.col(j);
    for (int k = j + 1; k < height; ++k) {
      block.col(k) -= scaled[k] * block.col(j);
    }
    column(factor, j) = scaled.cwiseProduct(below(j));
    return eliminate<j + 1>(block, rows, shift, least, factor, inverse_pivots);
  }
  return true;
}

}  // namespace

Cholesky::Cholesky(Eigen::Index max_size)
    : lower_(max_size, PanelMatrix::padded(max_size)),
      inverse_pivots_(Vector::Zero(PanelMatrix::padded(max_size))) {}

bool Cholesky::factorise(const PanelMatrix& m, double shift, double least) {
  const Eigen::Index size = m.rows();
  lower_.resize(size, PanelMatrix::padded(size));
  for (Eigen::Index p = 0; p < m.panels(); ++p) {
    const double* from = m.panel(p);
    double* to = lower_.panel(p);
    for (Eigen::Index j = 0; j < height * (p + 1); ++j) {
      column(to, j) =
          j < size ? column(from, j).eval() : Column::Zero().eval();  // so that all blocks are whole
    }
  }
  for (Eigen::Index block = 0; block < lower_.panels(); ++block) {
    double* diagonal = lower_.panel(block) + height * height * block;
    Eigen::Matrix4d now = Eigen::Map<const Eigen::Matrix4d>(diagonal);
    const auto rows = static_cast<int>(std::min(height, size - height * block));
    std::array<double, height> inverse_pivots{};
    if (!eliminate<0>(now, rows, shift, least, diagonal, inverse_pivots)) {
      return false;
    }
    set_column(inverse_pivots_.data(), block, [&](std::size_t j) { return inverse_pivots[j]; });
    for (Eigen::Index p = block + 1; p < lower_.panels(); ++p) {
      finish_panel(p, block);
    }
  }
  return true;
}

/// Up to three rows by their leading minors, which wait for no division.
bool Cholesky::positive_definite(const PanelMatrix& m, double shift) {
  if (m.rows() == 0 || m.rows() > 3) {
    return factorise(m, shift);
  }
  const double a = m(0, 0) + shift;
  if (m.rows() == 1) {
    return a > 0.0;
  }
  const double b = m(1, 0);
  const double c = m(1, 1) + shift;
  const double second = a * c - b * b;
  if (m.rows() == 2) {
    return a > 0.0 && second > 0.0;
  }
  const double d = m(2, 0);
  const double e = m(2, 1);
  const double third = (m(2, 2) + shift) * second - e * (a * e - b * d) - d * (c * d - b * e);
  return a > 0.0 && second > 0.0 && third > 0.0;
}

/// The four columns of `block` in a panel below it, and what they take off the panel's further columns.
void Cholesky::finish_panel(Eigen::Index p, Eigen::Index block) {
  const Eigen::Index first = height * block;
  double* panel = lower_.panel(p);
  const double* diagonal = lower_.panel(block) + height * first;
  std::array<Column, height> columns;
  for (Eigen::Index j = 0; j < height; ++j) {
    Column now = column(panel, first + j);
    for (Eigen::Index k = 0; k < j; ++k) {
      now -= diagonal[height * k + j] * columns[static_cast<std::size_t>(k)];
    }
    columns[static_cast<std::size_t>(j)] = now;
    column(panel, first + j) = inverse_pivots_[first + j] * now;
  }
  for (Eigen::Index q = block + 1; q <= p; ++q) {
    const double* shares = lower_.panel(q) + height * first;
    for (Eigen::Index i = 0; i < height; ++i) {
      Column now = column(panel, height * q + i);
      for (Eigen::Index j = 0; j < height; ++j) {
        now -= shares[height * j + i] * columns[static_cast<std::size_t>(j)];
      }
      column(panel, height * q + i) = now;
    }
  }
}

/// x <- L^-1 x, where panels of x are `stride` numbers apart and those before `first` are zero.
void Cholesky::forward(double* x, Eigen::Index stride, Eigen::Index first) const {
  const Eigen::Index panels = lower_.panels();
  for (Eigen::Index p = first; p < panels; ++p) {
    const double* diagonal = lower_.panel(p) + height * height * p;
    Eigen::Map<Column> here(x + stride * p);
    Column now = here;
    now -= now[0] * column(diagonal, 0);
    now -= now[1] * column(diagonal, 1);
    now -= now[2] * column(diagonal, 2);
    here = now;
    for (Eigen::Index q = p + 1; q < panels; ++q) {
      const double* panel = lower_.panel(q) + height * height * p;
      Eigen::Map<Column>(x + stride * q) -= now[0] * column(panel, 0) + now[1] * column(panel, 1) +
                                            now[2] * column(panel, 2) + now[3] * column(panel, 3);
    }
  }
}

void Cholesky::solve(double* x) const {
  const Eigen::Index panels = lower_.panels();
  forward(x, height, 0);
  for (Eigen::Index p = 0; p < panels; ++p) {
    column(x, p) = column(x, p).cwiseProduct(column(inverse_pivots_.data(), p));
  }
  for (Eigen::Index p = panels - 1; p >= 0; --p) {
    Column now = column(x, p);
    for (Eigen::Index q = p + 1; q < panels; ++q) {
      const double* panel = lower_.panel(q) + height * height * p;
      const Column known = column(x, q);
      now -= Column(column(panel, 0).dot(known), column(panel, 1).dot(known), column(panel, 2).dot(known),
                    column(panel, 3).dot(known));
    }
    const double* diagonal = lower_.panel(p) + height * height * p;
    const auto l = [diagonal](Eigen::Index i, Eigen::Index j) { return diagonal[height * j + i]; };
    const double third = now[2] - l(3, 2) * now[3];  // number by number, as each waits for the one before
    const double second = (now[1] - l(3, 1) * now[3]) - l(2, 1) * third;
    const double first = ((now[0] - l(3, 0) * now[3]) - l(2, 0) * third) - l(1, 0) * second;
    set_column(x, p, first, second, third, now[3]);
  }
}

void Cholesky::whiten(double* x) const {
  forward(x, height, 0);
  for (Eigen::Index p = 0; p < lower_.panels(); ++p) {
    column(x, p) = column(x, p).cwiseProduct(column(inverse_pivots_.data(), p).cwiseSqrt());
  }
}

void Cholesky::whiten(PanelMatrix& x) const {
  if (lower_.panels() == 1) {
    whiten_panel(x.panel(0), x.cols());
    return;
  }
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    forward(x.panel(0) + height * j, x.stride(), 0);
  }
  scale_rows(x);
}

/// The same for up to four rows, with all of L in registers.
void Cholesky::whiten_panel(double* panel, Eigen::Index cols) const {
  const double* lower = lower_.panel(0);
  const Column first = column(lower, 0);
  const Column second = column(lower, 1);
  const Column third = column(lower, 2);
  const Column scale = column(inverse_pivots_.data(), 0).cwiseSqrt();
  for (Eigen::Index j = 0; j < cols; ++j) {
    Column now = column(panel, j);
    now -= now[0] * first;
    now -= now[1] * second;
    now -= now[2] * third;
    column(panel, j) = now.cwiseProduct(scale);
  }
}

void Cholesky::invert_factor(PanelMatrix& out) const {
  out.set_identity(lower_.rows());
  for (Eigen::Index j = 0; j < out.cols(); ++j) {
    forward(out.panel(0) + height * j, out.stride(), j / height);
  }
  scale_rows(out);
}

/// X <- D^-1/2 X.
void Cholesky::scale_rows(PanelMatrix& x) const {
  for (Eigen::Index p = 0; p < x.panels(); ++p) {
    const Column scale = column(inverse_pivots_.data(), p).cwiseSqrt();
    double* panel = x.panel(p);
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
      column(panel, j) = column(panel, j).cwiseProduct(scale);
    }
  }
}

}  // namespace tope
