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
  const Eigen::Index panels = m.panels();
  const Eigen::Index cols = m.cols();
  if (panels == 0) {
    std::fill(out, out + cols, 0.0);
    return;
  }
  for (Eigen::Index p = 0; p < panels; ++p) {
    const double* panel = m.panel(p);
    const Column weights = column(w, p);
    for (Eigen::Index j = 0; j < cols; ++j) {
      const double sum = column(panel, j).dot(weights);
      out[j] = p == 0 ? sum : out[j] + sum;
    }
  }
}

void multiply(const PanelMatrix& a, const PanelMatrix& b, PanelMatrix& out) {
  out.resize(a.rows(), b.cols());
  const Eigen::Index inner = a.cols();
  const Eigen::Index cols = b.cols();
  for (Eigen::Index p = 0; p < a.panels(); ++p) {
    const double* left = a.panel(p);
    double* result = out.panel(p);
    for (Eigen::Index k = 0; k < inner; k += height) {
      const double* right = b.panel(k / height);
      const Eigen::Index depth = std::min(height, inner - k);
      for (Eigen::Index j = 0; j < cols; ++j) {
        Column sum = k == 0 ? Column::Zero().eval() : column(result, j).eval();
        for (Eigen::Index i = 0; i < depth; ++i) {
          sum += right[height * j + i] * column(left, k + i);
        }
        column(result, j) = sum;
      }
    }
  }
}

void multiply_rows(const PanelMatrix& m, PanelMatrix& out) {
  out.resize(m.rows(), m.rows());
  const Eigen::Index cols = m.cols();
  for (Eigen::Index p = 0; p < m.panels(); ++p) {
    double* result = out.panel(p);
    const double* left = m.panel(p);
    for (Eigen::Index q = 0; q <= p; ++q) {
      const double* right = m.panel(q);
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
      const std::array<Column, height> sums{first, second, third, fourth};
      const Eigen::Index count = std::min(height, m.rows() - height * q);
      for (Eigen::Index j = 0; j < count; ++j) {
        column(result, height * q + j) = sums[static_cast<std::size_t>(j)];
      }
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
