#include "forcebound/server/dynamics/bodies/mjcf_check.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "forcebound/server/dynamics/bodies/bodies_error.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

/// Of builtin textures and of height fields, each.
constexpr double kBytesMost = 256.0 * 1024 * 1024;

/// Of the bodies of one `composite`.
constexpr std::int64_t kCompositeMost = 10'000;

/// A whole number that MuJoCo takes as it is, -1 being its own choice.
struct CountLimit {
  std::string_view element;
  const char* attribute;
  std::int64_t most;
};

constexpr std::int64_t kUserMost = 1'000;
constexpr std::array kCountLimits{CountLimit{"size", "njmax", 100'000},
                                  CountLimit{"size", "nconmax", 100'000},
                                  CountLimit{"size", "nstack", 100'000'000},
                                  CountLimit{"size", "nuserdata", 1'000'000},
                                  CountLimit{"size", "nkey", 10'000},
                                  CountLimit{"size", "nuser_body", kUserMost},
                                  CountLimit{"size", "nuser_jnt", kUserMost},
                                  CountLimit{"size", "nuser_geom", kUserMost},
                                  CountLimit{"size", "nuser_site", kUserMost},
                                  CountLimit{"size", "nuser_cam", kUserMost},
                                  CountLimit{"size", "nuser_tendon", kUserMost},
                                  CountLimit{"size", "nuser_actuator", kUserMost},
                                  CountLimit{"size", "nuser_sensor", kUserMost},
                                  CountLimit{"numeric", "size", 1'000'000},
                                  CountLimit{"user", "dim", kUserMost}};

using tinyxml2::XMLElement;

/// Empty where the element has none.
std::string_view attribute(const XMLElement& element, const char* key) {
  const char* const value = element.Attribute(key);
  return value == nullptr ? std::string_view() : value;
}

std::optional<double> number_of(std::string_view word) {
  return text::finite_number(word.starts_with('+') ? word.substr(1) : word);
}

/// "mesh 'n'", or "size" without a name.
std::string element_named(const XMLElement& element) {
  const std::string_view name = attribute(element, "name");
  return text::printable(element.Name()) + (name.empty() ? "" : " '" + text::printable(name) + "'");
}

[[noreturn]] void refuse_count(const XMLElement& element, const char* key, const std::string& range) {
  throw BodiesError(element_named(element) + ": " + key + " must be a whole number " + range + ", got '" +
                    text::printable(attribute(element, key)) + "'");
}

/// Zero where it is absent. MuJoCo would take the beginning of other words for the number.
double count_at(const XMLElement& element, const char* key) {
  const std::vector<std::string_view> words = text::split_at_blanks(attribute(element, key));
  if (words.empty()) return 0;
  const auto count = text::whole_number<unsigned>(words.front());
  if (words.size() == 1 && count) return *count;
  refuse_count(element, key, ">= 0");
}

void check_count(const XMLElement& element, const CountLimit& limit) {
  const std::vector<std::string_view> words = text::split_at_blanks(attribute(element, limit.attribute));
  if (words.empty()) return;
  const auto count = text::whole_number<std::int64_t>(words.front());
  if (words.size() == 1 && count && *count >= -1 && *count <= limit.most) return;
  refuse_count(element, limit.attribute, "from -1 to " + std::to_string(limit.most));
}

void check_composite(const XMLElement& composite) {
  std::int64_t bodies = 1;
  for (const std::string_view word : text::split_at_blanks(attribute(composite, "count"))) {
    const auto count = text::whole_number<std::int64_t>(word);
    // Of what is not above zero MuJoCo says so.
    bodies = count && *count <= kCompositeMost ? bodies * std::max<std::int64_t>(1, *count) : kCompositeMost + 1;
    if (bodies <= kCompositeMost) continue;
    throw BodiesError(element_named(composite) + ": count must be whole numbers with a product of at most " +
                      std::to_string(kCompositeMost) + ", got '" + text::printable(attribute(composite, "count")) +
                      "'");
  }
}

void check_mesh(const XMLElement& mesh) {
  const std::vector<std::string_view> numbers = text::split_at_blanks(attribute(mesh, "vertex"));
  // MuJoCo reads at least up to the first that is no number.
  const auto end_of_numbers =
      std::ranges::find_if_not(numbers, [](std::string_view word) { return number_of(word).has_value(); });
  const auto vertices = static_cast<std::size_t>(end_of_numbers - numbers.begin()) / 3;
  for (const std::string_view word : text::split_at_blanks(attribute(mesh, "face"))) {
    const auto vertex = text::whole_number<std::size_t>(word);
    if (vertex && *vertex < vertices) continue;
    throw BodiesError(element_named(mesh) + ": face must have numbers of its " + std::to_string(vertices) +
                      " vertices, from 0 on, got " + text::printable(word));
  }
}

double bytes_of_texture(const XMLElement& texture) {
  constexpr int kSides = 6;
  constexpr int kColors = 3;
  const std::string_view builtin = attribute(texture, "builtin");
  if (builtin.empty() || builtin == "none") return 0;
  const double width = count_at(texture, "width");
  return kColors * width * (attribute(texture, "type") == "2d" ? count_at(texture, "height") : kSides * width);
}

double bytes_of_height_field(const XMLElement& field) {
  return sizeof(float) * count_at(field, "nrow") * count_at(field, "ncol");
}

/// `file` of meshes, textures and others, and `fileright` and its like of textures with six sides.
void check_files(const XMLElement& element) {
  for (const tinyxml2::XMLAttribute* at = element.FirstAttribute(); at != nullptr; at = at->Next()) {
    const std::string_view key = at->Name();
    if (!key.starts_with("file") || std::string_view(at->Value()).empty()) continue;
    throw BodiesError(element_named(element) + ": " + text::printable(key) + " '" + text::printable(at->Value()) +
                      "': a model must name no file, its meshes have vertex and face");
  }
  if (std::string_view(element.Name()) != "include") return;
  throw BodiesError("include: a model must name no file, but have all in one");
}

class MjcfCheck final : public tinyxml2::XMLVisitor {
 public:
  bool VisitEnter(const XMLElement& element, const tinyxml2::XMLAttribute* /*first*/) override {
    const std::string_view name = element.Name();
    check_files(element);
    for (const CountLimit& limit : kCountLimits) {
      if (name == limit.element) check_count(element, limit);
    }
    if (name == "composite") check_composite(element);
    if (name == "mesh") check_mesh(element);
    if (name == "texture") add(bytes_of_texture(element), texture_bytes_, "textures", element);
    if (name == "hfield") add(bytes_of_height_field(element), height_field_bytes_, "height fields", element);
    return true;
  }

 private:
  static void add(double bytes, double& sum, const std::string& what, const XMLElement& element) {
    sum += bytes;
    if (sum <= kBytesMost) return;
    throw BodiesError(element_named(element) + ": all " + what + " must take at most " + text::fixed(kBytesMost, 0) +
                      " bytes together, got " + text::fixed(sum, 0));
  }

  double texture_bytes_ = 0;
  double height_field_bytes_ = 0;
};

}  // namespace

void check_mjcf(std::string_view text) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return;
  // MuJoCo would take a <robot> for another format, which has files.
  const XMLElement* const root = document.RootElement();
  if (root != nullptr && std::string_view(root->Name()) != "mujoco") {
    throw BodiesError("expected <mujoco>...</mujoco>, got <" + text::printable(root->Name()) + ">");
  }
  MjcfCheck check;
  document.Accept(&check);
}

}  // namespace forcebound::server
