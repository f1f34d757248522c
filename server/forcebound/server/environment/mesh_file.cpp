#include "forcebound/server/environment/mesh_file.hpp"

#include <assimp/MemoryIOWrapper.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "forcebound/scene/geometry/decimate.hpp"
#include "forcebound/server/environment/mesh_check.hpp"
#include "forcebound/text/file.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::server {
namespace {

using scene::GeometryError;

struct Format {
  std::string_view ending;
  void (*check)(const std::string& path, const std::string& content);
  std::string (*plain)(const std::string& content) = nullptr;  ///< if it must be written otherwise for the importer
};

constexpr std::array kFormats{Format{".obj", check_obj}, Format{".off", check_off},
                              Format{".stl", check_stl, plain_stl}};

const Format& format_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const Format& format : kFormats) {
    if (format.ending == ending) return format;
  }
  throw GeometryError(path + ": a mesh is an .obj, .off or .stl file");
}

struct Soup {
  std::vector<scene::Point> vertices;
  std::vector<scene::Triangle> triangles;
};

void add(const aiMesh& mesh, Soup& soup) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  for (const aiVector3D& v : std::span(mesh.mVertices, mesh.mNumVertices)) soup.vertices.emplace_back(v.x, v.y, v.z);
  for (const aiFace& face : std::span(mesh.mFaces, mesh.mNumFaces)) {
    // Lines and points, which an OBJ file may have beside its faces.
    if (face.mNumIndices != 3) continue;
    soup.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
  }
}

/// All that Assimp can open: the text that was checked, under one name. Its own reader of memory opens the material
/// file that an OBJ file names, and takes the OBJ file itself for a missing one, which ends the process.
class OneFile final : public Assimp::IOSystem {
 public:
  /// @param content it must outlive this
  OneFile(std::string name, const std::string& content) : name_(std::move(name)), content_(content) {}

  bool Exists(const char* file) const override { return name_ == file; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* /*mode*/) override {
    if (!Exists(file)) return nullptr;
    // NOLINTNEXTLINE(cppcoreguidelines-owning-memory,cppcoreguidelines-pro-type-reinterpret-cast): Assimp's interface
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(content_.data()), content_.size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }  // NOLINT(cppcoreguidelines-owning-memory): as above

 private:
  std::string name_;
  const std::string& content_;
};

Soup import(const std::string& path, const std::string& content, const Format& format) {
  Assimp::Importer importer;
  const std::string hint(format.ending.substr(1));
  const std::string name = "mesh" + std::string(format.ending);
  importer.SetIOHandler(new OneFile(name, content));  // NOLINT(cppcoreguidelines-owning-memory): the importer owns it
  const aiScene* const read = importer.ReadFile(name, aiProcess_Triangulate);
  if (read == nullptr) {
    throw GeometryError(path + ": cannot be read as " + hint + ": " + text::printable(importer.GetErrorString()));
  }
  Soup soup;
  for (const aiMesh* mesh : std::span(read->mMeshes, read->mNumMeshes)) add(*mesh, soup);
  return soup;
}

}  // namespace

scene::TriangleMesh load_mesh(const std::string& path, const scene::MeshPlacement& placement) {
  const Format& format = format_of(path);
  std::string content;
  try {
    content = text::read_file(path);
    format.check(path, content);
    if (format.plain != nullptr) content = format.plain(content);
  } catch (const GeometryError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw GeometryError(error.what());
  }
  const Soup soup = import(path, content, format);
  return {path, soup.vertices, soup.triangles, placement};
}

scene::ShapeGeometry triangles_of(const scene::ShapeKind& kind, const config::Values& given,
                                  const std::string& folder) {
  if (kind.geometry != scene::GeometryKind::triangles || !given.has("file")) return {};
  const config::Values values = config::completed(kind.parameters, given);
  const std::string path = (std::filesystem::path(folder) / values.text("file")).string();
  return {.mesh = std::make_shared<const scene::TriangleMesh>(
              decimated(load_mesh(path, scene::placement_of(values)), values.number("detail")))};
}

}  // namespace forcebound::server
