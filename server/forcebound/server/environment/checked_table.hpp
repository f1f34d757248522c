#pragma once

#include <toml++/toml.h>

#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/scene/effects/parameter.hpp"
#include "forcebound/server/environment/scene_parser.hpp"

namespace forcebound::server {

/// A TOML table that is read key by key, so that every error names file, line and place, and a key that nothing
/// reads is an error. All members @throw SceneError.
class CheckedTable {
 public:
  /// @param place for errors: "object 'wall', effect 'surface'"
  CheckedTable(const toml::table& table, std::string file, std::string place);

  /// Null where the key is absent.
  const toml::node* find(std::string_view key);
  const toml::node& at(std::string_view key);

  std::string text(std::string_view key);

  /// Text that may stand in a log line: 1 to 64 bytes without control characters.
  std::string name(std::string_view key);

  const toml::table& table(std::string_view key);
  const toml::array& array(std::string_view key);
  double number(const scene::NumberParameter& parameter);
  int whole(const scene::NumberParameter& parameter);

  /// Unit length, any but zero in the file.
  scene::Point direction(std::string_view key, Eigen::Index rows);

  /// One of the words; the first where the key is absent.
  std::string choice(std::string_view key, std::span<const std::string_view> choices);

  bool flag(std::string_view key, bool preset);

  /// The name of a file beside this one, as a path from where the program runs.
  std::string path(std::string_view key);

  /// An array of `rows` finite numbers; the rest of the point is `rest`.
  scene::Point point(std::string_view key, Eigen::Index rows, double rest = 0);

  /// A number of a list; `key` for errors.
  double finite(const toml::node& node, std::string_view key) const;

  /// Every table of the array `what`, if there is one, by `read`, which returns its name; no two of this table's arrays
  /// may have the same.
  void each(std::string_view what, const std::function<std::string(const toml::table&)>& read);

  /// Adds to values_text: what was read by other means.
  void note(std::string_view key, const std::string& value);

  /// To be called when everything is read.
  void refuse_unknown_keys() const;

  /// What the file says of numbers, points and words read so far, "radius_m 0.02, center_m [0, 0]".
  [[nodiscard]] const std::string& values_text() const noexcept { return values_text_; }

  /// What `make` makes of what the table says; what it refuses is said of the place in the file that led there.
  template <class Make>
  auto built_at(const toml::node& where, Make make) const {
    try {
      return make();
    } catch (const SceneError&) {
      throw;
    } catch (const std::runtime_error& error) {
      fail(where, error.what());
    } catch (const std::invalid_argument& error) {
      fail(where, error.what());
    }
  }

  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] const std::string& place() const noexcept { return place_; }

  [[noreturn]] void fail(const toml::node& where, const std::string& what) const;
  [[noreturn]] void fail(const std::string& what) const { fail(table_, what); }

 private:
  /// What an error about a missing key ends with, where another looks like it.
  [[nodiscard]] std::string misspelling_of(std::string_view key) const;

  const toml::table& table_;
  std::string file_;
  std::string place_;
  std::vector<std::string> known_;
  struct Named {
    std::string kind;
    std::string name;
  };
  std::vector<Named> named_;
  std::string values_text_;
};

/// As it stands in the file, for "got ...".
std::string as_written(const toml::node& node);

}  // namespace forcebound::server
