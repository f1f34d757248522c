#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "forcebound/handover/hash.hpp"

namespace forcebound::client {

/// Scenes that servers handed over, in a folder of files that are called by their hash: a second visit costs nothing.
///
/// Trusts no file: who loads one holds it to its hash. What cannot be written or read is told by `problem`, and the
/// session goes on without. Does I/O: never in a tick.
class SceneCache {
 public:
  /// @param folder made when the first scene is stored; empty: nothing is kept
  /// @param bytes_max of all files together; the ones written longest ago go first
  explicit SceneCache(std::string folder, std::uintmax_t bytes_max = std::uintmax_t{256} << 20U);

  /// As it was stored, whatever has become of it since; nothing if there is none of that hash, or it is larger than
  /// `bytes_max`.
  /// @param ended nobody waits for it any more: nothing, after a mebibyte more at most
  [[nodiscard]] std::optional<std::vector<std::byte>> load(const handover::Hash& hash,
                                                           const std::stop_token& ended = {});

  /// In place of what was there, all of it or nothing; in a file that none but its owner reads, and through no link.
  /// @param ended nobody waits for it any more: it is given up before the next file, and not stored
  void store(const handover::Hash& hash, const std::vector<std::byte>& content, const std::stop_token& ended = {});

  /// It was not what the server announced. The file stays: it may be the announcement that is wrong.
  void store_mismatch(const handover::Hash& hash);

  /// The first thing that went wrong, in one line; empty: nothing did.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

 private:
  [[nodiscard]] std::string file_of(const handover::Hash& hash) const;
  void make_room_for(std::uintmax_t bytes, const std::stop_token& ended);
  void store_problem(const std::string& problem);

  std::string folder_;
  std::uintmax_t bytes_max_;
  std::string problem_;
};

}  // namespace forcebound::client
