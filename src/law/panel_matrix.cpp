#include "panel_columns.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

namespace tope {
namespace {

/// Calls an action with a number from 0 to 4 that the compiler then knows.
template <typename Action>
void with_constant(Eigen::Index count, Action action) {
  switch (count) {
    case 0:
      action(std::integral_constant<int, 0>());
      break;
    case 1:
      action(std::integral_constant<int, 1>());
      break;
    case 2:
      action(std::integral_constant<int, 2>());
      break;
    case 3:
      action(std::integral_constant<int, 3>());
      break;
    default:
      action(std::integral_constant<int, 4>());
  }
}

/// Writes `run` numbers from the beginning of each column, which are `stride` apart, to a panel's columns from row `place`
/// on, where it is zero; to columns of which the rest is zero if that is the first.
template <int run>
void copy_rows(const double* from, Eigen::Index stride, Eigen::Index cols, double* panel,
               Eigen::Index place) {
  if (place == 0) {
    for (Eigen::Index j = 0; j < cols; ++j) {
      set_column(panel, j, [&](int i) { return i < run ? from[stride * j + i] : 0.0; });
    }
    return;
  }
  for (Eigen::Index j = 0; j < cols; ++j) {
    Column now = column(panel, j);
    for (int i = 0; i < run; ++i) {
      now += from[stride * j + i] * unit(place + i);
    }
    column(panel, j) = now;
  }
}

void copy_rows(Eigen::Index run, const double* from, Eigen::Index stride, Eigen::Index cols, double* panel,
               Eigen::Index place) {
  with_constant(run, [&](auto known) { copy_rows<known>(from, stride, cols, panel, place); });
}

/// One panel times x. In line, as its result would else go through memory.
[[gnu::always_inline]] inline Column product(const double* panel, Eigen::Index cols, const double* x) {
  Column even = Column::Zero();  // two sums, as each waits for its last term
  Column odd = Column::Zero();
  Eigen::Index j = 0;
  for (; j + 1 < cols; j += 2) {
    even += x[j] * column(panel, j);
    odd += x[j + 1] * column(panel, j + 1);
  }
  if (j < cols) {
    even += x[j] * column(panel, j);
  }
  return even + odd;
}

/// The first `count` columns of one panel times another's transpose.
template <int count>
void multiply_by_transposed(const double* left, const double* right, Eigen::Index cols, double* result) {
  std::array<Column, count> sums;
  sums.fill(Column::Zero());
  for (Eigen::Index j = 0; j < cols; ++j) {
    const Column now = column(left, j);
    for (int i = 0; i < count; ++i) {
      sums[static_cast<std::size_t>(i)] += right[height * j + i] * now;
    }
  }
  for (int i = 0; i < count; ++i) {
    column(result, i) = sums[static_cast<std::size_t>(i)];
  }
}

/// Block q of a panel of A B^T.
void multiply_by_transposed(const double* left, const PanelMatrix& b, Eigen::Index q, double* panel) {
  with_constant(std::min(height, b.rows() - height * q), [&](auto known) {
    multiply_by_transposed<known>(left, b.panel(q), b.cols(), panel + height * height * q);
  });
}

/// out (cols) (+)= one panel's transpose times weights, two columns at once.
template <bool fresh>
void add_transposed(const double* panel, Eigen::Index cols, const Column& weights, double* out) {
  const auto half = [&](Eigen::Index j) -> Eigen::Vector2d {
    const Column products = column(panel, j).cwiseProduct(weights);
    return products.head<2>() + products.tail<2>();
  };
  Eigen::Index j = 0;
  for (; j + 1 < cols; j += 2) {
    const Eigen::Vector2d first = half(j);
    const Eigen::Vector2d second = half(j + 1);
    Eigen::Map<Eigen::Vector2d> sums(out + j);
    const Eigen::Vector2d both = Eigen::Vector2d(first[0], second[0]) + Eigen::Vector2d(first[1], second[1]);
    sums = fresh ? both : (sums + both).eval();
  }
  if (j < cols) {
    out[j] = (fresh ? 0.0 : out[j]) + half(j).sum();
  }
}

/// out (cols) += sign times the panels of M from `first` on, transposed, times w.
void add_transposed_panels(const PanelMatrix& m, Eigen::Index first, double sign, const double* w,
                           double* out) {
  const Eigen::Index panels = m.panels();
  const Eigen::Index cols = m.cols();
  for (Eigen::Index p = first; p < panels; ++p) {
    add_transposed<false>(m.panel(p), cols, sign * column(w, p), out);
  }
}

/// Columns of a result (+)= sign times `depth` columns of A, `stride` apart, times rows of B's panel.
template <int depth, int sign, bool fresh>
void add_block(const double* left, Eigen::Index stride, const double* right, Eigen::Index cols,
               double* result) {
  std::array<Column, depth> factors;
  for (int i = 0; i < depth; ++i) {
    factors[static_cast<std::size_t>(i)] = Eigen::Map<const Column>(left + stride * i);
  }
  for (Eigen::Index j = 0; j < cols; ++j) {
    Column sum = fresh ? Column::Zero().eval() : column(result, j).eval();
    for (int i = 0; i < depth; ++i) {
      sum += sign * right[height * j + i] * factors[static_cast<std::size_t>(i)];
    }
    column(result, j) = sum;
  }
}

template <int sign, bool fresh>
void add_block(Eigen::Index depth, const double* left, Eigen::Index stride, const double* right,
               Eigen::Index cols, double* result) {
  with_constant(depth, [&](auto known) { add_block<known, sign, fresh>(left, stride, right, cols, result); });
}

}  // namespace

void PanelMatrix::assign_transposed(const Matrix& m) {
  resize(m.cols(), m.rows());
  for (Eigen::Index p = 0; p < panels(); ++p) {
    const double* from = m.data() + height * p * m.rows();
    with_constant(std::min(height, rows_ - height * p), [&](auto known) {
      for (Eigen::Index j = 0; j < cols_; ++j) {
        set_column(panel(p), j, [&](int k) { return k < known ? from[m.rows() * k + j] : 0.0; });
      }
    });
  }
}

void PanelMatrix::set_rows(Eigen::Index first, const Eigen::Ref<const Matrix>& m) {
  Eigen::Index run = 0;  // rows within one panel
  for (Eigen::Index i = 0; i < m.rows(); i += run) {
    const Eigen::Index place = (first + i) % height;
    run = std::min(height - place, m.rows() - i);
    copy_rows(run, m.data() + i, m.outerStride(), m.cols(), panel((first + i) / height), place);
  }
}

void PanelMatrix::append_row(const double* row, Eigen::Index stride) {
  copy_rows<1>(row, stride, cols_, panel(rows_ / height), rows_ % height);
  ++rows_;
}

void PanelMatrix::append_rows(const PanelMatrix& other, Eigen::Index from) {
  Eigen::Index run = 0;  // rows within one panel of both
  for (; from < other.rows_; from += run, rows_ += run) {
    const Eigen::Index place = rows_ % height;
    run = std::min({height - place, height - from % height, other.rows_ - from});
    copy_rows(run, other.panel(from / height) + from % height, height, cols_, panel(rows_ / height), place);
  }
}

void PanelMatrix::keep_rows(Eigen::Index count) {
  rows_ = count;
  if (count % height != 0) {
    double* last = panel(count / height);
    for (Eigen::Index j = 0; j < cols_; ++j) {
      column(last, height * j) = column(last, height * j).cwiseProduct(above(count % height));
    }
  }
}

void multiply(const PanelMatrix& m, const double* x, double* out) {
  const Eigen::Index panels = m.panels();
  for (Eigen::Index p = 0; p < panels; ++p) {
    column(out, p) = product(m.panel(p), m.cols(), x);
  }
}

void add_product(const PanelMatrix& m, const double* x, double* out) {
  const Eigen::Index panels = m.panels();
  for (Eigen::Index p = 0; p < panels; ++p) {
    column(out, p) += product(m.panel(p), m.cols(), x);
  }
}

void subtract_product(const double* b, const PanelMatrix& m, const double* x, double* out) {
  const Eigen::Index panels = m.panels();
  for (Eigen::Index p = 0; p < panels; ++p) {
    column(out, p) = column(b, p) - product(m.panel(p), m.cols(), x);
  }
}

void multiply_transposed(const PanelMatrix& m, const double* w, double* out) {
  if (m.panels() == 0) {
    std::fill(out, out + m.cols(), 0.0);
    return;
  }
  add_transposed<true>(m.panel(0), m.cols(), column(w, 0), out);
  add_transposed_panels(m, 1, 1.0, w, out);
}

void subtract_transposed_product(const PanelMatrix& m, const double* w, double* out) {
  add_transposed_panels(m, 0, -1.0, w, out);
}

void multiply(const PanelMatrix& a, const PanelMatrix& b, PanelMatrix& out) {
  out.resize(a.rows(), b.cols());
  for (Eigen::Index p = 0; p < a.panels(); ++p) {
    double* result = out.panel(p);
    add_block<1, true>(std::min(height, a.cols()), a.panel(p), height, b.panel(0), b.cols(), result);
    for (Eigen::Index k = height; k < a.cols(); k += height) {
      add_block<1, false>(std::min(height, a.cols() - k), a.panel(p) + height * k, height,
                          b.panel(k / height), b.cols(), result);
    }
  }
}

void subtract_product(const PanelMatrix& a, const PanelMatrix& b, const PanelMatrix& c, PanelMatrix& out) {
  out.assign(a);
  for (Eigen::Index p = 0; p < a.panels(); ++p) {
    for (Eigen::Index k = 0; k < b.cols(); k += height) {
      add_block<-1, false>(std::min(height, b.cols() - k), b.panel(p) + height * k, height,
                           c.panel(k / height), c.cols(), out.panel(p));
    }
  }
}

void multiply_by_transposed(const PanelMatrix& a, const PanelMatrix& b, PanelMatrix& out) {
  out.resize(a.rows(), b.rows());
  for (Eigen::Index p = 0; p < a.panels(); ++p) {
    for (Eigen::Index q = 0; q < b.panels(); ++q) {
      multiply_by_transposed(a.panel(p), b, q, out.panel(p));
    }
  }
}

void multiply_rows(const PanelMatrix& m, PanelMatrix& out) {
  out.resize(m.rows(), m.rows());
  for (Eigen::Index p = 0; p < m.panels(); ++p) {
    for (Eigen::Index q = 0; q <= p; ++q) {
      multiply_by_transposed(m.panel(p), m, q, out.panel(p));
    }
  }
}

void multiply_columns(const PanelMatrix& m, PanelMatrix& out) {
  out.resize_for_rows(m.cols(), m.cols());
  const Eigen::Index cols = m.cols();
  for (Eigen::Index j = 0; j < cols; ++j) {
    for (Eigen::Index i = j; i < cols; ++i) {
      Column sum = Column::Zero();
      for (Eigen::Index p = 0; p < m.panels(); ++p) {
        const double* panel = m.panel(p);
        sum += column(panel, i).cwiseProduct(column(panel, j));
      }
      out(i, j) = sum.sum();
    }
  }
}

void scale(PanelMatrix& m, double factor) {
  for (Eigen::Index p = 0; p < m.panels(); ++p) {
    double* panel = m.panel(p);
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      column(panel, j) *= factor;
    }
  }
}

void scale(PanelMatrix& m, const double* factors) {
  for (Eigen::Index p = 0; p < m.panels(); ++p) {
    double* panel = m.panel(p);
    const Column factor = column(factors, p);
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      column(panel, j) = column(panel, j).cwiseProduct(factor);
    }
  }
}

void subtract(const PanelMatrix& a, double scale, const PanelMatrix& b, PanelMatrix& out) {
  out.resize(a.rows(), a.cols());
  for (Eigen::Index p = 0; p < a.panels(); ++p) {
    const double* left = a.panel(p);
    const double* right = b.panel(p);
    double* result = out.panel(p);
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      column(result, j) = column(left, j) - scale * column(right, j);
    }
  }
}

void subtract_outer(PanelMatrix& m, const double* w, const double* v) {
  const Eigen::Index panels = m.panels();
  const Eigen::Index cols = m.cols();
  for (Eigen::Index p = 0; p < panels; ++p) {
    double* panel = m.panel(p);
    const Column weights = column(w, p);
    for (Eigen::Index j = 0; j < cols; ++j) {
      column(panel, j) -= v[j] * weights;
    }
  }
}

void subtract_product(PanelMatrix& m, const Matrix& w, const PanelMatrix& b) {
  for (Eigen::Index p = 0; p < m.panels(); ++p) {
    for (Eigen::Index k = 0; k < b.rows(); k += height) {
      add_block<-1, false>(std::min(height, b.rows() - k), w.col(k).data() + height * p, w.rows(),
                           b.panel(k / height), m.cols(), m.panel(p));
    }
  }
}

void turn(PanelMatrix& m, Eigen::Index first, const double* v, double scale) {
  const Eigen::Index count = m.cols() - first;
  const Eigen::Index panels = m.panels();
  for (Eigen::Index p = 0; p < panels; ++p) {
    double* panel = m.panel(p) + height * first;
    const Column along = scale * product(panel, count, v);
    for (Eigen::Index j = 0; j < count; ++j) {
      column(panel, j) -= v[j] * along;
    }
  }
}

}  // namespace tope
