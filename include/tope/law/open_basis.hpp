#pragma once

#include <tope/law/closed_rows.hpp>
#include <tope/law/row_spectrum.hpp>

namespace tope {

/// The directions that higher levels leave open: y may still move by Z w. Levels take directions out one after the
/// other, so that each works on fewer unknowns than the one above it. The image T Z of the directions may come along.
class OpenBasis {
 public:
  /// For n unknowns.
  explicit OpenBasis(int n) : OpenBasis(n, n) {}
  /// With an image of up to `image_rows` >= n rows.
  OpenBasis(int n, int image_rows);

  /// All directions are open: Z is the identity, and its image is not used.
  void reset();
  /// The same directions as another basis that has no image.
  void reset(const OpenBasis& other);
  /// What is left of rows that are taken, Z Z^T = N. It has no image.
  void reset(const ClosedRows& closed);
  /// All directions, with the image T Z, for T (up to image_rows x n).
  void reset(const Matrix& t);

  int size() const { return static_cast<int>(open_.cols()); }                ///< d, columns of Z
  const PanelMatrix& columns() const { return open_; }                       ///< Z (n x d)
  const PanelMatrix& image() const { return with_image_ ? image_ : open_; }  ///< T Z (rows of T x d)
  bool has_image() const { return with_image_; }
  /// A Z (m x d): in `workspace`, or A itself while all directions are open.
  const PanelMatrix& project(const PanelMatrix& a, PanelMatrix& workspace) const;

  /// Takes out all directions of the rows B (m x d), of full rank m <= d.
  void close(const PanelMatrix& b);
  /// Takes each direction of the spectrum out by a share between 0 and 1: Z <- Z (I - sum share_i v_i v_i^T).
  void close(const RowSpectrum& spectrum, const Vector& shares);
  /// No direction is open.
  void close_all();

 private:
  void close_rows();
  void reflect_rows();
  void turn_reflectors();
  void take_out(PanelMatrix& m, bool identity);
  void turn_all(const double* v, double factor);
  const double* row_of(const PanelMatrix& m, Eigen::Index row);

  PanelMatrix open_;
  PanelMatrix image_;
  bool with_image_ = false;
  bool whole_ = true;     // Z is the identity
  PanelMatrix rows_;      // what is to be taken out whole (m x d)
  Matrix reflectors_;     // V (d x m)
  Matrix along_;          // M V (rows of M x m), padded
  PanelMatrix triangle_;  // T (m x m)
  PanelMatrix last_;      // V^T (m x d - m), where columns stay
  PanelMatrix turned_;    // T V^T, the same columns
  Vector shares_;
  Vector row_;  // (n), padded
};

}  // namespace tope
