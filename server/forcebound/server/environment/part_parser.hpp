#pragma once

#include <string>
#include <vector>

#include "forcebound/scene/effects/registry.hpp"
#include "forcebound/scene/plan.hpp"
#include "forcebound/server/environment/checked_table.hpp"

namespace forcebound::server {

/// Reads an [[object]] or a [[field]] with the effects that are registered. All members @throw SceneError.
class PartParser {
 public:
  /// @param registry must outlive this
  /// @param rows of points
  PartParser(std::string file, const scene::EffectRegistry& registry, Eigen::Index rows)
      : file_(std::move(file)), registry_(registry), rows_(rows) {}

  [[nodiscard]] scene::SceneObject object(const toml::table& table) const { return part(table, "object"); }
  [[nodiscard]] scene::SceneObject field(const toml::table& table) const { return part(table, "field"); }

 private:
  using Already = std::vector<scene::RequestedEffect>;

  [[nodiscard]] scene::SceneObject part(const toml::table& table, const std::string& what) const;
  [[nodiscard]] std::vector<std::string> names_of_effects(bool of_surfaces_too) const;
  void parse_shape_of(CheckedTable& object, scene::SceneObject& made) const;
  [[nodiscard]] scene::RequestedEffect parse_effect(CheckedTable& part, const toml::node& wanted,
                                                    const std::vector<std::string>& known,
                                                    const Already& already) const;
  [[nodiscard]] scene::EffectValues parse_values(CheckedTable& table, const scene::EffectKind& kind) const;
  [[nodiscard]] scene::Point parse_point(CheckedTable& table, const scene::PointParameter& parameter) const;
  static void refuse_pressure_of_nothing(const CheckedTable& object, const toml::node& effects, const Already& made);
  void refuse_unrequested_tables(const CheckedTable& part, const toml::table& table, const Already& effects) const;

  std::string file_;
  const scene::EffectRegistry& registry_;
  Eigen::Index rows_;
};

}  // namespace forcebound::server
