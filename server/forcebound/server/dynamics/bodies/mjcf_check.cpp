#include "forcebound/server/dynamics/bodies/mjcf_check.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

#include "forcebound/server/dynamics/bodies/mujoco.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::server {
namespace {

constexpr std::string_view kBlank = " \t\r\n";
constexpr double kTextureBytesMost = 256.0 * 1024 * 1024;

using tinyxml2::XMLElement;

/// Empty where the element has none.
std::string_view attribute(const XMLElement& element, const char* key) {
  const char* const value = element.Attribute(key);
  return value == nullptr ? std::string_view() : value;
}

std::vector<std::string_view> words_between_blanks(std::string_view text) {
  std::vector<std::string_view> words;
  for (std::size_t at = text.find_first_not_of(kBlank); at < text.size();) {
    const auto end = std::min(text.find_first_of(kBlank, at), text.size());
    words.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(kBlank, end);
  }
  return words;
}

/// As a C++ stream reads it, which is how MuJoCo does.
std::optional<double> number_of(std::string_view word) {
  return text::finite_number(word.starts_with('+') ? word.substr(1) : word);
}

void check_mesh(const XMLElement& mesh) {
  const std::vector<std::string_view> numbers = words_between_blanks(attribute(mesh, "vertex"));
  // MuJoCo reads up to the first that is no number.
  const auto end_of_numbers =
      std::ranges::find_if_not(numbers, [](std::string_view word) { return number_of(word).has_value(); });
  const auto vertices = static_cast<std::size_t>(end_of_numbers - numbers.begin()) / 3;
  // Without vertices of its own they come from a file, and MuJoCo refuses faces beside those of the file.
  if (numbers.empty()) return;
  for (const std::string_view word : words_between_blanks(attribute(mesh, "face"))) {
    std::size_t vertex = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), vertex);
    if (error == std::errc{} && end == word.data() + word.size() && vertex < vertices) continue;
    throw BodiesError("mesh '" + std::string(attribute(mesh, "name")) + "': face must have numbers of its " +
                      std::to_string(vertices) + " vertices, from 0 on, got " + std::string(word));
  }
}

double bytes_of_texture(const XMLElement& texture) {
  const auto size = [&](const char* key) {
    const std::vector<std::string_view> words = words_between_blanks(attribute(texture, key));
    return words.empty() ? 0.0 : number_of(words.front()).value_or(0);
  };
  const double width = size("width");
  const double height = size("height");
  constexpr int kSides = 6;
  constexpr int kColors = 3;
  return kColors * width * (attribute(texture, "type") == "2d" ? height : kSides * width);
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
    if (name == "texture") check_texture(element);
    if (name == "include") check_included(std::string(attribute(element, "file")));
    return true;
  }

 private:
  void check_texture(const XMLElement& texture) {
    texture_bytes_ += std::max(0.0, bytes_of_texture(texture));
    if (texture_bytes_ <= kTextureBytesMost) return;
    throw BodiesError("texture '" + std::string(attribute(texture, "name")) +
                      "': all textures must be at most 268435456 bytes together, got " +
                      text::fixed(texture_bytes_, 0));
  }

  void check_included(const std::string& file) {
    // MuJoCo refuses a file that is included twice, so that none includes itself.
    if (!included_.insert(file).second) return;
    std::string content;
    try {
      content = text::read_file((std::filesystem::path(folder_) / file).string());
    } catch (const std::runtime_error&) {
      return;
    }
    check(content);
  }

  std::string folder_;
  std::set<std::string> included_;
  double texture_bytes_ = 0;
};

}  // namespace

void check_mjcf(std::string_view text, const std::string& folder) { MjcfCheck(folder).check(text); }

}  // namespace forcebound::server
