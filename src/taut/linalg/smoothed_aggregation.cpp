#include "taut/linalg/smoothed_aggregation.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>

#include "taut/linalg/amg_level.h"
#include "taut/linalg/triangular_layout.h"

namespace taut {

class AmgHierarchy {
 public:
  virtual ~AmgHierarchy() = default;
  virtual Status build(const BlockCsr& a, const NearNullSpace& space) = 0;
  virtual void apply(std::span<const double> r, std::span<double> z) const = 0;
  virtual Offset bytes() const = 0;
  virtual std::vector<Index> level_nodes() const = 0;
  virtual double operator_complexity() const = 0;
};

namespace {

template <int n, int c>
class Hierarchy : public AmgHierarchy {
 public:
  explicit Hierarchy(const AmgOptions& options) : options_(options) {}

  Status build(const BlockCsr& a, const NearNullSpace& space) override {
    read(a, space);
    if (const Index bad = finest_.prepare(); bad >= 0) return bad_diagonal_block(a, node_[bad]);
    coarse_.emplace_back();
    finest_.coarsen(options_.strength, coarse_.back());
    while (true) {
      AmgLevel<c, c>& level = coarse_.back();
      if (level.prepare() >= 0) return not_definite();
      if (level.nodes() <= options_.coarsest_nodes ||
          static_cast<int>(coarse_.size()) + 1 >= options_.most_levels)
        break;
      AmgLevel<c, c> next;
      level.coarsen(options_.strength, next);
      if (next.nodes() == level.nodes()) break;
      coarse_.push_back(std::move(next));
    }
    return factorize_coarsest();
  }

  void apply(std::span<const double> r, std::span<double> z) const override {
    std::fill(padded_b_.begin(), padded_b_.end(), 0.0);
    for (std::size_t p = 0; p < node_.size(); ++p)
      std::copy_n(&r[dof_[p]], dim_[p], &padded_b_[p * n]);
    cycle(finest_, padded_b_, padded_x_, 0);
    for (std::size_t p = 0; p < node_.size(); ++p)
      std::copy_n(&padded_x_[p * n], dim_[p], &z[dof_[p]]);
  }

  Offset bytes() const override {
    Offset total =
        finest_.bytes() + static_cast<Offset>(coarsest_.rows() * coarsest_.cols() * sizeof(double));
    for (const auto& level : coarse_) total += level.bytes();
    return total;
  }
  std::vector<Index> level_nodes() const override {
    std::vector<Index> nodes{finest_.nodes()};
    for (const auto& level : coarse_) nodes.push_back(level.nodes());
    return nodes;
  }
  double operator_complexity() const override {
    double entries = static_cast<double>(finest_.a.values.size()) * n * n;
    const double finest = entries;
    for (const auto& level : coarse_) entries += static_cast<double>(level.a.values.size()) * c * c;
    return finest > 0.0 ? entries / finest : 1.0;
  }

 private:
  static Status not_definite() {
    return {Outcome::not_positive_definite,
            "multigrid: a coarse matrix is not positive definite, so the matrix is not"};
  }

  // The finest level: nodes with unknowns only, padded.
  void read(const BlockCsr& a, const NearNullSpace& space) {
    const BlockPattern& p = *a.pattern;
    std::vector<Index> place(static_cast<std::size_t>(p.rows()), -1);
    for (Index i = 0; i < p.rows(); ++i)
      if (p.dim(i) > 0) {
        place[i] = static_cast<Index>(node_.size());
        node_.push_back(i), dof_.push_back(p.dof_start[i]), dim_.push_back(p.dim(i));
      }
    finest_.a.columns = static_cast<Index>(node_.size());
    using Modes = typename AmgLevel<n, c>::Modes;
    for (const Index i : node_) {
      for (Index k = p.row_start[i]; k < p.row_start[i + 1]; ++k) {
        if (place[p.column[k]] < 0) continue;
        finest_.a.column.push_back(place[p.column[k]]);
        load_padded(a, i, k, n, finest_.a.values.emplace_back().data());
      }
      finest_.a.start.push_back(static_cast<Index>(finest_.a.column.size()));
      Modes& modes = finest_.modes.emplace_back(Modes::Zero());
      for (Index r = 0; r < p.dim(i); ++r)
        for (Index m = 0; m < c; ++m)
          modes(r, m) = space.modes > 0
                            ? space.values[static_cast<std::size_t>(p.dof_start[i] + r) * c + m]
                            : static_cast<double>(r == m);
    }
    padded_b_.resize(finest_.size()), padded_x_.resize(finest_.size());
  }

  Status factorize_coarsest() {
    const AmgLevel<c, c>& last = coarse_.back();
    Eigen::MatrixXd dense =
        Eigen::MatrixXd::Zero(static_cast<Index>(last.size()), static_cast<Index>(last.size()));
    for (Index i = 0; i < last.nodes(); ++i)
      for (Index k = last.a.start[i]; k < last.a.start[i + 1]; ++k)
        dense.template block<c, c>(c * i, c * last.a.column[k]) = last.a.values[k];
    coarsest_.compute(dense);
    if (coarsest_.info() != Eigen::Success || !dense.allFinite()) return not_definite();
    for (const auto& level : coarse_)
      level_b_.emplace_back(level.size()), level_x_.emplace_back(level.size());
    return {};
  }

  // x = one V-cycle for b from zero; the next level is coarse_[below].
  template <class Level>
  void cycle(const Level& level, std::span<const double> b, std::span<double> x,
             std::size_t below) const {
    std::fill(x.begin(), x.end(), 0.0);
    level.smooth(options_, b, x, true);
    multiply(level.a, x.data(), level.residual.data());
    residual_from_product(b, level.residual);
    multiply(level.restrictor, level.residual.data(), level_b_[below].data());
    if (below + 1 < coarse_.size()) {
      cycle(coarse_[below], level_b_[below], level_x_[below], below + 1);
    } else {
      Eigen::Map<Eigen::VectorXd>(level_x_[below].data(),
                                  static_cast<Index>(level_x_[below].size())) =
          coarsest_.solve(Eigen::Map<const Eigen::VectorXd>(
              level_b_[below].data(), static_cast<Index>(level_b_[below].size())));
    }
    multiply(level.prolongator, level_x_[below].data(), x.data(), true);
    level.smooth(options_, b, x, false);
  }

  AmgOptions options_;
  std::vector<Index> node_, dof_, dim_;
  AmgLevel<n, c> finest_;
  std::vector<AmgLevel<c, c>> coarse_;
  Eigen::LLT<Eigen::MatrixXd> coarsest_;
  mutable std::vector<double> padded_b_, padded_x_;
  mutable std::vector<std::vector<double>> level_b_, level_x_;
};

Index largest_dim(const BlockPattern& p) {
  Index largest = 0;
  for (Index i = 0; i < p.rows(); ++i) largest = std::max(largest, p.dim(i));
  return largest;
}

}  // namespace

SmoothedAggregation::SmoothedAggregation(AmgOptions options) : options_(options) {}
SmoothedAggregation::~SmoothedAggregation() = default;

Status SmoothedAggregation::update(const BlockCsr& a) {
  assert(space_.modes == 0 || static_cast<Index>(space_.values.size()) == a.dofs() * space_.modes);
  const bool scalar = largest_dim(*a.pattern) <= 1 && space_.modes <= 1;
  if (scalar) {
    hierarchy_ = std::make_unique<Hierarchy<1, 1>>(options_);
  } else if (space_.modes == 6) {
    hierarchy_ = std::make_unique<Hierarchy<3, 6>>(options_);
  } else {
    assert(space_.modes == 0 || space_.modes == 3);
    hierarchy_ = std::make_unique<Hierarchy<3, 3>>(options_);
  }
  return hierarchy_->build(a, space_);
}

void SmoothedAggregation::apply(std::span<const double> r, std::span<double> z) const {
  hierarchy_->apply(r, z);
}
Offset SmoothedAggregation::bytes() const { return hierarchy_ ? hierarchy_->bytes() : 0; }
std::vector<Index> SmoothedAggregation::level_nodes() const {
  return hierarchy_ ? hierarchy_->level_nodes() : std::vector<Index>();
}
double SmoothedAggregation::operator_complexity() const {
  return hierarchy_ ? hierarchy_->operator_complexity() : 1.0;
}

}  // namespace taut
