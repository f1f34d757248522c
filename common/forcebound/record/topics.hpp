#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "forcebound/time/clock.hpp"

namespace forcebound::record {

inline constexpr std::string_view kProtobufEncoding = "protobuf";

inline constexpr std::string_view kTickSchema = "forcebound.v1.TickRecord";
inline constexpr std::string_view kForceSchema = "forcebound.v1.ForceRecord";
inline constexpr std::string_view kMotionSchema = "forcebound.v1.MotionSample";
inline constexpr std::string_view kSceneUpdateSchema = "foxglove.SceneUpdate";
inline constexpr std::string_view kFrameTransformSchema = "foxglove.FrameTransform";

/// What recordings keep and live viewers are sent: README.md.
enum class Topic : std::uint8_t { tick, force, motion, scene, device, arrows };

struct TopicInfo {
  std::string_view name;
  std::string_view schema;  ///< name of its messages in Protocol Buffers
  bool is_picture = false;  ///< shows what another topic records
};

/// In the order of Topic.
inline constexpr std::array<TopicInfo, 6> kTopics{{{"/tick", kTickSchema},
                                                   {"/force", kForceSchema},
                                                   {"/motion", kMotionSchema},
                                                   {"/scene", kSceneUpdateSchema, true},
                                                   {"/device", kFrameTransformSchema, true},
                                                   {"/arrows", kSceneUpdateSchema, true}}};

[[nodiscard]] constexpr const TopicInfo& info_of(Topic topic) noexcept {
  return kTopics[static_cast<std::size_t>(topic)];
}

/// The serialized FileDescriptorSet that a reader needs to understand messages of this name.
[[nodiscard]] std::string schema_of(std::string_view message_name);

/// A message of a topic, in Protocol Buffers.
struct TopicMessage {
  Topic topic = Topic::tick;
  std::uint32_t sequence = 0;
  time::Nanoseconds at{0};  ///< wall-clock time [since 1970]
  std::string_view content;
};

/// Takes messages.
class TopicSink {
 public:
  virtual ~TopicSink() = default;

  /// Whether messages of this topic are of use now: others are not even made.
  [[nodiscard]] virtual bool wants(Topic topic) const noexcept = 0;
  virtual void take(const TopicMessage& message) = 0;
};

}  // namespace forcebound::record
