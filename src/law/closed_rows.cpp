#include <tope/law/closed_rows.hpp>

namespace tope {

ClosedRows::ClosedRows(int n, int max_rows)
    : rows_(n, n), shares_(Vector::Zero(PanelMatrix::padded(n))), along_(max_rows, n) {
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
  int first = 0;
  while (first < spectrum.size() && !(shares[first] > nothing)) {
    ++first;
  }
  for (int i = first; i < spectrum.size(); ++i) {
    shares_[size() + i - first] = shares[i];
    whole_ += shares[i] >= 1.0 ? 1 : 0;
  }
  rows_.append_rows(spectrum.directions(), first);
}

void ClosedRows::close(const double* direction) {
  shares_[size()] = 1.0;
  rows_.append_row(direction);
  ++whole_;
}

void ClosedRows::keep(int count) {
  rows_.keep_rows(count);
  whole_ = static_cast<int>((shares_.head(count).array() >= 1.0).count());
}

void ClosedRows::close_all() {
  whole_ = static_cast<int>(rows_.cols());
  rows_.resize(rows_.cols(), rows_.cols());
}

}  // namespace tope
