#include "forcebound/server/dynamics/bodies/mjcf_check.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "forcebound/server/dynamics/bodies/mujoco.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

/// Of builtin textures and of height fields, each.
constexpr double kBytesMost = 256.0 * 1024 * 1024;

using tinyxml2::XMLElement;

/// Empty where the element has none.
std::string_view attribute(const XMLElement& element, const char* key) {
  const char* const value = element.Attribute(key);
  return value == nullptr ? std::string_view() : value;
}

std::optional<double> number_of(std::string_view word) {
  return text::finite_number(word.starts_with('+') ? word.substr(1) : word);
}

std::string named(const XMLElement& element) {
  return std::string(element.Name()) + " '" + std::string(attribute(element, "name")) + "'";
}

/// Zero where it is absent. MuJoCo would take the beginning of other words for the number.
double count_at(const XMLElement& element, const char* key) {
  const std::vector<std::string_view> words = text::split_at_blanks(attribute(element, key));
  if (words.empty()) return 0;
  const auto count = text::whole_number<unsigned>(words.front());
  if (words.size() == 1 && count) return *count;
  throw BodiesError(named(element) + ": " + key + " must be a whole number >= 0, got '" +
                    text::printable(attribute(element, key)) + "'");
}

void check_mesh(const XMLElement& mesh) {
  const std::vector<std::string_view> numbers = text::split_at_blanks(attribute(mesh, "vertex"));
  // MuJoCo reads at least up to the first that is no number.
  const auto end_of_numbers =
      std::ranges::find_if_not(numbers, [](std::string_view word) { return number_of(word).has_value(); });
  const auto vertices = static_cast<std::size_t>(end_of_numbers - numbers.begin()) / 3;
  // Without vertices of its own they come from a file, and MuJoCo refuses faces beside those of the file.
  if (numbers.empty()) return;
  for (const std::string_view word : text::split_at_blanks(attribute(mesh, "face"))) {
    const auto vertex = text::whole_number<std::size_t>(word);
    if (vertex && *vertex < vertices) continue;
    throw BodiesError(named(mesh) + ": face must have numbers of its " + std::to_string(vertices) +
                      " vertices, from 0 on, got " + text::printable(word));
  }
}

double bytes_of_texture(const XMLElement& texture) {
  constexpr int kSides = 6;
  constexpr int kColors = 3;
  // The size of one from a file is the file's.
  const std::string_view builtin = attribute(texture, "builtin");
  if (builtin.empty() || builtin == "none") return 0;
  const double width = count_at(texture, "width");
  return kColors * width * (attribute(texture, "type") == "2d" ? count_at(texture, "height") : kSides * width);
}

double bytes_of_height_field(const XMLElement& field) {
  return sizeof(float) * count_at(field, "nrow") * count_at(field, "ncol");
}

class MjcfCheck final : public tinyxml2::XMLVisitor {
 public:
  explicit MjcfCheck(const std::string& folder) : folder_(folder) {}

  void check(std::string_view text) {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) == tinyxml2::XML_SUCCESS) document.Accept(this);
  }

  bool VisitEnter(const XMLElement& element, const tinyxml2::XMLAttribute* /*first*/) override {
    const std::string_view name = element.Name();
    if (name == "mesh") check_mesh(element);
    if (name == "texture") add(bytes_of_texture(element), texture_bytes_, "textures", element);
    if (name == "hfield") add(bytes_of_height_field(element), height_field_bytes_, "height fields", element);
    if (name == "include") check_included(std::string(attribute(element, "file")));
    return true;
  }

 private:
  static void add(double bytes, double& sum, const std::string& what, const XMLElement& element) {
    sum += bytes;
    if (sum <= kBytesMost) return;
    throw BodiesError(named(element) + ": all " + what + " must take at most " + text::fixed(kBytesMost, 0) +
                      " bytes together, got " + text::fixed(sum, 0));
  }

  void check_included(const std::string& file) {
    // MuJoCo refuses a file that is included twice, so that none includes itself.
    if (!included_.insert(file).second) return;
    // As MuJoCo does: a path that begins with a slash is below the folder too.
    const std::string path = folder_.empty() ? file : folder_ + '/' + file;
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return;
    try {
      check(text::read_file(path));
    } catch (const BodiesError&) {
      throw;
    } catch (const std::runtime_error&) {  // it cannot be read
    }
  }

  std::string folder_;
  std::set<std::string> included_;
  double texture_bytes_ = 0;
  double height_field_bytes_ = 0;
};

}  // namespace

void check_mjcf(std::string_view text, const std::string& folder) { MjcfCheck(folder).check(text); }

}  // namespace forcebound::server
