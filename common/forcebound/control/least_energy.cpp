#include "forcebound/control/least_energy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcebound::control {
namespace {

// So many knots a merge leaves: fewer than need be, so that most ticks have nothing to merge.
constexpr int kKnotsMerged = 26;

double soft_threshold(double s, double c) noexcept { return std::copysign(std::max(std::abs(s) - c, 0.0), s); }

}  // namespace

/// How one knot can be left out without lifting V: what that costs [J], and what becomes of the knot farther out.
struct LeastEnergy::Merge {
  double cost_J = std::numeric_limits<double>::infinity();
  int outer = 0;  ///< so many knots on, 1 or -1, one moves to `outer_p`; 0: none does
  double outer_p = 0;
};

void LeastEnergy::Graph::insert(int i, const Knot& knot) noexcept {
  std::move_backward(knots.begin() + i, knots.begin() + count, knots.begin() + count + 1);
  (*this)[i] = knot;
  ++count;
}

void LeastEnergy::Graph::erase(int i) noexcept {
  std::move(knots.begin() + i + 1, knots.begin() + count, knots.begin() + i);
  --count;
}

LeastEnergy::Knot LeastEnergy::crossing(const Knot& a, const Knot& b, double x) noexcept {
  return {x, a.p + (x - a.x) / (b.x - a.x) * (b.p - a.p)};
}

double LeastEnergy::work_above_zero(const Knot& a, const Knot& b) noexcept {
  if (b.p <= 0) return 0;
  const double width = b.x - a.x;
  if (a.p >= 0) return 0.5 * (a.p + b.p) * width;
  return 0.5 * b.p * width * (b.p / (b.p - a.p));
}

void LeastEnergy::restart(const Tube& tube) noexcept {
  left_slope_ = right_slope_ = 0;
  graph_.count = 0;
  graph_.push({tube.low, 0});
  if (tube.low < tube.high) graph_.push({tube.high, 0});
}

double LeastEnergy::reserve_J(double force, double spread, double duration_s) const noexcept {
  const double excess = std::max(std::abs(force) + spread - friction_, 0.0);
  return excess * excess * duration_s / (4 * damping_);
}

double LeastEnergy::hold(double force, double spread, double duration_s) noexcept {
  const double reach = duration_s / (2 * damping_);
  if (graph_.count == 0 || !(reach > 0)) return 0;
  if (graph_.count > kKnotsMax + 4) merge_knots();
  const double friction = friction_ - spread;
  if (friction < 0) split(-force, -friction * reach);
  if (friction > 0) {
    insert(-force - friction);
    insert(-force + friction);
  }
  // Less than no friction moves all of the graph on either side of -f; at -f itself it was split.
  const double threshold = std::max(friction, 0.0);
  for (int i = 0; i < graph_.count; ++i) graph_[i].x += soft_threshold(graph_[i].p + force, threshold) * reach;
  left_slope_ += reach;
  right_slope_ += reach;
  return -reserve_J(force, spread, duration_s);
}

/// Makes a knot of the point at p, unless there is one. Gives its place.
int LeastEnergy::insert(double p) noexcept {
  int i = 0;
  while (i < graph_.count && graph_[i].p < p) ++i;
  if (i < graph_.count && graph_[i].p == p) return i;
  double x = 0;
  if (i == 0) {
    x = graph_[0].x - (graph_[0].p - p) * left_slope_;
  } else if (i == graph_.count) {
    x = graph_[i - 1].x + (p - graph_[i - 1].p) * right_slope_;
  } else {
    const Knot& a = graph_[i - 1];
    const Knot& b = graph_[i];
    x = a.x + (p - a.p) / (b.p - a.p) * (b.x - a.x);
  }
  graph_.insert(i, {x, p});
  return i;
}

/// Moves what lies below p to the left and what lies above it to the right, with a level piece between.
void LeastEnergy::split(double p, double reach) noexcept {
  const int first = insert(p);
  int last = first;
  while (last + 1 < graph_.count && graph_[last + 1].p == p) ++last;
  if (last == first) graph_.insert(++last, Knot(graph_[first]));
  for (int i = 0; i < last; ++i) graph_[i].x -= reach;
  for (int i = last; i < graph_.count; ++i) graph_[i].x += reach;
}

/// The graph with so much of its sloped ends that it reaches both ends of the tube, and p = 0.
LeastEnergy::Graph LeastEnergy::extended(const Tube& tube) const noexcept {
  Graph line = graph_;
  const Knot first = graph_[0];
  if (left_slope_ > 0 && (tube.low < first.x || first.p > 0)) {
    const double missing = std::max(first.x - tube.low, 0.0);
    const double p = std::min(0.0, first.p - missing / left_slope_);
    const double x = first.x - (first.p - p) * left_slope_;
    line.insert(0, {missing > 0 ? std::min(x, tube.low) : x, p});
  }
  const Knot last = graph_[graph_.count - 1];
  if (right_slope_ > 0 && (tube.high > last.x || last.p < 0)) {
    const double missing = std::max(tube.high - last.x, 0.0);
    const double p = std::max(0.0, last.p + missing / right_slope_);
    const double x = last.x + (p - last.p) * right_slope_;
    line.push({missing > 0 ? std::max(x, tube.high) : x, p});
  }
  return line;
}

std::optional<double> LeastEnergy::read(const Tube& tube) noexcept {
  if (graph_.count == 0) return std::nullopt;
  const Graph line = extended(tube);
  int first = 0;
  while (first < line.count && line[first].x < tube.low) ++first;
  int last = line.count - 1;
  while (last >= 0 && line[last].x > tube.high) --last;
  if (first == line.count || last < 0) return std::nullopt;
  const bool cut_left = first > 0;
  const bool cut_right = last < line.count - 1;
  const Knot low = cut_left ? crossing(line[first - 1], line[first], tube.low) : line[0];
  const Knot high = cut_right ? crossing(line[last], line[last + 1], tube.high) : line[last];

  // Where the minimum was outside, the way from there to the tube is what the reading tells of.
  double gain_J = 0;
  for (int i = 1; i < first; ++i) gain_J += work_above_zero(line[i - 1], line[i]);
  if (cut_left) gain_J += work_above_zero(line[first - 1], low);
  for (int i = line.count - 1; i > last + 1; --i) gain_J += work_above_zero(mirrored(line[i]), mirrored(line[i - 1]));
  if (cut_right) gain_J += work_above_zero(mirrored(line[last + 1]), mirrored(high));
  if (!std::isfinite(gain_J) || !std::isfinite(low.p) || !std::isfinite(high.p)) return std::nullopt;

  if (tube.low < tube.high) {
    graph_.count = 0;
    if (cut_left && (first > last || line[first].x > tube.low)) graph_.push(low);
    for (int i = first; i <= last; ++i) graph_.push(line[i]);
    if (cut_right && (first > last || line[last].x < tube.high)) graph_.push(high);
    left_slope_ = right_slope_ = 0;
    if (graph_.count > kKnotsMax) merge_knots();
  } else {
    restart(tube);
  }
  return gain_J;
}

/// Away from p = 0 an estimate from below has x farther out at the same p. A knot that lies within its neighbours'
/// chord is left out, as the chord is farther out. For one beyond the chord, the line from its inner neighbour through
/// it is drawn on to the x of the outer neighbour, which moves there, to a smaller |p|.
LeastEnergy::Merge LeastEnergy::merge_of(int knot) const noexcept {
  const int out = graph_[knot].p >= 0 ? 1 : -1;
  const auto outwards = [&](int steps) { return out > 0 ? graph_[knot + steps] : mirrored(graph_[knot - steps]); };
  const int beyond = out > 0 ? graph_.count - 1 - knot : knot;
  const int within = graph_.count - 1 - beyond;
  Merge result;
  if (beyond < 1 || within < 1 || outwards(-1).p < 0) return result;
  const Knot a = outwards(-1);
  const Knot k = outwards(0);
  const Knot b = outwards(1);
  const double area = 0.5 * ((k.p - a.p) * (b.x - a.x) - (k.x - a.x) * (b.p - a.p));
  if (area >= 0) {
    result.cost_J = area;
    return result;
  }
  const double slope = out > 0 ? right_slope_ : left_slope_;
  if (beyond == 1 && slope > 0) return result;
  const double p = std::clamp(k.p + (b.x - k.x) * ((k.p - a.p) / (k.x - a.x)), k.p, b.p);
  result.cost_J = 0.5 * (b.p - p) * ((beyond == 1 ? b : outwards(2)).x - k.x);
  result.outer = out;
  result.outer_p = out * p;
  return result;
}

void LeastEnergy::merge_knots() noexcept {
  merged_ = true;
  std::array<Merge, Graph::kRoom> choices;
  const auto choice = [&](int i) -> Merge& { return choices[static_cast<std::size_t>(i)]; };
  for (int i = 0; i < graph_.count; ++i) choice(i) = merge_of(i);
  while (graph_.count > kKnotsMerged) {
    const auto cheapest = std::min_element(choices.begin(), choices.begin() + graph_.count,
                                           [](const Merge& a, const Merge& b) { return a.cost_J < b.cost_J; });
    const int knot = static_cast<int>(cheapest - choices.begin());
    if (cheapest->outer != 0) graph_[knot + cheapest->outer].p = cheapest->outer_p;
    graph_.erase(knot);
    std::move(choices.begin() + knot + 1, choices.begin() + graph_.count + 1, choices.begin() + knot);
    // The outer knot's move reaches two knots on either side.
    for (int i = std::max(0, knot - 3); i < std::min(graph_.count, knot + 3); ++i) choice(i) = merge_of(i);
  }
}

}  // namespace forcebound::control
