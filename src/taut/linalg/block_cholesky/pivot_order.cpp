#include "taut/linalg/block_cholesky/pivot_order.h"

#include <algorithm>
#include <limits>
#include <span>

namespace taut {

namespace {

// The supernodes below each node that have a row for it, ascending.
struct Descendants {
  std::vector<Offset> start;  // per place
  std::vector<Index> supernode;

  explicit Descendants(const SupernodeTree& tree)
      : start(tree.order.size() + 1), supernode(tree.row.size()) {
    for (const Index k : tree.row) ++start[k + 1];
    for (std::size_t k = 0; k < tree.order.size(); ++k) start[k + 1] += start[k];
    std::vector<Offset> next(start.begin(), start.end() - 1);
    for (Index s = 0; s < tree.supernodes(); ++s)
      for (const Index k : tree.rows(s)) supernode[static_cast<std::size_t>(next[k]++)] = s;
  }

  std::span<const Index> of(Index k) const {
    return {supernode.data() + start[k], supernode.data() + start[k + 1]};
  }
};

class TourBuilder {
 public:
  explicit TourBuilder(const SupernodeTree& tree) : tree_(tree), descendants_(tree) {}

  // The places begin ... end-1 in the order of their tour.
  const std::vector<Index>& tour(Index begin, Index end) {
    tour_.clear();
    step_.assign(1, 0);
    waiting_.clear();
    for (Index v = begin; v < end; ++v) waiting_.push_back({v, to_nothing(v)});
    while (!waiting_.empty()) {
      const auto farthest = std::ranges::max_element(waiting_, {}, &Waiting::distance);
      const Index v = farthest->place;
      waiting_.erase(farthest);
      insert(v);
      for (Waiting& w : waiting_) w.distance = std::min(w.distance, distance(v, w.place));
    }
    return tour_;
  }

 private:
  struct Waiting {
    Index place;
    Offset distance;  // to the nearest of the tour
  };

  void insert(Index v) {
    from_v_.resize(tour_.size());
    for (std::size_t i = 0; i < tour_.size(); ++i) from_v_[i] = distance(v, tour_[i]);
    const Offset nothing = to_nothing(v);
    Offset shortest = std::numeric_limits<Offset>::max();
    std::size_t at = 0;
    for (std::size_t i = 0; i <= tour_.size(); ++i) {
      const Offset longer = (i == 0 ? nothing : from_v_[i - 1]) +
                            (i == tour_.size() ? nothing : from_v_[i]) - step_[i];
      if (longer < shortest) shortest = longer, at = i;
    }
    const auto place = static_cast<std::ptrdiff_t>(at);
    step_[at] = at == 0 ? nothing : from_v_[at - 1];
    step_.insert(step_.begin() + place + 1, at == tour_.size() ? nothing : from_v_[at]);
    tour_.insert(tour_.begin() + place, v);
  }

  Offset weight(Index s) const { return tree_.row_start[s + 1] - tree_.row_start[s]; }

  Offset to_nothing(Index v) const {
    Offset sum = 0;
    for (const Index s : descendants_.of(v)) sum += weight(s);
    return sum;
  }

  Offset distance(Index u, Index v) const {
    const std::span<const Index> a = descendants_.of(u), b = descendants_.of(v);
    Offset sum = 0;
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
      if (a[i] == b[j]) {
        ++i, ++j;
      } else {
        sum += a[i] < b[j] ? weight(a[i++]) : weight(b[j++]);
      }
    }
    for (; i < a.size(); ++i) sum += weight(a[i]);
    for (; j < b.size(); ++j) sum += weight(b[j]);
    return sum;
  }

  const SupernodeTree& tree_;
  const Descendants descendants_;
  std::vector<Waiting> waiting_;
  std::vector<Index> tour_;
  std::vector<Offset> step_;    // lengths: from nothing to the first, ..., from the last to nothing
  std::vector<Offset> from_v_;  // from the node to be inserted to those of the tour
};

}  // namespace

std::vector<Index> pivot_places(const SupernodeTree& tree) {
  std::vector<Index> place(tree.order.size());
  TourBuilder builder(tree);
  for (Index s = 0; s < tree.supernodes(); ++s) {
    Index next = tree.first[s];
    for (const Index k : builder.tour(tree.first[s], tree.first[s + 1])) place[k] = next++;
  }
  return place;
}

}  // namespace taut
