#pragma once

#include <tope/common/types.hpp>

namespace tope {

/// A matrix in panels of four rows, each panel column by column (the layout of BLASFEO: Frison, Kouzoupis, Sartor,
/// Zanelli, Diehl 2018). The products that a law needs then run over whole panels: for a robot's few joints there is
/// nothing to pack and no remainder, for a hundred a panel stays in the first cache. Rows beyond the last are zero.
class PanelMatrix {
 public:
  using Column = Eigen::Vector4d;  ///< of one panel
  static constexpr Eigen::Index height = 4;

  /// Reserves memory for max_rows x max_cols, and has that size at first. All zero.
  PanelMatrix(Eigen::Index max_rows, Eigen::Index max_cols)
      : stride_(height * max_cols),
        values_(Vector::Zero(panels_of(max_rows) * stride_)),
        rows_(max_rows),
        cols_(max_cols) {}
  explicit PanelMatrix(const Eigen::Ref<const Matrix>& m) : PanelMatrix(m.rows(), m.cols()) {
    set_rows(0, m);
  }

  static constexpr Eigen::Index panels_of(Eigen::Index rows) { return (rows + height - 1) / height; }
  /// Size of a vector that whole panels can be multiplied with.
  static constexpr Eigen::Index padded(Eigen::Index rows) { return height * panels_of(rows); }

  Eigen::Index rows() const { return rows_; }
  Eigen::Index cols() const { return cols_; }
  Eigen::Index panels() const { return panels_of(rows_); }

  /// Takes another size within what is reserved; the elements are then undefined.
  void resize(Eigen::Index rows, Eigen::Index cols) {
    rows_ = rows;
    cols_ = cols;
    first_ = 0;
  }
  /// Takes another size, with zeros in the last panel if that is not full, for what fills the rows one by one.
  void resize_for_rows(Eigen::Index rows, Eigen::Index cols) {
    resize(rows, cols);
    if (rows % height != 0) {
      Eigen::Map<Vector>(panel(panels() - 1), height * cols).setZero();
    }
  }
  /// Becomes a copy of a matrix that fits into what is reserved.
  void assign(const PanelMatrix& other) {
    resize(other.rows_, other.cols_);
    for (Eigen::Index p = 0; p < panels(); ++p) {
      const double* from = other.panel(p);
      double* to = panel(p);
      for (Eigen::Index j = 0; j < height * other.cols(); j += height) {
        column(to, j) = column(from, j);
      }
    }
  }
  /// Becomes the transpose of m, which fits into what is reserved.
  void assign_transposed(const Matrix& m);
  /// Keeps the columns from `count` on.
  void drop_front(Eigen::Index count) {
    first_ += count;
    cols_ -= count;
  }
  void set_identity(Eigen::Index size) {
    resize(size, size);
    values_.setZero();
    for (Eigen::Index i = 0; i < size; ++i) {
      (*this)(i, i) = 1.0;
    }
  }
  /// Copies m (up to cols wide) into the rows from `first` on: the first of a panel, or one from which on its panel is zero.
  void set_rows(Eigen::Index first, const Eigen::Ref<const Matrix>& m);
  /// Adds a row (cols) at the end.
  void append_row(const double* row) { append_row(row, 1); }
  /// Adds a row of another matrix (any x cols) at the end.
  void append_row(const PanelMatrix& other, Eigen::Index row) {
    append_row(other.panel(row / height) + row % height, height);
  }
  /// Adds the rows of another matrix (any x cols) from `from` on at the end.
  void append_rows(const PanelMatrix& other, Eigen::Index from = 0);
  /// Keeps the first `count` rows.
  void keep_rows(Eigen::Index count);

  double& operator()(Eigen::Index i, Eigen::Index j) { return values_[index(i, j)]; }
  double operator()(Eigen::Index i, Eigen::Index j) const { return values_[index(i, j)]; }
  /// The first of a panel's columns, the others follow. Loops take this once: the compiler cannot know that what they
  /// write is no member of this class.
  double* panel(Eigen::Index p) { return values_.data() + p * stride_ + height * first_; }
  const double* panel(Eigen::Index p) const { return values_.data() + p * stride_ + height * first_; }
  Eigen::Index stride() const { return stride_; }  ///< numbers from panel to panel
  /// Copies into an ordinary matrix of the same size.
  void copy_to(Eigen::Ref<Matrix> m) const {
    for (Eigen::Index j = 0; j < cols_; ++j) {
      for (Eigen::Index i = 0; i < rows_; ++i) {
        m(i, j) = (*this)(i, j);
      }
    }
  }

 private:
  /// Adds a row of which the numbers are `stride` apart.
  void append_row(const double* row, Eigen::Index stride);

  static Eigen::Map<Column> column(double* panel, Eigen::Index offset) {
    return Eigen::Map<Column>(panel + offset);
  }
  static Eigen::Map<const Column> column(const double* panel, Eigen::Index offset) {
    return Eigen::Map<const Column>(panel + offset);
  }
  Eigen::Index index(Eigen::Index i, Eigen::Index j) const {
    return (i / height) * stride_ + height * (first_ + j) + i % height;
  }

  Eigen::Index stride_;
  Vector values_;
  Eigen::Index rows_;
  Eigen::Index cols_;
  Eigen::Index first_ = 0;  // columns dropped
};

// In what follows vectors with one number a row of M have padded(rows) of them, those beyond the last zero.

/// out (rows) = M x (cols).
void multiply(const PanelMatrix& m, const double* x, double* out);
/// out (rows) += M x (cols).
void add_product(const PanelMatrix& m, const double* x, double* out);
/// out = b (rows) - M x (cols).
void subtract_product(const double* b, const PanelMatrix& m, const double* x, double* out);
/// out (cols) = M^T w (rows).
void multiply_transposed(const PanelMatrix& m, const double* w, double* out);
/// out (cols) -= M^T w (rows).
void subtract_transposed_product(const PanelMatrix& m, const double* w, double* out);
/// out = A B.
void multiply(const PanelMatrix& a, const PanelMatrix& b, PanelMatrix& out);
/// out = A B^T.
void multiply_by_transposed(const PanelMatrix& a, const PanelMatrix& b, PanelMatrix& out);
/// out = A - B C.
void subtract_product(const PanelMatrix& a, const PanelMatrix& b, const PanelMatrix& c, PanelMatrix& out);
/// The lower triangle of M M^T.
void multiply_rows(const PanelMatrix& m, PanelMatrix& out);
/// The lower triangle of M^T M.
void multiply_columns(const PanelMatrix& m, PanelMatrix& out);
/// M <- factor M.
void scale(PanelMatrix& m, double factor);
/// M <- diag(factors) M, with a factor a row.
void scale(PanelMatrix& m, const double* factors);
/// out = A - scale B.
void subtract(const PanelMatrix& a, double scale, const PanelMatrix& b, PanelMatrix& out);
/// M -= w (rows) v^T (cols).
void subtract_outer(PanelMatrix& m, const double* w, const double* v);
/// M -= the first columns of W (padded rows) times B, as many as B has rows.
void subtract_product(PanelMatrix& m, const Matrix& w, const PanelMatrix& b);
/// M <- M (I - scale v v^T), where v has the coordinates from column `first` on and zeros before.
void turn(PanelMatrix& m, Eigen::Index first, const double* v, double scale);

}  // namespace tope
