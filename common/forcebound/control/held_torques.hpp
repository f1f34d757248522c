#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "forcebound/control/device_facts.hpp"
#include "forcebound/control/vector.hpp"

namespace forcebound::control {

/// The stages in which the device layer releases a torque, counted from when it took effect [s].
struct ReleaseStages {
  Bracket full_s{kNever, kNever};  ///< all of the torque until then
  double share = 0;                ///< from then on this share of it,
  Bracket part_s{kNever, kNever};  ///< until then

  static constexpr double kNever = std::numeric_limits<double>::infinity();
};

/// The torques in effect and on their way to the motors, as far as is known of when and how large.
///
/// Time is counted from the stamp of the latest reading. A torque is in effect until the next one is, or the device
/// releases it, in two stages. Each of these times is known within a bracket, so that at a given time several torques
/// are possible: what is asked for is the *band* that holds them all, and what the motors make of them,
///
///     mid - spread <= torque <= mid + spread          for each joint
///
/// With a lag, the motors' torque follows with a first-order lag of a time constant between 0 and that, and the band
/// holds what is left of torques before. Several are on their way at once where the latency is longer than a tick; one
/// for which there is no room and the newest become one band.
///
/// Real time: noexcept, no allocation. A value.
class HeldTorques {
 public:
  static constexpr int kWaitingMax = 16;

  /// @param lag_s time constant of the motors at the most
  explicit HeldTorques(Eigen::Index joints, double lag_s = 0) noexcept
      : zero_(Vector::Zero(joints)), lag_s_(lag_s), lagging_{zero_, zero_} {
    held_[0].mid = held_[0].spread = zero_;
  }

  /// When a torque takes effect that is told to do so within `begin_s`: never before an earlier one.
  [[nodiscard]] Bracket in_order(const Bracket& begin_s) const noexcept {
    return {std::max(begin_s.least, newest().begin_s.least), std::max(begin_s.most, horizon_s())};
  }

  /// A torque that takes effect within `begin_s`, but never before an earlier one. If it is not `certain`, it may not
  /// take effect at all, and what was in effect before goes on until the device releases it.
  void command(const Vector& torque, const Bracket& begin_s, const ReleaseStages& release,
               bool certain = true) noexcept {
    Held next{.mid = torque, .spread = zero_, .begin_s = in_order(begin_s), .release = release, .plain = true};
    if (!certain) {
      next.merge(newest());
      next.merge({.mid = zero_, .spread = zero_});
    }
    if (last_ < kWaitingMax) {
      at(++last_) = next;
      return;
    }
    const Held before = newest();
    newest().merge(next);
    newest().begin_s = {before.begin_s.least, next.begin_s.most};
    // From the earlier beginning to the earlier release, and from the later one to the later.
    const double later_s = next.begin_s.least - before.begin_s.least;
    const auto joined = [later_s](const Bracket& a, const Bracket& b) {
      return Bracket{std::min(a.least, later_s + b.least), std::max(a.most, b.most)};
    };
    newest().release = {joined(before.release.full_s, next.release.full_s),
                        std::max(before.release.share, next.release.share),
                        joined(before.release.part_s, next.release.part_s)};
  }

  /// When the newest one is in effect at the latest [s].
  [[nodiscard]] double horizon_s() const noexcept { return last_ > 0 ? std::max(newest().begin_s.most, 0.0) : 0.0; }

  /// Calls `visit(mid, spread, duration_s)` for each piece of the time from `begin_s` to `end_s` in which the band is
  /// the same, in the order of time.
  template <typename Visit>
  void each_piece(double begin_s, double end_s, Visit&& visit) const noexcept {
    if (lag_s_ > 0) {
      Band lagging = lagging_;
      each_command(begin_s, end_s, [&](const Vector& mid, const Vector& spread, double piece_s) {
        follow(lagging, {mid - spread, mid + spread}, piece_s, visit);
      });
    } else {
      each_command(begin_s, end_s, visit);
    }
  }

  /// The largest size in each joint of what the lag has left of earlier torques, at the time from which on pieces are
  /// asked for. None without a lag.
  [[nodiscard]] Vector left_by_lag() const noexcept {
    return lagging_.low.cwiseAbs().cwiseMax(lagging_.high.cwiseAbs());
  }

  /// A time passed that is known within a bracket; nothing before `begin_s` after it will be asked for any more.
  void pass(const Bracket& duration_s, double begin_s) noexcept {
    if (lag_s_ > 0) {
      const double least_s = begin_s + duration_s.least;
      each_command(begin_s, least_s, [&](const Vector& mid, const Vector& spread, double piece_s) {
        follow(lagging_, {mid - spread, mid + spread}, piece_s, [](const Vector&, const Vector&, double) {});
      });
      // If more time passed, the motors are on their way to what was in effect then.
      each_command(least_s, begin_s + duration_s.most, [&](const Vector& mid, const Vector& spread, double /*s*/) {
        lagging_.low = lagging_.low.cwiseMin(mid - spread).eval();
        lagging_.high = lagging_.high.cwiseMax(mid + spread).eval();
      });
    }
    for (int i = 0; i <= last_; ++i) {
      at(i).begin_s.least -= duration_s.most;
      at(i).begin_s.most -= duration_s.least;
    }
    int gone = 0;
    while (gone < last_ && at(gone + 1).begin_s.most <= begin_s) ++gone;
    if (gone == 0) return;
    std::move(held_.begin() + gone, held_.begin() + last_ + 1, held_.begin());
    last_ -= gone;
  }

  /// Calls `visit(mid, spread)` for each one in effect or on its way.
  template <typename Visit>
  void each(Visit&& visit) const noexcept {
    for (int i = 0; i <= last_; ++i) visit(at(i).mid, at(i).spread);
  }

 private:
  struct Held {
    Vector mid;
    Vector spread;
    Bracket begin_s{};
    ReleaseStages release{};
    bool plain = false;  ///< no spread

    /// Widens the band so that it holds another one's too.
    void merge(const Held& other) noexcept {
      const Vector low = (mid - spread).cwiseMin(other.mid - other.spread);
      const Vector high = (mid + spread).cwiseMax(other.mid + other.spread);
      mid = 0.5 * (low + high);
      spread = 0.5 * (high - low);
      plain = false;
    }
  };
  /// Where the motors' torque may be.
  struct Band {
    Vector low;
    Vector high;
  };

  Held& at(int i) noexcept { return held_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Held& at(int i) const noexcept { return held_[static_cast<std::size_t>(i)]; }
  Held& newest() noexcept { return at(last_); }
  [[nodiscard]] const Held& newest() const noexcept { return at(last_); }

  /// The share of a torque that may be in effect at a time, and until when that is so.
  struct Shares {
    double least = 0;
    double most = 0;
    double until_s = 0;
  };

  /// Of one torque at `now_s`, where it may be the one in effect.
  [[nodiscard]] static Shares shares_at(const Held& held, double now_s) noexcept {
    Shares shares{2, -1, ReleaseStages::kNever};
    const auto stage = [&](double share, double from_s, double to_s) {
      if (!(from_s < to_s) || now_s >= to_s) return;
      if (now_s < from_s) {
        shares.until_s = std::min(shares.until_s, from_s);
        return;
      }
      shares.least = std::min(shares.least, share);
      shares.most = std::max(shares.most, share);
      shares.until_s = std::min(shares.until_s, to_s);
    };
    const ReleaseStages& release = held.release;
    stage(1, -ReleaseStages::kNever, held.begin_s.most + release.full_s.most);
    stage(release.share, held.begin_s.least + release.full_s.least, held.begin_s.most + release.part_s.most);
    stage(0, held.begin_s.least + release.part_s.least, ReleaseStages::kNever);
    return shares;
  }

  template <typename Visit>
  void each_command(double begin_s, double end_s, Visit&& visit) const noexcept {
    double now_s = begin_s;
    int first = 0;  // those before are over
    while (now_s < end_s) {
      while (first < last_ && at(first + 1).begin_s.most <= now_s) ++first;
      Shares shares = shares_at(at(first), now_s);
      double next_s = std::min(end_s, shares.until_s);
      if (first == last_ || at(first + 1).begin_s.least > now_s) {
        if (first < last_) next_s = std::min(next_s, at(first + 1).begin_s.least);
        visit_one(at(first), shares, next_s - now_s, visit);
      } else {
        Held hull = scaled(at(first), shares);
        next_s = std::min(next_s, at(first + 1).begin_s.most);
        for (int i = first + 1; i <= last_; ++i) {
          if (at(i).begin_s.least > now_s) {
            next_s = std::min(next_s, at(i).begin_s.least);
            break;
          }
          shares = shares_at(at(i), now_s);
          next_s = std::min(next_s, shares.until_s);
          hull.merge(scaled(at(i), shares));
        }
        visit(hull.mid, hull.spread, next_s - now_s);
      }
      now_s = next_s;
    }
  }

  template <typename Visit>
  void visit_one(const Held& held, const Shares& shares, double duration_s, Visit&& visit) const noexcept {
    if (held.plain && shares.least == 1) {
      visit(held.mid, zero_, duration_s);
    } else if (shares.most <= 0) {
      visit(zero_, zero_, duration_s);
    } else {
      const Held some = scaled(held, shares);
      visit(some.mid, some.spread, duration_s);
    }
  }

  [[nodiscard]] static Held scaled(const Held& held, const Shares& shares) noexcept {
    Held most{.mid = shares.most * held.mid, .spread = shares.most * held.spread};
    if (shares.least < shares.most) most.merge({.mid = shares.least * held.mid, .spread = shares.least * held.spread});
    return most;
  }

  /// Lets the motors follow a command within `target` for a while. Whatever the time constant, the torque lies between
  /// the target and what it was, so that the band of a piece is that at its beginning; pieces are short at first.
  template <typename Visit>
  void follow(Band& lagging, const Band& target, double duration_s, Visit&& visit) const noexcept {
    constexpr double kNothingLeft = 1e-9;
    double piece_s = 0.5 * lag_s_;
    while (duration_s > 0) {
      const double excess = std::max((lagging.high - target.high).maxCoeff(), (target.low - lagging.low).maxCoeff());
      const double size = std::max(target.high.cwiseAbs().maxCoeff(), target.low.cwiseAbs().maxCoeff());
      if (excess <= kNothingLeft * size) piece_s = duration_s;
      const double now_s = std::min(piece_s, duration_s);
      const Band hull{lagging.low.cwiseMin(target.low), lagging.high.cwiseMax(target.high)};
      visit(Vector(0.5 * (hull.low + hull.high)), Vector(0.5 * (hull.high - hull.low)), now_s);
      const double left = std::exp(-now_s / lag_s_);
      lagging.high = target.high + left * (hull.high - target.high);
      lagging.low = target.low + left * (hull.low - target.low);
      duration_s -= now_s;
      piece_s *= 2;
    }
  }

  std::array<Held, kWaitingMax + 1> held_;  // the first may be in effect
  int last_ = 0;
  Vector zero_;
  double lag_s_;
  Band lagging_;
};

}  // namespace forcebound::control
