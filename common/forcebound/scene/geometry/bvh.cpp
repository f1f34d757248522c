#include "forcebound/scene/geometry/bvh.hpp"

#include <cmath>
#include <span>

namespace forcebound::scene {
namespace {

constexpr std::size_t kBins = 16;
// Deeper than this, nodes are halved by number, which takes at most 32 more levels: kDepthMost allows for both.
constexpr int kDepthOfHeuristic = 44;
// Boxes are larger by this share of the mesh's size than their triangles, more than contact allows for rounding.
constexpr double kMargin = 0x1p-34;

double half_area(const Bounds& box) {
  const Point size = box.sizes();
  return size.x() * size.y() + size.y() * size.z() + size.z() * size.x();
}

struct Bin {
  Bounds box;
  std::size_t count = 0;

  void add(const Bin& other) {
    box.extend(other.box);
    count += other.count;
  }
  [[nodiscard]] double cost() const { return count == 0 ? 0 : half_area(box) * static_cast<double>(count); }
};

}  // namespace

class Bvh::Builder {
 public:
  explicit Builder(Bvh& tree) : tree_(tree) {
    const TriangleMesh& mesh = tree.mesh();
    items_.resize(mesh.triangles().size());
    for (std::uint32_t i = 0; i < items_.size(); ++i) {
      for (std::size_t corner = 0; corner < 3; ++corner) items_[i].box.extend(mesh.corner_m(i, corner));
      items_[i].center = items_[i].box.center();
      items_[i].triangle = i;
    }
    margin_ = Point::Constant(kMargin * mesh.size_m());
    tree_.nodes_.reserve(items_.size());
    tree_.nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(items_.size()), 0);
    tree_.nodes_.shrink_to_fit();
    tree_.order_.reserve(items_.size());
    for (const Item& item : items_) tree_.order_.push_back(item.triangle);
  }

 private:
  /// Contiguous in the order of the tree, so that each level passes through the memory once.
  struct Item {
    Bounds box;
    Point center;
    std::uint32_t triangle;
  };

  [[nodiscard]] std::span<Item> items(std::uint32_t begin, std::uint32_t end) {
    return std::span(items_).subspan(begin, end - begin);
  }

  void build(std::uint32_t node, std::uint32_t begin, std::uint32_t end, int depth) {
    Bounds box;
    Bounds centers;
    for (const Item& item : items(begin, end)) {
      box.extend(item.box);
      centers.extend(item.center);
    }
    tree_.nodes_[node].low = box.min() - margin_;
    tree_.nodes_[node].high = box.max() + margin_;
    if (end - begin <= kLeafMost) {
      tree_.nodes_[node].first = begin;
      tree_.nodes_[node].count = end - begin;
      return;
    }
    std::uint32_t middle = depth < kDepthOfHeuristic ? split(begin, end, centers) : begin;
    if (middle == begin || middle == end) middle = halve(begin, end, centers);
    const auto child = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_[node].first = child;
    tree_.nodes_.resize(tree_.nodes_.size() + 2);
    build(child, begin, middle, depth + 1);
    build(child + 1, middle, end, depth + 1);
  }

  /// The split, by axis and bin, with the least sum of area times number of triangles on both sides.
  std::uint32_t split(std::uint32_t begin, std::uint32_t end, const Bounds& centers) {
    // More bins than triangles cost time and gain nothing.
    const std::size_t bin_count = std::min<std::size_t>(kBins, end - begin);
    const Point per_m = static_cast<double>(bin_count) * centers.sizes().cwiseInverse();
    const auto bin_of = [&](const Item& item, Eigen::Index axis) {
      const double bin = (item.center[axis] - centers.min()[axis]) * per_m[axis];
      return std::min(static_cast<std::size_t>(bin), bin_count - 1);
    };
    std::array<Eigen::Index, 3> axes;
    const auto axes_end = std::copy_if(kAxes.begin(), kAxes.end(), axes.begin(),
                                       [&](Eigen::Index axis) { return std::isfinite(per_m[axis]); });
    const std::span wide(axes.begin(), axes_end);
    std::array<std::array<Bin, kBins>, 3> bins;
    for (const Item& item : items(begin, end)) {
      for (const Eigen::Index axis : wide) bins[static_cast<std::size_t>(axis)][bin_of(item, axis)].add({item.box, 1});
    }
    double best_cost = std::numeric_limits<double>::infinity();
    std::size_t best_bin = 0;
    Eigen::Index best_axis = 0;
    for (const Eigen::Index axis : wide) {
      const auto& along = bins[static_cast<std::size_t>(axis)];
      std::array<double, kBins> cost{};
      Bin left;
      for (std::size_t i = 0; i + 1 < bin_count; ++i) {
        left.add(along[i]);
        cost[i] = left.cost();
      }
      Bin right;
      for (std::size_t i = bin_count - 1; i > 0; --i) {
        right.add(along[i]);
        if (cost[i - 1] + right.cost() >= best_cost) continue;
        best_cost = cost[i - 1] + right.cost();
        best_bin = i;
        best_axis = axis;
      }
    }
    if (!(best_cost < std::numeric_limits<double>::infinity())) return begin;
    const auto first = items_.begin();
    const auto right = std::partition(first + begin, first + end,
                                      [&](const Item& item) { return bin_of(item, best_axis) < best_bin; });
    return static_cast<std::uint32_t>(right - first);
  }

  std::uint32_t halve(std::uint32_t begin, std::uint32_t end, const Bounds& centers) {
    Eigen::Index axis = 0;
    centers.sizes().maxCoeff(&axis);
    const std::uint32_t middle = begin + (end - begin) / 2;
    const auto first = items_.begin();
    std::nth_element(first + begin, first + middle, first + end,
                     [&](const Item& a, const Item& b) { return a.center[axis] < b.center[axis]; });
    return middle;
  }

  static constexpr std::array<Eigen::Index, 3> kAxes{0, 1, 2};

  Bvh& tree_;
  std::vector<Item> items_;
  Point margin_;
};

Bvh::Bvh(std::shared_ptr<const TriangleMesh> mesh) : mesh_(std::move(mesh)) { Builder{*this}; }

std::optional<std::size_t> Bvh::gather(const Bounds& box_m, std::span<std::uint32_t> places) const noexcept {
  std::size_t count = 0;
  bool fits = true;
  descend([&](const Node& node) { return apart(node, box_m); },
          [&] { return fits ? 0 : -std::numeric_limits<double>::infinity(); },
          [&](const Node& leaf) {
            fits = fits && count + leaf.count <= places.size();
            for (std::uint32_t i = 0; fits && i < leaf.count; ++i) places[count++] = leaf.first + i;
          });
  return fits ? std::optional(count) : std::nullopt;
}

std::optional<NearestPoint> Bvh::nearest(const Point& point_m, double reach_m) const noexcept {
  double least = reach_m * reach_m;
  std::optional<NearestPoint> found;
  descend([&](const Node& node) { return squared_distance(node, point_m); }, [&] { return least; },
          [&](const Node& leaf) {
            for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
              const NearestOnTriangle on = nearest_on(order_[i], point_m);
              const double squared = (on.point_m - point_m).squaredNorm();
              if (!(squared <= least) || (found && squared == least)) continue;
              least = squared;
              found = NearestPoint{order_[i], on.point_m, std::sqrt(squared), on.part};
            }
          });
  return found;
}

}  // namespace forcebound::scene
