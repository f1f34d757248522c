#include "tests/tools/reference/worst_case.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcebound::test {
namespace {

constexpr long double kEverywhere = std::numeric_limits<long double>::infinity();

}  // namespace

void WorstCase::begin(long double low, long double high) {
  // max over x in [low, high] of p x
  pieces_ = {{-kEverywhere, 0, low, 0}, {0, 0, high, 0}};
}

std::size_t WorstCase::place(long double p) const {
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), p,
                                      [](long double value, const Piece& piece) { return value < piece.from; });
  return static_cast<std::size_t>(after - pieces_.begin()) - 1;
}

/// Makes a piece begin at p. Gives its place.
std::size_t WorstCase::cut(long double p) {
  const std::size_t at = place(p);
  if (pieces_[at].from == p) return at;
  Piece piece = pieces_[at];
  piece.from = p;
  pieces_.insert(pieces_.begin() + static_cast<std::ptrdiff_t>(at) + 1, piece);
  return at + 1;
}

void WorstCase::add(std::size_t from, std::size_t to, const Piece& piece) {
  for (std::size_t i = from; i < to; ++i) {
    pieces_[i].a += piece.a;
    pieces_[i].b += piece.b;
    pieces_[i].c += piece.c;
  }
}

void WorstCase::hold(long double force, long double spread, long double duration_s) {
  if (!(duration_s > 0)) return;
  // On either side t (|p + f| - d)^2/(4b), d = c - spread, and between them nothing.
  const long double dead = friction_ - spread;
  const long double weight = duration_s / (4 * damping_);
  const std::size_t left = cut(-force - std::max(dead, 0.0L));
  const std::size_t right = dead > 0 ? cut(-force + dead) : left;
  const long double below = force + dead;
  const long double above = force - dead;
  add(0, left, {0, weight, 2 * weight * below, weight * below * below});
  add(right, pieces_.size(), {0, weight, 2 * weight * above, weight * above * above});
}

void WorstCase::move_origin(long double by) { add(0, pieces_.size(), {0, 0, -by, 0}); }

/// Where V*'(p) goes through x; infinite where it never does.
long double WorstCase::where_slope_is(long double x) const {
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    const long double to = i + 1 < pieces_.size() ? pieces_[i + 1].from : kEverywhere;
    if (i > 0 && piece.slope(piece.from) >= x) return piece.from;
    if (piece.a > 0) {
      const long double p = (x - piece.b) / (2 * piece.a);
      if (p <= to) return p;
    } else if (i == 0 && piece.b >= x) {
      return -kEverywhere;
    }
  }
  return kEverywhere;
}

bool WorstCase::read(long double low, long double high) {
  const long double least = where_slope_is(low);
  const long double most = std::max(least, low == high ? least : where_slope_is(high));
  if (least == kEverywhere || most == -kEverywhere) return false;
  std::vector<Piece> cut_pieces;
  if (least > -kEverywhere) {
    cut_pieces.push_back({-kEverywhere, 0, low, value(least) - low * least});
  }
  if (least < most || low < high) {
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const long double to = i + 1 < pieces_.size() ? pieces_[i + 1].from : kEverywhere;
      if (to <= least || pieces_[i].from >= most) continue;
      Piece piece = pieces_[i];
      piece.from = std::max(piece.from, least);
      cut_pieces.push_back(piece);
    }
  }
  if (most < kEverywhere) cut_pieces.push_back({most, 0, high, value(most) - high * most});
  if (low == high) cut_pieces = {{-kEverywhere, 0, low, value(least) - low * least}};
  pieces_ = std::move(cut_pieces);
  return true;
}

long double WorstCase::reserve_J(long double force, long double spread, long double duration_s) const {
  const long double surplus = std::max(std::fabs(force) + spread - friction_, 0.0L);
  return surplus * surplus * duration_s / (4 * damping_);
}

std::vector<KnownTorque> torques_between(const std::vector<KnownCommand>& commands, const KnownRelease& release,
                                         long double begin_s, long double end_s) {
  struct Possible {
    long double force, from_s, to_s;
  };
  std::vector<Possible> all;
  for (std::size_t k = 0; k < commands.size(); ++k) {
    const auto next = std::find_if(commands.begin() + static_cast<std::ptrdiff_t>(k) + 1, commands.end(),
                                   [](const KnownCommand& command) { return command.certain; });
    const long double next_s = next != commands.end() ? static_cast<long double>(next->begin_s.most) : kEverywhere;
    const long double force = commands[k].force;
    const long double least_s = k == 0 ? -kEverywhere : static_cast<long double>(commands[k].begin_s.least);
    const long double most_s = commands[k].begin_s.most;
    all.push_back({force, least_s, std::min(next_s, most_s + release.full_s.most)});
    all.push_back({release.share * force, commands[k].begin_s.least + static_cast<long double>(release.full_s.least),
                   std::min(next_s, most_s + release.part_s.most)});
    all.push_back({0, commands[k].begin_s.least + static_cast<long double>(release.part_s.least), next_s});
  }
  std::vector<long double> times{begin_s, end_s};
  for (const Possible& one : all) {
    for (const long double at : {one.from_s, one.to_s}) {
      if (at > begin_s && at < end_s) times.push_back(at);
    }
  }
  std::sort(times.begin(), times.end());
  std::vector<KnownTorque> result;
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    const long double middle_s = (times[i] + times[i + 1]) / 2;
    long double low = kEverywhere;
    long double high = -kEverywhere;
    for (const Possible& one : all) {
      if (middle_s < one.from_s || middle_s > one.to_s) continue;
      low = std::min(low, one.force);
      high = std::max(high, one.force);
    }
    if (low <= high) result.push_back({(low + high) / 2, (high - low) / 2, times[i + 1] - times[i]});
  }
  return result;
}

}  // namespace forcebound::test
