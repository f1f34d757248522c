#pragma once

#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "forcebound/config/config_error.hpp"
#include "forcebound/config/node.hpp"
#include "forcebound/config/parameter.hpp"
#include "forcebound/control/vector.hpp"

namespace forcebound::config {

using control::Matrix;
using control::Vector;

/// The key `name` of each table that CheckedTable::each reads.
[[nodiscard]] TextParameter name_of_part();

/// A table of a file that is read key by key, so that every error names file, line and place, and an unknown key is an
/// error. All members @throw ConfigError.
class CheckedTable {
 public:
  /// @param table it must outlive this
  /// @param place for errors: "object 'wall', effect 'surface'"
  CheckedTable(const Node& table, std::string file, std::string place)
      : table_(table), file_(std::move(file)), place_(std::move(place)) {}

  /// Null where the key is absent.
  const Node* find(std::string_view key);

  /// @param accepted in words, for the error about a missing key
  const Node& at(std::string_view key, std::string_view accepted);
  const Node& at(std::string_view key) { return at(key, {}); }

  /// The first of these keys that the table has, which must have one. Does not mark them as known.
  [[nodiscard]] std::string_view first_given(std::span<const std::string_view> keys) const;

  // Value of a declared key: from the file, else the preset; ConfigError if there is neither.
  double number(const NumberParameter& parameter) { return value<double>(parameter); }
  int whole(NumberParameter parameter);
  bool flag(std::string_view key, bool preset) { return value<bool>(FlagParameter{.key = key, .preset = preset}); }
  std::string text(std::string_view key) { return value<std::string>(TextParameter{.key = key}); }
  std::string text(const TextParameter& parameter) { return value<std::string>(parameter); }

  /// Must be given: the first choice is no preset here.
  std::string choice(const ChoiceParameter& parameter);

  /// The declared keys that the file has, each value checked. Marks the declared keys as known.
  /// @param axes how many numbers a point has
  Values given(std::span<const Parameter> parameters, Eigen::Index axes = 3);

  /// As `given`, with presets for absent keys. An undeclared key in the table is an error.
  Values all(std::span<const Parameter> parameters, Eigen::Index axes = 3);

  /// One number for all rows, or a list with one number per row; all within the range of `each`. The preset applies
  /// to every row.
  Vector vector(const NumberParameter& each, Eigen::Index rows);

  /// A symmetric positive definite matrix: one number > 0 for the whole diagonal, a list for the diagonal, or a list
  /// of rows.
  Matrix matrix(std::string_view key, Eigen::Index rows);

  CheckedTable table(std::string_view key) { return table(key, place_ + ", " + std::string(key)); }
  CheckedTable table(std::string_view key, const std::string& place);
  const Node::List& list(std::string_view key);

  /// Calls `read` for every table of the array `kind`, with the table's name; the key `name` is marked as known. No two
  /// tables of this table's arrays may have the same name; the second is refused before it is read.
  void each(const std::string& kind, const std::function<void(CheckedTable& part, const std::string& name)>& read);

  /// Call it after everything was read.
  void refuse_unknown_keys(const std::string& refusal = "unknown key") const;

  /// Calls `make`. A ValueError that it throws becomes a ConfigError with the line of the key that it names, any other
  /// std::invalid_argument or std::runtime_error one with the line of `where`. Other exceptions leave as they are.
  template <class Make>
  decltype(auto) built_at(const Node& where, Make make) const {
    try {
      return make();
    } catch (const ConfigError&) {
      throw;
    } catch (const ValueError& error) {
      fail(place_of(error, where), error.what());
    } catch (const std::runtime_error& error) {
      fail(where, error.what());
    } catch (const std::invalid_argument& error) {
      fail(where, error.what());
    }
  }

  [[nodiscard]] const Node& node() const noexcept { return table_; }
  [[nodiscard]] const std::string& file() const noexcept { return file_; }
  [[nodiscard]] const std::string& place() const noexcept { return place_; }

  /// The folder of this file; paths in the file are relative to it.
  [[nodiscard]] std::string folder() const;

  /// Folders besides its own in which the files may lie that this file names. For tables that are read from now on.
  void allow_files_in(std::span<const std::string> folders) { folders_.assign(folders.begin(), folders.end()); }

  /// The path of a file that this one names, in its own folder or an allowed one. @param key with the name
  [[nodiscard]] std::string path_at(std::string_view key, const std::string& named) const;

  [[noreturn]] void fail(const Node& where, const std::string& what) const;
  [[noreturn]] void fail(const std::string& what) const { fail(table_, what); }

  /// @throws ConfigError always, with the line of the key.
  [[noreturn]] void refuse(std::string_view key, const std::string& must_be) const;

 private:
  template <class Type>
  Type value(const Parameter& parameter);
  [[nodiscard]] Value value_of(const Parameter& parameter, const Node& node, Eigen::Index axes) const;
  [[nodiscard]] double finite(const Node& node, const std::string& what) const;
  [[nodiscard]] double checked_number(const Node& node, NumberParameter parameter, const std::string& what) const;
  [[nodiscard]] Vector numbers(const Node& list, const NumberParameter& each, Eigen::Index rows) const;
  [[nodiscard]] const Node& place_of(const ValueError& error, const Node& otherwise) const noexcept;
  [[nodiscard]] Rows rows(const Node& list, const std::string& key) const;

  /// An unknown key of the table with a similar spelling; empty if there is none.
  [[nodiscard]] std::string misspelling_of(std::string_view key) const;

  const Node& table_;
  std::string file_;
  std::string place_;
  std::vector<std::string> folders_;
  std::vector<std::string> known_;
  struct Named {
    std::string kind;
    std::string name;
  };
  std::vector<Named> named_;
};

}  // namespace forcebound::config
