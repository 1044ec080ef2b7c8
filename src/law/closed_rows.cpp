#include <tope/law/closed_rows.hpp>

#include <cmath>

namespace tope {

ClosedRows::ClosedRows(int n, int max_rows) : rows_(n, n), shares_(Vector::Zero(n)), along_(max_rows, n) {
  reset();
}

void ClosedRows::reset() {
  rows_.resize(0, rows_.cols());
  whole_ = 0;
}

void ClosedRows::reset(const ClosedRows& other) {
  rows_.assign(other.rows_);
  shares_ = other.shares_;
  whole_ = other.whole_;
}

void ClosedRows::project(const PanelMatrix& a, PanelMatrix& out) {
  multiply_by_transposed(a, rows_, along_);
  subtract_product(a, along_, rows_, out);
}

void ClosedRows::close(const PanelMatrix& rows) {
  shares_.segment(size(), rows.rows()).setOnes();
  rows_.append_rows(rows);
  whole_ += static_cast<int>(rows.rows());
}

void ClosedRows::close(const RowSpectrum& spectrum, const Vector& shares) {
  for (int i = 0; i < spectrum.size(); ++i) {
    if (shares[i] > nothing) {
      shares_[size()] = shares[i];
      rows_.append_row(spectrum.directions(), i, 1.0 / std::sqrt(spectrum.squared(i)));
      whole_ += shares[i] >= 1.0 ? 1 : 0;
    }
  }
}

void ClosedRows::close(const double* direction) {
  shares_[size()] = 1.0;
  rows_.append_row(direction);
  ++whole_;
}

void ClosedRows::keep(int count) {
  rows_.resize(count, rows_.cols());
  whole_ = static_cast<int>((shares_.head(count).array() >= 1.0).count());
}

void ClosedRows::close_all() {
  whole_ = static_cast<int>(rows_.cols());
  rows_.resize(rows_.cols(), rows_.cols());
}

}  // namespace tope
