#include "panel_columns.hpp"

#include <algorithm>
#include <array>

namespace tope {
namespace {

/// One panel times x.
Column product(const double* panel, Eigen::Index cols, const double* x) {
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

/// One panel times the first columns of another's transpose.
std::array<Column, height> product_by_transposed(const double* left, const double* right, Eigen::Index cols) {
  Column first = Column::Zero();
  Column second = Column::Zero();
  Column third = Column::Zero();
  Column fourth = Column::Zero();
  for (Eigen::Index j = 0; j < cols; ++j) {
    const Column now = column(left, j);
    first += right[height * j] * now;
    second += right[height * j + 1] * now;
    third += right[height * j + 2] * now;
    fourth += right[height * j + 3] * now;
  }
  return {first, second, third, fourth};
}

/// out (cols) += sign times the panels of M from `first` on, transposed, times w.
void add_transposed_panels(const PanelMatrix& m, Eigen::Index first, double sign, const double* w,
                           double* out) {
  const Eigen::Index panels = m.panels();
  const Eigen::Index cols = m.cols();
  for (Eigen::Index p = first; p < panels; ++p) {
    const double* panel = m.panel(p);
    const Column weights = sign * column(w, p);
    for (Eigen::Index j = 0; j < cols; ++j) {
      out[j] += column(panel, j).dot(weights);
    }
  }
}

/// Writes block q of a panel that has `cols` columns.
void store(const std::array<Column, height>& block, Eigen::Index q, double* panel, Eigen::Index cols) {
  const Eigen::Index count = std::min(height, cols - height * q);
  for (Eigen::Index j = 0; j < count; ++j) {
    column(panel, height * q + j) = block[static_cast<std::size_t>(j)];
  }
}

/// Columns of a panel += `sign` times a panel of A times B.
template <int sign>
void add_product(const PanelMatrix& a, Eigen::Index panel, const PanelMatrix& b, double* result) {
  const double* left = a.panel(panel);
  for (Eigen::Index k = 0; k < a.cols(); k += height) {
    const double* right = b.panel(k / height);
    const Eigen::Index depth = std::min(height, a.cols() - k);
    for (Eigen::Index j = 0; j < b.cols(); ++j) {
      Column sum = column(result, j);
      for (Eigen::Index i = 0; i < depth; ++i) {
        sum += sign * right[height * j + i] * column(left, k + i);
      }
      column(result, j) = sum;
    }
  }
}

}  // namespace

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

void subtract_product(const PanelMatrix& m, const double* x, double* out) {
  const Eigen::Index panels = m.panels();
  for (Eigen::Index p = 0; p < panels; ++p) {
    column(out, p) -= product(m.panel(p), m.cols(), x);
  }
}

void multiply_transposed(const PanelMatrix& m, const double* w, double* out) {
  if (m.panels() == 0) {
    std::fill(out, out + m.cols(), 0.0);
    return;
  }
  const double* panel = m.panel(0);
  const Column weights = column(w, 0);
  for (Eigen::Index j = 0; j < m.cols(); ++j) {
    out[j] = column(panel, j).dot(weights);
  }
  add_transposed_panels(m, 1, 1.0, w, out);
}

void subtract_transposed_product(const PanelMatrix& m, const double* w, double* out) {
  add_transposed_panels(m, 0, -1.0, w, out);
}

void multiply(const PanelMatrix& a, const PanelMatrix& b, PanelMatrix& out) {
  out.resize(a.rows(), b.cols());
  for (Eigen::Index p = 0; p < a.panels(); ++p) {
    Eigen::Map<Vector>(out.panel(p), height * b.cols()).setZero();
    add_product<1>(a, p, b, out.panel(p));
  }
}

void subtract_product(const PanelMatrix& a, const PanelMatrix& b, const PanelMatrix& c, PanelMatrix& out) {
  out.assign(a);
  for (Eigen::Index p = 0; p < a.panels(); ++p) {
    add_product<-1>(b, p, c, out.panel(p));
  }
}

void multiply_by_transposed(const PanelMatrix& a, const PanelMatrix& b, PanelMatrix& out) {
  out.resize(a.rows(), b.rows());
  for (Eigen::Index p = 0; p < a.panels(); ++p) {
    for (Eigen::Index q = 0; q < b.panels(); ++q) {
      store(product_by_transposed(a.panel(p), b.panel(q), a.cols()), q, out.panel(p), b.rows());
    }
  }
}

void multiply_rows(const PanelMatrix& m, PanelMatrix& out) {
  out.resize(m.rows(), m.rows());
  for (Eigen::Index p = 0; p < m.panels(); ++p) {
    for (Eigen::Index q = 0; q <= p; ++q) {
      store(product_by_transposed(m.panel(p), m.panel(q), m.cols()), q, out.panel(p), m.rows());
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

void subtract_from_column(PanelMatrix& m, Eigen::Index j, const Matrix& w, const double* shares,
                          Eigen::Index count) {
  for (Eigen::Index p = 0; p < m.panels(); ++p) {
    Column sum = column(m.panel(p), j);
    for (Eigen::Index i = 0; i < count; ++i) {
      sum -= shares[i] * column(w.col(i).data(), p);
    }
    column(m.panel(p), j) = sum;
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
